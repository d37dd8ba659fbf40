/**
 * What happened and what is safe to do, above everything else; and the live region, which says
 * what changes, but not every position.
 */

import { button, element } from "husillo/viewer/element.js";
import { noticesOf, stateText } from "husillo/panel/states.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The notices. */
export class Notices {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        this.list = element("ul", { class: "notices" });
        this.root = element("section", { "aria-label": words.notices }, this.list);
        this.live = element("p", { class: "live", role: "status", "aria-live": "polite" });
        this.shown = "";
        this.said = "";
        desk.listen(() => this.show());
        this.show();
    }

    show() {
        const { desk, words, live } = this;
        const notices = noticesOf(desk, words);
        const text = JSON.stringify(notices);
        if (text !== this.shown) {
            this.shown = text;
            this.root.hidden = notices.length === 0;
            this.list.replaceChildren(...notices.map((notice) => this.item(notice)));
        }
        const name = desk.machines.size > 1 ? `${desk.machine?.info.name}: ` : "";
        const first = notices[0] ? `. ${notices[0].text} ${notices[0].advice ?? ""}` : "";
        const said = `${name}${stateText(desk, words).text}${first}`;
        if (said === this.said) return;
        this.said = said;
        live.textContent = said;
    }

    /** @param {import("husillo/panel/states.js").Notice} notice */
    item({ id, kind, text, advice }) {
        const { desk, words } = this;
        const actions = [];
        if (id === "link") actions.push(button(words.retry, () => desk.link.retry()));
        if (id === "refusal") actions.push(button(words.understood, () => desk.refuse("")));
        return element(
            "li",
            { class: kind, "data-notice": id },
            element(
                "div",
                {},
                element("strong", {}, text),
                ...(advice ? [element("p", {}, advice)] : [])
            ),
            ...actions
        );
    }

    /** @param {string} text what the live region says */
    say(text) {
        this.live.textContent = text;
    }
}
