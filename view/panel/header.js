/**
 * The bar that is always there: machines, state, operator, STOP.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put, toggle } from "husillo/panel/change.js";
import { stateText } from "husillo/panel/states.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The bar. */
export class Header {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {HTMLElement} stop the button
     */
    constructor(desk, words, stop) {
        this.desk = desk;
        this.words = words;
        this.name = element("h1", {}, "husillo");
        this.port = element("span", { class: "soft" });
        this.state = element("strong", { class: "state" });
        this.operator = element("span", { class: "operator" });
        this.takeButton = button(words.take, () => this.takeOver());
        this.giveButton = button(words.give, () => desk.command("give"));
        this.stopAll = button(words.stopAll, () => desk.link.tell("stop", {}));
        this.tabs = element("div", { role: "tablist", "aria-label": words.machines });
        this.tabs.addEventListener("keydown", (event) => this.key(event));
        this.root = element(
            "header",
            {},
            this.tabs,
            element("div", { class: "who" }, this.name, this.port),
            this.state,
            element(
                "div",
                { class: "items control" },
                this.operator,
                this.takeButton,
                this.giveButton
            ),
            this.stopAll,
            stop
        );
        /** @type {Map<number, HTMLButtonElement>} */
        this.buttons = new Map();
        desk.listen(() => this.show());
        this.show();
    }

    takeOver() {
        const other = this.desk.state?.operator ?? null;
        this.desk.command("take", { force: other !== null });
    }

    show() {
        const { desk, words } = this;
        this.showTabs();
        const { machine, state } = desk;
        put(this.name, machine?.info.name ?? "husillo");
        const simulated = machine?.info.is_simulated ? `, ${words.simulated}` : "";
        put(this.port, machine ? `${machine.info.port}${simulated}` : "");
        const { text, kind } = stateText(desk, words);
        put(this.state, text);
        toggle(this.state, "state", kind);
        const isFree = state !== undefined && state.operator === null;
        const others = state && state.clients > 1 ? ` · ${state.clients} ${words.pages}` : "";
        const who = desk.isOperator
            ? words.youOperate
            : isFree
              ? words.nobodyOperates
              : words.youWatch;
        put(this.operator, state ? who + others : "");
        this.takeButton.hidden = desk.isOperator;
        put(this.takeButton, isFree ? words.take : words.takeOver);
        disable(this.takeButton, state === undefined);
        this.giveButton.hidden = !desk.isOperator;
        this.stopAll.hidden = desk.machines.size < 2;
    }

    showTabs() {
        const { desk, tabs, buttons } = this;
        tabs.hidden = desk.machines.size < 2;
        if ([...buttons.keys()].join() !== [...desk.machines.keys()].join()) {
            buttons.clear();
            for (const [number, machine] of desk.machines) {
                const tab = button(machine.info.name, () => desk.choose(number), {
                    role: "tab",
                    "aria-controls": "machine",
                });
                buttons.set(number, tab);
            }
            tabs.replaceChildren(...buttons.values());
        }
        for (const [number, tab] of buttons) {
            const isChosen = number === desk.machine?.info.machine;
            tab.setAttribute("aria-selected", String(isChosen));
            tab.tabIndex = isChosen ? 0 : -1;
        }
    }

    /** @param {KeyboardEvent} event */
    key(event) {
        const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (step === undefined) return;
        event.preventDefault();
        const all = [...this.buttons.keys()];
        const at = all.indexOf(this.desk.machine?.info.machine ?? 0);
        const next = all[(at + step + all.length) % all.length];
        this.desk.choose(next);
        this.buttons.get(next)?.focus();
    }
}
