/**
 * Large paths for tests and benchmarks.
 */

/** @typedef {import("husillo/viewer/segments.js").Segments} Segments */

/**
 * A relief: passes to and fro over 100 x 80 mm, with a wave in every direction, and rapids between
 * the passes.
 *
 * @param {number} count segments
 * @param {number} passes
 * @returns {Segments}
 */
export function relief(count, passes) {
    const ends = new Float32Array(count * 6);
    const kinds = new Uint8Array(count);
    const moves = new Int32Array(count);
    const along = new Float32Array(count);
    const perPass = Math.ceil(count / passes);
    /** @param {number} index */
    const point = (index) => {
        const pass = Math.floor(index / perPass);
        const part = (index % perPass) / perPass;
        const x = (pass % 2 ? 1 - part : part) * 100e6 - 50e6;
        const y = (pass / passes) * 80e6 - 40e6 + 0.2e6 * Math.sin(index * 0.7);
        return [x, y, 3e6 * Math.sin(x / 9e6) * Math.cos(y / 7e6)];
    };
    let from = point(0);
    for (let index = 0; index < count; index++) {
        const to = point(index + 1);
        ends.set([...from, ...to], index * 6);
        kinds[index] = (index + 1) % perPass === 0 ? 1 : 2;
        moves[index] = index;
        from = to;
    }
    return { count, ends, kinds, moves, along };
}
