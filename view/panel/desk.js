/**
 * What the page knows: its machines, their states and consoles, and which of them it shows.
 */

import { Link } from "husillo/panel/link.js";

/** Lines of a console that are kept. */
const MOST_LINES = 2000;
/** Points of the path of a tool that are kept. */
const MOST_POINTS = 100_000;

/**
 * @typedef {object} Info
 * @property {number} machine
 * @property {string} name
 * @property {string} port
 * @property {boolean} [is_simulated]
 * @property {string[]} axes
 * @property {"grbl" | "micromill" | "drill" | "microfactory" | "measuring"} family
 * @property {string[]} offers what the page can do with it, beside moving it by hand
 * @property {([number, number] | null)[] | null} [travel_mm] of each axis, from machine zero
 *
 * @typedef {[number, number, number, number]} Point of the path of a tool: -1 for its begin, or the
 * motion that has led there (0 by hand, 1 rapid, 2 feed), then X, Y and Z in nm
 *
 * @typedef {object} Line a line of the console
 * @property {number} number
 * @property {number} at_ms
 * @property {"host" | "controller" | "server"} from
 * @property {string} text
 *
 * @typedef {object} Running the program of a machine
 * @property {string} name
 * @property {number} lines
 * @property {number} errors
 * @property {number} warnings
 * @property {number} load
 * @property {string} phase
 * @property {number | null} line
 * @property {number} sent
 * @property {number} answered
 * @property {number} of
 * @property {number | null} time_s
 * @property {number | null} elapsed_s
 * @property {number | null} remaining_s
 * @property {number | null} progress
 * @property {boolean} single_block
 * @property {number[]} breakpoints
 * @property {number | null} waits_before
 * @property {string | null} message
 * @property {number} [runs] how many have ended: the last one has a report
 * @property {number | null} [resume_line] the line with which an interrupted program goes on
 * @property {Change | null} [change] the tool that the operator puts in now
 *
 * @typedef {object} Change of a tool
 * @property {number | null} tool its number, if the program has one
 * @property {string} note the comment of its line
 * @property {number} line
 * @property {number | null} kind `$341` of a controller that has its own protocol for it
 *
 * @typedef {object} State
 * @property {number} number
 * @property {"opening" | "up" | "lost"} link
 * @property {string | null} why
 * @property {string | null} controller
 * @property {string | null} state
 * @property {number | null} detail
 * @property {{number: number, text: string} | null} alarm
 * @property {string | null} advice
 * @property {string[]} axes
 * @property {number[] | null} machine_mm
 * @property {number[] | null} work_mm
 * @property {number[] | null} zero_mm
 * @property {number | null} feed
 * @property {number | null} rpm
 * @property {{feed: number, rapid: number, spindle: number} | null} override
 * @property {{spindle: "off" | "cw" | "ccw", flood: boolean, mist: boolean} | null} accessories
 * @property {string[]} switches
 * @property {string[]} modal
 * @property {string | null} offset
 * @property {number | null} tool
 * @property {number | null} [tool_length_mm] that is in effect
 * @property {number | null} operator
 * @property {number} clients
 * @property {{client: number, jog: number} | null} jog
 * @property {boolean} stopping
 * @property {boolean} [emergency_waits] an emergency stop is asked for, and not confirmed
 * @property {number} undo
 * @property {{at_mm: number[], touched: boolean, count: number} | null} probe
 * @property {Running | null} program
 * @property {Mill} [mill]
 * @property {Drill} [drill]
 * @property {Factory} [factory]
 * @property {Measuring} [measuring]
 *
 * @typedef {object} Mill what only a micro mill has
 * @property {boolean} is_homed
 * @property {number[] | null} motor_steps
 * @property {number[] | null} backlash_um
 * @property {number} step_hz
 * @property {number} motor_rpm
 * @property {number | null} jog_hz
 * @property {string} sent
 * @property {string} echo
 * @property {string | null} outcome
 *
 * @typedef {object} Drill what only a drill has
 * @property {boolean} is_homed
 * @property {boolean} is_manual
 * @property {number[]} steps
 * @property {"up" | "down" | "between"} z
 * @property {boolean} spindle
 * @property {string[]} lights
 * @property {number} heartbeats
 * @property {number | null} records
 * @property {[number, number][]} taught_mm
 *
 * @typedef {object} Factory what only a microfactory has
 * @property {boolean} is_homed
 * @property {boolean} is_latched
 * @property {number[]} steps
 * @property {boolean} contact
 * @property {string | null} report
 * @property {string | null} motion
 * @property {number | null} line of the drawn program whose move is cut
 * @property {number | null} stored
 *
 * @typedef {object} Measuring what only a measuring machine has; lengths are in its unit
 * @property {"mm" | "counts"} unit
 * @property {{
 *     letter: string,
 *     work: number,
 *     machine: number | null,
 *     counts: number,
 *     target: number,
 *     error: number,
 * }[]} axes
 * @property {boolean} is_pressed
 * @property {{fast: number, slow: number}} speeds per second
 * @property {{pre_travel: [number, number], ball: number}} tip
 * @property {{
 *     trigger: number[],
 *     contact: number[],
 *     pre_travel: number,
 *     touches: number,
 *     spread: number,
 *     over_travel: number,
 * } | null} touch
 * @property {{sent: string, received: string}[]} line the last bytes
 * @property {RoutineState | null} routine
 *
 * @typedef {object} RoutineState the last routine
 * @property {string} name
 * @property {string} phase
 * @property {number | null} line
 * @property {number | null} waits_at
 * @property {string | null} message
 * @property {string | null} summary
 * @property {boolean} is_good
 * @property {number} features how many were measured
 * @property {number} runs how many have ended: the last one has a report
 */

/** A machine, as the page knows it. */
export class Machine {
    /** @param {Info} info */
    constructor(info) {
        this.info = info;
        /** The last state; none before the first, and after the link was lost. */
        this.state = /** @type {State | undefined} */ (undefined);
        /** @type {Line[]} */
        this.lines = [];
        /** The path of its tool. @type {Point[]} */
        this.path = [];
    }
}

/** The desk of the operator. */
export class Desk {
    /**
     * @param {string} origin
     * @param {string} token
     */
    constructor(origin, token) {
        /** @type {Map<number, Machine>} */
        this.machines = new Map();
        /** The machine that is shown. @type {Machine | undefined} */
        this.machine = undefined;
        /** The last refusal of a request, and whether it is shown. */
        this.refusal = "";
        /** @type {((machine: Machine | undefined) => void)[]} */
        this.listeners = [];
        /** @type {((lines: Line[] | undefined) => void)[]} */
        this.readers = [];
        this.link = new Link(origin, token, {
            frame: (frame) => this.take(frame),
            status: () => this.changed(),
        });
    }

    /** What the page can do with the shown machine, beside moving it by hand. */
    get offers() {
        return new Set(this.machine?.info.offers ?? []);
    }

    /** The family of the shown machine. */
    get family() {
        return this.machine?.info.family ?? "grbl";
    }

    /** The state of the shown machine, if the link is up. */
    get state() {
        return this.link.status === "up" ? this.machine?.state : undefined;
    }

    /** Whether this page is in control of the shown machine. */
    get isOperator() {
        const { state } = this;
        return state !== undefined && state.operator === this.link.client;
    }

    /** Whether this page may command the machine now. */
    get mayCommand() {
        return this.isOperator && this.state?.link === "up";
    }

    /** Whether a program runs, is held or waits. */
    get isUnderWay() {
        const phase = this.state?.program?.phase ?? "";
        return ["running", "held", "waiting", "stopping"].includes(phase);
    }

    /** The change of a tool for which a program waits. @returns {Change | undefined} */
    get change() {
        return this.state?.program?.change ?? undefined;
    }

    /** Whether a program has the machine. While it waits for a tool, the operator has it. */
    get isOfProgram() {
        return this.isUnderWay && !this.change;
    }

    /** Whether the machine stands and waits for commands. */
    get isIdle() {
        return this.state?.state === "Idle" && !this.isOfProgram;
    }

    /** Whether something moves or is about to. */
    get isBusy() {
        const { state } = this;
        const word = state?.state ?? "";
        return this.isOfProgram || ["Run", "Jog", "Home", "Probe", "Hold", "Door"].includes(word);
    }

    /** @param {() => void} listener called after each change */
    listen(listener) {
        this.listeners.push(listener);
    }

    /**
     * @param {(lines: Line[] | undefined) => void} reader called with new lines of the console of
     * the shown machine; without lines after another machine was chosen
     */
    read(reader) {
        this.readers.push(reader);
    }

    changed() {
        // A listener may remove itself.
        for (const listener of [...this.listeners]) listener(this.machine);
    }

    /** @param {any} frame */
    take(frame) {
        if (frame.kind === "welcome") this.welcome(frame.machines);
        else if (frame.kind === "refusal") this.refuse(frame.text);
        else {
            const machine = this.machines.get(frame.machine);
            if (!machine) return;
            if (frame.kind === "state") machine.state = frame;
            if (frame.kind === "console") this.print(machine, frame.lines);
            if (frame.kind === "path") {
                if (frame.from === 0) machine.path = [];
                machine.path.push(...frame.points);
                machine.path.splice(0, Math.max(0, machine.path.length - MOST_POINTS));
            }
            if (frame.kind !== "console" && machine === this.machine) this.changed();
        }
    }

    /** @param {Info[]} infos */
    welcome(infos) {
        const chosen = this.machine?.info.machine ?? Number(sessionStorage.getItem("machine"));
        this.machines = new Map(infos.map((info) => [info.machine, new Machine(info)]));
        this.machine = this.machines.get(chosen) ?? this.machines.values().next().value;
        for (const reader of this.readers) reader(undefined);
        for (const info of infos) {
            // It is refused if another page is in control: then this one watches.
            this.link.request("take", { machine: info.machine }).catch(() => {});
        }
    }

    /**
     * @param {Machine} machine
     * @param {Line[]} lines
     */
    print(machine, lines) {
        machine.lines.push(...lines);
        machine.lines.splice(0, Math.max(0, machine.lines.length - MOST_LINES));
        if (machine !== this.machine) return;
        for (const reader of this.readers) reader(lines);
    }

    /**
     * Shows another machine.
     *
     * @param {number} number
     */
    choose(number) {
        this.machine = this.machines.get(number);
        sessionStorage.setItem("machine", String(number));
        for (const reader of this.readers) reader(undefined);
        this.changed();
    }

    /** @param {string} text why a request was refused; empty to forget it */
    refuse(text) {
        this.refusal = text;
        this.changed();
    }

    /**
     * A request to the shown machine.
     *
     * @param {string} verb
     * @param {object} [fields]
     * @returns {Promise<any>}
     */
    request(verb, fields = {}) {
        return this.link.request(verb, { machine: this.machine?.info.machine, ...fields });
    }

    /**
     * A request whose refusal is shown to the operator. Gives the data, or undefined.
     *
     * @param {string} verb
     * @param {object} [fields]
     * @returns {Promise<any>}
     */
    async command(verb, fields = {}) {
        try {
            const data = await this.request(verb, fields);
            if (this.refusal) this.refuse("");
            return data ?? null;
        } catch (error) {
            this.refuse(error instanceof Error ? error.message : String(error));
            return undefined;
        }
    }

    /**
     * A request without an answer. Returns false if there is no link.
     *
     * @param {string} verb
     * @param {object} [fields]
     */
    tell(verb, fields = {}) {
        return this.link.tell(verb, { machine: this.machine?.info.machine, ...fields });
    }

    /**
     * The path of a file of the shown machine.
     *
     * @param {string} file such as `scene`
     */
    path(file) {
        return `/machines/${this.machine?.info.machine}/${file}`;
    }
}
