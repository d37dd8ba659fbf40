/**
 * Findings of a program: their places in its text, and their fixes.
 */

/**
 * @typedef {object} Fix a text that takes the place of some columns of a line
 * @property {number} line from 1
 * @property {number} column from 1
 * @property {number} end_column the first one that stays
 * @property {string} text
 *
 * @typedef {object} Finding
 * @property {string} code
 * @property {"error" | "warning"} severity
 * @property {number} line from 1; 0: the whole program
 * @property {number} column
 * @property {number} [end_column]
 * @property {string} message
 * @property {string | null} help
 * @property {string[]} [notes]
 * @property {Fix[]} [fixes]
 */

/**
 * The text with its fixes.
 *
 * @param {string} text
 * @param {Fix[]} fixes
 */
export function applied(text, fixes) {
    const lines = text.split("\n");
    // From the end, so that the places before stay.
    const order = [...fixes].sort((a, b) => b.line - a.line || b.column - a.column);
    for (const fix of order) {
        const old = Array.from(lines[fix.line - 1] ?? "");
        old.splice(fix.column - 1, fix.end_column - fix.column, fix.text);
        lines[fix.line - 1] = old.join("");
    }
    return lines.join("\n");
}

/**
 * The offset of a place in a text. Columns count characters.
 *
 * @param {string} text
 * @param {number} line from 1
 * @param {number} column from 1
 */
export function offsetOf(text, line, column) {
    const lines = text.split("\n");
    const before = lines.slice(0, line - 1).reduce((sum, one) => sum + one.length + 1, 0);
    const part = Array.from(lines[line - 1] ?? "").slice(0, column - 1);
    return before + part.join("").length;
}
