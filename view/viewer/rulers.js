/**
 * Rulers with numbers along the lower and left edge of a plane view, and a bar of a round length
 * where the view is turned.
 */

import { length, trimmed } from "husillo/viewer/quantity.js";

/** @typedef {import("husillo/viewer/camera.js").Camera} Camera */
/** @typedef {import("husillo/viewer/look.js").Look} Look */

/** Pixels between two numbers, at least. */
const SPACING = 70;
/** Height of the lower ruler and width of the left one, pixels. */
export const RULER = 26;

/** The axes of the plane views: to the right and up. */
const PLANES = /** @type {Record<string, [number, number]>} */ ({
    XY: [0, 1],
    XZ: [0, 2],
    YZ: [1, 2],
});

/**
 * The smallest of 1, 2 and 5 times a power of ten that is at least `value`.
 *
 * @param {number} value above 0
 */
export function roundUp(value) {
    const power = 10 ** Math.floor(Math.log10(value));
    const found = [1, 2, 5, 10].find((digit) => digit * power >= value * (1 - 1e-9)) ?? 10;
    return Number((found * power).toPrecision(1));
}

/**
 * Draws the rulers of a plane view, in the frame of the work.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Look} look
 * @param {number[]} zero position of work zero, nm
 * @param {string[]} letters
 */
export function rulers(context, camera, look, zero, letters) {
    context.font = "12px system-ui, sans-serif";
    const plane = PLANES[camera.view ?? ""];
    if (!plane) return bar(context, camera, look);
    const step = roundUp(SPACING / camera.scale);
    const [right, up] = plane;
    const { width, height } = camera;
    context.fillStyle = look.ground;
    context.fillRect(0, height - RULER, width, RULER);
    context.fillRect(0, 0, RULER + 24, height);
    context.strokeStyle = look.line;
    context.fillStyle = look.soft;
    context.lineWidth = 1;
    context.beginPath();
    context.textBaseline = "middle";
    const left = RULER + 24;
    const low = camera.under(left, height - RULER);
    const high = camera.under(width, 0);
    marks(low[right] - zero[right], high[right] - zero[right], step, (value) => {
        const [x] = camera.project(at(right, value + zero[right]));
        if (x < left + 4) return;
        context.moveTo(x, height - RULER);
        context.lineTo(x, height - RULER + 5);
        context.textAlign = "center";
        if (x < width - 46) context.fillText(trimmed(value / 1e6, 6), x, height - 12);
    });
    marks(low[up] - zero[up], high[up] - zero[up], step, (value) => {
        const [, y] = camera.project(at(up, value + zero[up]));
        context.moveTo(left - 5, y);
        context.lineTo(left, y);
        context.textAlign = "right";
        if (y > 14) context.fillText(trimmed(value / 1e6, 6), left - 8, y);
    });
    context.moveTo(left, 0);
    context.lineTo(left, height - RULER);
    context.lineTo(width, height - RULER);
    context.stroke();
    context.fillStyle = look.ink;
    context.textAlign = "right";
    context.fillText(`${letters[right] ?? ""} mm`, width - 4, height - 12);
    context.textAlign = "left";
    context.fillText(letters[up] ?? "", 4, 10);
}

/**
 * @param {number} axis
 * @param {number} value
 */
function at(axis, value) {
    const point = [0, 0, 0];
    point[axis] = value;
    return point;
}

/**
 * @param {number} low
 * @param {number} high
 * @param {number} step
 * @param {(value: number) => void} each
 */
function marks(low, high, step, each) {
    const first = Math.ceil(low / step);
    // A ruler has at most one mark in five pixels.
    for (let mark = first; mark * step <= high && mark < first + 400; mark++) each(mark * step);
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Look} look
 */
function bar(context, camera, look) {
    const nm = roundUp(SPACING / camera.scale);
    const y = camera.height - 14;
    context.strokeStyle = look.soft;
    context.fillStyle = look.soft;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(14, y - 5);
    context.lineTo(14, y);
    context.lineTo(14 + nm * camera.scale, y);
    context.lineTo(14 + nm * camera.scale, y - 5);
    context.stroke();
    context.textAlign = "left";
    context.textBaseline = "middle";
    context.fillText(length(nm), 22 + nm * camera.scale, y - 3);
    triad(context, camera, look);
}

/**
 * The three directions, red, green and blue as everywhere.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Look} look
 */
function triad(context, camera, look) {
    const [x, y] = [camera.width - 44, camera.height - 40];
    const [right, up] = camera.axes;
    ["#c92a2a", "#2b8a3e", "#1971c2"].forEach((colour, axis) => {
        const [u, v] = [x + 26 * right[axis], y - 26 * up[axis]];
        context.strokeStyle = colour;
        context.lineWidth = 2;
        context.beginPath();
        context.moveTo(x, y);
        context.lineTo(u, v);
        context.stroke();
        context.fillStyle = look.ink;
        context.textAlign = "center";
        context.textBaseline = "middle";
        context.fillText("XYZ"[axis], x + 35 * right[axis], y - 35 * up[axis]);
    });
}
