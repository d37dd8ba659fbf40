/**
 * Running a program: start in two steps, pause, resume, single block, breakpoints, start from a
 * line, progress and remaining time.
 */

import { button, element } from "husillo/viewer/element.js";
import { duration } from "husillo/viewer/quantity.js";
import { disable, fill, put, toggle } from "husillo/panel/change.js";
import { lineState } from "husillo/panel/line_state.js";
import { toolText } from "husillo/panel/tool_change.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/desk.js").Running} Running */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The controls of a program. */
export class Run {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {() => string} text of the program
     */
    constructor(desk, words, text) {
        this.desk = desk;
        this.words = words;
        this.text = text;
        /** The program that a start was asked for. */
        this.asked = "";
        /** The program whose lines are split. */
        this.splitText = "";
        /** @type {string[]} */
        this.lines = [];
        this.start = button(words.startAsk, () => this.ask(), { class: "main" });
        this.goOn = button("", () => this.ask(desk.state?.program?.resume_line ?? undefined));
        this.pause = button(words.pause, () => desk.command("hold"));
        this.resume = button(words.resume, () => desk.command("resume"));
        this.from = element("input", { inputmode: "numeric", size: 6 });
        this.fromText = element("span", {}, words.fromLine);
        this.breakpointsText = element("span", {}, words.breakpoints);
        this.fromField = element("label", { class: "field" }, this.fromText, this.from);
        this.fromButton = button(words.startFrom, () => this.ask(Number(this.from.value)));
        this.single = element("input", { type: "checkbox" });
        this.single.addEventListener("change", () =>
            desk.command("single_block", { on: this.single.checked })
        );
        this.breakpoints = element("input", { size: 12, placeholder: "12, 40" });
        this.breakpoints.addEventListener("change", () => this.setBreakpoints());
        this.waits = element(
            "div",
            { class: "items" },
            element("label", { class: "check" }, this.single, words.singleBlock),
            element("label", { class: "field" }, this.breakpointsText, this.breakpoints),
            this.fromField,
            this.fromButton
        );
        this.progress = element("progress", { max: 1, value: 0, "aria-label": words.progress });
        this.times = element("p", { class: "number times" });
        this.current = element("p", { class: "current mono" });
        this.message = element("p", { class: "message" });
        this.open = element("a", { target: "_blank", rel: "noopener" }, words.report);
        this.save = element("a", { download: "" }, words.saveReport);
        this.report = element("p", { class: "items", hidden: true }, this.open, this.save);
        this.confirm = element("div", {
            class: "confirm",
            role: "group",
            tabindex: -1,
            "aria-label": words.startAsk,
            hidden: true,
        });
        this.root = element(
            "div",
            { hidden: true },
            element("div", { class: "items" }, this.start, this.goOn, this.pause, this.resume),
            this.confirm,
            this.progress,
            this.times,
            this.current,
            this.message,
            this.report,
            this.waits
        );
        desk.listen(() => this.show());
    }

    /** The text of a line of the program. @param {number} line from 1 */
    lineText(line) {
        const text = this.text();
        if (this.splitText !== text) {
            this.splitText = text;
            this.lines = text.split(/\r\n|\n|\r/);
        }
        return this.lines[line - 1] ?? "";
    }

    /** The text of what is made, if it is a line. @param {number} number from 1 */
    textOf(number) {
        const hasLines = !["drill", "microfactory"].includes(this.desk.family);
        return hasLines ? `: ${this.lineText(number)}` : "";
    }

    /** What a program is made of. */
    get unit() {
        const { desk, words } = this;
        if (desk.family === "drill") {
            return { ...words.drill.units, one: words.drill.hole, many: words.drill.holes };
        }
        const isFigure = desk.family === "microfactory";
        return {
            one: isFigure ? words.factory.move : words.line,
            many: isFigure ? words.factory.moves : words.linesToSend,
            waits: words.waitsBefore,
            breakpoints: words.breakpoints,
            from: words.fromLine,
            start: words.startFrom,
            goOn: words.goOnFrom,
        };
    }

    /** Which program of which machine is shown. */
    get key() {
        return `${this.desk.machine?.info.machine}/${this.desk.state?.program?.load}`;
    }

    /** Pauses what runs, and resumes what is held or waits. */
    pauseOrResume() {
        const { state } = this.desk;
        if (state?.state === "Hold" || state?.program?.phase === "waiting") {
            this.desk.command("resume");
        } else if (state?.state === "Run") this.desk.command("hold");
    }

    show() {
        const { desk } = this;
        const { state } = desk;
        const program = state?.program;
        this.root.hidden = !program;
        if (!program) {
            this.confirm.hidden = true;
            return;
        }
        // A figure is cut from its begin to its end.
        this.waits.hidden = this.pause.hidden = this.resume.hidden =
            desk.family === "microfactory";
        const isFree = desk.isIdle && !desk.isUnderWay;
        const mayStart = desk.mayCommand && isFree && program.errors === 0;
        disable(this.start, !mayStart);
        disable(this.fromButton, !mayStart);
        this.fromField.hidden = this.fromButton.hidden = !desk.offers.has("from");
        const resumeLine = program.resume_line ?? null;
        this.goOn.hidden = resumeLine === null || desk.isUnderWay || this.fromButton.hidden;
        disable(this.goOn, !mayStart);
        const { unit } = this;
        put(this.goOn, `${unit.goOn} ${resumeLine}`);
        put(this.fromButton, unit.start);
        put(this.fromText, unit.from);
        put(this.breakpointsText, unit.breakpoints);
        disable(this.pause, state.link !== "up" || state.state !== "Run");
        const waits = program.phase === "waiting" || state.state === "Hold";
        disable(this.resume, !desk.mayCommand || !(waits || state.state === "Door"));
        disable(this.single, !desk.mayCommand);
        disable(this.breakpoints, !desk.mayCommand);
        if (this.single.checked !== program.single_block) {
            this.single.checked = program.single_block;
        }
        fill(this.breakpoints, program.breakpoints.join(", "));
        // What was shown is not what would start.
        if (desk.isUnderWay || this.asked !== this.key) this.confirm.hidden = true;
        this.showProgress(program);
        this.showReport(program);
    }

    /** The links to the report of the last run. @param {Running} program */
    showReport({ runs = 0 }) {
        const { desk } = this;
        this.report.hidden = runs === 0 || desk.isUnderWay || !desk.offers.has("report");
        const { origin, token } = desk.link;
        const href = `${origin}${desk.path("report")}?token=${token}&run=${runs}`;
        for (const link of [this.open, this.save]) if (link.href !== href) link.href = href;
    }

    /** @param {Running} program */
    showProgress(program) {
        const { words, progress } = this;
        const { phase, line, elapsed_s, remaining_s, waits_before, message } = program;
        const part = program.progress ?? (phase === "done" ? 1 : 0);
        if (progress.value !== part) progress.value = part;
        const parts = [
            words.phases[phase] ?? phase,
            `${Math.round(part * 100)} %`,
            `${words.elapsed} ${duration(elapsed_s ?? 0)}`,
            ...(remaining_s === null ? [] : [`${words.remaining} ${duration(remaining_s)}`]),
            ...(program.time_s === null ? [] : [`${words.wholeTime} ${duration(program.time_s)}`]),
        ];
        put(this.times, parts.join(" · "));
        toggle(this.current, "current", "mono");
        const at = waits_before ?? line;
        this.current.hidden = at === null;
        const what = waits_before === null ? this.unit.one : this.unit.waits;
        if (at !== null) put(this.current, `${what} ${at} / ${program.lines}${this.textOf(at)}`);
        put(this.message, message ?? "");
        this.message.hidden = !message;
    }

    /**
     * The first step of a start: what would happen. Nothing moves.
     *
     * @param {number} [from] line
     */
    async ask(from) {
        const { desk, confirm } = this;
        if (this.start.disabled) return;
        const lines = desk.state?.program?.lines ?? 0;
        if (from !== undefined && !(from >= 1 && from <= lines)) {
            desk.refuse(`${this.unit.from}: 1 … ${lines}`);
            return;
        }
        const { key } = this;
        const fields = from === undefined ? {} : { from };
        const plan = await desk.command("run", { ...fields, confirmed: false });
        if (!plan || key !== this.key) return;
        this.asked = key;
        confirm.hidden = false;
        confirm.replaceChildren(...this.plan(plan), this.answers(fields));
        confirm.scrollIntoView({ block: "nearest" });
        // Not on the button: a key that is hit by chance starts nothing.
        confirm.focus();
    }

    /** What a start does, as elements. @param {any} plan */
    plan(plan) {
        const { desk, words } = this;
        const first = this.textOf(plan.from ?? 1);
        const before = plan.before ?? [];
        const time = plan.time_s === null ? "" : `, ${duration(plan.time_s)}`;
        return [
            element("strong", {}, `${words.startAsk} ${plan.name}`),
            element("p", {}, `${plan.lines} ${this.unit.many}${time}`),
            ...(plan.from ? [element("p", {}, `${this.unit.one} ${plan.from}${first}`)] : []),
            ...this.tools(plan.changes ?? []),
            ...(plan.state
                ? [
                      element("p", {}, words.stateBefore),
                      lineState(plan.state, desk.machine?.info.axes ?? [], words),
                  ]
                : []),
            ...(before.length
                ? [
                      element("p", {}, words.sentBefore),
                      element("pre", { class: "mono" }, before.join("\n")),
                  ]
                : []),
            ...(plan.warnings ?? []).map((/** @type {string} */ warning) =>
                element("p", { class: "error" }, warning)
            ),
        ];
    }

    /**
     * The tools that the program asks for.
     *
     * @param {import("husillo/panel/desk.js").Change[]} changes
     */
    tools(changes) {
        const { words } = this;
        if (changes.length === 0) return [];
        const items = changes.map((change) =>
            element("li", {}, `${toolText(change, words)}: ${words.line} ${change.line}`)
        );
        return [element("p", {}, words.toolsOf), element("ul", {}, ...items)];
    }

    /** @param {object} fields */
    answers(fields) {
        const { desk, words, confirm } = this;
        const close = () => {
            confirm.hidden = true;
            this.start.focus();
        };
        return element(
            "div",
            { class: "items" },
            button(words.cancel, close),
            button(
                words.startNow,
                () => {
                    close();
                    desk.command("run", { ...fields, confirmed: true });
                },
                { class: "main" }
            )
        );
    }

    setBreakpoints() {
        const lines = this.breakpoints.value
            .split(/[^0-9]+/)
            .filter(Boolean)
            .map(Number);
        this.desk.command("breakpoints", { lines });
    }

    /** Sets or removes a breakpoint. @param {number} line */
    toggleBreakpoint(line) {
        const now = this.desk.state?.program?.breakpoints ?? [];
        const lines = now.includes(line) ? now.filter((one) => one !== line) : [...now, line];
        this.desk.command("breakpoints", { lines: lines.sort((a, b) => a - b) });
    }
}
