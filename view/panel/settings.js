/**
 * The settings of a controller: meaning, limits, and what would change before it is written.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put, toggle } from "husillo/panel/change.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/**
 * @typedef {object} Setting
 * @property {number} number
 * @property {string} value
 * @property {string} name
 * @property {string} unit
 * @property {string} kind
 * @property {number | null} least
 * @property {number | null} most
 * @property {string | null} meaning
 */

/** The settings. */
export class Settings {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        /** @type {Setting[]} */
        this.settings = [];
        /** @type {Map<number, HTMLInputElement>} */
        this.fields = new Map();
        /** @type {Map<number, HTMLElement>} */
        this.rows = new Map();
        this.machine = 0;
        this.read = button(words.readSettings, () => this.load());
        this.compare = button(words.showChanges, () => this.diff());
        this.body = element("tbody");
        const heads = [words.setting, words.meaning, words.limits, words.value];
        this.table = element(
            "div",
            { class: "scroll", tabindex: 0, role: "region", "aria-label": words.settings },
            element(
                "table",
                { class: "settings" },
                element(
                    "thead",
                    {},
                    element("tr", {}, ...heads.map((text) => element("th", { scope: "col" }, text)))
                ),
                this.body
            )
        );
        this.table.hidden = true;
        this.changes = element("div", { class: "confirm", tabindex: -1, hidden: true });
        this.note = element("p", { class: "why", role: "status" });
        this.root = element(
            "div",
            {},
            element("div", { class: "items" }, this.read, this.compare),
            this.note,
            this.changes,
            this.table
        );
        desk.listen(() => this.show());
        this.show();
    }

    async load() {
        const { machine } = this.desk;
        const data = await this.desk.command("settings");
        if (data && machine === this.desk.machine) this.fill(data.settings);
    }

    /** @param {Setting[]} settings */
    fill(settings) {
        const { words } = this;
        this.settings = settings;
        this.machine = this.desk.machine?.info.machine ?? 0;
        this.fields.clear();
        this.rows.clear();
        this.body.replaceChildren(...settings.map((setting) => this.row(setting)));
        this.table.hidden = false;
        this.changes.hidden = true;
        put(this.note, `${words.settings}: ${settings.length}`);
        this.show();
    }

    /** @param {Setting} setting */
    row(setting) {
        const { number, value, name, unit, meaning, least, most } = setting;
        const id = `setting-${number}`;
        const field = element("input", {
            value,
            id,
            inputmode: setting.kind === "text" ? "text" : "decimal",
        });
        field.addEventListener("input", () => this.edited(setting));
        const label = `$${number} ${name}${unit ? `, ${unit}` : ""}`;
        const text = this.words.settingMeanings[number] ?? meaning ?? "";
        const row = element(
            "tr",
            {},
            element("td", {}, element("label", { for: id }, label)),
            element("td", { class: "soft" }, text),
            element("td", { class: "soft" }, limitsText(least, most)),
            element("td", {}, field)
        );
        this.fields.set(number, field);
        this.rows.set(number, row);
        return row;
    }

    /** @param {Setting} setting */
    edited(setting) {
        const field = this.fields.get(setting.number);
        const row = this.rows.get(setting.number);
        if (!field || !row) return;
        toggle(row, field.value !== setting.value ? "changed" : "");
        field.setAttribute("aria-invalid", String(!isWithin(setting, field.value)));
        this.changes.hidden = true;
        this.show();
    }

    /** What the operator has changed. @returns {Record<string, string>} */
    get values() {
        return Object.fromEntries(
            this.settings
                .map((one) => ({ ...one, now: this.fields.get(one.number)?.value ?? one.value }))
                .filter(({ value, now }) => now !== value)
                .map(({ number, now }) => [String(number), now.trim()])
        );
    }

    /** Shows what would change. Nothing is written. */
    async diff() {
        const { desk, words, changes, values } = this;
        const { machine } = desk;
        const data = await desk.command("settings_diff", { values });
        if (!data || machine !== desk.machine) return;
        const mayWrite = data.refused.length === 0 && data.changes.length > 0;
        const write = button(words.write, () => this.save(values), { class: "main" });
        disable(write, !mayWrite);
        changes.hidden = false;
        changes.replaceChildren(
            element("strong", {}, data.changes.length > 0 ? words.changes : words.noChanges),
            element(
                "ul",
                {},
                ...data.changes.map((/** @type {any} */ one) =>
                    element(
                        "li",
                        {},
                        `$${one.number} ${one.name}: ${one.from} → ${one.to} ${one.unit}`
                    )
                ),
                ...data.refused.map((/** @type {any} */ one) =>
                    element("li", { class: "error" }, `$${one.number}: ${one.why}`)
                )
            ),
            element(
                "div",
                { class: "items" },
                button(words.cancel, () => (changes.hidden = true)),
                write
            )
        );
        changes.focus();
    }

    /** @param {Record<string, string>} values */
    async save(values) {
        const { machine } = this.desk;
        const data = await this.desk.command("settings_save", { values });
        if (!data || machine !== this.desk.machine) return;
        this.fill(data.settings);
        put(this.note, this.words.written);
    }

    show() {
        const { desk } = this;
        const isOther = this.machine !== 0 && this.machine !== desk.machine?.info.machine;
        if (isOther) {
            this.machine = 0;
            this.settings = [];
            this.table.hidden = true;
            this.changes.hidden = true;
        }
        disable(this.read, desk.state?.link !== "up" || desk.isUnderWay);
        const hasChanges = Object.keys(this.values).length > 0;
        disable(this.compare, !desk.mayCommand || !hasChanges);
        for (const field of this.fields.values()) disable(field, !desk.mayCommand);
    }
}

/**
 * @param {number | null} least
 * @param {number | null} most
 */
function limitsText(least, most) {
    if (least === null && most === null) return "";
    if (most === null) return `≥ ${least}`;
    return least === null ? `≤ ${most}` : `${least} … ${most}`;
}

/**
 * @param {Setting} setting
 * @param {string} text
 */
function isWithin({ kind, least, most }, text) {
    if (kind === "text") return true;
    const value = Number(text);
    if (text.trim() === "" || Number.isNaN(value)) return false;
    return (least === null || value >= least) && (most === null || value <= most);
}
