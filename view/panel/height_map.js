/**
 * The height map of a Grbl controller that has one: a grid is measured with the probe, shown, and
 * switched on, so that Z follows the surface.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put } from "husillo/panel/change.js";
import { drawMap, isWhole, rangeText, readMap, tableOf } from "husillo/panel/height_grid.js";
import { VALUES as PROBING, height } from "husillo/panel/probing.js";
import { LinkedRig, Stopped } from "husillo/panel/rig.js";
import { numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/height_grid.js").HeightGrid} HeightGrid */
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
    down: "5",
    feed: "100",
});

/** The height map. */
export class HeightMap {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {{isTested: boolean}} probe whether it was seen closed, so that it works
     */
    constructor(desk, words, probe) {
        this.desk = desk;
        this.words = words;
        this.probe = probe;
        /** @type {HeightGrid | undefined} */
        this.grid = undefined;
        /** @type {LinkedRig | undefined} */
        this.rig = undefined;
        /** Whether the answer to the last `$Z` has come as a whole. */
        this.isRead = false;
        /** Contacts of the present measurement, and how many there will be. */
        this.contacts = 0;
        this.ofContacts = 0;
        this.fields = new Map(
            Object.entries(VALUES).map(([name, value]) => {
                const kept = localStorage.getItem(`husillo.map.${name}`) ?? value;
                const attributes = { inputmode: "decimal", size: 6, "data-map": name };
                const field = element("input", { ...attributes, value: kept });
                field.addEventListener("change", () =>
                    localStorage.setItem(`husillo.map.${name}`, field.value)
                );
                return [name, field];
            })
        );
        const act = (/** @type {() => Promise<string>} */ what) => () => this.run(what);
        this.measure = button(
            words.mapMeasure,
            act(() => this.measured()),
            { class: "main" }
        );
        this.zero = button(words.mapZero, act(() => this.zeroed()));
        this.on = button(words.mapOn, act(() => this.switch(true)));
        this.off = button(words.mapOff, act(() => this.switch(false)));
        this.read = button(words.mapRead, act(() => this.shown()));
        this.delete = button(words.mapDelete, act(() => this.deleted()));
        this.why = element("p", { class: "why" });
        this.result = element("p", { role: "status", class: "result" });
        this.state = element("p", { class: "map-state", hidden: true });
        this.picture = element("div", { class: "map-picture" });
        this.table = element("table", { class: "heights" });
        const label = words.mapHeights;
        this.scroll = element(
            "div",
            { class: "scroll", tabindex: 0, role: "region", "aria-label": label, hidden: true },
            this.table
        );
        const others = [this.zero, this.on, this.off, this.read, this.delete];
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
            element("div", { class: "items" }, this.measure, ...others),
            this.why,
            this.result,
            this.state,
            this.picture,
            this.scroll
        );
        desk.read((lines) => this.heard(lines));
        desk.listen(() => this.show());
        this.show();
    }

    /** STOP: nothing more is sent. */
    stop() {
        this.rig?.stop();
    }

    /** Lines of the console. @param {import("husillo/panel/desk.js").Line[] | undefined} lines */
    heard(lines) {
        const before = this.grid;
        if (!lines) this.grid = undefined;
        let isChanged = before !== this.grid;
        for (const { from, text } of lines ?? this.desk.machine?.lines ?? []) {
            if (from !== "controller") continue;
            if (text.startsWith("[PRB:") && this.contacts < this.ofContacts) this.counted();
            if (!/^\[(MAP|HEIGHTS|MSG):/.test(text)) continue;
            this.grid = readMap(text, this.grid);
            isChanged = true;
            this.isRead ||= isWhole(this.grid) || (text.startsWith("[MAP:") && !this.grid);
        }
        if (!isChanged) return;
        this.showGrid();
        // Who waits for the map is woken.
        if (this.isRead && this.rig) this.desk.changed();
    }

    /** A point of the present measurement was touched. */
    counted() {
        this.contacts += 1;
        put(this.result, `${this.words.mapPoints} ${this.contacts} / ${this.ofContacts}`);
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
        this.ofContacts = 0;
        this.rig = undefined;
        this.show();
    }

    /** @param {string} text */
    async send(text) {
        if (!this.rig) throw new Stopped(this.words.wasStopped);
        await this.rig.send("line", { text });
    }

    /** Waits until the axes stand: commands of a map need that. */
    async stand() {
        await this.send("G4 P0");
        await this.rig?.until(() => this.desk.state?.state === "Idle");
    }

    /** Reads the map of the controller. */
    async shown() {
        await this.stand();
        this.grid = undefined;
        this.isRead = false;
        await this.send("$Z");
        // The lines of the console may come after the answer.
        await this.rig?.until(() => this.isRead);
        this.showGrid();
        const { words } = this;
        const grid = /** @type {HeightGrid | undefined} */ (this.grid);
        return grid ? (grid.isOn ? words.mapIsOn : words.mapIsOff) : words.mapNone;
    }

    /** Measures the grid from the present height. */
    async measured() {
        const { words, values } = this;
        if (!values) return words.mapWrong;
        const { x, y, width, depth, columns, rows, down, feed } = values;
        await this.stand();
        // The points are those of the table, not of a map before.
        if (this.grid?.isOn) await this.send("$Z=0");
        await this.send("G90 G21");
        await this.send(`G0 X${x} Y${y}`);
        await this.stand();
        await this.send(`$ZG=${[x, y, width, depth, columns, rows].join(",")}`);
        [this.contacts, this.ofContacts] = [0, columns * rows];
        await this.send(`$ZP=${down},${feed}`);
        this.ofContacts = 0;
        await this.shown();
        return words.mapMeasured;
    }

    /** Touches the first point, whose height is 0, and makes it the zero of Z. */
    async zeroed() {
        const { words, values, rig } = this;
        if (!values || !rig) return words.mapWrong;
        const { x, y, down, feed } = values;
        await this.stand();
        if (this.grid?.isOn) await this.send("$Z=0");
        await this.send("G90 G21");
        await this.send(`G0 X${x} Y${y}`);
        await this.stand();
        const touchFeed = Math.min(feed, PROBING.touchFeed);
        const search = { distance: down, searchFeed: feed, touchFeed, thickness: 0 };
        await height(rig, { ...PROBING, ...search });
        await this.shown();
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
        return this.shown();
    }

    showGrid() {
        const { grid, words } = this;
        const hasAll = isWhole(grid);
        this.scroll.hidden = this.state.hidden = !hasAll;
        if (!grid || !hasAll) {
            this.picture.replaceChildren();
            this.table.replaceChildren();
        } else {
            this.picture.replaceChildren(drawMap(grid, words));
            this.table.replaceChildren(...tableOf(grid, words));
            const state = grid.isOn ? words.mapIsOn : words.mapIsOff;
            put(this.state, `${state} ${rangeText(grid, words)}.`);
        }
        this.show();
    }

    /** Why nothing can be begun, in words; empty if it can. */
    get obstacle() {
        const { desk, words } = this;
        if (this.rig) return "";
        if (!desk.mayCommand) return words.whyWatching;
        if (!desk.isIdle) return words.whyBusy;
        return this.probe.isTested ? "" : words.probeTest;
    }

    show() {
        const { desk, grid } = this;
        const mayBegin = desk.mayCommand && desk.isIdle && !this.rig;
        const mayProbe = mayBegin && this.probe.isTested;
        for (const one of [this.measure, this.zero]) disable(one, !mayProbe);
        for (const one of [this.off, this.read, this.delete]) disable(one, !mayBegin);
        disable(this.on, !mayBegin || !isWhole(grid));
        put(this.why, this.obstacle);
        this.on.setAttribute("aria-pressed", String(grid?.isOn ?? false));
        this.off.setAttribute("aria-pressed", String(grid ? !grid.isOn : false));
    }
}
