/**
 * Feed, speed of the spindle, overrides, accessories and switches.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put, toggle } from "husillo/panel/change.js";
import { lengthText } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/units.js").Units} Units */
/** @typedef {import("husillo/panel/words.js").Words} Words */
/** @typedef {"feed" | "rapid" | "spindle"} What */

/** Least, most and step of each override, percent. */
const RANGES = /** @type {Record<What, [number, number, number]>} */ ({
    feed: [10, 200, 1],
    rapid: [25, 100, 25],
    spindle: [10, 200, 1],
});
/** Time after the last movement of a slider before the machine is told, milliseconds. */
const SETTLED = 120;
/** Time in which the machine takes a new override, milliseconds. The slider stays so long. */
const TAKEN = 1500;

/** Feed, rpm and their overrides. */
export class Speeds {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {Units} units
     */
    constructor(desk, words, units) {
        this.desk = desk;
        this.words = words;
        this.units = units;
        this.feed = element("dd", { "data-value": "feed" });
        this.rpm = element("dd", { "data-value": "rpm" });
        this.modal = element("dd", { "data-value": "modal" });
        this.tool = element("dd", { "data-value": "tool" });
        const figures = /** @type {[string, HTMLElement][]} */ ([
            [words.feed, this.feed],
            [words.spindle, this.rpm],
            [words.tool, this.tool],
            [words.modal, this.modal],
        ]);
        const names = { feed: words.feed, rapid: words.rapids, spindle: words.spindle };
        this.overrides = /** @type {What[]} */ (["feed", "rapid", "spindle"]).map(
            (what) => new Override(desk, words, what, names[what])
        );
        this.root = element(
            "section",
            { class: "card", "aria-label": words.speeds },
            element("h2", {}, words.speeds),
            element(
                "dl",
                { class: "figures" },
                ...figures.map(([name, value]) =>
                    element("div", {}, element("dt", {}, name), value)
                )
            ),
            ...this.overrides.map((one) => one.root)
        );
        desk.listen(() => this.show());
        this.show();
    }

    show() {
        const { desk, units } = this;
        const { state } = desk;
        const feed = lengthText(state?.feed, units.unit).replace(/\.?0+$/, "");
        put(this.feed, state ? `${feed || "0"} ${units.unit}/min` : "–");
        put(this.rpm, state ? `${Math.round(state.rpm ?? 0)} rpm` : "–");
        put(this.tool, state?.tool === null || !state ? "–" : `T${state.tool}`);
        put(this.modal, state?.modal.join(" ") || "–");
        for (const one of this.overrides) one.show();
    }
}

/** An override: slider, steps of 10 %, and 100 %. */
export class Override {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {What} what
     * @param {string} name
     */
    constructor(desk, words, what, name) {
        this.desk = desk;
        this.what = what;
        this.timer = 0;
        /** The machine whose override it shows. @type {object | undefined} */
        this.machine = undefined;
        /** Until when the slider is not moved by the machine. */
        this.ownUntil = 0;
        const [min, max, step] = RANGES[what];
        this.slider = element("input", {
            type: "range",
            min,
            max,
            step,
            "aria-label": `${words.override}: ${name}`,
        });
        this.slider.addEventListener("input", () => this.moved());
        this.percent = element("output", { class: "number", "data-override": what });
        this.reset = button("100 %", () => this.set(100), {
            "aria-label": `${words.resetOverride}: ${name}`,
        });
        this.root = element(
            "div",
            { class: "override" },
            element("span", {}, name),
            element("span", { class: "wide" }, this.slider),
            this.percent,
            this.reset
        );
    }

    moved() {
        this.ownUntil = Date.now() + TAKEN;
        put(this.percent, `${this.slider.value} %`);
        clearTimeout(this.timer);
        this.timer = window.setTimeout(() => this.tell(), SETTLED);
    }

    /** @param {number} percent */
    set(percent) {
        const [min, max] = RANGES[this.what];
        this.slider.value = String(Math.max(min, Math.min(max, percent)));
        this.ownUntil = Date.now() + TAKEN;
        put(this.percent, `${this.slider.value} %`);
        this.tell();
    }

    /** @param {number} by percent */
    change(by) {
        this.set(Number(this.slider.value) + by);
    }

    tell() {
        clearTimeout(this.timer);
        this.desk.command("override", {
            what: this.what,
            percent: Number(this.slider.value),
        });
    }

    show() {
        const { desk, what, slider, percent } = this;
        if (this.machine !== desk.machine) {
            this.machine = desk.machine;
            this.ownUntil = 0;
            clearTimeout(this.timer);
        }
        const value = desk.state?.override?.[what];
        disable(slider, !desk.mayCommand);
        disable(this.reset, !desk.mayCommand);
        if (value === undefined) put(percent, "–");
        else if (Date.now() > this.ownUntil || Number(slider.value) === value) {
            if (Number(slider.value) !== value) slider.value = String(value);
            put(percent, `${value} %`);
        }
    }
}

/** Accessories, which can be switched, and the switches of the machine. */
export class Outputs {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        const names = { spindle: words.spindle, flood: words.flood, mist: words.mist };
        this.buttons = /** @type {(keyof typeof names)[]} */ (Object.keys(names)).map((what) => ({
            what,
            name: names[what],
            button: button(names[what], () => this.change(what), { "aria-pressed": "false" }),
        }));
        this.rpm = element("input", { inputmode: "numeric", value: "1000", size: 6 });
        this.lamps = element("ul", { class: "lamps", "aria-label": words.switches });
        this.shown = "";
        this.root = element(
            "section",
            { class: "card", "aria-label": words.outputs },
            element("h2", {}, words.outputs),
            element(
                "div",
                { class: "items" },
                ...this.buttons.map((one) => one.button),
                element("label", { class: "field" }, "rpm", this.rpm)
            ),
            element("h3", {}, words.switches),
            this.lamps
        );
        desk.listen(() => this.show());
        this.show();
    }

    /** @param {"spindle" | "flood" | "mist"} what */
    change(what) {
        const { desk } = this;
        const on = desk.state?.accessories;
        // Lines are for a machine that stands; what runs a program is toggled.
        if (!desk.isIdle) desk.command("toggle", { what });
        else if (what === "spindle") {
            const rpm = Math.max(0, Math.round(Number(this.rpm.value) || 0));
            const turns = on?.spindle === "cw" || on?.spindle === "ccw";
            desk.command("line", { text: turns ? "M5" : `M3 S${rpm}` });
        } else if (on?.[what]) {
            // M9 switches both off, so the other one is switched on again.
            const other = what === "flood" ? on.mist && "M7" : on.flood && "M8";
            desk.command("line", { text: "M9" }).then((done) => {
                if (done !== undefined && other) desk.command("line", { text: other });
            });
        } else desk.command("line", { text: what === "flood" ? "M8" : "M7" });
    }

    show() {
        const { desk, words } = this;
        const { state } = desk;
        const on = state?.accessories;
        const isHeld = state?.state === "Hold" && state.detail === 0;
        for (const { what, name, button } of this.buttons) {
            const value = on?.[what] ?? false;
            const isOn = what === "spindle" ? value === "cw" || value === "ccw" : value === true;
            button.setAttribute("aria-pressed", String(isOn));
            const turn = value === "ccw" ? words.counterClockwise : words.on;
            put(button, `${name}: ${isOn ? turn : words.off}`);
            disable(button, !desk.mayCommand || (what === "spindle" && !desk.isIdle && !isHeld));
        }
        const closed = state?.switches ?? [];
        const letters = ["X", "Y", "Z", "P", "D", "H", "R", "S"];
        const text = closed.join();
        if (this.shown === text && this.lamps.childElementCount > 0) return;
        this.shown = text;
        this.lamps.replaceChildren(
            ...letters.map((letter) => {
                const isOn = closed.includes(letter);
                const item = element("li", { "data-switch": letter });
                toggle(item, isOn ? "on" : "");
                const position = isOn ? words.closed : words.open;
                item.textContent = `${words.switchNames[letter]}: ${position}`;
                return item;
            })
        );
    }
}
