/**
 * Quantities as text: numbers with units, as a person reads them.
 */

/**
 * A length with the unit that suits its size.
 *
 * @param {number} nm
 * @returns {string}
 */
export function length(nm) {
    const size = Math.abs(nm);
    if (size >= 1e6) return `${trimmed(nm / 1e6, 4)} mm`;
    if (size >= 1e3) return `${trimmed(nm / 1e3, 2)} um`;
    return `${Math.round(nm) || 0} nm`;
}

/**
 * A position in millimetres, to the nanometre of the controllers rounded to 0.1 um.
 *
 * @param {number} nm
 * @returns {string}
 */
export function millimetres(nm) {
    // Without the sign of a zero.
    return (Math.round(nm / 100) / 1e4 + 0).toFixed(4);
}

/**
 * A time in seconds as hours, minutes and seconds.
 *
 * @param {number} seconds
 * @returns {string}
 */
export function duration(seconds) {
    const tenths = Math.round(seconds * 10);
    const hours = Math.floor(tenths / 36000);
    const minutes = Math.floor(tenths / 600) % 60;
    const rest = ((tenths % 600) / 10).toFixed(1).padStart(4, "0");
    return `${hours}:${String(minutes).padStart(2, "0")}:${rest}`;
}

/**
 * A number of at most `digits` decimals, without zeros at its end.
 *
 * @param {number} value
 * @param {number} digits
 * @returns {string}
 */
export function trimmed(value, digits) {
    return String(Number(value.toFixed(digits)) + 0);
}
