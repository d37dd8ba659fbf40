/**
 * What the parts of the viewer share: the scene, the time, and the selected line.
 */

import { event, placeAt } from "husillo/viewer/path.js";

/** @typedef {import("husillo/viewer/scene.js").Scene} Scene */

/**
 * What gives exact positions between two times, such as the simulator as WebAssembly. Without one,
 * positions come from the scene.
 *
 * @typedef {object} Steps
 * @property {(seconds: number) => {commanded: number[], real: number[]} | undefined} at
 */

/** The shared state. Listeners are called after each change. */
export class Model {
    /** @param {Scene} scene */
    constructor(scene) {
        this.scene = scene;
        this.seconds = 0;
        /** The selected line, from 1; 0 without one. */
        this.line = 0;
        /** The selected moves. @type {number[]} */
        this.moves = [];
        /** The span of the charts, seconds. @type {[number, number]} */
        this.span = [0, scene.seconds];
        /** @type {Steps | undefined} */
        this.steps = undefined;
        /** @type {(() => void)[]} */
        this.listeners = [];
        this.byLine = new ByLine(scene.line);
    }

    /** @param {() => void} listener */
    listen(listener) {
        this.listeners.push(listener);
    }

    changed() {
        for (const listener of this.listeners) listener();
    }

    /**
     * Where the tool is now: exact to the step if `steps` knows it.
     *
     * @returns {import("husillo/viewer/path.js").Place}
     */
    get place() {
        return { ...placeAt(this.scene, this.seconds), ...this.steps?.at(this.seconds) };
    }

    /**
     * Goes to a time, and selects what moves there.
     *
     * @param {number} seconds
     */
    goTo(seconds) {
        this.seconds = Math.min(Math.max(0, seconds), this.scene.seconds);
        const move = this.scene.moveAt(this.seconds);
        this.moves = move < 0 ? [] : [move];
        this.line = move < 0 ? 0 : this.scene.line[move];
        this.changed();
    }

    /**
     * Selects a line of the program with all of its moves, and goes to the first of them.
     *
     * @param {number} line
     */
    selectLine(line) {
        this.line = Math.min(Math.max(1, line), this.scene.lines.length);
        this.moves = this.byLine.get(this.line) ?? [];
        if (this.moves.length) this.seconds = this.scene.begin[this.moves[0]];
        this.changed();
    }

    /**
     * Selects one move, and goes to its begin.
     *
     * @param {number} move
     */
    selectMove(move) {
        this.goTo(this.scene.begin[move]);
        this.moves = [move];
        this.line = this.scene.line[move];
        this.changed();
    }

    /**
     * Goes to the next line that moves, or to the one before.
     *
     * @param {1 | -1} direction
     */
    stepLine(direction) {
        const { scene } = this;
        let move = scene.moveAt(this.seconds);
        const line = move < 0 ? 0 : scene.line[move];
        do move += direction;
        while (move >= 0 && move < scene.count && scene.line[move] === line);
        if (move < 0) return this.goTo(0);
        if (move >= scene.count) return this.goTo(scene.seconds);
        // Backwards, its first move.
        while (direction < 0 && move > 0 && scene.line[move - 1] === scene.line[move]) move--;
        this.selectMove(move);
    }

    /**
     * Goes to the next begin of a move, take-up or dwell, or to the one before.
     *
     * @param {1 | -1} direction
     */
    stepEvent(direction) {
        this.goTo(event(this.scene, this.seconds, direction));
    }

    /**
     * Shows a span of the charts; the whole time without one.
     *
     * @param {[number, number]} [span]
     */
    show(span) {
        this.span = span ?? [0, this.scene.seconds];
        this.changed();
    }
}

/** The moves of each line, in two arrays: a list for each line would take a tenth of a second. */
class ByLine {
    /** @param {ArrayLike<number>} lines the line of each move */
    constructor(lines) {
        let last = 0;
        for (let move = 0; move < lines.length; move++) last = Math.max(last, lines[move]);
        /** Where the moves of each line begin. */
        this.begins = new Int32Array(last + 2);
        for (let move = 0; move < lines.length; move++) this.begins[lines[move] + 1]++;
        for (let line = 0; line <= last; line++) this.begins[line + 1] += this.begins[line];
        this.moves = new Int32Array(lines.length);
        const next = this.begins.slice();
        for (let move = 0; move < lines.length; move++) this.moves[next[lines[move]]++] = move;
    }

    /**
     * The moves of a line; `undefined` without one.
     *
     * @param {number} line
     */
    get(line) {
        const [from, to] = [this.begins[line], this.begins[line + 1]];
        return to > from ? Array.from(this.moves.subarray(from, to)) : undefined;
    }
}
