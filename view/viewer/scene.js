/**
 * A scene: a program, its moves with their times, and what was measured on them. Lengths are in
 * nanometres of the machine frame, times in seconds.
 */

import { unpack } from "husillo/viewer/container.js";

/** The kinds of moves, by their number in a scene. */
export const KINDS = /** @type {const} */ (["jog", "rapid", "feed", "thread", "probe"]);

/**
 * @typedef {object} Axis
 * @property {string} letter
 * @property {number} step_nm
 * @property {[number, number] | null} travel_nm
 * @property {number} zero_nm
 *
 * @typedef {object} Finding
 * @property {string} code
 * @property {string} severity
 * @property {string} message
 * @property {string | null} help
 * @property {number} line
 * @property {number} column
 *
 * @typedef {object} Stand a time at which the tool stands still
 * @property {number} begin seconds
 * @property {number} move
 * @property {number} axis the axis that takes up its backlash, or -1: a dwell
 * @property {[number, number, number]} at
 *
 * @typedef {object} Arc
 * @property {[number, number]} plane its axes
 * @property {[number, number]} centre
 * @property {number} turns begun turns, positive counter-clockwise
 *
 * @typedef {object} Band values over time
 * @property {string} name
 * @property {number} seconds per column
 * @property {Float64Array} low
 * @property {Float64Array} high
 * @property {Float64Array} isThere 1 where there is a value
 */

/** A scene. */
export class Scene {
    /** @param {import("husillo/viewer/container.js").Container} container */
    constructor({ header, columns }) {
        /** @param {string} name */
        const column = (name) => columns.get(name) ?? new Float64Array();
        /** @type {{name: string, text: string}} */
        this.program = header.program;
        /** @type {string[]} */
        this.lines = header.program.text.split(/\r\n|\n|\r/);
        /** @type {{name: string, title: string, axes: Axis[], view: [number, number]}} */
        this.machine = header.machine;
        /** @type {Axis[]} */
        this.axes = header.machine.axes;
        /** @type {number | null} */
        this.toolDiameter = header.tool_diameter_nm;
        /** @type {Finding[]} */
        this.findings = header.findings;
        /** Whether the scene has every move. */
        this.isWhole = Boolean(header.is_whole);
        const seconds = 1 / header.ticks_per_second;
        this.line = column("move.line");
        this.kind = Uint8Array.from(column("move.kind"));
        const begin = column("move.begin");
        this.begin = begin.map((ticks) => ticks * seconds);
        this.end = column("move.ticks").map((ticks, move) => (begin[move] + ticks) * seconds);
        this.feed = column("move.feed");
        this.rpm = column("move.rpm").map((thousandths) => thousandths / 1000);
        this.deviation = column("move.deviation");
        /** Ends of the moves, by axis. */
        this.to = this.axes.map((_, axis) => column(`move.to.${axis}`));
        /** Starts of the moves, by axis. */
        this.from = starts(this.to, column);
        this.arcs = arcs(column);
        this.curves = curves(column);
        this.stands = stands(column, seconds);
        this.sampleSeconds = header.sample_ticks * seconds;
        this.tool = this.axes.map((_, axis) => column(`sample.tool.${axis}`));
        this.lag = this.axes.map((_, axis) => column(`sample.lag.${axis}`));
        this.bands = bands(column, header.chart_seconds, header.deviation_ticks * seconds);
    }

    /** Number of moves. */
    get count() {
        return this.line.length;
    }

    /** Seconds from the start to the end. */
    get seconds() {
        const sampled = Math.max(0, (this.tool[0]?.length ?? 0) - 1) * this.sampleSeconds;
        return Math.max(sampled, this.count ? this.end[this.count - 1] : 0);
    }

    /**
     * The move at a time, or the last one before it; -1 before the first.
     *
     * @param {number} seconds
     */
    moveAt(seconds) {
        return lastAtMost(this.begin, seconds);
    }
}

/**
 * Reads a scene.
 *
 * @param {string} text
 * @returns {Promise<Scene>}
 */
export async function read(text) {
    return new Scene(await unpack(text));
}

/**
 * Index of the last value that is at most `value` in an array in ascending order; -1 without one.
 *
 * @param {ArrayLike<number>} values
 * @param {number} value
 */
export function lastAtMost(values, value) {
    let [low, high] = [0, values.length];
    while (low < high) {
        const middle = (low + high) >> 1;
        if (values[middle] <= value) low = middle + 1;
        else high = middle;
    }
    return low - 1;
}

/** @typedef {(name: string) => Float64Array} Column */

/**
 * @param {Float64Array[]} to
 * @param {Column} column
 */
function starts(to, column) {
    const moves = column("jump.move");
    return to.map((ends, axis) => {
        const from = new Float64Array(ends.length);
        from.set(ends.subarray(0, Math.max(0, ends.length - 1)), 1);
        column(`jump.from.${axis}`).forEach((at, index) => (from[moves[index]] = at));
        return from;
    });
}

/** @param {Column} column */
function arcs(column) {
    const [right, up, turns] = ["right", "up", "turns"].map((name) => column(`arc.${name}`));
    const [x, y] = [0, 1].map((axis) => column(`arc.centre.${axis}`));
    /** @type {Map<number, Arc>} */
    const all = new Map();
    column("arc.move").forEach((move, index) => {
        all.set(move, {
            plane: [right[index], up[index]],
            centre: [x[index], y[index]],
            turns: turns[index],
        });
    });
    return all;
}

/** @param {Column} column */
function curves(column) {
    const [x, y, z] = [0, 1, 2].map((axis) => column(`curve.at.${axis}`));
    /** @type {Map<number, [number, number, number][]>} */
    const all = new Map();
    column("curve.move").forEach((move, index) => {
        const points = all.get(move) ?? [];
        points.push([x[index], y[index], z[index]]);
        all.set(move, points);
    });
    return all;
}

/**
 * @param {Column} column
 * @param {number} seconds
 * @returns {Stand[]}
 */
function stands(column, seconds) {
    const [move, axis] = ["move", "axis"].map((name) => column(`stand.${name}`));
    const [x, y, z] = [0, 1, 2].map((part) => column(`stand.at.${part}`));
    return Array.from(column("stand.begin"), (begin, index) => ({
        begin: begin * seconds,
        move: move[index],
        axis: axis[index],
        at: [x[index], y[index], z[index]],
    }));
}

/**
 * @param {Column} column
 * @param {number} seconds
 * @param {number} deviationSeconds
 * @returns {Record<string, Band>}
 */
function bands(column, seconds, deviationSeconds) {
    /** @type {Record<string, Band>} */
    const all = {};
    for (const name of ["rapid", "feed", "programmed", "acceleration", "jerk"]) {
        const [low, high, isThere] = ["low", "high", "is_there"].map((part) =>
            column(`${name}.${part}`)
        );
        all[name] = { name, seconds, low, high, isThere };
    }
    const largest = column("deviation.largest");
    all.deviation = {
        name: "deviation",
        seconds: deviationSeconds,
        low: largest.map(() => 0),
        high: largest,
        isThere: largest.map(() => 1),
    };
    return all;
}
