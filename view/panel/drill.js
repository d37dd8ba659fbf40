/**
 * The status of the drill: its menu, its mode and position in a line, and the lamps of its panel.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put, toggle } from "husillo/panel/change.js";
import { lengthText } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/units.js").Units} Units */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The lamps, in the order of the panel. The one for `ready` blinks. */
const LAMPS = ["x", "y", "home", "drill", "manual", "ready", "receive", "full"];

/** The menu and the status line. */
export class DrillStatus {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {Units} units
     * @param {{open: () => void, edit: () => void, start: () => void, manual: () => void}} acts
     */
    constructor(desk, words, units, acts) {
        this.desk = desk;
        this.words = words;
        this.units = units;
        this.open = button(words.openFile, acts.open);
        this.edit = button(words.drill.editAndCheck, acts.edit);
        this.start = button(words.startAsk, acts.start);
        this.manual = button(words.drill.manualMode, acts.manual);
        this.line = element("p", { class: "number", "data-value": "drill-status" });
        this.lamps = LAMPS.map((name) => ({
            name,
            lamp: element("li", { "data-lamp": name }, words.drill.lamps[name]),
        }));
        this.root = element(
            "section",
            { class: "card", "aria-label": words.drill.menu },
            element("h2", {}, words.drill.menu),
            element(
                "nav",
                { class: "items", "aria-label": words.drill.menu },
                this.open,
                this.edit,
                this.start,
                this.manual
            ),
            this.line,
            element(
                "ul",
                { class: "drill-lamps", "aria-label": words.drill.lampsName },
                ...this.lamps.map((one) => one.lamp)
            )
        );
        desk.listen(() => this.show());
        this.show();
    }

    show() {
        const { desk, words } = this;
        this.root.hidden = desk.family !== "drill";
        const drill = desk.state?.drill;
        const may = desk.mayCommand && desk.isIdle;
        disable(this.open, !desk.mayCommand || desk.isUnderWay);
        disable(this.edit, !desk.state?.program);
        disable(this.start, !may || desk.state?.program?.errors !== 0);
        disable(this.manual, !may);
        put(this.manual, drill?.is_manual ? words.drill.leaveManual : words.drill.manualMode);
        put(this.line, drill ? this.text(drill).join(" · ") : "–");
        const isAlive = desk.state?.link === "up";
        for (const { name, lamp } of this.lamps) {
            const isLit = drill?.lights.includes(name) ?? false;
            // The lamp blinks while the drill is ready and answers.
            toggle(lamp, isLit ? (name === "ready" && isAlive ? "lit blinks" : "lit") : "");
            const text = isLit ? words.on : words.off;
            if (lamp.title !== text) lamp.title = text;
            lamp.setAttribute("aria-label", `${words.drill.lamps[name]}: ${text}`);
        }
    }

    /** @param {import("husillo/panel/desk.js").Drill} drill */
    text(drill) {
        const { desk, words, units } = this;
        const { drill: texts } = words;
        const program = desk.state?.program;
        const phase = program ? (words.phases[program.phase] ?? program.phase) : "";
        const [x, y] = desk.state?.work_mm ?? [];
        return [
            drill.is_manual ? texts.inManual : texts.inCommand,
            `X ${lengthText(x, units.unit)} Y ${lengthText(y, units.unit)} ${units.unit}`,
            `${words.steps} ${drill.steps.join(", ")}`,
            `Z ${texts.heights[drill.z] ?? drill.z}`,
            `${words.spindle} ${drill.spindle ? words.on : words.off}`,
            program ? `${program.name}: ${phase} ${program.sent}/${program.of}` : texts.noBoard,
        ];
    }
}
