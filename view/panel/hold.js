/**
 * Hold to move: an axis moves only while somebody holds a key, a button or a stick, and the page
 * says so every 80 ms. Whatever ends the holding ends the motion.
 */

/** Interval of the renewals, milliseconds. The server ends a motion 250 ms after the last one. */
export const RENEWAL = 80;

/**
 * @typedef {Record<string, number>} Direction for each letter of an axis -1 to 1
 *
 * @typedef {object} Motion what a hold tells the machine
 * @property {(direction: Direction) => boolean} begin begins, or changes the direction; false if
 * nothing may move
 * @property {() => void} renew
 * @property {(reason: string) => void} end
 *
 * @typedef {object} Timers
 * @property {(act: () => void, milliseconds: number) => any} setInterval
 * @property {(timer: any) => void} clearInterval
 */

/** @type {Timers} */
const BROWSER = {
    setInterval: (act, milliseconds) => setInterval(act, milliseconds),
    clearInterval: (timer) => clearInterval(timer),
};

/** What is held. Several inputs at once move several axes at once. */
export class Hold {
    /**
     * @param {Motion} motion
     * @param {Timers} [timers] those of the browser
     */
    constructor(motion, timers = BROWSER) {
        this.motion = motion;
        this.timers = timers;
        /** @type {Map<string, Direction>} */
        this.inputs = new Map();
        /** Inputs whose motion was ended while they were held. @type {Set<string>} */
        this.ended = new Set();
        /** @type {any} */
        this.timer = undefined;
        /** The direction that the machine was told last. */
        this.told = "";
    }

    /** Whether something is held. */
    get isActive() {
        return this.timer !== undefined;
    }

    /**
     * An input is held. The repetition of a key changes nothing.
     *
     * @param {string} input its name, such as `key ArrowUp`
     * @param {Direction} direction
     */
    press(input, direction) {
        this.ended.delete(input);
        this.inputs.set(input, direction);
        this.tell();
    }

    /**
     * An input that is looked at again and again is held. After its motion was ended, it has no
     * effect until it was let go.
     *
     * @param {string} input
     * @param {Direction} direction
     */
    steer(input, direction) {
        if (!this.ended.has(input)) this.press(input, direction);
    }

    /**
     * An input is let go.
     *
     * @param {string} input
     * @param {string} reason
     */
    release(input, reason) {
        this.ended.delete(input);
        if (!this.inputs.delete(input)) return;
        if (this.inputs.size === 0) this.end(reason);
        else this.tell();
    }

    /**
     * Everything is let go: the page has lost the focus, or the link, or was told to stop.
     *
     * @param {string} reason
     */
    end(reason) {
        for (const input of this.inputs.keys()) this.ended.add(input);
        this.inputs.clear();
        this.told = "";
        if (this.timer === undefined) return;
        this.timers.clearInterval(this.timer);
        this.timer = undefined;
        this.motion.end(reason);
    }

    /** The sum of what is held, each axis at most 1. */
    get direction() {
        /** @type {Direction} */
        const sum = {};
        for (const one of this.inputs.values()) {
            for (const [axis, part] of Object.entries(one)) {
                sum[axis] = Math.max(-1, Math.min(1, (sum[axis] ?? 0) + part));
            }
        }
        return Object.fromEntries(Object.entries(sum).filter(([, part]) => part !== 0));
    }

    tell() {
        const { direction } = this;
        const text = JSON.stringify(direction);
        if (text === this.told) return;
        if (text === "{}") {
            // Opposite keys: nothing moves, until one of them is let go.
            if (this.timer === undefined) return;
            const inputs = new Map(this.inputs);
            this.end("opposite");
            this.ended.clear();
            this.inputs = inputs;
            return;
        }
        if (!this.motion.begin(direction)) {
            this.end("refused");
            return;
        }
        this.told = text;
        this.timer ??= this.timers.setInterval(() => this.motion.renew(), RENEWAL);
    }
}
