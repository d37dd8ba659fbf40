/**
 * The manual screen of the drill: keys that move by steps, the spindle, taught holes, the zero.
 */

import { button, element } from "husillo/viewer/element.js";
import { ByHand, lower } from "husillo/panel/by_hand.js";
import { disable, put } from "husillo/panel/change.js";
import { lengthText, numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/hold.js").Direction} Direction */
/** @typedef {import("husillo/panel/units.js").Units} Units */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** Sizes of a step that have a button: steps of the motors. */
const STEPS = [1, 5, 10, 50, 107, 255];
/** The largest step of the original. */
const MOST = 255;
/** Steps of a millimetre. */
const STEPS_PER_MM = 107;

/** Motion by hand. The size of a step is in steps of the motors. */
export class DrillHand extends ByHand {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {Units} units
     * @param {() => void} start what F4 does
     */
    constructor(desk, words, units, start) {
        super(desk, words);
        this.units = units;
        this.start = start;
        const { drill } = words;
        this.mode = button(drill.manualMode, () => this.switchMode(), { class: "main" });
        this.home = button(`${words.home} (F1)`, () => desk.command("home"));
        this.clear = button(`${drill.clear} (F2)`, () => this.zero());
        this.test = button(`${drill.test} (F3)`, () => this.testLink());
        this.spindleOn = button(`${drill.spindleOn} (${drill.homeKey})`, () => this.spindle(true));
        this.spindleOff = button(`${drill.spindleOff} (${drill.endKey})`, () =>
            this.spindle(false)
        );
        this.teach = button(drill.teach, () => desk.command("teach"));
        this.taught = button(drill.taught, () => desk.command("taught"));
        this.answer = element("p", { class: "why", role: "status" });
        this.own = element("input", { inputmode: "numeric", size: 4, value: "1" });
        this.own.addEventListener("change", () => this.chooseOwn());
        this.length = element("output", { class: "number", "data-value": "step-length" });
        this.screen = element(
            "div",
            { class: "screen", tabindex: 0, role: "group", "aria-label": drill.screen },
            this.pads,
            element("p", { class: "soft" }, drill.screenHelp)
        );
        this.screen.addEventListener("keydown", (event) => this.key(event));
        this.root = element(
            "section",
            { class: "card", "aria-label": words.byHand },
            element("h2", {}, words.byHand),
            element("div", { class: "items" }, this.mode, this.home),
            this.choices,
            element(
                "div",
                { class: "items" },
                element("label", { class: "field" }, drill.ownStep, this.own),
                this.length
            ),
            this.screen,
            this.why,
            element("div", { class: "items" }, this.spindleOn, this.spindleOff),
            element("div", { class: "items" }, this.teach, this.taught),
            element("div", { class: "items" }, this.clear, this.test),
            element("p", { class: "soft" }, drill.clearHelp),
            this.answer
        );
        this.fillSizes(STEPS, (steps) => `${steps} ${steps === 1 ? words.step : words.steps}`);
        desk.listen(() => this.show());
        this.show();
    }

    get isShown() {
        return this.desk.family === "drill";
    }

    get isManual() {
        return this.desk.state?.drill?.is_manual ?? false;
    }

    get obstacle() {
        if (!super.mayMove) return super.obstacle;
        return this.isManual ? "" : this.words.drill.whyNotManual;
    }

    get mayMove() {
        return super.mayMove && this.isManual;
    }

    /** Without a feed: the drill has one rate. */
    get feedMm() {
        return 1;
    }

    async switchMode() {
        const { desk, isManual } = this;
        const done = await desk.command("manual", { on: !isManual });
        if (done !== undefined && !isManual) this.screen.focus();
    }

    zero() {
        return this.desk.command("zero", { at_mm: { x: 0, y: 0 } });
    }

    async testLink() {
        const { desk, words } = this;
        put(this.answer, "");
        const tested = await desk.command("link_test");
        if (tested) put(this.answer, `${words.drill.linkWorks} ${tested.ms} ms`);
    }

    /** @param {boolean} on */
    spindle(on) {
        this.desk.command("spindle", { on });
    }

    /** The step of the field. */
    chooseOwn() {
        const steps = numberOf(this.own.value);
        const isValid = Number.isInteger(steps) && Number(steps) >= 1 && Number(steps) <= MOST;
        this.own.setAttribute("aria-invalid", String(!isValid));
        if (isValid) this.choose(Number(steps));
    }

    /** @param {number} size */
    choose(size) {
        if (size > 0) this.own.value = String(size);
        super.choose(size);
    }

    /**
     * The keys of the original, while its screen has the focus. Tab makes the step larger by one,
     * with Shift smaller; F6 leaves the screen.
     *
     * @param {KeyboardEvent} event
     */
    key(event) {
        const act = this.actOf(event);
        if (!act || event.altKey || event.ctrlKey || event.metaKey) return;
        event.preventDefault();
        event.stopPropagation();
        if (!event.repeat || event.key === "Tab") act();
    }

    /**
     * @param {KeyboardEvent} event
     * @returns {(() => void) | undefined}
     */
    actOf({ key, shiftKey }) {
        const { desk } = this;
        const may = desk.mayCommand && desk.isIdle;
        const command = (/** @type {() => unknown} */ act) => () => {
            if (may) act();
        };
        switch (key) {
            case "Tab": {
                const size = this.size + (shiftKey ? -1 : 1);
                return () => this.choose(Math.max(1, Math.min(MOST, size)));
            }
            case "Home":
                return command(() => this.spindle(true));
            case "End":
                return command(() => this.spindle(false));
            case "F1":
                return command(() => desk.command("home"));
            case "F2":
                return command(() => this.zero());
            case "F3":
                return command(() => this.testLink());
            case "F4":
                return command(() => this.start());
            case "F5":
                return () => {
                    this.units.choose(this.units.unit === "mm" ? "in" : "mm");
                    desk.changed();
                };
            case "F6":
                return () => this.mode.focus();
            default:
                return undefined;
        }
    }

    /** @param {Direction} direction */
    jogOf(direction) {
        return { axes: lower(direction) };
    }

    /**
     * @param {Direction} direction
     * @param {number} size
     */
    step(direction, size) {
        if (!this.mayMove) return;
        const steps = Object.fromEntries(
            Object.entries(lower(direction)).map(([axis, side]) => [axis, side * size])
        );
        this.desk.command("steps", { steps });
    }

    show() {
        super.show();
        const { desk, words, units, isManual } = this;
        this.root.hidden = !this.isShown;
        const may = desk.mayCommand && desk.isIdle;
        put(this.mode, isManual ? words.drill.leaveManual : words.drill.manualMode);
        const controls = [this.mode, this.home, this.clear, this.test];
        for (const one of [...controls, this.spindleOn, this.spindleOff]) disable(one, !may);
        disable(this.teach, !may || !isManual);
        disable(this.taught, !may || !desk.state?.drill?.records);
        const spindle = desk.state?.drill?.spindle ?? false;
        this.spindleOn.setAttribute("aria-pressed", String(spindle));
        const mm = this.size / STEPS_PER_MM;
        const { unit } = units;
        put(this.length, this.size > 0 ? `= ${lengthText(mm, unit, 1)} ${unit}` : "");
    }
}
