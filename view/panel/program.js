/**
 * The program of a machine: loaded by drag and drop or from a file field, checked before anything
 * moves, its findings with their fixes, and its text to correct.
 */

import { button, element } from "husillo/viewer/element.js";
import { duration } from "husillo/viewer/quantity.js";
import { disable, put, toggle } from "husillo/panel/change.js";
import { applied, offsetOf } from "husillo/panel/fixes.js";
import { Preview } from "husillo/panel/preview.js";
import { Run } from "husillo/panel/run.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/fixes.js").Finding} Finding */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** Names of files that may be programs. */
const ENDS = ".nc,.ngc,.gcode,.tap,.cnc,.txt,.drl,.xln,.exc,.drd,.ncd,.drill,.fig";
/** A longer text is not put into the editor of the page, characters. */
const MOST_EDITED = 1_000_000;

/**
 * @typedef {object} Checked the answer of the server to a program
 * @property {string} name
 * @property {number} lines
 * @property {number} errors
 * @property {number} warnings
 * @property {boolean} is_complete
 * @property {Finding[]} findings
 * @property {number | null} time_s
 * @property {boolean} [has_scene]
 * @property {{least: number[], most: number[]} | null} bounds_mm
 */

/** The program. */
export class Program {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        this.text = "";
        /** @type {Checked | undefined} */
        this.checked = undefined;
        /** Which program of which machine is shown. */
        this.shown = "";
        this.file = element("input", { type: "file", accept: ENDS });
        this.file.addEventListener("change", () => this.choose(this.file.files));
        this.chooser = element("label", { class: "file" }, words.openFile, this.file);
        this.edit = button(words.edit, () => this.toggleEditor());
        this.unload = button(words.unload, () => desk.command("unload"));
        this.drop = element(
            "div",
            { class: "drop" },
            element("div", { class: "items" }, this.chooser, this.edit, this.unload),
            element("p", { class: "soft" }, words.dropHelp)
        );
        this.summary = element("p", { class: "summary", role: "status" });
        this.findings = element("ul", {
            class: "findings",
            // A long list scrolls.
            tabindex: 0,
            "aria-label": words.findings,
        });
        this.source = element("textarea", {
            class: "source",
            spellcheck: "false",
            "aria-label": words.programText,
        });
        this.check = button(words.checkAgain, () => this.load(this.name, this.source.value), {
            class: "main",
        });
        this.editor = element(
            "div",
            { hidden: true },
            this.source,
            element("div", { class: "items" }, this.check)
        );
        this.run = new Run(desk, words, () => this.text);
        this.preview = new Preview(desk, words, this.run);
        this.root = element(
            "section",
            { class: "card", "aria-label": words.program },
            element("h2", {}, words.program),
            this.drop,
            this.summary,
            this.findings,
            this.editor,
            this.run.root,
            this.preview.root
        );
        this.listen();
        desk.listen(() => this.show());
        this.show();
    }

    /** A file may be dropped anywhere on the page. */
    listen() {
        for (const name of ["dragenter", "dragover"]) {
            window.addEventListener(name, (event) => {
                event.preventDefault();
                toggle(this.drop, "drop", "over");
            });
        }
        window.addEventListener("dragleave", () => toggle(this.drop, "drop"));
        window.addEventListener("drop", (event) => {
            event.preventDefault();
            toggle(this.drop, "drop");
            // Files of other machines are dropped elsewhere on the page.
            if (this.root.hidden) return;
            this.choose(event.dataTransfer?.files ?? null);
        });
    }

    /** What a program is made of. */
    get unit() {
        const { desk, words } = this;
        if (desk.family === "drill") return words.drill.holes;
        return desk.family === "microfactory" ? words.factory.moves : words.lines;
    }

    /** The name of the program. */
    get name() {
        return this.desk.state?.program?.name ?? "program.nc";
    }

    /** @param {FileList | null} files */
    async choose(files) {
        const file = files?.[0];
        if (file) await this.load(file.name, await file.text());
        this.file.value = "";
    }

    /**
     * Gives a program to the server, which checks and simulates it. Nothing moves.
     *
     * @param {string} name
     * @param {string} text
     */
    async load(name, text) {
        const { desk, words } = this;
        put(this.summary, `${words.checking} ${name} …`);
        const path = `${desk.path("program")}?name=${encodeURIComponent(name)}`;
        try {
            const answer = await desk.link.fetch(path, { method: "POST", body: text });
            if (!answer.ok) {
                const reason = await answer.text();
                throw new Error(reason || `${answer.status} ${answer.statusText}`);
            }
            this.checked = await answer.json();
            desk.refuse("");
        } catch (error) {
            this.checked = undefined;
            desk.refuse(error instanceof Error ? error.message : String(error));
        }
        this.keep();
        this.text = text;
        this.shown = "";
        this.show();
    }

    /** The findings survive a reload of the page. */
    keep() {
        const { checked } = this;
        const machine = this.desk.machine?.info.machine;
        sessionStorage.setItem(`husillo.checked.${machine}`, JSON.stringify(checked ?? null));
    }

    /** @returns {Checked | undefined} */
    kept() {
        const machine = this.desk.machine?.info.machine;
        const kept = JSON.parse(sessionStorage.getItem(`husillo.checked.${machine}`) ?? "null");
        const program = this.desk.state?.program;
        const isSame =
            kept?.name === program?.name &&
            kept?.lines === program?.lines &&
            kept?.errors === program?.errors;
        return isSame ? (kept ?? undefined) : undefined;
    }

    show() {
        const { desk, words } = this;
        const program = desk.state?.program;
        const may = desk.mayCommand && !desk.isUnderWay;
        disable(this.file, !may);
        toggle(this.chooser, "file", may ? "" : "soft");
        disable(this.check, !may);
        disable(this.unload, !may || !program);
        disable(this.edit, !program);
        if (desk.state === undefined) return;
        const key = program ? `${desk.machine?.info.machine}/${program.load}` : "none";
        if (key === this.shown) return;
        this.shown = key;
        this.changed(program?.errors === 0).catch((error) => desk.refuse(error.message));
        if (!program) put(this.summary, words.noProgram);
    }

    /**
     * Another program is there.
     *
     * @param {boolean} hasScene
     */
    async changed(hasScene) {
        const { desk, shown } = this;
        if (!desk.state?.program) {
            this.text = "";
            this.checked = undefined;
            this.fillFindings();
            this.editor.hidden = true;
            this.preview.clear();
            return;
        }
        this.checked = this.kept();
        this.fillFindings();
        const answer = await desk.link.fetch(desk.path("program"));
        if (answer.ok && this.shown === shown) {
            this.text = await answer.text();
            if (document.activeElement !== this.source) this.fillEditor();
            // The fixes are shown in their lines.
            this.fillFindings();
        }
        // A program that would take minutes to simulate has no scene.
        const isDrill = desk.family === "drill";
        if (hasScene && !isDrill && (this.checked?.has_scene ?? true)) await this.preview.load();
        else {
            this.preview.clear();
            // What has errors is to be corrected. A board has a view of its own.
            const isWell = isDrill && hasScene;
            this.editor.hidden = isWell || this.text.length > MOST_EDITED;
        }
    }

    fillEditor() {
        this.source.value = this.text.length > MOST_EDITED ? "" : this.text;
    }

    /** Shows the text, and puts the caret there. */
    openEditor() {
        if (this.editor.hidden) this.toggleEditor();
        if (this.editor.hidden) return;
        if (this.source.value === "") this.fillEditor();
        this.source.focus();
    }

    toggleEditor() {
        const { editor, desk, words } = this;
        if (this.text.length > MOST_EDITED) desk.refuse(words.tooLong);
        else editor.hidden = !editor.hidden;
    }

    fillFindings() {
        const { desk, words, checked } = this;
        const program = desk.state?.program;
        const { errors = 0, warnings = 0, lines = 0, name = "" } = program ?? {};
        const time = program?.time_s ?? checked?.time_s;
        const parts = [
            `${name}: ${lines} ${this.unit}`,
            errors > 0 ? `${words.errors}: ${errors}` : words.noErrors,
            ...(warnings > 0 ? [`${words.warnings}: ${warnings}`] : []),
            ...(typeof time === "number" ? [duration(time)] : []),
            ...(checked?.bounds_mm ? [boundsText(checked.bounds_mm, desk)] : []),
        ];
        if (program) put(this.summary, parts.join(" · "));
        toggle(this.summary, "summary", errors > 0 ? "error" : "");
        this.findings.replaceChildren(
            ...(checked?.findings ?? []).map((finding) => this.finding(finding)),
            ...(checked && !checked.is_complete ? [element("li", {}, words.moreFindings)] : [])
        );
        this.findings.hidden = this.findings.childElementCount === 0;
    }

    /** @param {Finding} finding */
    finding(finding) {
        const { words } = this;
        const { code, severity, line, column, message, help, notes = [], fixes } = finding;
        const place = line > 0 ? `${words.line} ${line}:${column}` : words.program;
        const [fix] = fixes ?? [];
        return element(
            "li",
            { class: severity },
            element("strong", {}, `${place} ${severity === "error" ? words.error : words.warning}`),
            ` ${code}: ${message} `,
            ...[...notes, ...(help ? [help] : [])].map((text) =>
                element("p", { class: "soft" }, text)
            ),
            ...(line > 0 ? [button(words.showPlace, () => this.goTo(finding))] : []),
            ...(fix
                ? [
                      element("p", {}, element("code", {}, this.fixed(finding))),
                      button(words.applyFix, () =>
                          this.load(this.name, applied(this.text, fixes ?? []))
                      ),
                  ]
                : [])
        );
    }

    /** The line of a finding after its fixes. @param {Finding} finding */
    fixed({ fixes = [] }) {
        const [{ line }] = fixes;
        const here = fixes.filter((fix) => fix.line === line);
        return applied(
            this.run.lineText(line),
            here.map((fix) => ({ ...fix, line: 1 }))
        );
    }

    /** Puts the caret on the place of a finding. @param {Finding} finding */
    goTo({ line, column, end_column }) {
        if (this.text.length > MOST_EDITED) return;
        this.editor.hidden = false;
        if (this.source.value === "") this.fillEditor();
        const begin = offsetOf(this.source.value, line, column);
        const end = offsetOf(this.source.value, line, end_column ?? column + 1);
        this.source.focus();
        this.source.setSelectionRange(begin, end);
        const rows = this.source.value.split("\n").length;
        this.source.scrollTop = (this.source.scrollHeight * Math.max(0, line - 4)) / rows;
    }
}

/**
 * @param {{least: number[], most: number[]}} bounds
 * @param {Desk} desk
 */
function boundsText({ least, most }, desk) {
    const letters = desk.machine?.info.axes ?? [];
    return letters
        .filter((_, axis) => axis < least.length)
        .map((letter, axis) => `${letter} ${least[axis].toFixed(3)}…${most[axis].toFixed(3)}`)
        .join(" ")
        .concat(" mm");
}
