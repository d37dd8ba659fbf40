/**
 * The height map of a Grbl controller that has one: a grid is measured with the probe, shown, and
 * switched on, so that Z follows the surface.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put } from "husillo/panel/change.js";
import { LinkedRig, Stopped } from "husillo/panel/rig.js";
import { numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** Columns and rows of a map. */
const MOST = 16;

/** The values that are asked for: mm, mm/min and counts. */
const VALUES = /** @type {Record<string, string>} */ ({
    x: "0",
    y: "0",
    width: "60",
    depth: "40",
    columns: "4",
    rows: "3",
    travel: "2",
    down: "5",
    feed: "100",
});

/**
 * A map of a controller.
 *
 * @typedef {object} HeightGrid
 * @property {boolean} isOn
 * @property {[number, number, number, number]} area first point, width and depth, mm
 * @property {number} columns
 * @property {number} rows
 * @property {number[][]} heights mm, of each row
 */

/**
 * Reads a line of the answer to `$Z`.
 *
 * @param {string} text
 * @param {HeightGrid | undefined} grid what was read before
 * @returns {HeightGrid | undefined}
 */
export function readMap(text, grid) {
    const [, head, rest] = /^\[(MAP|HEIGHTS):(.*)\]$/.exec(text) ?? [];
    const numbers = (rest ?? "").split(",").map(Number);
    if (numbers.some(Number.isNaN)) return grid;
    if (head === "MAP" && numbers.length === 7) {
        const [isOn, x, y, width, depth, columns, rows] = numbers;
        return { isOn: isOn === 1, area: [x, y, width, depth], columns, rows, heights: [] };
    }
    const [row, ...heights] = numbers;
    if (head === "HEIGHTS" && grid && heights.length === grid.columns) grid.heights[row] = heights;
    return grid;
}

/** The height map. */
export class HeightMap {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        /** @type {HeightGrid | undefined} */
        this.grid = undefined;
        /** @type {LinkedRig | undefined} */
        this.rig = undefined;
        this.fields = new Map(
            Object.entries(VALUES).map(([name, value]) => {
                const kept = localStorage.getItem(`husillo.map.${name}`) ?? value;
                const field = element("input", {
                    inputmode: "decimal",
                    size: 6,
                    value: kept,
                    "data-map": name,
                });
                field.addEventListener("change", () =>
                    localStorage.setItem(`husillo.map.${name}`, field.value)
                );
                return [name, field];
            })
        );
        this.measure = button(words.mapMeasure, () => this.run(() => this.measured()), {
            class: "main",
        });
        this.zero = button(words.mapZero, () => this.run(() => this.zeroed()));
        this.on = button(words.mapOn, () => this.run(() => this.switch(true)));
        this.off = button(words.mapOff, () => this.run(() => this.switch(false)));
        this.read = button(words.mapRead, () => this.run(() => this.shown()));
        this.delete = button(words.mapDelete, () => this.run(() => this.deleted()));
        this.result = element("p", { role: "status", class: "result" });
        this.table = element("table", { class: "heights", hidden: true });
        this.root = element(
            "div",
            {},
            element("ol", {}, ...words.mapSteps.map((text) => element("li", {}, text))),
            element(
                "div",
                { class: "items" },
                ...[...this.fields].map(([name, field]) =>
                    element("label", { class: "field" }, words.mapValues[name], field)
                )
            ),
            element(
                "div",
                { class: "items" },
                this.measure,
                this.zero,
                this.on,
                this.off,
                this.read,
                this.delete
            ),
            this.result,
            element(
                "div",
                { class: "scroll", tabindex: 0, role: "region", "aria-label": words.mapHeights },
                this.table
            )
        );
        desk.read((lines) => {
            if (!lines) this.grid = undefined;
            for (const { from, text } of lines ?? []) {
                if (from === "controller") this.grid = readMap(text, this.grid);
            }
            this.showGrid();
        });
        desk.listen(() => this.show());
        this.show();
    }

    /** STOP, or another machine. */
    stop() {
        this.rig?.stop();
    }

    /** The values of the fields; undefined if one has none. */
    get values() {
        /** @type {Record<string, number>} */
        const values = {};
        let isValid = true;
        for (const [name, field] of this.fields) {
            const value = numberOf(field.value);
            const isCount = name === "columns" || name === "rows";
            const isPositive = !["x", "y"].includes(name);
            const isGood =
                value !== undefined &&
                (!isPositive || value > 0) &&
                (!isCount || (Number.isInteger(value) && value >= 2 && value <= MOST));
            field.setAttribute("aria-invalid", String(!isGood));
            isValid &&= isGood;
            values[name] = value ?? 0;
        }
        return isValid ? values : undefined;
    }

    /** Carries something out, and tells how it ended. @param {() => Promise<string>} act */
    async run(act) {
        const { desk, words } = this;
        const rig = new LinkedRig(desk, { contact: words.unexpected, stopped: words.wasStopped });
        this.rig = rig;
        put(this.result, words.mapBusy);
        this.show();
        try {
            put(this.result, await act());
        } catch (error) {
            const text = error instanceof Error ? error.message : String(error);
            put(this.result, error instanceof Stopped ? text : `${words.refused}: ${text}`);
        }
        if (this.rig === rig) this.rig = undefined;
        this.show();
    }

    /** @param {string} text */
    async send(text) {
        if (!this.rig) throw new Stopped(this.words.wasStopped);
        await this.rig.send("line", { text });
    }

    /** Waits until the axes stand. */
    async stand() {
        await this.send("G4 P0");
        await this.rig?.until(() => this.desk.state?.state === "Idle");
    }

    /** Reads the map of the controller. */
    async shown() {
        this.grid = undefined;
        await this.stand();
        await this.send("$Z");
        const { words } = this;
        const grid = /** @type {HeightGrid | undefined} */ (this.grid);
        return grid ? (grid.isOn ? words.mapIsOn : words.mapIsOff) : words.mapNone;
    }

    /** Measures the grid from the height above its first point. */
    async measured() {
        const { words, values } = this;
        if (!values) return words.mapWrong;
        const { x, y, width, depth, columns, rows, travel, down, feed } = values;
        if (this.grid?.isOn) await this.switch(false);
        await this.send("G90 G21");
        await this.send(`G0 X${x} Y${y}`);
        await this.stand();
        await this.send(`$ZG=${[x, y, width, depth, columns, rows].join(",")}`);
        await this.send(`$ZP=${down + travel},${feed}`);
        await this.shown();
        return words.mapMeasured;
    }

    /** Touches the first point, whose height is 0, and makes it the zero of Z. */
    async zeroed() {
        const { words, values } = this;
        if (!values) return words.mapWrong;
        const { x, y, travel, down, feed } = values;
        await this.send("G90 G21");
        await this.send(`G0 X${x} Y${y}`);
        await this.stand();
        await this.rig?.touch("z", -(down + travel), feed, travel, 0);
        return words.mapZeroed;
    }

    /** @param {boolean} isOn */
    async switch(isOn) {
        await this.stand();
        await this.send(`$Z=${isOn ? 1 : 0}`);
        return this.shown();
    }

    async deleted() {
        await this.stand();
        await this.send("$Z=0");
        await this.send("$ZC");
        this.grid = undefined;
        this.showGrid();
        return this.words.mapNone;
    }

    showGrid() {
        const { grid, table } = this;
        table.hidden = !grid || grid.heights.length < grid.rows;
        if (!grid || table.hidden) return table.replaceChildren();
        const [x, y, width, depth] = grid.area;
        /** @type {(from: number, size: number, part: number) => string} */
        const at = (from, size, part) => (from + size * part).toFixed(1);
        const all = grid.heights.flat();
        const [low, high] = [Math.min(...all), Math.max(...all)];
        const columns = Array.from({ length: grid.columns }, (_, column) =>
            at(x, width, column / (grid.columns - 1))
        );
        const rows = grid.heights.map((heights, row) =>
            element(
                "tr",
                {},
                element("th", { scope: "row" }, `Y ${at(y, depth, row / (grid.rows - 1))}`),
                ...heights.map((height) => {
                    const part = high > low ? (height - low) / (high - low) : 0;
                    const cell = element("td", { class: "number" }, height.toFixed(3));
                    // The bar grows with the height; the number says the same.
                    cell.style.setProperty("--part", `${Math.round(part * 100)}%`);
                    return cell;
                })
            )
        );
        table.replaceChildren(
            element("caption", {}, `${low.toFixed(3)} … ${high.toFixed(3)} mm`),
            element(
                "thead",
                {},
                element(
                    "tr",
                    {},
                    element("td", {}),
                    ...columns.map((text) => element("th", { scope: "col" }, `X ${text}`))
                )
            ),
            // The farthest row is on top, as on the table.
            element("tbody", {}, ...rows.reverse())
        );
    }

    show() {
        const { desk, grid } = this;
        if (this.rig && !this.rig.mayGoOn) this.rig.stop();
        const mayBegin = desk.mayCommand && desk.isIdle && !this.rig;
        for (const one of [this.measure, this.zero, this.on, this.off, this.read, this.delete]) {
            disable(one, !mayBegin);
        }
        this.on.setAttribute("aria-pressed", String(grid?.isOn ?? false));
        this.off.setAttribute("aria-pressed", String(grid ? !grid.isOn : false));
    }
}
