/**
 * The probing wizards: they say the next step in plain words, and measure height, corner, centre
 * and tool length.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put } from "husillo/panel/change.js";
import { VALUES, centre, corner, height, toolLength } from "husillo/panel/probing.js";
import { LinkedRig, Stopped } from "husillo/panel/rig.js";
import { numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/probing.js").Values} Values */
/** @typedef {import("husillo/panel/words.js").Words} Words */
/** @typedef {"height" | "corner" | "centre" | "tool"} Kind */

/** The values that each wizard asks for. @type {Record<Kind, (keyof Values)[]>} */
const ASKED = {
    height: ["thickness", "distance", "searchFeed", "touchFeed", "retract"],
    corner: ["tip", "clearance", "depth", "searchFeed", "touchFeed", "retract"],
    centre: ["tip", "distance", "searchFeed", "touchFeed", "retract"],
    tool: ["distance", "searchFeed", "touchFeed", "retract"],
};

/** The corners: their sides in X and Y. */
const CORNERS = /** @type {[1 | -1, 1 | -1][]} */ ([
    [-1, -1],
    [1, -1],
    [-1, 1],
    [1, 1],
]);

/** The wizards. */
export class Wizard {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        /** @type {Kind} */
        this.kind = "height";
        /** Machines whose probe was seen closed on this link, so that it works. */
        this.works = new WeakSet();
        /** @type {LinkedRig | undefined} */
        this.rig = undefined;
        this.kinds = /** @type {Kind[]} */ (["height", "corner", "centre", "tool"]).map(
            (kind) => ({
                kind,
                button: button(words.wizards[kind], () => this.choose(kind)),
            })
        );
        this.corner = element(
            "select",
            { "aria-label": words.whichCorner },
            ...words.corners.map((name, index) => element("option", { value: index }, name))
        );
        /** @type {Map<keyof Values, HTMLInputElement>} */
        this.fields = new Map();
        this.steps = element("ol", {});
        this.tested = element("li", { "aria-live": "polite" });
        this.form = element("div", { class: "items" });
        this.begin = button(words.probeStart, () => this.start(), { class: "main" });
        this.again = button(words.firstTool, () => this.forget());
        this.result = element("p", { role: "status", class: "result" });
        this.why = element("p", { class: "why" });
        this.root = element(
            "div",
            {},
            element("div", { class: "items" }, ...this.kinds.map((one) => one.button)),
            this.steps,
            this.form,
            element("div", { class: "items" }, this.begin, this.again),
            this.why,
            this.result
        );
        desk.listen(() => this.show());
        this.choose("height");
    }

    /** Where the browser keeps the contact of the first tool: it outlasts a reload. */
    get referenceKey() {
        const { name, port } = this.desk.machine?.info ?? {};
        return `husillo.reference.${name}.${port}`;
    }

    /** Machine Z of the contact of the first tool, mm. @returns {number | undefined} */
    get reference() {
        return numberOf(sessionStorage.getItem(this.referenceKey) ?? "");
    }

    /** @param {Kind} kind */
    choose(kind) {
        const { words, fields } = this;
        this.kind = kind;
        this.fields = new Map(
            ASKED[kind].map((name) => {
                const kept = localStorage.getItem(`husillo.probe.${name}`);
                const value = fields.get(name)?.value ?? kept ?? String(VALUES[name]);
                return [name, element("input", { inputmode: "decimal", value })];
            })
        );
        this.form.replaceChildren(
            ...(kind === "corner" ? [this.corner] : []),
            ...[...this.fields].map(([name, field]) =>
                element("label", { class: "field" }, words.probeValues[name], field)
            )
        );
        const [place, ...rest] = words.wizardSteps[kind];
        this.steps.replaceChildren(
            element("li", {}, place),
            this.tested,
            ...rest.map((text) => element("li", {}, text))
        );
        put(this.result, "");
        for (const one of this.kinds) {
            one.button.setAttribute("aria-pressed", String(one.kind === kind));
        }
        this.show();
    }

    /** Whether the probe of the shown machine works. */
    get isTested() {
        const { machine } = this.desk;
        return machine !== undefined && this.works.has(machine);
    }

    show() {
        const { desk, words, kind } = this;
        const isClosed = desk.state?.switches.includes("P") ?? false;
        if (isClosed && desk.machine) this.works.add(desk.machine);
        const tested = isClosed
            ? words.probeIsClosed
            : this.isTested
              ? words.probeWorks
              : words.probeTest;
        put(this.tested, tested);
        const obstacle = this.obstacle(isClosed);
        put(this.why, obstacle);
        disable(this.begin, obstacle !== "");
        const hasReference = this.reference !== undefined;
        this.again.hidden = kind !== "tool" || !hasReference;
        const begin = kind === "tool" && hasReference ? words.probeNextTool : words.probeStart;
        put(this.begin, begin);
    }

    /**
     * Why the cycle cannot begin, in words; empty if it can.
     *
     * @param {boolean} isClosed
     */
    obstacle(isClosed) {
        const { desk, words } = this;
        if (this.rig) return words.probing;
        if (!desk.mayCommand) return words.whyWatching;
        if (!desk.isIdle) return words.whyBusy;
        if (isClosed) return words.probeIsClosed;
        return this.isTested ? "" : words.probeTest;
    }

    /** The values of the form; undefined if one is no number. @returns {Values | undefined} */
    values() {
        const values = { ...VALUES };
        let isValid = true;
        for (const [name, field] of this.fields) {
            const value = numberOf(field.value);
            const isGood = value !== undefined && (value > 0 || name === "thickness");
            field.setAttribute("aria-invalid", String(!isGood));
            isValid &&= isGood;
            if (value === undefined) continue;
            values[name] = value;
            localStorage.setItem(`husillo.probe.${name}`, String(value));
        }
        return isValid ? values : undefined;
    }

    async start() {
        const { desk, words, result } = this;
        const values = this.values();
        if (!values) {
            put(result, words.notANumber);
            return;
        }
        this.rig = new LinkedRig(desk, { contact: words.unexpected, stopped: words.wasStopped });
        put(result, words.probing);
        this.show();
        try {
            put(result, await this.cycle(this.rig, values));
        } catch (error) {
            const text = error instanceof Error ? error.message : String(error);
            put(result, error instanceof Stopped ? text : `${text}. ${words.nothingSet}`);
        }
        this.rig = undefined;
        // The guide through a change of a tool shows the contact of the first tool.
        desk.changed();
    }

    /**
     * @param {LinkedRig} rig
     * @param {Values} values
     */
    async cycle(rig, values) {
        const { words } = this;
        switch (this.kind) {
            case "height":
                await height(rig, values);
                return words.heightDone;
            case "corner":
                await corner(rig, values, CORNERS[Number(this.corner.value)]);
                return words.cornerDone;
            case "centre": {
                const { x, y } = await centre(rig, values);
                return `${words.centreDone} X ${x.toFixed(3)} mm, Y ${y.toFixed(3)} mm`;
            }
            default: {
                const { reference } = this;
                const contact = await toolLength(rig, values, reference);
                if (reference === undefined) {
                    sessionStorage.setItem(this.referenceKey, contact.toFixed(4));
                }
                const length = contact - (reference ?? contact);
                return `${words.toolDone} ${length.toFixed(3)} mm`;
            }
        }
    }

    forget() {
        sessionStorage.removeItem(this.referenceKey);
        this.desk.changed();
    }

    /** STOP: no further move is sent. */
    stop() {
        this.rig?.stop();
    }
}
