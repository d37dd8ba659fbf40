/**
 * The microfactory: the emergency stop, what it does, its lamps, and where its motors are.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put, toggle } from "husillo/panel/change.js";
import { lengthText } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/units.js").Units} Units */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The lamps, in their order. */
const LAMPS = /** @type {const} */ (["homed", "moving", "contact", "emergency"]);
/** The motors: three axes, and the spindle. */
const MOTORS = ["X", "Y", "Z"];

/** The status of the microfactory. */
export class FactoryStatus {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {Units} units
     */
    constructor(desk, words, units) {
        this.desk = desk;
        this.words = words;
        this.units = units;
        const { factory } = words;
        // It works in every state, and from pages that watch. If the controller is lost, it acts
        // when the controller answers again.
        this.emergency = button(factory.emergency, () => desk.command("emergency"), {
            class: "emergency",
        });
        this.reset = button(factory.reset, () => desk.command("reset"));
        this.help = element("p", { class: "soft" });
        this.line = element("p", { class: "number", "data-value": "factory-status" });
        this.lamps = LAMPS.map((name) => ({
            name,
            lamp: element("li", { "data-lamp": name }, factory.lamps[name]),
        }));
        this.unitButtons = /** @type {const} */ (["mm", "in"]).map((unit) =>
            button(unit === "mm" ? "mm" : words.inch, () => {
                units.choose(unit);
                desk.changed();
            })
        );
        this.rows = [...MOTORS, words.spindle].map((name) => ({
            name,
            steps: element("td", { class: "number", "data-steps": name }),
            length: element("td", { class: "number", "data-length": name }),
        }));
        this.unit = element("th", { scope: "col" });
        this.root = element(
            "section",
            { class: "card", "aria-label": factory.name },
            element(
                "div",
                { class: "items" },
                element("h2", { class: "wide" }, factory.name),
                ...this.unitButtons
            ),
            element("div", { class: "items" }, this.emergency, this.reset),
            this.help,
            this.line,
            element(
                "ul",
                { class: "drill-lamps", "aria-label": factory.lampsName },
                ...this.lamps.map((one) => one.lamp)
            ),
            element(
                "table",
                { class: "motors" },
                element(
                    "thead",
                    {},
                    element(
                        "tr",
                        {},
                        element("th", { scope: "col" }, words.motor),
                        element("th", { scope: "col" }, words.steps),
                        this.unit
                    )
                ),
                element(
                    "tbody",
                    {},
                    ...this.rows.map(({ name, steps, length }) =>
                        element("tr", {}, element("th", { scope: "row" }, name), steps, length)
                    )
                )
            )
        );
        desk.listen(() => this.show());
        this.show();
    }

    show() {
        const { desk, words, units } = this;
        this.root.hidden = desk.family !== "microfactory";
        if (this.root.hidden) return;
        const { factory: texts } = words;
        const state = desk.state;
        const factory = state?.factory;
        const isLatched = factory?.is_latched ?? false;
        disable(this.emergency, state === undefined);
        this.reset.hidden = !isLatched;
        const isSimulated = desk.machine?.info.is_simulated ?? false;
        disable(this.reset, !desk.mayCommand || !isSimulated);
        put(this.help, isLatched && !isSimulated ? texts.resetThere : texts.emergencyHelp);
        put(this.line, factory ? this.text(factory).join(" · ") : "–");
        const lit = {
            homed: factory?.is_homed,
            moving: desk.isBusy,
            contact: factory?.contact,
            emergency: isLatched,
        };
        for (const { name, lamp } of this.lamps) {
            toggle(lamp, lit[name] ? (name === "emergency" ? "lit bad" : "lit") : "");
            const text = lit[name] ? words.on : words.off;
            lamp.setAttribute("aria-label", `${texts.lamps[name]}: ${text}`);
        }
        this.unitButtons.forEach((one, index) =>
            one.setAttribute("aria-pressed", String(units.unit === ["mm", "in"][index]))
        );
        put(this.unit, units.unit === "mm" ? "mm" : words.inch);
        this.rows.forEach(({ steps, length }, motor) => {
            put(steps, String(factory?.steps[motor] ?? "–"));
            put(length, lengthText(state?.machine_mm?.[motor], units.unit, 1));
        });
    }

    /**
     * What it does, and how the last motion has ended.
     *
     * @param {import("husillo/panel/desk.js").Factory} factory
     */
    text({ motion, report, stored, is_homed }) {
        const { desk, words } = this;
        const { factory: texts } = words;
        const program = desk.state?.program;
        const motions = /** @type {Record<string, string>} */ ({
            home: words.stateHome,
            figure: texts.cutting,
        });
        const doing =
            stored !== null
                ? `${texts.storing} ${stored}/${program?.lines ?? 0}`
                : motion !== null
                  ? (motions[motion] ?? motion)
                  : (report ?? texts.rest);
        return [
            doing,
            is_homed ? texts.fromHome : texts.fromPowerOn,
            program ? `${program.name}: ${words.phases[program.phase]}` : texts.noFigure,
        ];
    }
}
