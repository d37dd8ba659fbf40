/**
 * The machine behind the link as the rig of the probing cycles.
 */

/** @typedef {import("husillo/panel/probing.js").Axis} Axis */

/** Rate of the moves that meet no part, mm/min. */
const RATE = 600;

/** A cycle was stopped by the operator. */
export class Stopped extends Error {}

/** The machine of a desk, whose answers and states tell when a move is over. */
export class LinkedRig {
    /**
     * @param {import("husillo/panel/desk.js").Desk} desk
     * @param {{contact: string, stopped: string}} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        /** A cycle ends when another machine is shown: its moves are for this one. */
        this.machine = desk.machine;
        this.isStopped = false;
    }

    /** Ends the cycle: no further move is sent. */
    stop() {
        // What is shown anew may stop once more.
        if (this.isStopped) return;
        this.isStopped = true;
        // Who waits for a state is woken.
        this.desk.changed();
    }

    get mayGoOn() {
        const { desk, machine } = this;
        return !this.isStopped && desk.machine === machine && desk.mayCommand;
    }

    /**
     * @param {string} verb
     * @param {object} fields
     */
    async send(verb, fields) {
        if (!this.mayGoOn) throw new Stopped(this.words.stopped);
        return this.desk.request(verb, fields);
    }

    /**
     * Sends a move, and waits until the machine stands: a state from after the answer says so.
     *
     * @param {string} verb
     * @param {object} fields
     */
    async move(verb, fields) {
        const from = String(this.desk.state?.machine_mm);
        await this.send(verb, fields);
        await this.until(() => {
            const { state } = this.desk;
            return state?.state === "Idle" && String(state.machine_mm) !== from;
        });
    }

    /** @param {() => boolean} isOver */
    until(isOver) {
        return new Promise((resolve, reject) => {
            const look = () => {
                if (!this.mayGoOn || this.desk.state?.state === "Alarm") {
                    reject(new Stopped(this.words.stopped));
                } else if (isOver()) resolve(undefined);
                else return;
                this.desk.listeners.splice(this.desk.listeners.indexOf(look), 1);
            };
            this.desk.listen(look);
            look();
        });
    }

    /**
     * @param {Axis} axis
     * @param {number} by
     * @param {number} feed
     * @param {number} back
     * @param {number} [set]
     */
    async touch(axis, by, feed, back, set) {
        const fields = { axis, by_mm: by, feed, back_mm: back };
        const index = "xyz".indexOf(axis);
        const more = set === undefined ? {} : { set_mm: set };
        const { at_mm } = await this.send("probe", { ...fields, ...more });
        await this.until(() => this.desk.state?.state === "Idle");
        return at_mm[index];
    }

    /**
     * @param {Axis} axis
     * @param {number} by
     * @param {number} feed
     */
    async beside(axis, by, feed) {
        const fields = { axis, by_mm: by, feed, beside: true };
        const { touched } = await this.send("probe", fields);
        await this.until(() => this.desk.state?.state === "Idle");
        if (touched) throw new Error(this.words.contact);
    }

    /**
     * @param {Axis} axis
     * @param {number} by
     */
    async away(axis, by) {
        await this.move("step", { move_mm: { [axis]: by }, feed: RATE });
    }

    /**
     * @param {Axis} axis
     * @param {number} position
     */
    async to(axis, position) {
        const now = this.desk.state?.machine_mm?.["xyz".indexOf(axis)];
        // Without a distance there is no motion to wait for.
        if (now !== undefined && Math.abs(now - position) < 0.001) return;
        const to = { [axis]: Math.round(position * 10_000) / 10_000 };
        await this.move("goto", { to_mm: to, frame: "machine", feed: RATE });
    }

    /** @param {Partial<Record<Axis, number>>} at */
    async zero(at) {
        await this.send("zero", { at_mm: at });
    }

    /** @param {number} length */
    async offset(length) {
        await this.send("line", { text: `G43.1Z${length.toFixed(4)}` });
    }
}
