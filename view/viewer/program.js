/**
 * The lines of the program. Only those in sight are elements, so a long program costs nothing.
 */

import { element } from "husillo/viewer/element.js";
import { KINDS } from "husillo/viewer/scene.js";

/** @typedef {import("husillo/viewer/model.js").Model} Model */
/** @typedef {import("husillo/viewer/words.js").Words} Words */

/** Height of a line, pixels. */
const ROW = 22;
/** Lines kept beyond the edge. */
const MARGIN = 10;
/** A browser's largest height of an element is about 17 million pixels. */
const MOST_HEIGHT = 10_000_000;

/** The list. */
export class ProgramList {
    /**
     * @param {Model} model
     * @param {Words} words
     */
    constructor(model, words) {
        this.model = model;
        this.words = words;
        this.count = model.scene.lines.length;
        this.inner = element("div", { class: "rows", role: "presentation" });
        this.inner.style.height = `${Math.min(this.count * ROW, MOST_HEIGHT)}px`;
        this.root = element(
            "div",
            {
                class: "program",
                role: "listbox",
                tabindex: 0,
                "aria-label": `${words.program}. ${words.programHelp}`,
            },
            this.inner
        );
        this.root.addEventListener("scroll", () => this.fill());
        this.root.addEventListener("keydown", (event) => this.key(event));
        this.root.addEventListener("click", (event) => {
            const row = /** @type {HTMLElement} */ (event.target).closest("[data-line]");
            if (row instanceof HTMLElement) this.model.selectLine(Number(row.dataset.line));
        });
        new ResizeObserver(() => this.fill()).observe(this.root);
        /** @type {Map<number, import("husillo/viewer/scene.js").Finding>} */
        this.findings = new Map(model.scene.findings.map((one) => [one.line, one]));
        this.shown = 0;
        model.listen(() => this.select());
    }

    /** Pixels of the scroll per line. */
    get pitch() {
        return Math.min(ROW, MOST_HEIGHT / this.count);
    }

    fill() {
        const { root, inner, count, pitch } = this;
        const first = Math.floor(root.scrollTop / pitch);
        const height = Math.ceil(root.clientHeight / ROW) || 20;
        const from = Math.max(0, first - MARGIN);
        const to = Math.min(count, first + height + MARGIN);
        const top = root.scrollTop - (first - from) * ROW - (root.scrollTop % pitch);
        inner.replaceChildren(
            ...Array.from({ length: to - from }, (_, index) => {
                const row = this.row(from + index + 1);
                row.style.top = `${Math.max(top, from === 0 ? 0 : -Infinity) + index * ROW}px`;
                return row;
            })
        );
        this.mark();
    }

    /** @param {number} line */
    row(line) {
        const { scene, byLine } = this.model;
        const moves = byLine.get(line);
        const finding = this.findings.get(line);
        const kind = moves ? KINDS[scene.kind[moves[0]]] : "none";
        const number = element("span", { class: "number" }, String(line));
        const text = element("span", { class: "text" }, scene.lines[line - 1] || "\u00a0");
        const row = element(
            "div",
            {
                role: "option",
                id: `line-${line}`,
                "data-line": line,
                "aria-selected": String(line === this.model.line),
                class: `row ${kind}${finding ? ` ${finding.severity}` : ""}`,
                title: finding ? `${finding.code}: ${finding.message}` : undefined,
            },
            number,
            text
        );
        return row;
    }

    select() {
        if (this.shown === this.model.line) return;
        this.shown = this.model.line;
        const { root, pitch } = this;
        const at = (this.model.line - 1) * pitch;
        const isSeen = at >= root.scrollTop && at + ROW <= root.scrollTop + root.clientHeight;
        if (!isSeen && this.model.line > 0) root.scrollTop = at - root.clientHeight / 3;
        this.fill();
    }

    mark() {
        const { line } = this.model;
        if (line > 0 && this.inner.querySelector(`#line-${line}`)) {
            this.root.setAttribute("aria-activedescendant", `line-${line}`);
        } else this.root.removeAttribute("aria-activedescendant");
    }

    /** @param {KeyboardEvent} event */
    key(event) {
        const page = Math.max(1, Math.floor(this.root.clientHeight / ROW) - 1);
        const steps = /** @type {Record<string, number>} */ ({
            ArrowUp: -1,
            ArrowDown: 1,
            PageUp: -page,
            PageDown: page,
            Home: -this.count,
            End: this.count,
        });
        const step = steps[event.key];
        if (step === undefined || event.ctrlKey || event.altKey || event.metaKey) return;
        event.preventDefault();
        this.model.selectLine(this.model.line + step);
    }
}
