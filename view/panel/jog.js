/**
 * Motion by hand: hold to move, steps, go to a position, home, unlock.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, fill, put, toggle } from "husillo/panel/change.js";
import { Hold } from "husillo/panel/hold.js";
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

/** The buttons of the pad: letter and direction of each axis, and where it is. */
const PAD = /** @type {(["X" | "Y", 1 | -1] | null)[]} */ ([
    null,
    ["Y", 1],
    null,
    ["X", -1],
    null,
    ["X", 1],
    null,
    ["Y", -1],
    null,
]);

/** Motion by hand. */
export class Jog {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {Units} units
     */
    constructor(desk, words, units) {
        this.desk = desk;
        this.words = words;
        this.units = units;
        /** A step in millimetres; 0: hold to move. */
        this.stepMm = 0;
        this.isFast = false;
        /** The unit of the fields. @type {import("husillo/panel/units.js").Unit | undefined} */
        this.unitShown = undefined;
        /** The number of the last jog. A larger one follows, also after a reload. */
        this.number = Date.now();
        /** The machine of the last jog. @type {number | undefined} */
        this.machine = undefined;
        /** The last jog of this page that the server has told of. */
        this.wasSeen = 0;
        this.hold = new Hold({
            begin: (direction) => this.begin(direction),
            renew: () => desk.tell("renew", { machine: this.machine, jog: this.number }),
            end: () => desk.tell("release", { machine: this.machine, jog: this.number }),
        });
        /** @type {HTMLButtonElement[]} */
        this.arrows = [];
        this.why = element("p", { class: "why" });
        this.feed = element("input", {
            inputmode: "decimal",
            value: localStorage.getItem(`husillo.jogFeed.${units.unit}`) ?? FEED[units.unit],
        });
        this.feed.addEventListener("change", () =>
            localStorage.setItem(`husillo.jogFeed.${units.unit}`, this.feed.value)
        );
        this.choices = element(
            "fieldset",
            { class: "choices" },
            element("legend", {}, words.stepSize)
        );
        this.pads = element("div", { class: "pads" });
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
        this.fillPads();
        this.fillSteps();
        this.listen();
        desk.listen(() => this.show());
        this.show();
    }

    /** Whatever takes the operator away from the page ends the motion. */
    listen() {
        window.addEventListener("blur", () => this.hold.end("blur"));
        window.addEventListener("pagehide", () => this.hold.end("closed"));
        document.addEventListener("visibilitychange", () => {
            if (document.hidden) this.hold.end("hidden");
        });
        for (const name of ["pointerup", "pointercancel"]) {
            window.addEventListener(name, (event) => {
                const { pointerId } = /** @type {PointerEvent} */ (event);
                this.hold.release(`pointer ${pointerId}`, name);
            });
        }
    }

    fillPads() {
        const letters = this.desk.machine?.info.axes ?? ["X", "Y", "Z"];
        this.lettersShown = letters.join();
        this.arrows = [];
        const plane = element("div", { class: "pad" });
        for (const place of PAD) {
            plane.append(
                place && letters.includes(place[0]) ? this.arrow(...place) : element("span")
            );
        }
        const others = letters
            .filter((letter) => letter !== "X" && letter !== "Y")
            .map((letter) =>
                element(
                    "div",
                    { class: "pad one" },
                    this.arrow(letter, 1),
                    element("span"),
                    this.arrow(letter, -1)
                )
            );
        this.pads.replaceChildren(plane, ...others);
    }

    /**
     * @param {string} letter
     * @param {1 | -1} side
     */
    arrow(letter, side) {
        const { words } = this;
        const sign = side > 0 ? "+" : "−";
        const name = `${words.jog} ${letter} ${side > 0 ? words.plus : words.minus}`;
        const made = element(
            "button",
            { type: "button", "aria-label": name, "data-jog": `${letter}${side > 0 ? "+" : "-"}` },
            letter + sign
        );
        const direction = { [letter]: side };
        made.addEventListener("pointerdown", (event) => {
            if (event.button !== 0 || made.disabled) return;
            // Touch would capture the pointer, and leaving the button would not be seen.
            if (made.hasPointerCapture(event.pointerId)) {
                made.releasePointerCapture(event.pointerId);
            }
            this.press(`pointer ${event.pointerId}`, direction, event);
        });
        made.addEventListener("pointerleave", (event) =>
            this.hold.release(`pointer ${event.pointerId}`, "pointerleave")
        );
        made.addEventListener("contextmenu", (event) => event.preventDefault());
        made.addEventListener("keydown", (event) => {
            if (event.key !== "Enter") return;
            event.preventDefault();
            if (!event.repeat) this.press(`enter ${name}`, direction, event);
        });
        made.addEventListener("keyup", (event) => {
            if (event.key === "Enter") this.hold.release(`enter ${name}`, "keyup");
        });
        made.addEventListener("blur", () => this.hold.release(`enter ${name}`, "blur"));
        made.addEventListener("click", ({ detail }) => {
            // A click of a space or of a screen reader counts no presses. It makes one step.
            if (detail === 0) this.step(direction, this.stepMm || SMALL);
        });
        this.arrows.push(made);
        return made;
    }

    fillSteps() {
        const { units, words, choices } = this;
        const [legend] = choices.children;
        const sizes = STEPS[units.unit];
        const feed = this.unitShown && lengthOf(this.feed.value, this.unitShown);
        if (feed) this.feed.value = trimmed(feed / (units.unit === "mm" ? 1 : 25.4), 3);
        this.unitShown = units.unit;
        this.stepMm = 0;
        this.stepButtons = [0, ...sizes].map((size) => {
            const mm = size * (units.unit === "mm" ? 1 : 25.4);
            const text = size === 0 ? words.holdToMove : `${size} ${units.unit}`;
            return { mm, button: button(text, () => this.choose(mm)) };
        });
        choices.replaceChildren(legend, ...this.stepButtons.map((one) => one.button));
        put(this.feedUnit, `${words.jogFeed}, ${units.unit}/min`);
    }

    /** @param {number} mm */
    choose(mm) {
        this.stepMm = mm;
        this.show();
    }

    /** The next larger or smaller step. @param {1 | -1} by */
    chooseNext(by) {
        const all = this.stepButtons?.map((one) => one.mm) ?? [0];
        const at = all.indexOf(this.stepMm) + by;
        this.choose(all[Math.max(0, Math.min(all.length - 1, at))]);
    }

    /** Whether a motion by hand may begin. */
    get mayMove() {
        const { desk } = this;
        const word = desk.state?.state;
        return desk.mayCommand && !desk.isUnderWay && (word === "Idle" || word === "Jog");
    }

    /** Why none may begin, in words; empty if one may. */
    get obstacle() {
        const { desk, words } = this;
        if (this.mayMove) return "";
        if (desk.link.status !== "up") return words.whyNoLink;
        if (desk.state?.link !== "up") return words.whyNoController;
        if (!desk.isOperator) return words.whyWatching;
        if (desk.isUnderWay) return words.whyProgram;
        if (desk.state.state === "Alarm") return words.whyAlarm;
        return words.whyBusy;
    }

    /** The feed in mm/min; undefined if the field has none. */
    get feedMm() {
        const feed = numberOf(this.feed.value);
        const isValid = feed !== undefined && feed > 0;
        this.feed.setAttribute("aria-invalid", String(!isValid));
        return isValid ? lengthOf(this.feed.value, this.units.unit) : undefined;
    }

    /**
     * An input is pressed: it holds, or makes a step.
     *
     * @param {string} input
     * @param {Direction} direction
     * @param {{shiftKey: boolean, ctrlKey: boolean}} keys Shift is faster, Ctrl makes one step
     */
    press(input, direction, { shiftKey, ctrlKey }) {
        this.isFast = shiftKey;
        if (ctrlKey || this.stepMm > 0) this.step(direction, this.stepMm || SMALL);
        else this.hold.press(input, direction);
    }

    /**
     * @param {Direction} direction
     * @returns {boolean}
     */
    begin(direction) {
        const { desk, feedMm } = this;
        if (!this.mayMove || feedMm === undefined) return false;
        const isNew = !this.hold.isActive;
        if (isNew) this.number = Math.max(this.number + 1, Date.now());
        const jog = this.number;
        this.machine = desk.machine?.info.machine;
        desk.request("jog", {
            jog,
            axes: lower(direction),
            feed: this.isFast ? feedMm * FAST : feedMm,
        }).catch((error) => {
            if (this.number === jog) this.hold.end("refused");
            desk.refuse(error.message);
        });
        return true;
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
        const { desk, words, units, hold } = this;
        if (hold.isActive && this.machine !== desk.machine?.info.machine) hold.end("another");
        if (hold.isActive && !this.mayMove) hold.end("refused");
        // The server has ended the jog: its lease was over, or somebody stopped.
        const jog = desk.state?.jog;
        if (jog && jog.client === desk.link.client) this.wasSeen = jog.jog;
        else if (hold.isActive && this.wasSeen === this.number) hold.end("ended");
        const letters = desk.machine?.info.axes.join();
        if (letters !== undefined && letters !== this.lettersShown) this.fillPads();
        if (units.unit !== this.unitShown) this.fillSteps();
        const { obstacle } = this;
        put(this.why, obstacle || (this.stepMm > 0 ? words.stepHelp : words.holdHelp));
        const held = hold.isActive ? hold.direction : {};
        for (const arrow of this.arrows) {
            disable(arrow, obstacle !== "" && !hold.isActive);
            const [letter, sign] = arrow.dataset.jog ?? "";
            const isHeld = Math.sign(held[letter] ?? 0) === (sign === "+" ? 1 : -1);
            toggle(arrow, isHeld ? "held" : "");
        }
        for (const one of this.stepButtons ?? []) {
            one.button.setAttribute("aria-pressed", String(one.mm === this.stepMm));
        }
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

/**
 * The names of axes as the server has them.
 *
 * @param {Direction} direction
 */
function lower(direction) {
    return Object.fromEntries(
        Object.entries(direction).map(([letter, part]) => [letter.toLowerCase(), part])
    );
}
