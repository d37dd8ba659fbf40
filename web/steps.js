/**
 * The exact positions of a run, for the viewer.
 */

/**
 * What `model.steps` of the viewer takes. While a time is shown twice, it is asked for once.
 *
 * @param {import("./index.js").Run | any} run
 */
export function stepsOf(run) {
    const { nm_per_step: nm } = run.results;
    /** @param {number[]} steps */
    const inNm = (steps) => steps.map((count, axis) => count * nm[axis]);
    let [last, place] = [NaN, /** @type {any} */ (undefined)];
    return {
        /** @param {number} seconds */
        at(seconds) {
            if (seconds === last) return place;
            const at = run.atTime(seconds);
            last = seconds;
            place = at.error
                ? undefined
                : { commanded: inNm(at.commanded), real: inNm(at.tool) };
            return place;
        },
    };
}
