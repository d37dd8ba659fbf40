/**
 * What lies over the path: work area, marks, the selected moves, the tool, a measured distance.
 */

import { points } from "husillo/viewer/path.js";
import { length } from "husillo/viewer/quantity.js";
import { rulers } from "husillo/viewer/rulers.js";

/** @typedef {import("husillo/viewer/scene.js").Scene} Scene */
/** @typedef {import("husillo/viewer/camera.js").Camera} Camera */
/** @typedef {import("husillo/viewer/look.js").Look} Look */

/** Most moves of a selection that are drawn. */
const MOST_SELECTED = 5000;
/** Most marks of one picture. */
const MOST_MARKS = 5000;

/**
 * @typedef {object} Shown
 * @property {number[]} selected moves
 * @property {number[]} [commanded] position of the tool, nm
 * @property {number[]} [real]
 * @property {number[][]} measured none, one or two points
 */

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Scene} scene
 * @param {Camera} camera
 * @param {Look} look
 * @param {Shown} shown
 */
export function overlay(context, scene, camera, look, shown) {
    context.clearRect(0, 0, camera.width, camera.height);
    area(context, scene, camera, look);
    takeUps(context, scene, camera, look);
    selection(context, scene, camera, look, shown.selected);
    tool(context, camera, look, shown);
    distance(context, camera, look, shown.measured);
    const zero = [0, 1, 2].map((axis) => scene.axes[axis]?.zero_nm ?? 0);
    rulers(
        context,
        camera,
        look,
        zero,
        scene.axes.map((axis) => axis.letter)
    );
}

/**
 * The limits of the axes, as a box; of axes without limits nothing.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Scene} scene
 * @param {Camera} camera
 * @param {Look} look
 */
function area(context, scene, camera, look) {
    const limits = [0, 1, 2].map((axis) => scene.axes[axis]?.travel_nm);
    const [x, y, z] = limits;
    if (!x || !y) return;
    context.strokeStyle = look.limit;
    context.lineWidth = 1.2;
    const heights = z ?? [0];
    for (const height of heights) {
        const corners = [
            [x[0], y[0]],
            [x[1], y[0]],
            [x[1], y[1]],
            [x[0], y[1]],
        ];
        line(
            context,
            camera,
            [...corners, corners[0]].map(([u, v]) => [u, v, height])
        );
    }
    if (!z) return;
    for (const u of x)
        for (const v of y)
            line(
                context,
                camera,
                z.map((height) => [u, v, height])
            );
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {number[][]} all
 */
function line(context, camera, all) {
    context.beginPath();
    all.forEach((at, index) => {
        const [x, y] = camera.project(at);
        if (index === 0) context.moveTo(x, y);
        else context.lineTo(x, y);
    });
    context.stroke();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Scene} scene
 * @param {Camera} camera
 * @param {Look} look
 */
function takeUps(context, scene, camera, look) {
    context.strokeStyle = look.takeUp;
    context.lineWidth = 2;
    context.beginPath();
    let drawn = 0;
    for (const stand of scene.stands) {
        if (stand.axis < 0) continue;
        const [x, y] = camera.project(stand.at);
        if (x < 0 || y < 0 || x > camera.width || y > camera.height) continue;
        context.moveTo(x, y - 5);
        context.lineTo(x, y + 5);
        if (++drawn >= MOST_MARKS) break;
    }
    context.stroke();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Scene} scene
 * @param {Camera} camera
 * @param {Look} look
 * @param {number[]} moves
 */
function selection(context, scene, camera, look, moves) {
    context.lineJoin = "round";
    for (const [colour, width] of /** @type {const} */ ([
        [look.ink, 6],
        [look.ground, 3],
    ])) {
        context.strokeStyle = colour;
        context.lineWidth = width;
        for (const move of moves.slice(0, MOST_SELECTED))
            line(context, camera, points(scene, move));
    }
    context.lineWidth = 2;
    for (const move of moves.slice(0, MOST_SELECTED)) {
        context.strokeStyle = look.kinds[scene.kind[move]].colour;
        line(context, camera, points(scene, move));
    }
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Look} look
 * @param {Shown} shown
 */
function tool(context, camera, look, { commanded, real }) {
    if (!commanded || !real) return;
    const [[x, y], [u, v]] = [camera.project(commanded), camera.project(real)];
    context.strokeStyle = look.accent;
    context.lineWidth = 2;
    context.beginPath();
    context.arc(x, y, 7, 0, 2 * Math.PI);
    context.stroke();
    // A cross at the real position, on a ground that sets it off.
    for (const [colour, width] of /** @type {const} */ ([
        [look.ground, 4],
        [look.ink, 2],
    ])) {
        context.strokeStyle = colour;
        context.lineWidth = width;
        context.beginPath();
        context.moveTo(u - 5, v);
        context.lineTo(u + 5, v);
        context.moveTo(u, v - 5);
        context.lineTo(u, v + 5);
        context.stroke();
    }
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Camera} camera
 * @param {Look} look
 * @param {number[][]} measured
 */
function distance(context, camera, look, measured) {
    if (measured.length === 0) return;
    context.strokeStyle = look.ink;
    context.lineWidth = 1.5;
    line(context, camera, measured);
    for (const at of measured) {
        const [x, y] = camera.project(at);
        context.strokeRect(x - 3, y - 3, 6, 6);
    }
    if (measured.length < 2) return;
    const [from, to] = measured;
    const [[x, y], [u, v]] = [camera.project(from), camera.project(to)];
    const text = length(Math.hypot(...from.map((at, axis) => to[axis] - at)));
    context.font = "600 13px system-ui, sans-serif";
    const width = context.measureText(text).width + 10;
    context.fillStyle = look.ground;
    context.fillRect((x + u) / 2 - width / 2, (y + v) / 2 - 10, width, 20);
    context.fillStyle = look.ink;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(text, (x + u) / 2, (y + v) / 2);
}
