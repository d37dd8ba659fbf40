/**
 * The time: a slider, playing at any speed, steps by line and by event.
 */

import { button, element } from "husillo/viewer/element.js";
import { duration } from "husillo/viewer/quantity.js";

/** @typedef {import("husillo/viewer/model.js").Model} Model */
/** @typedef {import("husillo/viewer/words.js").Words} Words */

const SPEEDS = [0.01, 0.1, 0.25, 0.5, 1, 2, 5, 10, 30, 100, 300, 1000, 3000];
/** Positions of the slider. */
const POSITIONS = 100_000;
/** The whole takes about this long to play, seconds. */
const PLAYING = 30;
/** Milliseconds between two pictures for users who ask for less motion. */
const REDUCED = 500;

/** The time line. */
export class Timeline {
    /**
     * @param {Model} model
     * @param {Words} words
     */
    constructor(model, words) {
        this.model = model;
        this.words = words;
        this.slider = element("input", {
            type: "range",
            min: 0,
            max: POSITIONS,
            step: 1,
            "aria-label": words.time,
            oninput: () => {
                this.stop();
                model.goTo((Number(this.slider.value) / POSITIONS) * model.scene.seconds);
            },
            onkeydown: (/** @type {KeyboardEvent} */ event) => this.key(event),
        });
        this.toggle = button(words.play, () => (this.isPlaying ? this.stop() : this.play()));
        this.speed = element(
            "select",
            { "aria-label": words.speed },
            ...SPEEDS.map((speed) => element("option", { value: speed }, `${speed} ×`))
        );
        const wanted = model.scene.seconds / PLAYING;
        const whole = SPEEDS.find((speed) => speed >= wanted) ?? SPEEDS[SPEEDS.length - 1];
        this.speed.value = String(Math.max(1, whole));
        this.clock = element("output", { class: "clock" });
        this.root = element(
            "div",
            { class: "timeline", role: "group", "aria-label": words.time },
            element(
                "div",
                { class: "bar" },
                this.toggle,
                this.speed,
                this.step("|◂", words.previousLine, () => model.stepLine(-1)),
                this.step("▸|", words.nextLine, () => model.stepLine(1)),
                this.step("◂", words.previousEvent, () => model.stepEvent(-1)),
                this.step("▸", words.nextEvent, () => model.stepEvent(1)),
                this.clock
            ),
            this.slider
        );
        this.isPlaying = false;
        model.listen(() => this.show());
        this.show();
    }

    /**
     * @param {string} sign
     * @param {string} name
     * @param {() => void} act
     */
    step(sign, name, act) {
        const stopped = () => {
            this.stop();
            act();
        };
        return button(sign, stopped, { "aria-label": name, title: name });
    }

    show() {
        const { seconds, scene, line } = this.model;
        this.slider.value = String(Math.round((seconds / (scene.seconds || 1)) * POSITIONS));
        const text = `${duration(seconds)}, ${this.words.line} ${line || "—"}`;
        this.slider.setAttribute("aria-valuetext", text);
        this.clock.textContent = `${duration(seconds)} / ${duration(scene.seconds)}`;
    }

    /**
     * The arrow keys move by a thousandth, more with Shift; Page Up and Down by lines.
     *
     * @param {KeyboardEvent} event
     */
    key(event) {
        const { model } = this;
        const step = model.scene.seconds / (event.shiftKey ? 100 : 1000);
        const acts = /** @type {Record<string, () => void>} */ ({
            ArrowLeft: () => model.goTo(model.seconds - step),
            ArrowRight: () => model.goTo(model.seconds + step),
            PageUp: () => model.stepLine(-1),
            PageDown: () => model.stepLine(1),
        });
        const act = acts[event.key];
        if (!act) return;
        event.preventDefault();
        this.stop();
        act();
    }

    play() {
        const { model } = this;
        if (model.seconds >= model.scene.seconds) model.goTo(0);
        this.isPlaying = true;
        this.toggle.textContent = this.words.pause;
        const isReduced = matchMedia("(prefers-reduced-motion: reduce)").matches;
        let last = performance.now();
        const tick = () => {
            if (!this.isPlaying) return;
            const now = performance.now();
            if (!isReduced || now - last >= REDUCED) {
                model.goTo(model.seconds + ((now - last) / 1000) * Number(this.speed.value));
                last = now;
            }
            if (model.seconds >= model.scene.seconds) this.stop();
            else requestAnimationFrame(tick);
        };
        requestAnimationFrame(tick);
    }

    stop() {
        this.isPlaying = false;
        this.toggle.textContent = this.words.play;
    }
}
