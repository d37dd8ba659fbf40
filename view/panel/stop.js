/**
 * STOP: a button that is always there, and the keys Esc and space. It never asks.
 */

import { element } from "husillo/viewer/element.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** Fields in which a space is text. */
const TYPED = "textarea, input:not([type=checkbox], [type=radio], [type=range], [type=file])";
/** What a space operates while nothing moves. */
const OPERATED = "button, a, select, input, summary, [role=tab], [tabindex]";

/** The button. */
export class Stop {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {() => void} before called first: what is held by hand ends
     */
    constructor(desk, words, before) {
        this.desk = desk;
        this.before = before;
        this.root = element(
            "button",
            { type: "button", class: "stop", title: words.stopHelp },
            words.stop,
            element("small", {}, ` ${words.stopKeys}`)
        );
        // It acts when it is pressed, not when it is let go. A second STOP resets the controller,
        // so the click of the same press must not stop again.
        let wasPressed = false;
        const pressed = (/** @type {PointerEvent} */ event) => {
            const target = /** @type {Node} */ (event.target);
            wasPressed = event.button === 0 && this.root.contains(target);
            if (wasPressed) this.stop();
        };
        window.addEventListener("pointerdown", pressed, { capture: true });
        this.root.addEventListener("click", ({ detail }) => {
            // The click of a key or of a screen reader counts no presses.
            if (detail === 0 || !wasPressed) this.stop();
            wasPressed = false;
        });
        // Before any other listener, whatever has the focus.
        window.addEventListener("keydown", (event) => this.key(event), { capture: true });
    }

    /** @param {KeyboardEvent} event */
    key(event) {
        if (!this.isStop(event)) return;
        event.preventDefault();
        event.stopPropagation();
        if (!event.repeat) this.stop();
    }

    /** @param {KeyboardEvent} event */
    isStop({ key, target, repeat }) {
        if (key === "Escape") return true;
        const focused = target instanceof Element ? target : document.body;
        if (key !== " " || focused.closest(TYPED)) return false;
        // The repetition of a space that operates a button is not a STOP.
        return !focused.closest(OPERATED) || (this.desk.isBusy && !repeat);
    }

    stop() {
        this.before();
        this.desk.tell("stop");
    }
}
