/**
 * The keyboard: arrows and PgUp/PgDn move while they are held, others set zero, steps and speeds.
 * No key acts in a text field, except Esc.
 */

import { button, element } from "husillo/viewer/element.js";
import { put } from "husillo/panel/change.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The keys that move: axis and direction. */
const MOVES = /** @type {Record<string, [string, 1 | -1]>} */ ({
    ArrowLeft: ["X", -1],
    ArrowRight: ["X", 1],
    ArrowUp: ["Y", 1],
    ArrowDown: ["Y", -1],
    PageUp: ["Z", 1],
    PageDown: ["Z", -1],
});

/** Elements that need the arrow keys themselves. */
const OWN =
    "input:not([type=checkbox]), textarea, select, [role=application], [role=listbox], " +
    "[role=tab], [role=slider], .log, .scroll, .findings, progress";

/** The keyboard. */
export class Keys {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {{
     *     jog: import("husillo/panel/by_hand.js").ByHand,
     *     pace: (by: 1 | -1) => void,
     *     positions: import("husillo/panel/positions.js").Positions,
     *     start: () => void,
     *     pause: () => void,
     * }} parts
     */
    constructor(desk, words, parts) {
        this.desk = desk;
        this.words = words;
        this.parts = parts;
        this.isOn = localStorage.getItem("husillo.keys") !== "off";
        this.badge = element("span", { class: "keys-badge" });
        this.switch = button("", () => this.turn(!this.isOn));
        this.root = element(
            "section",
            { class: "card", "aria-label": words.keys },
            element(
                "div",
                { class: "items" },
                element("h2", { class: "wide" }, words.keys),
                this.badge,
                this.switch
            ),
            element(
                "details",
                {},
                element("summary", {}, words.keyList),
                element(
                    "dl",
                    { class: "keys" },
                    ...words.keyHelp.flatMap(([key, text]) => [
                        element("dt", {}, key),
                        element("dd", {}, text),
                    ])
                )
            )
        );
        window.addEventListener("keydown", (event) => this.down(event));
        // In the capture phase: a key that is let go anywhere ends its motion.
        window.addEventListener("keyup", (event) => this.up(event), { capture: true });
        document.addEventListener("focusin", () => this.focused());
        document.addEventListener("focusout", () => this.focused());
        desk.listen(() => this.show());
        this.show();
    }

    /** @param {boolean} isOn */
    turn(isOn) {
        this.isOn = isOn;
        localStorage.setItem("husillo.keys", isOn ? "on" : "off");
        this.parts.jog.hold.end("keys off");
        this.show();
    }

    /** Whether the element with the focus needs the keys itself. */
    get isTyping() {
        return document.activeElement?.closest(OWN) !== null && document.activeElement !== null;
    }

    /** What the keys do now. */
    get use() {
        if (!this.isOn) return this.words.keysOff;
        if (this.isTyping) return this.words.keysTyping;
        return this.parts.jog.obstacle ? this.words.keysIdle : this.words.keysJog;
    }

    focused() {
        if (this.isTyping) this.parts.jog.hold.end("typing");
        this.show();
    }

    show() {
        put(this.badge, this.use);
        put(this.switch, this.isOn ? this.words.switchOff : this.words.switchOn);
    }

    /** @param {KeyboardEvent} event */
    down(event) {
        if (event.defaultPrevented || event.metaKey || !this.isOn) return;
        if (event.target instanceof Element && event.target.closest(OWN)) return;
        const move = event.altKey ? undefined : MOVES[event.key];
        const act = move ? () => this.move(event, move) : this.actOf(event);
        if (!act) return;
        // Without a machine to move, the keys scroll the page.
        if (move && !this.desk.isOperator) return;
        event.preventDefault();
        if (!event.repeat) act();
    }

    /**
     * @param {KeyboardEvent} event
     * @param {[string, 1 | -1]} move
     */
    move(event, [letter, side]) {
        this.parts.jog.press(`key ${event.code}`, { [letter]: side }, event);
    }

    /** @param {KeyboardEvent} event */
    up(event) {
        this.parts.jog.hold.release(`key ${event.code}`, "keyup");
    }

    /**
     * @param {KeyboardEvent} event
     * @returns {(() => void) | undefined}
     */
    actOf({ key, code, altKey, shiftKey, ctrlKey }) {
        const { desk, parts } = this;
        const axis = /^Key([A-CX-Z])$/.exec(code)?.[1];
        const may = desk.mayCommand && !desk.isBusy;
        if (altKey && !ctrlKey && axis && may) {
            if (!shiftKey) return () => parts.positions.zero([axis]);
            return () => {
                const feed = parts.jog.feedMm;
                const to = { [axis.toLowerCase()]: 0 };
                if (feed !== undefined) desk.command("goto", { to_mm: to, frame: "work", feed });
            };
        }
        if (altKey && code === "Digit0" && may) {
            return () => parts.positions.zero(parts.positions.letters);
        }
        if (altKey) return undefined;
        if (ctrlKey) {
            if (key === "Enter") return parts.start;
            if (key === "Home" && may) return () => desk.command("home");
            if (key === "z" && may) return () => desk.command("undo_zero");
            return undefined;
        }
        switch (key) {
            case "+":
                return () => parts.jog.chooseNext(1);
            case "-":
                return () => parts.jog.chooseNext(-1);
            case "[":
                return () => parts.pace(-1);
            case "]":
                return () => parts.pace(1);
            case "p":
                return parts.pause;
            default:
                return undefined;
        }
    }
}
