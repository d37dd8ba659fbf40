/**
 * Positions: work and machine coordinates in millimetres and inches, the work zero, and its undo.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, fill, put, toggle } from "husillo/panel/change.js";
import { lengthOf, lengthText } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/units.js").Units} Units */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The positions. */
export class Positions {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {Units} units
     */
    constructor(desk, words, units) {
        this.desk = desk;
        this.words = words;
        this.units = units;
        /** @type {Row[]} */
        this.rows = [];
        this.body = element("tbody");
        this.heads = [words.axis, words.work, words.machine, words.zeroColumn].map((text) =>
            element("th", { scope: "col" }, text)
        );
        this.table = element(
            "table",
            { class: "positions" },
            element("thead", {}, element("tr", {}, ...this.heads)),
            this.body
        );
        this.note = element("p", { class: "soft" });
        this.zeroAll = button(words.zeroAll, () => this.zero(this.letters));
        this.undo = button(words.undoZero, () => desk.command("undo_zero"));
        this.unitButtons = /** @type {const} */ (["mm", "in"]).map((unit) =>
            button(unit === "mm" ? "mm" : words.inch, () => {
                units.choose(unit);
                desk.changed();
            })
        );
        this.root = element(
            "section",
            { class: "card", "aria-label": words.position },
            element(
                "div",
                { class: "items" },
                element("h2", { class: "wide" }, words.position),
                ...this.unitButtons
            ),
            this.table,
            this.note,
            element("div", { class: "items" }, this.zeroAll, this.undo)
        );
        desk.listen(() => this.show());
        this.show();
    }

    /** The letters of the axes. */
    get letters() {
        return this.desk.machine?.info.axes ?? [];
    }

    /**
     * Makes the present position zero. It does not ask; it can be undone.
     *
     * @param {string[]} letters
     */
    zero(letters) {
        const at = Object.fromEntries(letters.map((letter) => [letter.toLowerCase(), 0]));
        return this.desk.command("zero", { at_mm: at });
    }

    show() {
        const { desk, words, units, rows, letters } = this;
        if (rows.map((row) => row.letter).join() !== letters.join()) {
            this.rows = letters.map((letter) => new Row(this, letter));
            this.body.replaceChildren(...this.rows.map((row) => row.root));
        }
        const { state } = desk;
        // After the link was lost the last position is shown as an old one.
        const last = desk.machine?.state;
        toggle(this.table, "positions", state?.machine_mm ? "" : "stale");
        this.rows.forEach((row, axis) => row.show(axis));
        const mayZero = desk.mayCommand && !desk.isBusy;
        disable(this.zeroAll, !mayZero);
        disable(this.undo, !mayZero || state?.undo === 0);
        const isMill = desk.family !== "grbl";
        // Other machines set the zero of all axes at once, and keep no other one.
        this.undo.hidden = isMill;
        put(this.heads[3], isMill ? words.workZero : words.zeroColumn);
        put(this.undo, state?.undo ? `${words.undoZero} (${state.undo})` : words.undoZero);
        this.unitButtons.forEach((one, index) =>
            one.setAttribute("aria-pressed", String(units.unit === ["mm", "in"][index]))
        );
        const zero = letters
            .map((letter, axis) => `${letter} ${lengthText(last?.zero_mm?.[axis], units.unit)}`)
            .join(" ");
        const frame = last?.offset ? ` ${last.offset}` : "";
        put(
            this.note,
            state?.machine_mm
                ? `${words.workZero}${frame}: ${zero} ${units.unit}`
                : words.positionUnknown
        );
    }
}

/** An axis. */
class Row {
    /**
     * @param {Positions} positions
     * @param {string} letter
     */
    constructor(positions, letter) {
        const { words } = positions;
        this.positions = positions;
        this.letter = letter;
        // A number that changes 30 times a second is not spoken.
        this.work = element("span", { class: "work", "data-work": letter });
        this.workOther = element("small");
        this.machine = element("span", { "data-machine": letter });
        this.machineOther = element("small");
        this.value = element("input", {
            inputmode: "decimal",
            size: 6,
            value: "0",
            "aria-label": `${words.setTo} ${letter}`,
        });
        this.value.addEventListener("keydown", (event) => {
            if (event.key === "Enter") this.set();
        });
        this.button = button(`${letter} =`, () => this.set(), {
            "aria-label": `${words.setZero} ${letter}`,
        });
        this.setter = element("div", { class: "items" }, this.button, this.value);
        this.setter.style.justifyContent = "flex-end";
        this.zero = element("span", { "data-zero": letter });
        this.zeroOther = element("small");
        this.root = element(
            "tr",
            {},
            element("th", { scope: "row" }, letter),
            element("td", {}, this.work, this.workOther),
            element("td", {}, this.machine, this.machineOther),
            element("td", {}, this.setter, this.zero, this.zeroOther)
        );
    }

    /** Makes the present position what the field says. */
    async set() {
        const { desk, units } = this.positions;
        const at = lengthOf(this.value.value || "0", units.unit);
        this.value.setAttribute("aria-invalid", String(at === undefined));
        if (at === undefined) return;
        const done = await desk.command("zero", { at_mm: { [this.letter.toLowerCase()]: at } });
        if (done !== undefined) fill(this.value, "0");
    }

    /** @param {number} axis */
    show(axis) {
        const { desk, units } = this.positions;
        const last = desk.machine?.state;
        const other = units.unit === "mm" ? "in" : "mm";
        const [work, machine] = [last?.work_mm?.[axis], last?.machine_mm?.[axis]];
        // A mill has a place for it instead of the button, and steps of 0.14 um.
        const isMill = desk.family !== "grbl";
        this.setter.hidden = isMill;
        this.zero.hidden = this.zeroOther.hidden = !isMill;
        const more = desk.family === "micromill" ? 2 : 0;
        put(this.work, lengthText(work, units.unit, more));
        put(this.workOther, `${lengthText(work, other, more)} ${other}`);
        put(this.machine, lengthText(machine, units.unit, more));
        put(this.machineOther, `${lengthText(machine, other, more)} ${other}`);
        const zero = last?.zero_mm?.[axis];
        put(this.zero, lengthText(zero, units.unit, more));
        put(this.zeroOther, `${lengthText(zero, other, more)} ${other}`);
        const isDisabled = !desk.mayCommand || desk.isBusy;
        disable(this.button, isDisabled);
        disable(this.value, isDisabled);
    }
}
