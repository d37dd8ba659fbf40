/**
 * The path of a move: its points, and the position of the tool at a time.
 */

import { lastAtMost } from "husillo/viewer/scene.js";

/** @typedef {import("husillo/viewer/scene.js").Scene} Scene */
/** @typedef {[number, number, number]} Point */

/** Most chords of one turn of an arc. Their error is then below 0.02 % of the radius. */
const CHORDS_PER_TURN = 180;
/** Least chords of an arc. */
const LEAST_CHORDS = 2;

/**
 * The ends of a move in X, Y and Z.
 *
 * @param {Scene} scene
 * @param {number} move
 * @returns {[Point, Point]}
 */
export function ends(scene, move) {
    /** @param {Float64Array[]} of */
    const point = (of) => /** @type {Point} */ ([0, 1, 2].map((axis) => of[axis]?.[move] ?? 0));
    return [point(scene.from), point(scene.to)];
}

/**
 * The angle that an arc sweeps in radians, positive counter-clockwise.
 *
 * @param {import("husillo/viewer/scene.js").Arc} arc
 * @param {Point} from
 * @param {Point} to
 */
export function sweep({ plane: [right, up], centre, turns }, from, to) {
    /** @param {Point} at */
    const angle = (at) => Math.atan2(at[up] - centre[1], at[right] - centre[0]);
    const turn = 2 * Math.PI;
    const sign = Math.sign(turns) || 1;
    let first = (sign * (angle(to) - angle(from))) % turn;
    if (first < 0) first += turn;
    // Equal ends are a whole turn. A rounded one may miss it by less than a nanometre.
    const radius = Math.hypot(from[right] - centre[0], from[up] - centre[1]);
    if (first * radius < 0.5) first = turn;
    return sign * (first + (Math.abs(turns) - 1) * turn);
}

/**
 * The point of a move at a part of its length, 0 to 1.
 *
 * @param {Scene} scene
 * @param {number} move
 * @param {number} part
 * @returns {Point}
 */
export function pointAt(scene, move, part) {
    const [from, to] = ends(scene, move);
    const arc = scene.arcs.get(move);
    if (arc) return onArc(arc, from, to, sweep(arc, from, to), part);
    const curve = scene.curves.get(move);
    if (!curve) return between(from, to, part);
    const points = [from, ...curve, to];
    const at = Math.min(part, 1) * (points.length - 1);
    const index = Math.min(Math.floor(at), points.length - 2);
    return between(points[index], points[index + 1], at - index);
}

/**
 * @param {import("husillo/viewer/scene.js").Arc} arc
 * @param {Point} from
 * @param {Point} to
 * @param {number} swept
 * @param {number} part
 * @returns {Point}
 */
function onArc({ plane: [right, up], centre }, from, to, swept, part) {
    const [x, y] = [from[right] - centre[0], from[up] - centre[1]];
    const ends = [Math.hypot(x, y), Math.hypot(to[right] - centre[0], to[up] - centre[1])];
    const radius = ends[0] + (ends[1] - ends[0]) * part;
    const angle = Math.atan2(y, x) + swept * part;
    const at = between(from, to, part);
    at[right] = centre[0] + radius * Math.cos(angle);
    at[up] = centre[1] + radius * Math.sin(angle);
    return at;
}

/**
 * @param {Point} from
 * @param {Point} to
 * @param {number} part
 * @returns {Point}
 */
function between(from, to, part) {
    const [x, y, z] = from;
    return [x + (to[0] - x) * part, y + (to[1] - y) * part, z + (to[2] - z) * part];
}

/**
 * The points of a move, both ends included.
 *
 * @param {Scene} scene
 * @param {number} move
 * @returns {Point[]}
 */
export function points(scene, move) {
    const [from, to] = ends(scene, move);
    const arc = scene.arcs.get(move);
    if (!arc) return [from, ...(scene.curves.get(move) ?? []), to];
    const swept = sweep(arc, from, to);
    const turns = Math.abs(swept) / (2 * Math.PI);
    const chords = Math.max(LEAST_CHORDS, Math.ceil(turns * CHORDS_PER_TURN));
    return Array.from({ length: chords + 1 }, (_, index) =>
        index === chords ? to : onArc(arc, from, to, swept, index / chords)
    );
}

/**
 * Where the tool is at an instant.
 *
 * @typedef {object} Place
 * @property {number} move -1 before the first
 * @property {number[]} commanded nm of the machine frame, every axis
 * @property {number[]} real
 * @property {boolean} isMoving
 */

/**
 * @param {Scene} scene
 * @param {number} seconds
 * @returns {Place}
 */
export function placeAt(scene, seconds) {
    const move = scene.moveAt(seconds);
    const sampled = sampleAt(scene, seconds);
    const isMoving = move >= 0 && seconds < scene.end[move];
    const real = scene.axes.map((axis, index) => sampled.tool[index] * axis.step_nm);
    const sent = scene.axes.map((axis, index) => sampled.sent[index] * axis.step_nm);
    // At rest, and within few samples, the programmed path is more exact than the samples.
    const lag = real.map((at, axis) => at - sent[axis]);
    const commanded = move < 0 ? sent : onMove(scene, move, seconds, sent, isMoving);
    return { move, commanded, real: commanded.map((at, axis) => at + lag[axis]), isMoving };
}

/**
 * @param {Scene} scene
 * @param {number} seconds
 */
function sampleAt(scene, seconds) {
    const count = scene.tool[0]?.length ?? 0;
    const at = Math.min(Math.max(seconds / scene.sampleSeconds, 0), Math.max(0, count - 1));
    const [index, part] = [Math.floor(at), at % 1];
    /** @param {Float64Array} values */
    const read = (values) => {
        const here = values[index] ?? 0;
        return here + ((values[index + 1] ?? here) - here) * part;
    };
    const tool = scene.tool.map(read);
    return { tool, sent: tool.map((at, axis) => at + read(scene.lag[axis])) };
}

/**
 * The commanded position on a move: at the part of it that its time gives. Its samples correct the
 * time where the speed changes.
 *
 * @param {Scene} scene
 * @param {number} move
 * @param {number} seconds
 * @param {number[]} sent
 * @param {boolean} isMoving
 */
function onMove(scene, move, seconds, sent, isMoving) {
    const [begin, end] = [scene.begin[move], scene.end[move]];
    if (!isMoving) return scene.to.map((ends) => ends[move]);
    const isSampled = end - begin > 4 * scene.sampleSeconds;
    if (isSampled) return sent;
    const part = end > begin ? (seconds - begin) / (end - begin) : 1;
    const at = pointAt(scene, move, part);
    return scene.to.map((ends, axis) => {
        const from = scene.from[axis][move];
        return at[axis] ?? from + (ends[move] - from) * part;
    });
}

/**
 * The next event after a time, or the last one before it: begins of moves, take-ups and dwells.
 *
 * @param {Scene} scene
 * @param {number} seconds
 * @param {1 | -1} direction
 */
export function event(scene, seconds, direction) {
    const begins = scene.stands.map((stand) => stand.begin);
    const near = [scene.begin, begins].map((times) =>
        direction > 0
            ? (times[lastAtMost(times, seconds + 1e-9) + 1] ?? scene.seconds)
            : (times[lastAtMost(times, seconds - 1e-9)] ?? 0)
    );
    return direction > 0 ? Math.min(...near) : Math.max(...near);
}
