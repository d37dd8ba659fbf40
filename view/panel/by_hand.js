/**
 * What motion by hand has in common on all machines: a pad of buttons and keys that are held or
 * make steps, and the sizes of the steps.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put, toggle } from "husillo/panel/change.js";
import { Hold } from "husillo/panel/hold.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/hold.js").Direction} Direction */
/** @typedef {import("husillo/panel/words.js").Words} Words */

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

/** States of a machine in which it can be moved. */
const MOVABLE = ["Idle", "Jog", "Tool"];

/** Motion by hand. A machine says what a jog and a step are. */
export class ByHand {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        /** The size of a step; 0: hold to move. */
        this.size = 0;
        this.isFast = false;
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
        /** @type {{size: number, button: HTMLButtonElement}[]} */
        this.sizeButtons = [];
        this.why = element("p", { class: "why" });
        this.choices = element(
            "fieldset",
            { class: "choices" },
            element("legend", {}, words.stepSize)
        );
        this.pads = element("div", { class: "pads" });
        this.fillPads();
        this.listen();
    }

    /** Whether this motion by hand is that of the shown machine. */
    get isShown() {
        return true;
    }

    /** The step of a click that is no press, as a screen reader makes it. */
    get small() {
        return 1;
    }

    /** The feed in mm/min; undefined if the field has none. @returns {number | undefined} */
    get feedMm() {
        return 0;
    }

    /**
     * What the request of a jog needs besides its number; undefined if none may begin.
     *
     * @param {Direction} direction
     * @returns {object | undefined}
     */
    jogOf(direction) {
        return { axes: lower(direction) };
    }

    /**
     * Makes a step.
     *
     * @param {Direction} _direction
     * @param {number} _size
     */
    step(_direction, _size) {}

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
            if (detail === 0) this.step(direction, this.size || this.small);
        });
        this.arrows.push(made);
        return made;
    }

    /**
     * @param {number[]} sizes of a step
     * @param {(size: number) => string} text
     */
    fillSizes(sizes, text) {
        const [legend] = this.choices.children;
        this.size = 0;
        this.sizeButtons = [0, ...sizes].map((size) => {
            const name = size === 0 ? this.words.holdToMove : text(size);
            return { size, button: button(name, () => this.choose(size)) };
        });
        this.choices.replaceChildren(legend, ...this.sizeButtons.map((one) => one.button));
    }

    /** @param {number} size */
    choose(size) {
        this.size = size;
        this.show();
    }

    /** The next larger or smaller step. @param {1 | -1} by */
    chooseNext(by) {
        const all = this.sizeButtons.map((one) => one.size);
        const at = all.indexOf(this.size) + by;
        this.choose(all[Math.max(0, Math.min(all.length - 1, at))] ?? 0);
    }

    /** Whether a motion by hand may begin. */
    get mayMove() {
        const { desk } = this;
        const word = desk.state?.state;
        return desk.mayCommand && !desk.isOfProgram && MOVABLE.includes(word ?? "");
    }

    /** Why none may begin, in words; empty if one may. */
    get obstacle() {
        const { desk, words } = this;
        if (this.mayMove) return "";
        if (desk.link.status !== "up") return words.whyNoLink;
        if (desk.state?.link !== "up") return words.whyNoController;
        if (!desk.isOperator) return words.whyWatching;
        if (desk.isOfProgram) return words.whyProgram;
        if (desk.state.state === "Alarm") return words.whyAlarm;
        return words.whyBusy;
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
        if (ctrlKey || this.size > 0) this.step(direction, this.size || this.small);
        else this.hold.press(input, direction);
    }

    /**
     * @param {Direction} direction
     * @returns {boolean}
     */
    begin(direction) {
        const { desk } = this;
        const fields = this.mayMove ? this.jogOf(direction) : undefined;
        if (fields === undefined) return false;
        const isNew = !this.hold.isActive;
        if (isNew) this.number = Math.max(this.number + 1, Date.now());
        const jog = this.number;
        this.machine = desk.machine?.info.machine;
        desk.request("jog", { jog, ...fields }).catch((error) => {
            if (this.number === jog) this.hold.end("refused");
            desk.refuse(error.message);
        });
        return true;
    }

    show() {
        const { desk, words, hold } = this;
        if (hold.isActive && this.machine !== desk.machine?.info.machine) hold.end("another");
        if (hold.isActive && !this.mayMove) hold.end("refused");
        // The server has ended the jog: its lease was over, or somebody stopped.
        const jog = desk.state?.jog;
        if (jog && jog.client === desk.link.client) this.wasSeen = jog.jog;
        else if (hold.isActive && this.wasSeen === this.number) hold.end("ended");
        const letters = desk.machine?.info.axes.join();
        if (letters !== undefined && letters !== this.lettersShown) this.fillPads();
        const { obstacle } = this;
        put(this.why, obstacle || (this.size > 0 ? words.stepHelp : words.holdHelp));
        const held = hold.isActive ? hold.direction : {};
        for (const arrow of this.arrows) {
            disable(arrow, obstacle !== "" && !hold.isActive);
            const [letter, sign] = arrow.dataset.jog ?? "";
            const isHeld = Math.sign(held[letter] ?? 0) === (sign === "+" ? 1 : -1);
            toggle(arrow, isHeld ? "held" : "");
        }
        for (const one of this.sizeButtons) {
            one.button.setAttribute("aria-pressed", String(one.size === this.size));
        }
    }
}

/**
 * The names of axes as the server has them.
 *
 * @param {Direction} direction
 */
export function lower(direction) {
    return Object.fromEntries(
        Object.entries(direction).map(([letter, part]) => [letter.toLowerCase(), part])
    );
}
