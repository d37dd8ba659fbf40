/**
 * Colours and patterns of the moves. They follow the theme of the page; the patterns carry the
 * meaning without colour.
 */

import { KINDS } from "husillo/viewer/scene.js";

/**
 * @typedef {object} Stroke
 * @property {string} colour
 * @property {number} width pixels
 * @property {number[]} dash pixels: drawn, left out; empty for a solid line
 *
 * @typedef {object} Look
 * @property {Stroke[]} kinds in the order of `KINDS`
 * @property {string} ground
 * @property {string} ink
 * @property {string} soft
 * @property {string} line
 * @property {string} limit
 * @property {string} takeUp
 * @property {string} accent
 */

/** @type {Record<typeof KINDS[number], [string, number, number[]]>} */
const STROKES = {
    jog: ["--jog", 1.5, [1.5, 4]],
    rapid: ["--rapid", 1.5, [7, 5]],
    feed: ["--feed", 1.8, []],
    // G33 cuts, so it is drawn as a feed; a probing move is one too.
    thread: ["--feed", 1.8, []],
    probe: ["--feed", 1.8, []],
};

/**
 * The look that an element has now.
 *
 * @param {Element} element
 * @returns {Look}
 */
export function lookOf(element) {
    const style = getComputedStyle(element);
    /** @param {string} name */
    const colour = (name) => style.getPropertyValue(name).trim();
    return {
        kinds: KINDS.map((kind) => {
            const [name, width, dash] = STROKES[kind];
            return { colour: colour(name), width, dash };
        }),
        ground: colour("--ground"),
        ink: colour("--ink"),
        soft: colour("--soft"),
        line: colour("--line"),
        limit: colour("--limit"),
        takeUp: colour("--take-up"),
        accent: colour("--accent"),
    };
}

/**
 * A colour such as `#0b5cad` or `#fff` as three parts from 0 to 1.
 *
 * @param {string} colour
 * @returns {[number, number, number]}
 */
export function parts(colour) {
    const digits = colour.replace("#", "");
    const size = digits.length === 3 ? 1 : 2;
    /** @param {number} index */
    const part = (index) => {
        const text = digits.slice(index * size, (index + 1) * size);
        return parseInt(size === 1 ? text + text : text, 16) / 255;
    };
    return [part(0), part(1), part(2)];
}
