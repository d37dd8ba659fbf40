/**
 * Lengths as the operator reads and writes them: millimetres or inches.
 */

/** Millimetres of an inch. */
const INCH = 25.4;

/** @typedef {"mm" | "in"} Unit */

/**
 * A length with as many places as the unit needs.
 *
 * @param {number | null | undefined} mm
 * @param {Unit} unit
 * @param {number} [more] places than usual
 */
export function lengthText(mm, unit, more = 0) {
    if (mm === null || mm === undefined) return "–";
    const value = unit === "mm" ? mm : mm / INCH;
    // Without the sign of a zero.
    const places = (unit === "mm" ? 3 : 4) + more;
    const rounded = Number(value.toFixed(places)) + 0;
    return rounded.toFixed(places);
}

/**
 * A number that was typed, in millimetres. A decimal comma is a point; other text is `undefined`.
 *
 * @param {string} text
 * @param {Unit} [unit]
 * @returns {number | undefined}
 */
export function lengthOf(text, unit = "mm") {
    const number = numberOf(text);
    return number === undefined ? undefined : number * (unit === "mm" ? 1 : INCH);
}

/**
 * A number that was typed; `undefined` for other text.
 *
 * @param {string} text
 * @returns {number | undefined}
 */
export function numberOf(text) {
    const plain = text.trim().replace(",", ".");
    return /^[-+]?(\d+\.?\d*|\.\d+)$/.test(plain) ? Number(plain) : undefined;
}

/** The unit that the operator has chosen. It is kept by the browser. */
export class Units {
    constructor() {
        /** @type {Unit} */
        this.unit = localStorage.getItem("husillo.unit") === "in" ? "in" : "mm";
    }

    /** @param {Unit} unit */
    choose(unit) {
        this.unit = unit;
        localStorage.setItem("husillo.unit", unit);
    }
}
