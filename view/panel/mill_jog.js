/**
 * Motion by hand of the micro mill: hold to move one or several axes, steps of the motors, faster
 * and slower, a rate of its own for one axis, home.
 */

import { button, element } from "husillo/viewer/element.js";
import { ByHand, lower } from "husillo/panel/by_hand.js";
import { disable, put } from "husillo/panel/change.js";
import { numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/hold.js").Direction} Direction */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** Sizes of a step of the original: motor steps of 140 nm. */
const STEPS = [1, 10, 14, 28, 50, 100, 1000];
/** The fastest rate, steps per second. */
const TOP_HZ = 390;

/** Motion by hand. The size of a step is in motor steps. */
export class MillJog extends ByHand {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        super(desk, words);
        this.home = button(words.home, () => desk.command("home"));
        this.slower = button(words.slower, () => this.pace(false), {
            "aria-label": words.slowerHelp,
        });
        this.faster = button(words.faster, () => this.pace(true), {
            "aria-label": words.fasterHelp,
        });
        this.hz = element("output", { class: "number", "data-value": "jog-hz" });
        this.rate = element("input", { inputmode: "numeric", size: 5, placeholder: "170" });
        this.root = element(
            "section",
            { class: "card", "aria-label": words.byHand },
            element("h2", {}, words.byHand),
            element("div", { class: "items" }, this.home),
            this.choices,
            this.pads,
            this.why,
            element(
                "div",
                { class: "items" },
                this.slower,
                this.hz,
                this.faster,
                element("label", { class: "field" }, words.ownRate, this.rate)
            ),
            element("p", { class: "soft" }, words.ownRateHelp)
        );
        this.fillSizes(STEPS, (steps) => `${steps} ${steps === 1 ? words.step : words.steps}`);
        desk.listen(() => this.show());
        this.show();
    }

    get isShown() {
        return this.desk.family === "micromill";
    }

    /** @param {boolean} faster */
    pace(faster) {
        this.desk.command("pace", { faster });
    }

    /** The rate of the field in steps per second; undefined if it has none that is possible. */
    get rateHz() {
        const rate = numberOf(this.rate.value);
        const isValid = rate !== undefined && Number.isInteger(rate) && rate > 0 && rate <= TOP_HZ;
        this.rate.setAttribute("aria-invalid", String(this.rate.value !== "" && !isValid));
        return isValid ? rate : undefined;
    }

    /** @param {Direction} direction */
    jogOf(direction) {
        const { rateHz } = this;
        if (this.rate.value !== "" && rateHz === undefined) return undefined;
        const axes = lower(direction);
        // A rate of its own has one axis only. Several axes have that of a jog.
        const isOne = Object.keys(axes).length === 1;
        return isOne && rateHz !== undefined ? { axes, hz: rateHz } : { axes };
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
        const { desk, words } = this;
        this.root.hidden = !this.isShown;
        disable(this.home, !desk.mayCommand || !desk.isIdle);
        const hz = desk.state?.mill?.jog_hz ?? null;
        put(this.hz, hz === null ? `– ${words.stepsPerSecond}` : `${hz} ${words.stepsPerSecond}`);
        disable(this.slower, !desk.mayCommand || hz === null);
        disable(this.faster, !desk.mayCommand || hz === null);
        disable(this.rate, !desk.mayCommand);
    }
}
