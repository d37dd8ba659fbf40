/**
 * The texts of the panel, in English and Spanish, besides those of the viewer.
 */

import { wordsOf as viewerWordsOf } from "husillo/viewer/words.js";
import { ENGLISH } from "husillo/panel/english.js";
import { SPANISH } from "husillo/panel/spanish.js";

/** @typedef {import("husillo/panel/english.js").Texts & ReturnType<typeof viewerWordsOf>} Words */

/**
 * The texts in the language of the reader. Those of the panel win over those of the viewer.
 *
 * @param {string} language such as `es-MX`
 * @returns {Words}
 */
export function wordsOf(language) {
    const viewer = viewerWordsOf(language);
    return { ...viewer, ...(isSpanish(language) ? SPANISH : ENGLISH) };
}

/** @param {string} language */
export function isSpanish(language) {
    return language.toLowerCase().startsWith("es");
}
