/**
 * A measuring routine: its editor, its drawing, its run, its features and verdicts.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put, toggle } from "husillo/panel/change.js";
import { offsetOf } from "husillo/panel/fixes.js";
import { RoutineDrawing } from "husillo/panel/routine_drawing.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/fixes.js").Finding} Finding */
/** @typedef {import("husillo/panel/routine_drawing.js").Dimension} Dimension */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** A text is checked this long after the last key, milliseconds. */
const AFTER = 400;
/** A routine to begin with: the top of the block of examples/piece.toml. */
const EXAMPLE =
    "safe z -10\nclearance 3\nsearch 4\n" +
    "plane top towards -z at x14 y14 z-20 at x46 y14 z-20 at x46 y34 z-20\n" +
    "point left towards +x at x10 y30 z-25 x 10 +-0.05\n" +
    "bore B at x30 y30 z-24 diameter 16 +-0.05\n";

/** The routine of a machine. */
export class RoutinePanel {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        /** @type {Finding[]} */
        this.findings = [];
        /** @type {any} */
        this.timer = undefined;
        /** The text that was checked last. */
        this.checked = "";
        /** The text that a start was asked for. */
        this.asked = "";
        /** What was fetched: machine, runs, features. */
        this.fetched = "";
        this.name = element("input", { size: 16, value: "part.routine" });
        this.part = element("input", { size: 10 });
        this.text = element("textarea", {
            class: "mono",
            rows: 10,
            spellcheck: "false",
            "aria-label": words.routineText,
        });
        const kept = sessionStorage.getItem("husillo.routine");
        this.text.value = kept ?? EXAMPLE;
        /** Whether it was written here. If not, the routine of the machine takes its place. */
        this.isOwn = kept !== null;
        this.text.addEventListener("input", () => {
            this.isOwn = true;
            sessionStorage.setItem("husillo.routine", this.text.value);
            this.later();
            this.show();
        });
        this.file = element("input", { type: "file", "aria-label": words.routineFile });
        this.file.addEventListener("change", () => this.take(this.file.files?.[0]));
        this.list = element("ul", { class: "findings", "aria-label": words.findings });
        this.drawing = new RoutineDrawing(words);
        this.start = button(words.runRoutine, () => this.ask(), { class: "main" });
        this.resume = button(words.resume, () => desk.command("resume"));
        this.save = button(words.saveRoutine, () => this.download());
        this.confirm = element("div", {
            class: "confirm",
            role: "group",
            tabindex: -1,
            "aria-label": words.runRoutine,
            hidden: true,
        });
        this.message = element("p", { class: "message", role: "status" });
        this.body = element("tbody");
        const heads = [
            words.feature,
            words.figure,
            words.actual,
            words.nominal,
            words.deviation,
            words.verdict,
        ];
        this.table = element(
            "table",
            { class: "features" },
            element(
                "thead",
                {},
                element("tr", {}, ...heads.map((text) => element("th", { scope: "col" }, text)))
            ),
            this.body
        );
        this.results = element(
            "div",
            { class: "scroll", tabindex: 0, role: "region", "aria-label": words.results },
            this.table
        );
        this.open = element("a", { target: "_blank", rel: "noopener" }, words.report);
        this.saveReport = element("a", { download: "" }, words.saveReport);
        this.report = element("p", { class: "items", hidden: true }, this.open, this.saveReport);
        this.root = element(
            "section",
            { class: "card routine", "aria-label": words.routine },
            element("h2", {}, words.routine),
            element(
                "div",
                { class: "items" },
                element("label", { class: "field" }, words.routineName, this.name),
                element("label", { class: "field" }, words.part, this.part),
                this.file,
                this.save
            ),
            this.text,
            this.list,
            element("div", { class: "items" }, this.start, this.resume),
            this.confirm,
            this.message,
            this.report,
            this.drawing.root,
            this.results
        );
        window.addEventListener("drop", (event) => this.dropped(event));
        desk.listen(() => this.show());
        this.show();
    }

    /** @param {DragEvent} event */
    dropped(event) {
        if (this.root.hidden) return;
        event.preventDefault();
        this.take(event.dataTransfer?.files[0]);
    }

    /** @param {File | undefined} file */
    async take(file) {
        if (!file) return;
        this.name.value = file.name;
        this.text.value = await file.text();
        this.isOwn = true;
        this.check();
    }

    download() {
        const link = element("a", { download: this.name.value || "part.routine" });
        link.href = URL.createObjectURL(new Blob([this.text.value], { type: "text/plain" }));
        link.click();
        URL.revokeObjectURL(link.href);
    }

    /** Which text for which machine is shown. */
    get key() {
        return `${this.desk.machine?.info.machine}/${this.text.value}`;
    }

    /** Checks the text after the last key. */
    later() {
        clearTimeout(this.timer);
        this.timer = setTimeout(() => {
            this.timer = undefined;
            this.check();
        }, AFTER);
    }

    async check() {
        const { desk } = this;
        const [name, text] = [this.name.value, this.text.value];
        if (this.isOwn) sessionStorage.setItem("husillo.routine", text);
        this.checked = this.key;
        this.show();
        const checked = await desk.command("routine", { name, text });
        // The text may have changed meanwhile.
        if (!checked || this.text.value !== text) return;
        this.findings = checked.findings;
        this.drawing.sketch = checked.sketch;
        this.showFindings();
        this.show();
    }

    showFindings() {
        const { words } = this;
        this.list.replaceChildren(
            ...this.findings.map((one) =>
                element(
                    "li",
                    { class: one.severity },
                    button(`${words.line} ${one.line}`, () => this.goTo(one)),
                    ` ${one.message}${one.help ? `. ${one.help}` : ""}`
                )
            )
        );
        this.list.hidden = this.findings.length === 0;
    }

    /** Puts the caret at a finding. @param {Finding} finding */
    goTo({ line, column }) {
        const at = offsetOf(this.text.value, line, column);
        this.text.focus();
        this.text.setSelectionRange(at, at);
    }

    /** Asks before anything moves. */
    ask() {
        const { desk, words } = this;
        this.asked = this.key;
        const begin = button(
            words.startRoutine,
            () => {
                this.confirm.hidden = true;
                desk.command("routine_run", {
                    name: this.name.value,
                    text: this.text.value,
                    part: this.part.value,
                });
            },
            { class: "main" }
        );
        const back = button(words.cancel, () => {
            this.confirm.hidden = true;
            this.start.focus();
        });
        const count = this.drawing.sketch.length;
        this.confirm.replaceChildren(
            element("p", {}, `${words.routineMoves} ${count} ${words.features}.`),
            element("div", { class: "items" }, begin, back)
        );
        this.confirm.hidden = false;
        this.confirm.focus();
    }

    /** Fetches what was measured since. */
    async fetch(/** @type {string} */ key) {
        this.fetched = key;
        const measured = await this.desk.command("measured");
        if (!measured || this.fetched !== key) return;
        if (!this.isOwn && this.text.value !== measured.text) {
            this.name.value = measured.name;
            this.text.value = measured.text;
            this.check();
        }
        this.drawing.features = measured.features;
        this.drawing.show();
        this.body.replaceChildren(
            ...measured.features.flatMap((/** @type {any} */ one) => this.rows(one))
        );
    }

    /** @param {import("husillo/panel/routine_drawing.js").Feature} feature */
    rows({ kind, feature, dimensions }) {
        const { words } = this;
        const places = (/** @type {Dimension} */ one) => (one.unit === "mm" ? 4 : 3);
        return dimensions.map((one, index) => {
            const number = (/** @type {number | null | undefined} */ value) =>
                value === null || value === undefined ? "" : value.toFixed(places(one));
            const verdict =
                one.in_tolerance === undefined
                    ? ""
                    : one.in_tolerance === null
                      ? words.spoiled
                      : one.in_tolerance
                        ? words.kept
                        : words.notKept;
            const kindOf = one.in_tolerance === false ? "error" : one.in_tolerance ? "kept" : "";
            return element(
                "tr",
                {},
                index === 0
                    ? element("th", { scope: "row" }, `${kind} ${feature}`)
                    : element("td"),
                element("td", {}, `${one.figure}, ${one.unit}`),
                element("td", { class: "number" }, number(one.actual)),
                element("td", { class: "number" }, number(one.nominal)),
                element("td", { class: "number" }, number(one.deviation)),
                element("td", { class: kindOf }, verdict)
            );
        });
    }

    show() {
        const { desk, words } = this;
        // What was shown is not what would start.
        if (this.asked !== this.key) this.confirm.hidden = true;
        this.root.hidden = !desk.offers.has("routine");
        if (this.root.hidden) return;
        const { state } = desk;
        const number = desk.machine?.info.machine;
        if (state && this.checked !== this.key && !this.timer) this.later();
        const routine = state?.measuring?.routine ?? null;
        const isInMm = state?.measuring?.unit !== "counts";
        this.drawing.line = desk.isIdle ? null : (routine?.line ?? null);
        this.drawing.show();
        const key = `${number}/${routine?.name}/${routine?.runs}/${routine?.features}`;
        if (routine && key !== this.fetched) this.fetch(key);
        const mayBegin = desk.mayCommand && desk.isIdle && isInMm;
        disable(this.start, !mayBegin || this.findings.length > 0);
        this.resume.hidden = routine?.phase !== "waiting";
        put(this.message, isInMm ? this.said(routine) : words.routineNeedsLength);
        toggle(
            this.message,
            "message",
            routine && ["failed", "stopped"].includes(routine.phase) ? "error" : ""
        );
        this.results.hidden = !routine || routine.features === 0;
        this.report.hidden = !routine || routine.runs === 0 || !desk.isIdle;
        if (!this.report.hidden) {
            const { origin, token } = desk.link;
            const href = `${origin}${desk.path("report")}?token=${token}&run=${routine?.runs}`;
            for (const link of [this.open, this.saveReport]) {
                if (link.href !== href) link.href = href;
            }
        }
    }

    /** @param {import("husillo/panel/desk.js").RoutineState | null} routine */
    said(routine) {
        const { words } = this;
        if (!routine) return "";
        const phase = words.routinePhases[routine.phase] ?? routine.phase;
        const line = routine.phase === "running" || routine.phase === "waiting"
            ? `, ${words.line.toLowerCase()} ${routine.line ?? "–"}`
            : "";
        const hasEnded = !["running", "waiting"].includes(routine.phase);
        const summary = routine.summary && hasEnded ? ` ${routine.summary}.` : "";
        const message = routine.message ? ` ${routine.message}.` : "";
        return `${routine.name}: ${phase}${line}.${summary}${message}`;
    }
}
