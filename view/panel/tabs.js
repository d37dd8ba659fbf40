/**
 * Tabs: one of several parts of the page is shown.
 */

import { button, element } from "husillo/viewer/element.js";

/**
 * @param {string} name of the whole
 * @param {{id: string, name: string, content: HTMLElement}[]} parts
 */
export function tabs(name, parts) {
    const panels = parts.map(({ id, content }) =>
        element(
            "div",
            { id: `part-${id}`, role: "tabpanel", "aria-labelledby": `tab-${id}` },
            content
        )
    );
    const all = parts.map(({ id, name }, index) =>
        button(name, () => choose(index), {
            id: `tab-${id}`,
            role: "tab",
            "aria-controls": `part-${id}`,
        })
    );
    /** @param {number} index */
    const choose = (index) => {
        panels.forEach((one, other) => (one.hidden = other !== index));
        all.forEach((one, other) => {
            one.setAttribute("aria-selected", String(other === index));
            one.tabIndex = other === index ? 0 : -1;
        });
    };
    choose(0);
    const list = element("div", { role: "tablist", "aria-label": name }, ...all);
    list.addEventListener("keydown", (event) => {
        const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
        if (step === undefined) return;
        event.preventDefault();
        const shown = all.filter((one) => !one.hidden);
        const at = shown.findIndex((one) => one === document.activeElement);
        const next = shown[(at + step + shown.length) % shown.length];
        choose(all.indexOf(next));
        next.focus();
    });
    const root = element("section", { class: "card", "aria-label": name }, list, ...panels);
    /** @param {Set<string>} offers the parts that are shown */
    const offer = (offers) => {
        all.forEach((one, index) => (one.hidden = !offers.has(parts[index].id)));
        const first = all.findIndex((one) => !one.hidden);
        root.hidden = first < 0;
        const chosen = all.find((one) => one.getAttribute("aria-selected") === "true");
        if (chosen?.hidden && first >= 0) choose(first);
    };
    /** @param {string} id of the part that is shown */
    const chooseId = (id) => choose(parts.findIndex((one) => one.id === id));
    return { root, offer, choose: chooseId };
}
