/**
 * Finds the segment under the pointer.
 */

/** @typedef {import("husillo/viewer/segments.js").Segments} Segments */
/** @typedef {import("husillo/viewer/camera.js").Camera} Camera */

/**
 * @typedef {object} Found
 * @property {number} move
 * @property {number[]} at the point of the machine on the segment
 * @property {number} distance pixels
 */

/**
 * The segment nearest to a pixel. Of equally near ones the later wins, as it is drawn on top.
 *
 * @param {Segments} segments
 * @param {number[]} centre
 * @param {Camera} camera
 * @param {number} x
 * @param {number} y
 * @param {number} within pixels
 * @returns {Found | undefined}
 */
export function nearest(segments, centre, camera, x, y, within) {
    const [right, up] = camera.axes.map((axis) => axis.map((part) => part * camera.scale));
    const [left, top] = camera.project(centre);
    const [px, py] = [x - left, top - y];
    const { ends } = segments;
    let [best, least, share] = [-1, within * within, 0];
    for (let index = 0; index < segments.count; index++) {
        const at = index * 6;
        const [a, b, c] = [ends[at], ends[at + 1], ends[at + 2]];
        const [d, e, f] = [ends[at + 3], ends[at + 4], ends[at + 5]];
        const x0 = a * right[0] + b * right[1] + c * right[2];
        const y0 = a * up[0] + b * up[1] + c * up[2];
        const dx = d * right[0] + e * right[1] + f * right[2] - x0;
        const dy = d * up[0] + e * up[1] + f * up[2] - y0;
        const square = dx * dx + dy * dy;
        const along = square > 0 ? ((px - x0) * dx + (py - y0) * dy) / square : 0;
        const part = along < 0 ? 0 : along > 1 ? 1 : along;
        const [u, v] = [px - x0 - part * dx, py - y0 - part * dy];
        const distance = u * u + v * v;
        if (distance <= least) [best, least, share] = [index, distance, part];
    }
    if (best < 0) return undefined;
    return {
        move: segments.moves[best],
        at: place(segments, best, share, centre),
        distance: Math.sqrt(least),
    };
}

/**
 * @param {Segments} segments
 * @param {number} index
 * @param {number} part
 * @param {number[]} centre
 */
function place({ ends }, index, part, centre) {
    return centre.map((middle, axis) => {
        const [from, to] = [ends[index * 6 + axis], ends[index * 6 + 3 + axis]];
        return middle + from + (to - from) * part;
    });
}
