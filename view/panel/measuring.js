/**
 * What only a measuring machine has: its positions with target, zero and position error, its
 * touches with trigger and contact, and the bytes of its line.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, fill, put, toggle } from "husillo/panel/change.js";
import { numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/desk.js").Measuring} Measuring */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/**
 * An amount of a measuring machine: mm with tenths of a micrometre, or counts.
 *
 * @param {number | null | undefined} amount
 * @param {Measuring | undefined} measuring
 */
export function amountText(amount, measuring) {
    if (amount === null || amount === undefined) return "–";
    const places = measuring?.unit === "mm" ? 4 : 0;
    return (Number(amount.toFixed(places)) + 0).toFixed(places);
}

/** Positions, targets, zeros. */
export class Scales {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        /** @type {Scale[]} */
        this.rows = [];
        this.body = element("tbody");
        const heads = [
            words.axis,
            words.position,
            words.machine,
            words.target,
            words.zeroColumn,
        ];
        this.table = element(
            "table",
            { class: "positions scales" },
            element(
                "thead",
                {},
                element("tr", {}, ...heads.map((text) => element("th", { scope: "col" }, text)))
            ),
            this.body
        );
        this.unit = element("span", { class: "soft" });
        this.home = button(words.home, () => desk.command("home"));
        this.zeroAll = button(words.zeroAll, () => this.zero(this.letters));
        this.go = button(words.goTarget, () => this.goTo());
        this.cancel = button(words.cancelMove, () => desk.command("cancel"));
        this.rapid = element("input", { type: "checkbox" });
        this.root = element(
            "section",
            { class: "card", "aria-label": words.position },
            element(
                "div",
                { class: "items" },
                element("h2", { class: "wide" }, words.position),
                this.unit
            ),
            this.table,
            element("div", { class: "items" }, this.home, this.go, this.cancel, this.zeroAll),
            element("label", { class: "check" }, this.rapid, words.rapidMove),
            element("p", { class: "soft" }, words.targetHelp)
        );
        desk.listen(() => this.show());
        this.show();
    }

    /** The letters of the axes. */
    get letters() {
        return this.desk.machine?.info.axes ?? [];
    }

    /** @param {string[]} letters */
    zero(letters) {
        const at = Object.fromEntries(letters.map((letter) => [letter.toLowerCase(), 0]));
        return this.desk.command("zero", { at_mm: at });
    }

    /** Moves to the targets that have a number. */
    goTo() {
        /** @type {Record<string, number>} */
        const to = {};
        for (const { letter, target } of this.rows) {
            if (target.value.trim() === "") continue;
            const value = numberOf(target.value);
            target.setAttribute("aria-invalid", String(value === undefined));
            if (value === undefined) return;
            to[letter.toLowerCase()] = value;
        }
        if (Object.keys(to).length === 0) return;
        this.desk.command("goto", { to_mm: to, frame: "work", rapid: this.rapid.checked });
    }

    show() {
        const { desk, rows, letters, words } = this;
        this.root.hidden = desk.family !== "measuring";
        if (this.root.hidden) return;
        if (rows.map((row) => row.letter).join() !== letters.join()) {
            this.rows = letters.map((letter) => new Scale(this, letter));
            this.body.replaceChildren(...this.rows.map((row) => row.root));
        }
        const { state } = desk;
        const last = desk.machine?.state?.measuring;
        toggle(this.table, "positions", "scales", state?.measuring ? "" : "stale");
        put(this.unit, last?.unit === "counts" ? words.counts : "mm");
        this.rows.forEach((row, axis) => row.show(last, axis));
        const mayBegin = desk.mayCommand && desk.isIdle;
        for (const one of [this.home, this.go, this.zeroAll]) disable(one, !mayBegin);
        disable(this.cancel, !desk.mayCommand || desk.isIdle);
    }
}

/** An axis. */
class Scale {
    /**
     * @param {Scales} scales
     * @param {string} letter
     */
    constructor(scales, letter) {
        const { words, desk } = scales;
        this.scales = scales;
        this.letter = letter;
        // A number that changes all the time is not spoken.
        this.work = element("span", { class: "work", "data-scale": letter });
        this.counts = element("small", { "data-counts": letter });
        this.machine = element("span", { "data-from-home": letter });
        this.error = element("span", { "data-error": letter });
        this.target = element("input", {
            inputmode: "decimal",
            size: 7,
            "aria-label": `${words.target} ${letter}`,
            "data-target": letter,
        });
        this.target.addEventListener("keydown", (event) => {
            if (event.key === "Enter") scales.goTo();
        });
        this.button = button(`${letter} = 0`, () => scales.zero([letter]), {
            "aria-label": `${letter} = 0: ${words.setZeroHere}`,
        });
        this.home = button("⌂", () => desk.command("home", { axis: letter }), {
            "aria-label": `${words.home} ${letter}`,
        });
        this.root = element(
            "tr",
            {},
            element("th", { scope: "row" }, letter),
            element("td", {}, this.work, this.counts),
            element("td", {}, this.machine),
            element(
                "td",
                {},
                this.target,
                element("small", {}, `${words.positionError} `, this.error)
            ),
            element("td", {}, element("div", { class: "items" }, this.button, this.home))
        );
    }

    /**
     * @param {Measuring | undefined} measuring
     * @param {number} index
     */
    show(measuring, index) {
        const { desk, words } = this.scales;
        const axis = measuring?.axes[index];
        put(this.work, amountText(axis?.work, measuring));
        put(this.counts, axis ? `${axis.counts} ${words.counts}` : "");
        const isUnknown = axis?.machine === null;
        put(this.machine, isUnknown ? words.notHomed : amountText(axis?.machine, measuring));
        put(this.error, amountText(axis?.error, measuring));
        const mayBegin = desk.mayCommand && desk.isIdle;
        disable(this.button, !mayBegin);
        disable(this.home, !mayBegin);
        disable(this.target, !desk.mayCommand);
    }
}

/** Touches, and the tip that touches. */
export class Contact {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        this.towards = element("select", { "aria-label": words.touchTowards });
        this.lettersShown = "";
        const field = (/** @type {string} */ value, /** @type {string} */ name) =>
            element("input", { inputmode: "decimal", size: 6, value, "data-touch": name });
        this.within = field("", "within");
        this.touches = field("1", "touches");
        this.reference = field("", "reference");
        this.button = button(words.touch, () => this.touch(), { class: "main" });
        this.boxes = /** @type {[string, HTMLElement][]} */ (
            [
                ["probe", words.probeNow],
                ["trigger", words.trigger],
                ["contact", words.contact],
                ["pre-travel", words.preTravel],
                ["spread", words.spread],
                ["over-travel", words.overTravel],
            ].map(([name, text]) => [text, element("dd", { "data-value": name })])
        );
        this.plus = field("", "plus");
        this.minus = field("", "minus");
        this.ball = field("", "ball");
        this.set = button(words.setTip, () => this.setTip());
        /** What the fields had from the machine. */
        this.shown = "";
        this.root = element(
            "section",
            { class: "card", "aria-label": words.contactProbe },
            element("h2", {}, words.contactProbe),
            element(
                "dl",
                { class: "figures" },
                ...this.boxes.map(([name, value]) =>
                    element("div", {}, element("dt", {}, name), value)
                )
            ),
            element(
                "div",
                { class: "items" },
                element("label", { class: "field" }, words.touchTowards, this.towards),
                element("label", { class: "field" }, words.touchWithin, this.within),
                element("label", { class: "field" }, words.touchCount, this.touches),
                element("label", { class: "field" }, words.touchReference, this.reference),
                this.button
            ),
            element("p", { class: "soft" }, words.touchHelp),
            element(
                "div",
                { class: "items" },
                element("label", { class: "field" }, `${words.preTravel} +`, this.plus),
                element("label", { class: "field" }, `${words.preTravel} −`, this.minus),
                element("label", { class: "field" }, words.ballRadius, this.ball),
                this.set
            )
        );
        desk.listen(() => this.show());
        this.show();
    }

    /** The number of a field; undefined where it has none that is possible. */
    number(/** @type {HTMLInputElement} */ field, isNeeded = true) {
        const value = numberOf(field.value);
        const isWrong = value === undefined && (isNeeded || field.value.trim() !== "");
        field.setAttribute("aria-invalid", String(isWrong));
        return value;
    }

    touch() {
        const [letter, sign] = this.towards.value;
        const within = this.number(this.within, false);
        const reference = this.number(this.reference, false);
        const touches = this.number(this.touches);
        if (hasMistake([this.within, this.reference, this.touches]) || !letter) return;
        this.desk.command("touch", {
            towards: { [letter.toLowerCase()]: sign === "+" ? 1 : -1 },
            within: within ?? null,
            reference: reference ?? null,
            touches,
        });
    }

    setTip() {
        const fields = [this.plus, this.minus, this.ball];
        const [plus, minus, ball] = fields.map((one) => this.number(one));
        if (hasMistake(fields)) return;
        this.desk.command("tip", { pre_travel: [plus, minus], ball });
    }

    show() {
        const { desk, words } = this;
        this.root.hidden = desk.family !== "measuring";
        if (this.root.hidden) return;
        const letters = desk.machine?.info.axes ?? [];
        if (letters.join() !== this.lettersShown) {
            this.lettersShown = letters.join();
            const ways = letters.flatMap((letter) => [`${letter}+`, `${letter}-`]);
            // Downwards, as most parts are touched first.
            const first = letters.includes("Z") ? "Z-" : ways[0];
            this.towards.replaceChildren(
                ...ways.map((way) =>
                    element("option", { value: way, selected: way === first }, way)
                )
            );
        }
        const measuring = desk.machine?.state?.measuring;
        const touch = measuring?.touch;
        const place = (/** @type {number[] | undefined} */ at) =>
            at?.map((one, axis) => `${letters[axis]} ${amountText(one, measuring)}`).join("  ") ??
            "–";
        const texts = [
            measuring ? (measuring.is_pressed ? words.probePressed : words.probeFree) : "–",
            place(touch?.trigger),
            place(touch?.contact),
            amountText(touch?.pre_travel, measuring),
            amountText(touch?.spread, measuring),
            amountText(touch?.over_travel, measuring),
        ];
        this.boxes.forEach(([, value], index) => put(value, texts[index]));
        toggle(this.boxes[0][1], measuring?.is_pressed ? "error" : "");
        const tip = measuring?.tip;
        const key = JSON.stringify([desk.machine?.info.machine, tip]);
        // What was typed stays until the machine has another tip.
        if (tip && key !== this.shown) {
            this.shown = key;
            fill(this.plus, String(tip.pre_travel[0]));
            fill(this.minus, String(tip.pre_travel[1]));
            fill(this.ball, String(tip.ball));
        }
        const mayBegin = desk.mayCommand && desk.isIdle;
        for (const one of [this.button, this.set]) disable(one, !mayBegin);
    }
}

/** Whether a field of a form has no number. @param {HTMLInputElement[]} fields */
function hasMistake(fields) {
    return fields.some((one) => one.getAttribute("aria-invalid") === "true");
}

/** The bytes of the last commands and answers. */
export class RawBytes {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.list = element("pre", { class: "mono bytes", "data-value": "bytes" });
        this.details = element(
            "details",
            {},
            element("summary", {}, words.rawBytes),
            element("p", { class: "soft" }, words.rawBytesHelp),
            this.list
        );
        this.details.addEventListener("toggle", () => this.show());
        this.root = element(
            "section",
            { class: "card", "aria-label": words.rawBytes },
            this.details
        );
        desk.listen(() => this.show());
        this.show();
    }

    show() {
        const { desk } = this;
        this.root.hidden = desk.family !== "measuring";
        if (this.root.hidden || !this.details.open) return;
        const line = desk.state?.measuring?.line ?? [];
        put(this.list, line.map(({ sent, received }) => `> ${sent}\n< ${received}`).join("\n"));
    }
}
