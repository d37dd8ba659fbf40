/**
 * Macros: lines with a name, which run with one click.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable } from "husillo/panel/change.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */
/** @typedef {{name: string, text: string}} Macro */

/** The macros. */
export class Macros {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        /** Which link the macros were read on. */
        this.client = 0;
        this.list = element("ul", { class: "macros" });
        this.name = element("input", { maxlength: 60 });
        this.text = element("textarea", {
            class: "source",
            spellcheck: "false",
            "aria-label": words.macroText,
        });
        this.save = button(words.save, () => this.change("macro_save"));
        this.root = element(
            "div",
            {},
            this.list,
            element(
                "details",
                {},
                element("summary", {}, words.macroEdit),
                element(
                    "div",
                    { class: "items" },
                    element("label", { class: "field" }, words.macroName, this.name),
                    this.save
                ),
                this.text
            )
        );
        /** @type {HTMLButtonElement[]} */
        this.buttons = [];
        desk.listen(() => this.show());
    }

    show() {
        const { desk } = this;
        const { client } = desk.link;
        if (client !== 0 && client !== this.client && desk.state) {
            this.client = client;
            // A server without macros has an empty list.
            desk.request("macros").then((macros) => this.fill(macros ?? []), () => this.fill([]));
        }
        for (const one of this.buttons) disable(one, !desk.mayCommand || !desk.isIdle);
        disable(this.save, !desk.mayCommand);
    }

    /** @param {"macro_save" | "macro_delete"} verb */
    async change(verb, name = this.name.value.trim()) {
        if (name === "") return;
        const text = this.text.value;
        const fields = verb === "macro_save" ? { name, text } : { name };
        const macros = await this.desk.command(verb, fields);
        if (macros) this.fill(macros);
    }

    /** @param {Macro[]} macros */
    fill(macros) {
        const { desk, words } = this;
        this.buttons = [];
        this.list.replaceChildren(
            ...macros.map(({ name, text }) => {
                const run = button(name, () => desk.command("macro_run", { name }), {
                    class: "main",
                    title: text,
                });
                this.buttons.push(run);
                const edit = button(words.edit, () => this.open(name, text), {
                    "aria-label": `${words.edit}: ${name}`,
                });
                const remove = button(words.remove, () => this.change("macro_delete", name), {
                    "aria-label": `${words.remove}: ${name}`,
                });
                return element("li", { class: "items" }, run, edit, remove);
            })
        );
        this.list.hidden = macros.length === 0;
        this.show();
    }

    /**
     * @param {string} name
     * @param {string} text
     */
    open(name, text) {
        this.name.value = name;
        this.text.value = text;
        const details = this.text.closest("details");
        if (details) details.open = true;
        this.text.focus();
    }
}
