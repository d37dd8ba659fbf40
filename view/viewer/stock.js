/**
 * Stock under a flat tool: a field of heights over X and Y, lowered by the moves. It is exact for
 * moves in planes and for straight moves between them, up to the size of its cells.
 */

import { points } from "husillo/viewer/path.js";

/** @typedef {import("husillo/viewer/scene.js").Scene} Scene */

/** A field of heights. */
export class Stock {
    /**
     * @param {number[]} low corner, nm
     * @param {number[]} high corner
     * @param {number} top height of the stock, nm
     * @param {number} most cells along the longer side
     */
    constructor(low, high, top, most) {
        this.low = low;
        const [width, height] = [high[0] - low[0], high[1] - low[1]];
        /** Size of a cell, nm. */
        this.cell = Math.max(1, width, height) / most;
        this.columns = Math.max(1, Math.ceil(width / this.cell));
        this.rows = Math.max(1, Math.ceil(height / this.cell));
        this.top = top;
        /** Row by row, Y upward. */
        this.heights = new Float64Array(this.columns * this.rows).fill(top);
    }

    /**
     * Moves a flat tool from one point to another. `each` gets the index and the height of every
     * cell that becomes lower, before it does.
     *
     * @param {number[]} from
     * @param {number[]} to
     * @param {number} radius nm
     * @param {(cell: number, height: number) => void} [each]
     */
    cut(from, to, radius, each) {
        const { cell, columns, heights, low } = this;
        const [dx, dy, dz] = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
        const square = dx * dx + dy * dy;
        const [left, right] = this.range(0, from[0], to[0], radius);
        const [bottom, top] = this.range(1, from[1], to[1], radius);
        for (let row = bottom; row < top; row++) {
            const y = low[1] + (row + 0.5) * cell - from[1];
            for (let column = left; column < right; column++) {
                const x = low[0] + (column + 0.5) * cell - from[0];
                const part = span(x * dx + y * dy, x * x + y * y - radius * radius, square);
                if (!part) continue;
                // The height changes evenly, so it is least at an end of the part.
                const height = from[2] + Math.min(part[0] * dz, part[1] * dz);
                const index = row * columns + column;
                if (height >= heights[index]) continue;
                each?.(index, height);
                heights[index] = height;
            }
        }
    }

    /**
     * The rows or columns that a tool reaches.
     *
     * @param {0 | 1} axis
     * @param {number} from
     * @param {number} to
     * @param {number} radius
     */
    range(axis, from, to, radius) {
        const most = axis === 0 ? this.columns : this.rows;
        const place = (/** @type {number} */ at) => (at - this.low[axis]) / this.cell;
        return [
            Math.max(0, Math.floor(place(Math.min(from, to) - radius))),
            Math.min(most, Math.ceil(place(Math.max(from, to) + radius))),
        ];
    }

    /** Volume that was removed, cubic nanometres. */
    get removed() {
        let sum = 0;
        for (const height of this.heights) sum += this.top - height;
        return sum * this.cell * this.cell;
    }
}

/**
 * The part of a move, 0 to 1, in which a point is under the tool: where
 * `square t^2 - 2 along t + rest <= 0`.
 *
 * @param {number} along
 * @param {number} rest
 * @param {number} square
 * @returns {[number, number] | undefined}
 */
function span(along, rest, square) {
    if (square === 0) return rest <= 0 ? [0, 1] : undefined;
    const under = along * along - square * rest;
    if (under < 0) return undefined;
    const root = Math.sqrt(under);
    const [begin, end] = [(along - root) / square, (along + root) / square];
    return begin > 1 || end < 0 ? undefined : [Math.max(0, begin), Math.min(1, end)];
}

/**
 * The stock of a scene: as commanded, and as the real tool cut it. They differ where steps were
 * lost or backlash was not taken up.
 */
export class Cutting {
    /**
     * @param {Scene} scene
     * @param {{low: number[], high: number[]}} box of the moves
     * @param {number} diameter nm
     * @param {number} top height of the stock, nm
     * @param {number} [most] cells along the longer side
     */
    constructor(scene, box, diameter, top, most = 400) {
        this.scene = scene;
        this.radius = diameter / 2;
        const low = box.low.map((at) => at - 1.2 * this.radius);
        const high = box.high.map((at) => at + 1.2 * this.radius);
        this.commanded = new Stock(low, high, top, most);
        this.real = new Stock(low, high, top, most);
        /** Cells that a rapid has cut. */
        this.crossed = new Uint8Array(this.real.heights.length);
        /** Moves that are made. */
        this.done = 0;
        this.hasLag = scene.lag.some((steps) => steps.some((lag) => lag !== 0));
    }

    /**
     * Makes the moves up to a time. Going back begins anew.
     *
     * @param {number} seconds
     */
    goTo(seconds) {
        const last = this.scene.moveAt(seconds) + 1;
        if (last < this.done) this.clear();
        while (this.done < last) this.make(this.done++);
    }

    clear() {
        this.done = 0;
        this.crossed.fill(0);
        for (const stock of [this.commanded, this.real]) stock.heights.fill(stock.top);
    }

    /** @param {number} move */
    make(move) {
        const { scene, commanded, real, radius, crossed } = this;
        const isRapid = scene.kind[move] === 1;
        const path = points(scene, move);
        const cross = isRapid ? (/** @type {number} */ cell) => (crossed[cell] = 1) : undefined;
        for (let index = 1; index < path.length; index++) {
            commanded.cut(path[index - 1], path[index], radius);
        }
        const [begin, end] = [scene.begin[move], scene.end[move]];
        const tool = path.map((at, index) =>
            this.shifted(at, begin + ((end - begin) * index) / (path.length - 1))
        );
        for (let index = 1; index < tool.length; index++) {
            real.cut(tool[index - 1], tool[index], radius, cross);
        }
    }

    /**
     * A commanded point, moved by what the tool is off at that time.
     *
     * @param {number[]} at
     * @param {number} seconds
     */
    shifted(at, seconds) {
        if (!this.hasLag) return at;
        const { lag, axes, sampleSeconds } = this.scene;
        const sample = Math.round(seconds / sampleSeconds);
        return at.map((nm, axis) => {
            const steps = lag[axis]?.[Math.min(sample, lag[axis].length - 1)] ?? 0;
            return nm - steps * (axes[axis]?.step_nm ?? 0);
        });
    }

    /**
     * What the tool did to a cell: it cut too deep, left material, or cut in a rapid.
     *
     * @param {number} cell
     * @param {number} tolerance nm
     * @returns {"gouge" | "uncut" | "crossed" | undefined}
     */
    fault(cell, tolerance) {
        const off = this.real.heights[cell] - this.commanded.heights[cell];
        if (off < -tolerance) return "gouge";
        if (off > tolerance) return "uncut";
        return this.crossed[cell] ? "crossed" : undefined;
    }

    /**
     * Areas in square nanometres, and the largest differences in height.
     *
     * @param {number} tolerance nm
     */
    faults(tolerance) {
        const area = this.real.cell * this.real.cell;
        const found = { gouge: 0, uncut: 0, crossed: 0, deepest: 0, highest: 0 };
        for (let cell = 0; cell < this.crossed.length; cell++) {
            const fault = this.fault(cell, tolerance);
            if (fault) found[fault] += area;
            const off = this.real.heights[cell] - this.commanded.heights[cell];
            found.deepest = Math.max(found.deepest, -off);
            found.highest = Math.max(found.highest, off);
        }
        return found;
    }
}
