/**
 * The moves of a scene as straight segments, and coarser levels of them for a picture that moves.
 */

import { points } from "husillo/viewer/path.js";

/** @typedef {import("husillo/viewer/scene.js").Scene} Scene */

/**
 * Straight segments. Coordinates are relative to `centre`, so that 32 bits are exact enough.
 *
 * @typedef {object} Segments
 * @property {number} count
 * @property {Float32Array} ends six per segment: start and end in X, Y and Z
 * @property {Uint8Array} kinds index of `KINDS`
 * @property {Int32Array} moves number of the move
 * @property {Float32Array} along length of the path before each segment, since its kind began
 */

/** The largest number of points that an arc gives is kept low where there are very many arcs. */
const MOST_SEGMENTS = 4_000_000;

/** The ends in an axis that the machine does not have. */
const ZERO = new Float64Array(1);

/** The smallest box around points. */
export class Box {
    constructor() {
        this.low = [Infinity, Infinity, Infinity];
        this.high = [-Infinity, -Infinity, -Infinity];
    }

    /** @param {ArrayLike<number>} at */
    add(at) {
        for (let axis = 0; axis < 3; axis++) {
            if (at[axis] < this.low[axis]) this.low[axis] = at[axis];
            if (at[axis] > this.high[axis]) this.high[axis] = at[axis];
        }
    }

    get isEmpty() {
        return this.low[0] > this.high[0];
    }

    /** Its middle; zero without points. */
    get centre() {
        return this.low.map((low, axis) => (this.isEmpty ? 0 : (low + this.high[axis]) / 2));
    }

    /** Its eight corners. */
    get corners() {
        return Array.from({ length: 8 }, (_, bits) =>
            this.low.map((low, axis) => ((bits >> axis) & 1 ? this.high[axis] : low))
        );
    }
}

/**
 * The box around the ends of all moves, arcs included.
 *
 * @param {Scene} scene
 */
export function boxOf(scene) {
    const box = new Box();
    if (!scene.count) return box;
    for (let axis = 0; axis < 3; axis++) {
        let [low, high] = [Infinity, -Infinity];
        // The ends of bent moves are points of them too.
        for (const ends of [scene.from[axis] ?? ZERO, scene.to[axis] ?? ZERO]) {
            for (const at of ends) {
                if (at < low) low = at;
                if (at > high) high = at;
            }
        }
        [box.low[axis], box.high[axis]] = [low, high];
    }
    for (const move of [...scene.arcs.keys(), ...scene.curves.keys()]) {
        points(scene, move).forEach(box.add, box);
    }
    return box;
}

/**
 * The segments of all moves.
 *
 * @param {Scene} scene
 * @param {number[]} centre
 * @returns {Segments}
 */
export function segmentsOf(scene, centre) {
    const builder = new Builder(scene.count + 256, centre);
    const none = new Float64Array(scene.count);
    const [[x, y, z], [u, v, w]] = [scene.from, scene.to].map((of) =>
        [0, 1, 2].map((axis) => of[axis] ?? none)
    );
    const [from, to] = [
        [0, 0, 0],
        [0, 0, 0],
    ];
    for (let move = 0; move < scene.count; move++) {
        const isBent = scene.arcs.has(move) || scene.curves.has(move);
        const kind = scene.kind[move];
        if (isBent && builder.count < MOST_SEGMENTS) {
            const all = points(scene, move);
            for (let index = 1; index < all.length; index++) {
                builder.add(all[index - 1], all[index], kind, move);
            }
        } else {
            [from[0], from[1], from[2]] = [x[move], y[move], z[move]];
            [to[0], to[1], to[2]] = [u[move], v[move], w[move]];
            builder.add(from, to, kind, move);
        }
    }
    return builder.made();
}

/** Collects segments. */
class Builder {
    /**
     * @param {number} expected
     * @param {number[]} centre
     */
    constructor(expected, centre) {
        this.centre = centre;
        this.count = 0;
        this.length = 0;
        this.kind = -1;
        this.ends = new Float32Array(expected * 6);
        this.kinds = new Uint8Array(expected);
        this.moves = new Int32Array(expected);
        this.along = new Float32Array(expected);
    }

    /**
     * @param {number[]} from
     * @param {number[]} to
     * @param {number} kind
     * @param {number} move
     */
    add(from, to, kind, move) {
        if (this.count === this.kinds.length) this.grow();
        if (kind !== this.kind) this.length = 0;
        const at = this.count++;
        let square = 0;
        for (let axis = 0; axis < 3; axis++) {
            this.ends[at * 6 + axis] = from[axis] - this.centre[axis];
            this.ends[at * 6 + 3 + axis] = to[axis] - this.centre[axis];
            square += (to[axis] - from[axis]) ** 2;
        }
        this.kinds[at] = this.kind = kind;
        this.moves[at] = move;
        this.along[at] = this.length;
        // Math.hypot() takes ten times as long.
        this.length += Math.sqrt(square);
    }

    grow() {
        const size = this.kinds.length * 2;
        /**
         * @template {Float32Array | Int32Array | Uint8Array} T
         * @param {T} old
         * @param {T} larger
         */
        const copy = (old, larger) => (larger.set(old), larger);
        this.ends = copy(this.ends, new Float32Array(size * 6));
        this.kinds = copy(this.kinds, new Uint8Array(size));
        this.moves = copy(this.moves, new Int32Array(size));
        this.along = copy(this.along, new Float32Array(size));
    }

    /** @returns {Segments} */
    made() {
        const { count } = this;
        return {
            count,
            ends: this.ends.subarray(0, count * 6),
            kinds: this.kinds.subarray(0, count),
            moves: this.moves.subarray(0, count),
            along: this.along.subarray(0, count),
        };
    }
}

/**
 * Fewer segments that fill the same cells of a cube of this size: consecutive segments of one kind
 * are joined while they are shorter than a cell, and a segment between two cells is kept once.
 *
 * @param {Segments} of
 * @param {number} cell
 * @returns {Segments}
 */
export function thinned(of, cell) {
    const builder = new Builder(1024, [0, 0, 0]);
    const seen = new Set();
    const [from, to, last] = [
        [0, 0, 0],
        [0, 0, 0],
        [NaN, 0, 0],
    ];
    let open = -1;
    for (let index = 0; index < of.count; index++) {
        const at = index * 6;
        const kind = of.kinds[index];
        const follows =
            of.ends[at] === last[0] &&
            of.ends[at + 1] === last[1] &&
            of.ends[at + 2] === last[2];
        if (open !== kind || !follows) {
            for (let axis = 0; axis < 3; axis++) from[axis] = of.ends[at + axis];
            open = kind;
        }
        let far = 0;
        for (let axis = 0; axis < 3; axis++) {
            to[axis] = last[axis] = of.ends[at + 3 + axis];
            far = Math.max(far, Math.abs(to[axis] - from[axis]));
        }
        if (far < cell && (far === 0 || isFollowed(of, index))) continue;
        const key = pair(from, to, kind, cell);
        if (!seen.has(key)) {
            seen.add(key);
            builder.add(from, to, kind, of.moves[index]);
        }
        for (let axis = 0; axis < 3; axis++) from[axis] = to[axis];
    }
    return builder.made();
}

/**
 * Whether the next segment goes on from the end of this one.
 *
 * @param {Segments} of
 * @param {number} index
 */
function isFollowed({ count, kinds, ends }, index) {
    const at = index * 6 + 3;
    return (
        index + 1 < count &&
        kinds[index + 1] === kinds[index] &&
        ends[at] === ends[at + 3] &&
        ends[at + 1] === ends[at + 4] &&
        ends[at + 2] === ends[at + 5]
    );
}

/**
 * A number for a pair of cells. Different pairs rarely share one: a segment is then missing for as
 * long as the picture moves.
 *
 * @param {number[]} from
 * @param {number[]} to
 * @param {number} kind
 * @param {number} cell
 */
function pair(from, to, kind, cell) {
    let key = kind + 1;
    for (const value of [...from, ...to]) {
        key = (key * 1_000_003 + Math.round(value / cell)) % 9_007_199_254_740;
    }
    return key;
}

/**
 * Levels of at most `most` segments, and the whole: the first level that is fine enough is drawn.
 *
 * @typedef {object} Level
 * @property {number} cell 0 for the whole
 * @property {Segments} segments
 */

/**
 * @param {Segments} whole
 * @param {number} size of the box
 * @param {number} most segments of the coarsest level
 * @returns {Level[]} from coarse to fine
 */
export function levelsOf(whole, size, most) {
    const levels = [{ cell: 0, segments: whole }];
    let cell = Math.max(1, size / 4096);
    while (levels[0].segments.count > most && cell < size) {
        const segments = thinned(levels[0].segments, cell);
        if (segments.count < 0.7 * levels[0].segments.count) levels.unshift({ cell, segments });
        cell *= Math.SQRT2;
    }
    return levels;
}

/**
 * The level that shows `pixel` nanometres, with at most `most` segments if there is one.
 *
 * @param {Level[]} levels
 * @param {number} pixel
 * @param {number} most
 */
export function levelFor(levels, pixel, most) {
    const fine = levels.find((level) => level.cell <= pixel) ?? levels[levels.length - 1];
    const index = levels.indexOf(fine);
    for (let at = index; at >= 0; at--)
        if (levels[at].segments.count <= most) return levels[at];
    return levels[0];
}
