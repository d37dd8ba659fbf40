/**
 * What only a micro mill has: the string that was sent beside its echo, its speeds, its backlash.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, fill, put, toggle } from "husillo/panel/change.js";
import { lengthText, numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/units.js").Units} Units */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The string that was sent, and its confirmation. */
export class Confirmation {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        this.sent = element("dd", { class: "mono", "data-value": "sent" });
        this.echo = element("dd", { class: "mono", "data-value": "echo" });
        this.outcome = element("dd", { "data-value": "outcome" });
        this.root = section(words.confirmation, [
            figures([
                [words.stringSent, this.sent],
                [words.stringEcho, this.echo],
                [words.stringOutcome, this.outcome],
            ]),
        ]);
        desk.listen(() => this.show());
        this.show();
    }

    show() {
        const { desk, words } = this;
        this.root.hidden = desk.family !== "micromill";
        const mill = desk.state?.mill;
        put(this.sent, mill?.sent || "–");
        put(this.echo, mill?.echo || "–");
        const outcome = mill?.outcome ?? null;
        const isConfirmed = mill !== undefined && mill.sent !== "" && mill.sent === mill.echo;
        put(this.outcome, outcome === null ? "–" : (words.outcomes[outcome] ?? outcome));
        toggle(this.echo, "mono", isConfirmed ? "confirmed" : "");
        toggle(this.outcome, outcome === "done" || outcome === "moving" ? "" : "error");
    }
}

/** Feed, step rate, turns of motor and spindle. */
export class MillSpeeds {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {Units} units
     */
    constructor(desk, words, units) {
        this.desk = desk;
        this.units = units;
        this.feed = element("dd", { "data-value": "mill-feed" });
        this.hz = element("dd", { "data-value": "step-hz" });
        this.motor = element("dd", { "data-value": "motor-rpm" });
        this.spindle = element("dd", { "data-value": "spindle-rpm" });
        this.steps = element("dd", { "data-value": "motor-steps" });
        this.root = section(words.speeds, [
            figures([
                [words.feed, this.feed],
                [words.stepRate, this.hz],
                [words.motor, this.motor],
                [words.spindle, this.spindle],
                [words.motorSteps, this.steps],
            ]),
        ]);
        desk.listen(() => this.show());
        this.show();
    }

    show() {
        const { desk, units } = this;
        this.root.hidden = desk.family !== "micromill";
        const { state } = desk;
        const mill = state?.mill;
        const feed = lengthText(state?.feed, units.unit);
        put(this.feed, mill ? `${feed} ${units.unit}/min` : "–");
        put(this.hz, mill ? `${mill.step_hz} Hz` : "–");
        put(this.motor, mill ? `${mill.motor_rpm} rpm` : "–");
        put(this.spindle, mill ? `${Math.round(state?.rpm ?? 0)} rpm` : "–");
        const letters = desk.machine?.info.axes ?? [];
        const steps = mill?.motor_steps?.map((count, axis) => `${letters[axis]} ${count}`);
        put(this.steps, steps?.join("  ") ?? "–");
    }
}

/** The backlash that the mill takes up when an axis turns round. */
export class Backlash {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.fields = ["X", "Y", "Z"].map((letter) => {
            const field = element("input", { inputmode: "numeric", size: 4, "data-um": letter });
            field.addEventListener("keydown", (event) => {
                if (event.key === "Enter") this.set();
            });
            return { letter, field };
        });
        this.button = button(words.setBacklash, () => this.set());
        this.root = section(words.backlash, [
            element(
                "div",
                { class: "items" },
                ...this.fields.map(({ letter, field }) =>
                    element("label", { class: "field" }, `${letter}, µm`, field)
                ),
                this.button
            ),
            element("p", { class: "soft" }, words.backlashHelp),
        ]);
        /** What the fields had from the machine. */
        this.shown = "";
        desk.listen(() => this.show());
        this.show();
    }

    /** Tells the mill the values that differ. */
    set() {
        const now = this.desk.state?.mill?.backlash_um;
        /** @type {Record<string, number>} */
        const um = {};
        for (const [axis, { letter, field }] of this.fields.entries()) {
            const value = numberOf(field.value);
            const isValid = Number.isInteger(value) && Number(value) >= 0 && Number(value) <= 999;
            field.setAttribute("aria-invalid", String(!isValid));
            if (!isValid) return;
            if (value !== now?.[axis]) um[letter.toLowerCase()] = Number(value);
        }
        if (Object.keys(um).length > 0) this.desk.command("backlash", { um });
    }

    show() {
        const { desk } = this;
        this.root.hidden = desk.family !== "micromill";
        const um = desk.state?.mill?.backlash_um;
        const key = `${desk.machine?.info.machine} ${um}`;
        // What was typed stays until the mill has other values.
        if (um && key !== this.shown) {
            this.shown = key;
            this.fields.forEach(({ field }, axis) => fill(field, String(um[axis])));
        }
        const isDisabled = !desk.mayCommand || !desk.isIdle;
        for (const { field } of this.fields) disable(field, isDisabled);
        disable(this.button, isDisabled);
    }
}

/**
 * @param {string} name
 * @param {HTMLElement[]} content
 */
function section(name, content) {
    return element(
        "section",
        { class: "card", "aria-label": name },
        element("h2", {}, name),
        ...content
    );
}

/** @param {[string, HTMLElement][]} rows */
function figures(rows) {
    return element(
        "dl",
        { class: "figures" },
        ...rows.map(([name, value]) => element("div", {}, element("dt", {}, name), value))
    );
}
