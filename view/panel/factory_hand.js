/**
 * Motion by hand of the microfactory, in the modes of the original: the joystick, whose eight
 * buttons move while they are held, and a number of steps of a chosen motor. One motor moves at a
 * time, and while it moves all other buttons are grey.
 */

import { button, element } from "husillo/viewer/element.js";
import { ByHand, lower } from "husillo/panel/by_hand.js";
import { disable } from "husillo/panel/change.js";
import { numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/hold.js").Direction} Direction */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The most steps of the original. */
const MOST = 255;
/** The letters of the motors: C is the spindle. */
const MOTORS = ["X", "Y", "Z", "C"];

/** Motion by hand. */
export class FactoryHand extends ByHand {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {() => void} figure shows what a start of the figure would do
     */
    constructor(desk, words, figure) {
        super(desk, words);
        const { factory } = words;
        /** @type {"joystick" | "steps"} */
        this.mode = "joystick";
        this.home = button(words.home, () => desk.command("home"), { class: "main" });
        this.figure = button(factory.figure, figure);
        this.modes = /** @type {const} */ (["joystick", "steps"]).map((mode) => ({
            mode,
            button: button(factory.modes[mode], () => this.change(mode)),
        }));
        this.motor = element(
            "select",
            {},
            ...MOTORS.map((letter) =>
                element("option", { value: letter }, letter === "C" ? words.spindle : letter)
            )
        );
        this.count = element("input", { inputmode: "numeric", size: 5, value: "1" });
        this.count.addEventListener("input", () => this.check());
        this.count.addEventListener("keydown", (event) => {
            if (event.key === "Enter" && !event.repeat && !this.enter.disabled) this.make();
        });
        this.enter = button(factory.enter, () => this.make(), { class: "main" });
        this.joystick = element(
            "div",
            {},
            this.pads,
            element("p", { class: "soft" }, factory.help)
        );
        this.steps = element(
            "div",
            { hidden: true },
            element(
                "div",
                { class: "items" },
                element("label", { class: "field" }, words.motor, this.motor),
                element("label", { class: "field" }, factory.count, this.count),
                this.enter
            ),
            element("p", { class: "soft" }, factory.countHelp)
        );
        this.root = element(
            "section",
            { class: "card", "aria-label": words.byHand },
            element("h2", {}, words.byHand),
            element(
                "div",
                { class: "items" },
                this.home,
                ...this.modes.map((one) => one.button),
                this.figure
            ),
            this.joystick,
            this.steps,
            this.why
        );
        this.fillSizes([], () => "");
        desk.listen(() => this.show());
        this.show();
    }

    get isShown() {
        return this.desk.family === "microfactory";
    }

    /** Eight buttons: three axes, and the spindle with its two directions of rotation. */
    fillPads() {
        super.fillPads();
        const { factory } = this.words;
        const turns = /** @type {const} */ ([1, -1]).map((side) => {
            const turn = side > 0 ? factory.clockwise : factory.counterClockwise;
            const made = this.arrow("C", side);
            const text = side > 0 ? "C ↻" : "C ↺";
            made.textContent = text;
            made.setAttribute("aria-label", `${text} ${this.words.spindle} ${turn}`);
            return made;
        });
        this.pads.append(
            element("div", { class: "pad one" }, turns[0], element("span"), turns[1])
        );
    }

    /** @param {"joystick" | "steps"} mode */
    change(mode) {
        this.hold.end("mode");
        this.mode = mode;
        this.show();
    }

    /** The steps of the field; undefined if it has none that are possible. */
    get countOf() {
        const count = numberOf(this.count.value) ?? 0;
        const isValid = Number.isInteger(count) && count !== 0 && Math.abs(count) <= MOST;
        return isValid ? count : undefined;
    }

    check() {
        this.count.setAttribute("aria-invalid", String(this.countOf === undefined));
        this.show();
    }

    /** Makes the steps of the field. */
    make() {
        const { countOf } = this;
        if (countOf !== undefined) this.step({ [this.motor.value]: 1 }, countOf);
    }

    /** Without a feed: each motor has one rate. */
    get feedMm() {
        return 1;
    }

    get obstacle() {
        const isLatched = this.desk.state?.factory?.is_latched ?? false;
        return isLatched ? this.words.factory.latchedLong : super.obstacle;
    }

    /** @param {Direction} direction */
    jogOf(direction) {
        // One motor turns at a time: a second key ends the motion.
        const isOne = Object.keys(direction).length === 1;
        return isOne && this.mode === "joystick" ? { axes: lower(direction) } : undefined;
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
        const { desk, hold, modes, mode } = this;
        this.root.hidden = !this.isShown;
        // The pads of other machines are in its place.
        if (this.root.hidden || !modes) return;
        const may = desk.mayCommand && desk.isIdle && !hold.isActive;
        disable(this.home, !may);
        disable(this.figure, !may || desk.state?.program?.errors !== 0);
        for (const one of modes) {
            disable(one.button, !may);
            one.button.setAttribute("aria-pressed", String(one.mode === mode));
        }
        this.joystick.hidden = mode !== "joystick";
        this.steps.hidden = mode !== "steps";
        // The one that is held stays as it is.
        for (const arrow of this.arrows) {
            const isFree = !hold.isActive || arrow.classList.contains("held");
            disable(arrow, !this.mayMove || !isFree);
        }
        disable(this.motor, !may);
        disable(this.count, !may);
        disable(this.enter, !may || this.countOf === undefined);
        // Numbers are not held.
        this.why.hidden = mode === "steps" && this.obstacle === "";
    }
}
