/**
 * The joystick of a measuring machine: a stick for mouse and touch with two speeds by its
 * deflection, hold-to-move buttons and keys, and steps.
 */

import { element } from "husillo/viewer/element.js";
import { ByHand, lower } from "husillo/panel/by_hand.js";
import { put, toggle } from "husillo/panel/change.js";
import { amountText } from "husillo/panel/measuring.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/hold.js").Direction} Direction */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** Sizes of a step. */
const STEPS = { mm: [0.01, 0.1, 1, 10], counts: [1, 10, 100, 1000] };
/** Deflections of the stick: from the first part of its way on slow, from the second on fast. */
const [SLOW_FROM, FAST_FROM] = [0.15, 0.6];
/** What the server is told for the two speeds. */
const [SLOW, FAST] = [0.4, 1];

/** Motion by hand. */
export class Joystick extends ByHand {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        super(desk, words);
        this.unitShown = "";
        this.knob = element("span", { class: "knob" });
        this.stick = element(
            "div",
            { class: "stick", role: "img", "aria-label": words.stickHelp, "data-stick": "free" },
            element("span", { class: "slow-ring" }),
            this.knob
        );
        /** The pointer that holds the stick. @type {number | undefined} */
        this.pointer = undefined;
        this.speeds = element("p", { class: "soft", "data-value": "stick-speeds" });
        this.root = element(
            "section",
            { class: "card", "aria-label": words.byHand },
            element("h2", {}, words.byHand),
            this.choices,
            element("div", { class: "stick-and-pads" }, this.stick, this.pads),
            this.why,
            this.speeds
        );
        this.listenToStick();
        desk.listen(() => this.show());
        this.show();
    }

    get isShown() {
        return this.desk.family === "measuring";
    }

    get small() {
        return this.sizeButtons[1]?.size ?? 1;
    }

    /**
     * Keys and buttons are slow, and fast with Shift.
     *
     * @param {string} input
     * @param {Direction} direction
     * @param {{shiftKey: boolean, ctrlKey: boolean}} keys
     */
    press(input, direction, keys) {
        const part = keys.shiftKey ? FAST : SLOW;
        const isStep = keys.ctrlKey || this.size > 0;
        const scaled = Object.entries(direction).map(([axis, side]) => [axis, side * part]);
        super.press(input, isStep ? direction : Object.fromEntries(scaled), keys);
    }

    /**
     * @param {Direction} direction
     * @param {number} size
     */
    step(direction, size) {
        if (!this.mayMove) return;
        const move = Object.fromEntries(
            Object.entries(lower(direction)).map(([axis, side]) => [axis, Math.sign(side) * size])
        );
        this.desk.command("step", { move_mm: move });
    }

    listenToStick() {
        const { stick } = this;
        stick.addEventListener("pointerdown", (event) => {
            if (event.button !== 0 || this.obstacle !== "") return;
            event.preventDefault();
            this.pointer = event.pointerId;
            stick.setPointerCapture(event.pointerId);
            this.deflect(event);
        });
        stick.addEventListener("pointermove", (event) => {
            if (event.pointerId === this.pointer) this.deflect(event);
        });
        for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) {
            stick.addEventListener(name, () => this.letGo(name));
        }
        stick.addEventListener("contextmenu", (event) => event.preventDefault());
    }

    /** @param {string} reason */
    letGo(reason) {
        if (this.pointer === undefined) return;
        this.hold.release(`pointer ${this.pointer}`, reason);
        this.pointer = undefined;
        this.place(0, 0);
    }

    /** @param {PointerEvent} event */
    deflect(event) {
        const { left, top, width, height } = this.stick.getBoundingClientRect();
        let x = (event.clientX - left - width / 2) / (width / 2);
        let y = (top + height / 2 - event.clientY) / (height / 2);
        const far = Math.hypot(x, y);
        if (far > 1) [x, y] = [x / far, y / far];
        this.place(x, y);
        const letters = this.desk.machine?.info.axes ?? [];
        /** @type {Direction} */
        const direction = {};
        for (const [letter, part] of /** @type {[string, number][]} */ ([
            ["X", x],
            ["Y", y],
        ])) {
            const size = Math.abs(part);
            if (!letters.includes(letter) || size < SLOW_FROM) continue;
            direction[letter] = Math.sign(part) * (size >= FAST_FROM ? FAST : SLOW);
        }
        const input = `pointer ${this.pointer}`;
        if (Object.keys(direction).length === 0) this.hold.release(input, "centre");
        else this.hold.steer(input, direction);
    }

    /**
     * Shows the deflection.
     *
     * @param {number} x
     * @param {number} y
     */
    place(x, y) {
        this.knob.style.transform = `translate(${x * 100}%, ${-y * 100}%)`;
        this.stick.dataset.stick = x === 0 && y === 0 ? "free" : "held";
    }

    show() {
        super.show();
        const { desk, words } = this;
        this.root.hidden = !this.isShown;
        if (!this.isShown) return;
        const measuring = desk.machine?.state?.measuring;
        const unit = measuring?.unit === "counts" ? "counts" : "mm";
        if (unit !== this.unitShown) {
            this.unitShown = unit;
            const name = unit === "mm" ? "mm" : words.counts;
            this.fillSizes(STEPS[unit], (size) => `${size} ${name}`);
            super.show();
        }
        toggle(this.stick, "stick", this.obstacle === "" ? "" : "off");
        const speed = (/** @type {number | undefined} */ one) =>
            `${amountText(one, measuring)} ${unit === "mm" ? "mm" : words.counts}/s`;
        const [slow, fast] = [speed(measuring?.speeds.slow), speed(measuring?.speeds.fast)];
        put(this.speeds, `${words.stickSpeeds}: ${slow}, ${fast}`);
    }
}
