/**
 * The change of a tool in a program: the steps in words, and what is done in each of them. A
 * controller with a protocol of its own (grblHAL) measures the tool itself.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put } from "husillo/panel/change.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/desk.js").Change} Change */
/** @typedef {import("husillo/panel/words.js").Words} Words */
/** @typedef {import("husillo/panel/wizard.js").Wizard} Wizard */

/**
 * A tool as text: its number, and the comment of the program.
 *
 * @param {{tool: number | null, note: string}} change
 * @param {Words} words
 */
export function toolText({ tool, note }, words) {
    const name = tool === null ? words.nextTool : `T${tool}`;
    return note ? `${name} (${note})` : name;
}

/** The guide. */
export class ToolChange {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {Wizard} wizard
     * @param {() => void} openWizard shows the wizard for the length of a tool
     */
    constructor(desk, words, wizard, openWizard) {
        this.desk = desk;
        this.words = words;
        this.wizard = wizard;
        /** What is shown. */
        this.key = "";
        this.title = element("h2", {}, words.change);
        this.steps = element("ol", {});
        this.length = element("p", { class: "soft" });
        this.warning = element("p", { class: "error" });
        this.measure = button(words.changeMeasure, openWizard);
        this.touch = button(words.changeTouch, () => desk.command("line", { text: "$TPW" }));
        this.forget = button(words.changeForget, () => desk.command("line", { text: "$TLR" }));
        this.goOn = button(words.changeGoOn, () => desk.command("resume"), { class: "main" });
        this.why = element("p", { class: "why" });
        this.root = element(
            "section",
            { class: "card tool-change", "aria-label": words.change, hidden: true },
            this.title,
            this.steps,
            this.length,
            this.warning,
            element("div", { class: "items" }, this.measure, this.touch, this.forget, this.goOn),
            this.why
        );
        desk.listen(() => this.show());
        this.show();
    }

    show() {
        const { desk, words } = this;
        const { change, state } = desk;
        this.root.hidden = !change;
        if (!change || !state) {
            this.key = "";
            return;
        }
        const key = JSON.stringify([desk.machine?.info.machine, change]);
        if (key !== this.key) {
            this.key = key;
            this.fill(change);
        }
        const length = state.tool_length_mm ?? 0;
        const reference = this.wizard.reference;
        const known =
            reference === undefined ? "" : `; ${words.toolReference} ${reference.toFixed(3)} mm`;
        put(this.length, `${words.toolLength}: ${length.toFixed(3)} mm${known}`);
        const isByHost = change.kind === null;
        put(this.warning, isByHost && reference === undefined ? words.changeNoReference : "");
        const mayAct = desk.mayCommand && ["Idle", "Tool"].includes(state.state ?? "");
        for (const one of [this.measure, this.touch, this.forget]) disable(one, !mayAct);
        disable(this.goOn, !mayAct);
        put(this.why, mayAct ? "" : desk.mayCommand ? words.whyBusy : words.whyWatching);
    }

    /** @param {Change} change */
    fill(change) {
        const { words } = this;
        const { kind } = change;
        put(this.title, `${words.change}: ${toolText(change, words)}`);
        const steps = words.changeSteps[kind ?? 0];
        const name = toolText(change, words);
        const items = steps.map((text) => element("li", {}, text.replace("{tool}", name)));
        this.steps.replaceChildren(...items);
        this.measure.hidden = kind !== null;
        // A controller of kind 3 measures by itself.
        this.touch.hidden = this.forget.hidden = kind !== 1 && kind !== 2;
    }
}
