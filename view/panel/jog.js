/**
 * Motion by hand of a machine with feeds: hold to move, steps, go to a position, home, unlock.
 */

import { button, element } from "husillo/viewer/element.js";
import { ByHand, lower } from "husillo/panel/by_hand.js";
import { disable, fill, put, toggle } from "husillo/panel/change.js";
import { trimmed } from "husillo/viewer/quantity.js";
import { lengthOf, lengthText, numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/hold.js").Direction} Direction */
/** @typedef {import("husillo/panel/units.js").Units} Units */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** Sizes of a step in the unit of the operator. */
const STEPS = { mm: [0.01, 0.1, 1, 10, 100], in: [0.001, 0.01, 0.1, 1] };
/** The feed before the operator gives another, per minute. */
const FEED = { mm: "600", in: "24" };
/** How much faster it is with Shift. */
const FAST = 3;
/** The step of a click that is no press, as a screen reader makes it, mm. */
const SMALL = 0.1;

/** Motion by hand. The size of a step is in millimetres. */
export class Jog extends ByHand {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {Units} units
     */
    constructor(desk, words, units) {
        super(desk, words);
        this.units = units;
        /** The unit of the fields. @type {import("husillo/panel/units.js").Unit | undefined} */
        this.unitShown = undefined;
        this.feed = element("input", {
            inputmode: "decimal",
            value: localStorage.getItem(`husillo.jogFeed.${units.unit}`) ?? FEED[units.unit],
        });
        this.feed.addEventListener("change", () =>
            localStorage.setItem(`husillo.jogFeed.${units.unit}`, this.feed.value)
        );
        this.feedUnit = element("span");
        this.home = button(words.home, () => desk.command("home"));
        this.unlock = button(words.unlock, () => desk.command("unlock"));
        this.reset = button(words.reset, () => desk.command("reset"));
        this.goTo = new GoTo(this);
        this.root = element(
            "section",
            { class: "card", "aria-label": words.byHand },
            element("h2", {}, words.byHand),
            element("div", { class: "items" }, this.home, this.unlock, this.reset),
            this.choices,
            this.pads,
            this.why,
            element(
                "div",
                { class: "items" },
                element("label", { class: "field" }, this.feedUnit, this.feed)
            ),
            this.goTo.root
        );
        this.fillSteps();
        desk.listen(() => this.show());
        this.show();
    }

    get isShown() {
        return this.desk.family === "grbl";
    }

    get small() {
        return SMALL;
    }

    fillSteps() {
        const { units, words } = this;
        const feed = this.unitShown && lengthOf(this.feed.value, this.unitShown);
        if (feed) this.feed.value = trimmed(feed / (units.unit === "mm" ? 1 : 25.4), 3);
        this.unitShown = units.unit;
        const inMm = units.unit === "mm" ? 1 : 25.4;
        const sizes = STEPS[units.unit];
        this.fillSizes(
            sizes.map((size) => size * inMm),
            (mm) => `${sizes.find((size) => size * inMm === mm)} ${units.unit}`
        );
        put(this.feedUnit, `${words.jogFeed}, ${units.unit}/min`);
    }

    /** The feed in mm/min; undefined if the field has none. */
    get feedMm() {
        const feed = numberOf(this.feed.value);
        const isValid = feed !== undefined && feed > 0;
        this.feed.setAttribute("aria-invalid", String(!isValid));
        return isValid ? lengthOf(this.feed.value, this.units.unit) : undefined;
    }

    /** @param {Direction} direction */
    jogOf(direction) {
        const { feedMm } = this;
        if (feedMm === undefined) return undefined;
        return { axes: lower(direction), feed: this.isFast ? feedMm * FAST : feedMm };
    }

    /**
     * @param {Direction} direction
     * @param {number} mm
     */
    step(direction, mm) {
        const { feedMm } = this;
        if (!this.mayMove || feedMm === undefined) return;
        const move = Object.fromEntries(
            Object.entries(lower(direction)).map(([axis, side]) => [axis, side * mm])
        );
        this.desk.command("step", { move_mm: move, feed: feedMm });
    }

    show() {
        const { desk, units } = this;
        if (units.unit !== this.unitShown) this.fillSteps();
        super.show();
        this.root.hidden = !this.isShown;
        const word = desk.state?.state ?? "";
        disable(this.home, !desk.mayCommand || !["Idle", "Alarm"].includes(word));
        disable(this.unlock, !desk.mayCommand || word !== "Alarm");
        disable(this.reset, !desk.mayCommand);
        toggle(this.unlock, word === "Alarm" ? "main" : "");
        this.goTo.show();
    }
}

/** Goes to a position: Z apart, because a straight line down through the part is not wanted. */
class GoTo {
    /** @param {Jog} jog */
    constructor(jog) {
        const { words } = jog;
        this.jog = jog;
        this.fields = element("div", { class: "items" });
        this.frame = element(
            "select",
            { "aria-label": words.frame },
            element("option", { value: "work" }, words.work),
            element("option", { value: "machine" }, words.machine)
        );
        this.go = button(words.go, () => this.start());
        this.zero = button(words.goToZero, () => this.toZero());
        this.root = element(
            "details",
            {},
            element("summary", {}, words.goTo),
            this.fields,
            element("div", { class: "items" }, this.frame, this.go, this.zero),
            element("p", { class: "soft" }, words.goToHelp)
        );
        this.shown = "";
        /** @type {Map<string, HTMLInputElement>} */
        this.inputs = new Map();
    }

    show() {
        const { desk, words, units } = this.jog;
        const letters = desk.machine?.info.axes ?? [];
        if (letters.join() !== this.shown) {
            this.shown = letters.join();
            this.inputs = new Map(
                letters.map((letter) => [letter, element("input", { inputmode: "decimal" })])
            );
            this.fields.replaceChildren(
                ...[...this.inputs].map(([letter, input]) =>
                    element("label", { class: "field" }, `${letter}, ${units.unit}`, input)
                )
            );
        }
        const isDisabled = !this.jog.mayMove;
        disable(this.go, isDisabled);
        disable(this.zero, isDisabled);
        put(this.go, words.go);
    }

    start() {
        const { desk, units, feedMm } = this.jog;
        /** @type {Record<string, number>} */
        const to = {};
        for (const [letter, input] of this.inputs) {
            const at = lengthOf(input.value, units.unit);
            input.setAttribute("aria-invalid", String(input.value !== "" && at === undefined));
            if (input.value !== "" && at === undefined) return;
            if (at !== undefined) to[letter.toLowerCase()] = at;
        }
        if (Object.keys(to).length === 0 || feedMm === undefined) return;
        desk.command("goto", { to_mm: to, frame: this.frame.value, feed: feedMm });
    }

    /** X and Y of the work zero. Z stays. */
    toZero() {
        const { feedMm } = this.jog;
        if (feedMm === undefined) return;
        for (const letter of ["X", "Y"]) {
            const input = this.inputs.get(letter);
            if (input) fill(input, lengthText(0, "mm"));
        }
        this.jog.desk.command("goto", { to_mm: { x: 0, y: 0 }, frame: "work", feed: feedMm });
    }
}
