/**
 * The preview of a program: the viewer of reports, with the position of the machine in it.
 */

import { button, element } from "husillo/viewer/element.js";
import { read } from "husillo/viewer/scene.js";
import { mount } from "husillo/viewer/viewer.js";
import { disable, put } from "husillo/panel/change.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The preview. */
export class Preview {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {import("husillo/panel/run.js").Run} run
     */
    constructor(desk, words, run) {
        this.desk = desk;
        this.words = words;
        this.run = run;
        /** @type {import("husillo/viewer/viewer.js").Viewer | undefined} */
        this.viewer = undefined;
        /** The line of the machine that is marked. */
        this.line = 0;
        this.drawn = "";
        this.live = element("input", { type: "checkbox", checked: true });
        this.live.addEventListener("change", () => this.follow());
        this.breakpoint = button(words.breakpointHere, () => this.toggleBreakpoint());
        this.fromHere = button(words.fromHere, () => this.run.ask(this.selected));
        this.place = element("div", { class: "preview" });
        this.root = element(
            "div",
            { hidden: true },
            element(
                "div",
                { class: "items" },
                element("label", { class: "check" }, this.live, words.livePosition),
                this.breakpoint,
                this.fromHere
            ),
            this.place
        );
        desk.listen(() => this.show());
    }

    /** The selected line, from 1. */
    get selected() {
        return this.viewer?.model.line ?? 0;
    }

    toggleBreakpoint() {
        if (this.selected > 0) this.run.toggleBreakpoint(this.selected);
    }

    clear() {
        // A browser has few contexts of WebGL: it takes this one back.
        const context = this.viewer?.path.path.getContext("webgl2");
        context?.getExtension("WEBGL_lose_context")?.loseContext();
        this.viewer = undefined;
        this.line = 0;
        this.place.replaceChildren();
        this.root.hidden = true;
    }

    /** Shows the scene of the loaded program. */
    async load() {
        const { desk } = this;
        const answer = await desk.link.fetch(desk.path("scene"));
        this.clear();
        if (!answer.ok) return;
        const scene = await read(await answer.text());
        this.root.hidden = false;
        this.viewer = mount(this.place, scene, { language: document.documentElement.lang });
        this.viewer.model.listen(() => this.showSelected());
        this.follow();
    }

    /** Whether the tool in the picture is the one of the machine. */
    follow() {
        const { viewer, live } = this;
        if (!viewer) return;
        viewer.model.steps = live.checked ? { at: () => this.position() } : undefined;
        viewer.model.changed();
    }

    /** Where the machine is, in the frame of the scene: its work zero is that of the scene. */
    position() {
        const work = this.desk.state?.work_mm;
        const axes = this.viewer?.model.scene.axes ?? [];
        if (!work || work.length < axes.length) return undefined;
        const at = axes.map((axis, index) => axis.zero_nm + work[index] * 1e6);
        return { commanded: at, real: at };
    }

    showSelected() {
        const { desk, words, selected } = this;
        const isThere = desk.state?.program?.breakpoints.includes(selected) ?? false;
        this.breakpoint.hidden = this.fromHere.hidden = !desk.offers.has("from");
        const text = isThere ? words.breakpointRemove : words.breakpointHere;
        put(this.breakpoint, selected > 0 ? `${text} ${selected}` : text);
        put(this.fromHere, selected > 0 ? `${words.startFrom} ${selected}` : words.startFrom);
        disable(this.breakpoint, !desk.mayCommand || selected === 0);
        disable(this.fromHere, this.run.start.disabled || selected === 0);
    }

    show() {
        const { desk, viewer, live } = this;
        if (!viewer) return;
        this.showSelected();
        if (!live.checked) return;
        const program = desk.state?.program;
        // What others call lines are the moves of a figure.
        const at = desk.state?.factory?.line ?? program?.waits_before ?? program?.line ?? 0;
        const line = desk.isUnderWay ? at : 0;
        if (line > 0 && line !== this.line) viewer.model.selectLine(line);
        this.line = line;
        const now = String(desk.state?.work_mm);
        if (now !== this.drawn) viewer.path.drawOver();
        this.drawn = now;
    }
}
