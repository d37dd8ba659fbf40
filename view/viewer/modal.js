/**
 * The modal state at a line, as the words of the program set it. It is read from the text in the
 * order of the lines: in a program with loops and subroutines it is that of the last line above.
 */

/** Groups of codes that exclude each other. */
const GROUPS = [
    [
        "G0",
        "G1",
        "G2",
        "G3",
        "G5",
        "G33",
        "G38.2",
        "G38.3",
        "G38.4",
        "G38.5",
        "G73",
        "G76",
        "G80",
        "G81",
        "G82",
        "G83",
        "G84",
        "G85",
        "G86",
        "G87",
        "G88",
        "G89",
    ],
    ["G17", "G18", "G19"],
    ["G20", "G21"],
    ["G90", "G91"],
    ["G93", "G94", "G95"],
    ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"],
    ["G40", "G41", "G42", "G41.1", "G42.1"],
    ["G43", "G43.1", "G49"],
    ["G61", "G61.1", "G64"],
    ["M3", "M4", "M5"],
    ["M7", "M8", "M9"],
];

/** @type {Map<string, number>} */
const GROUP_OF = new Map(GROUPS.flatMap((codes, group) => codes.map((code) => [code, group])));
/** Lines between two states that are kept. */
const STRIDE = 256;

/** @typedef {(string | undefined)[]} State one code per group, then F, S and T */

/** The states of a program. */
export class Modal {
    /** @param {string[]} lines */
    constructor(lines) {
        this.lines = lines;
        /** @type {State[]} states before every `STRIDE`th line */
        this.kept = [new Array(GROUPS.length + 3).fill(undefined)];
    }

    /**
     * The words in force after a line, from 1.
     *
     * @param {number} line
     * @returns {string[]}
     */
    at(line) {
        const last = Math.min(Math.max(0, line), this.lines.length);
        const block = Math.floor(last / STRIDE);
        while (this.kept.length <= block) {
            const from = (this.kept.length - 1) * STRIDE;
            this.kept.push(this.read(this.kept[this.kept.length - 1], from, from + STRIDE));
        }
        const state = this.read(this.kept[block], block * STRIDE, last);
        return state.filter((code) => code !== undefined);
    }

    /**
     * @param {State} before
     * @param {number} from
     * @param {number} to
     * @returns {State}
     */
    read(before, from, to) {
        const state = [...before];
        for (let line = from; line < to; line++) apply(state, this.lines[line]);
        return state;
    }
}

/**
 * @param {State} state
 * @param {string} line
 */
function apply(state, line) {
    const text = line.replace(/\([^)]*\)?/g, "").replace(/;.*/, "");
    for (const [, letter, digits] of text.matchAll(/([A-Za-z])\s*([-+]?\d*\.?\d+)/g)) {
        const upper = letter.toUpperCase();
        const value = String(Number(digits));
        const other = "FST".indexOf(upper);
        if (other >= 0) state[GROUPS.length + other] = upper + value;
        const group = GROUP_OF.get(upper + value);
        if (group !== undefined) state[group] = upper + value;
    }
}
