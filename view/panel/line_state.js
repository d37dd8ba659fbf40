/**
 * The state of a program before one of its lines, in words: modes, tool, speeds and position.
 */

import { element } from "husillo/viewer/element.js";

/** @typedef {import("husillo/panel/words.js").Words} Words */

/**
 * @typedef {object} LineState
 * @property {string[]} modal codes such as `G1`
 * @property {string} offset work coordinate system, such as `G54`
 * @property {number} tool
 * @property {{feed: number | null, rpm: number}} programmed
 * @property {number[]} work_mm
 */

/** Which codes each row has. */
const ROWS = /** @type {const} */ ([
    ["motionMode", /^G(0|1|80)$/],
    ["unitsMode", /^G2[01]$/],
    ["planeMode", /^G1[789]$/],
    ["distanceMode", /^G9[01]$/],
    ["feedMode", /^G9[34]$/],
    ["spindleMode", /^M[345]$/],
    ["coolantMode", /^M[789]$/],
]);

/**
 * @param {LineState} state
 * @param {string[]} axes
 * @param {Words} words
 */
export function lineState({ modal, offset, tool, programmed, work_mm }, axes, words) {
    const { feed, rpm } = programmed;
    const speeds = /** @type {Record<string, string>} */ ({
        feedMode: feed === null ? "" : `, ${feed} mm/min`,
        spindleMode: rpm > 0 ? `, ${rpm} rpm` : "",
    });
    const said = (/** @type {string} */ code) => `${words.codes[code] ?? ""} (${code})`.trim();
    const modes = ROWS.map(([name, codes]) => {
        const all = modal.filter((code) => codes.test(code)).map(said);
        return [words.lineState[name], all.join(", ") + (speeds[name] ?? "")];
    });
    const at = work_mm.map((mm, axis) => `${axes[axis]} ${mm.toFixed(3)}`).join("  ");
    const rows = [
        [words.lineState.position, `${at} mm`],
        [words.workZero, offset],
        ...modes,
        [words.tool, String(tool)],
    ];
    return element(
        "dl",
        { class: "line-state" },
        ...rows.map(([name, text]) =>
            element("div", {}, element("dt", {}, name), element("dd", {}, text))
        )
    );
}
