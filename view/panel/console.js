/**
 * A line by hand, with its history; and the console with everything that was sent and received.
 */

import { button, element } from "husillo/viewer/element.js";
import { disable, put } from "husillo/panel/change.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** Lines that are elements. The page keeps more. */
const SHOWN = 500;
/** Lines of the history. */
const HISTORY = 100;

/** The console. */
export class Console {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        this.history = load();
        /** Which line of the history the field has, from the end; 0: none of them. */
        this.back = 0;
        this.draft = "";
        this.field = element("input", {
            class: "wide mono",
            maxlength: 255,
            autocomplete: "off",
            autocapitalize: "characters",
            spellcheck: "false",
            "aria-label": words.lineByHand,
            placeholder: "G1 X10 F600",
        });
        this.field.addEventListener("keydown", (event) => this.key(event));
        this.send = button(words.send, () => this.sendLine());
        // A line may be a long move. A program has buttons of its own.
        this.pause = button(words.pause, () => desk.command("hold"), { class: "pause" });
        this.resume = button(words.resume, () => desk.command("resume"), { class: "resume" });
        this.answer = element("p", { class: "why", role: "status" });
        this.log = element("div", {
            class: "log",
            role: "log",
            "aria-live": "off",
            "aria-label": words.console,
            tabindex: 0,
        });
        this.filter = element("input", { type: "checkbox" });
        this.filter.addEventListener("change", () => this.refill());
        this.byHand = element(
            "div",
            {},
            element("h2", {}, words.lineByHand),
            element("div", { class: "items" }, this.field, this.send, this.pause, this.resume),
            this.answer
        );
        this.root = element(
            "section",
            { class: "card", "aria-label": words.console },
            this.byHand,
            element(
                "div",
                { class: "items" },
                element("h3", { class: "wide" }, words.console),
                element("label", { class: "check" }, this.filter, words.withoutOk),
                button(words.save, () => this.save())
            ),
            this.log
        );
        desk.read((lines) => (lines ? this.print(lines) : this.refill()));
        desk.listen(() => this.show());
        this.show();
    }

    show() {
        const { desk } = this;
        const word = desk.state?.state ?? "";
        const may =
            desk.mayCommand &&
            !desk.isOfProgram &&
            ["Idle", "Alarm", "Check", "Jog", "Tool"].includes(word);
        // The field stays open, so that a line can be written while the machine moves.
        disable(this.send, !may);
        // These take single keys, records, or the bytes of their modules.
        const isSilent = ["drill", "microfactory", "measuring"].includes(desk.family ?? "");
        this.byHand.hidden = isSilent;
        const isMill = desk.family === "micromill";
        this.field.placeholder = isMill ? "G01X01000.00F08;" : "G1 X10 F600";
        // A mill holds between the lines of a program only.
        this.pause.hidden = this.resume.hidden = isMill || Boolean(desk.state?.program);
        disable(this.pause, desk.state?.link !== "up" || word !== "Run");
        disable(this.resume, !desk.mayCommand || word !== "Hold");
    }

    /** @param {KeyboardEvent} event */
    key(event) {
        if (event.key === "Enter") {
            event.preventDefault();
            if (!event.repeat) this.sendLine();
        } else if (event.key === "ArrowUp" || event.key === "ArrowDown") {
            event.preventDefault();
            this.recall(event.key === "ArrowUp" ? 1 : -1);
        }
    }

    /** @param {1 | -1} by */
    recall(by) {
        if (this.back === 0) this.draft = this.field.value;
        this.back = Math.max(0, Math.min(this.history.length, this.back + by));
        this.field.value =
            this.back === 0 ? this.draft : this.history[this.history.length - this.back];
    }

    async sendLine() {
        const { desk, words, field, answer } = this;
        const text = field.value.trim();
        if (text === "") return;
        if (this.send.disabled) {
            put(answer, words.notNow);
            return;
        }
        this.history = this.history.filter((one) => one !== text).slice(1 - HISTORY);
        this.history.push(text);
        localStorage.setItem("husillo.history", JSON.stringify(this.history));
        this.back = 0;
        field.value = "";
        put(answer, `${text} …`);
        try {
            await desk.request("line", { text });
            put(answer, `${text}: ok`);
        } catch (error) {
            // The line is not lost.
            if (field.value === "") field.value = text;
            put(answer, `${text}: ${error instanceof Error ? error.message : error}`);
        }
    }

    /** @param {import("husillo/panel/desk.js").Line} line */
    isShown({ text }) {
        return !this.filter.checked || text !== "ok";
    }

    refill() {
        this.log.replaceChildren();
        this.print(this.desk.machine?.lines ?? []);
    }

    /** @param {import("husillo/panel/desk.js").Line[]} lines */
    print(lines) {
        const { log } = this;
        const isAtEnd = log.scrollHeight - log.scrollTop - log.clientHeight < 40;
        const shown = lines.filter((line) => this.isShown(line)).slice(-SHOWN);
        log.append(...shown.map((line) => this.row(line)));
        while (log.childElementCount > SHOWN) log.firstElementChild?.remove();
        if (isAtEnd) log.scrollTop = log.scrollHeight;
    }

    /** @param {import("husillo/panel/desk.js").Line} line */
    row({ from, text }) {
        const sign = { host: "> ", controller: "< ", server: "* " }[from];
        const isBad = /^(error|ALARM):/.test(text);
        const kind = from === "host" ? "sent" : isBad ? "bad" : "heard";
        return element("div", { class: kind }, sign + text);
    }

    /** Saves the console as a file. */
    save() {
        const rows = (this.desk.machine?.lines ?? []).map(
            ({ at_ms, from, text }) => `${(at_ms / 1000).toFixed(3)}\t${from}\t${text}\n`
        );
        const href = URL.createObjectURL(new Blob(rows, { type: "text/plain" }));
        element("a", { href, download: "console.txt" }).click();
        setTimeout(() => URL.revokeObjectURL(href), 10_000);
    }
}

/** @returns {string[]} */
function load() {
    try {
        const kept = JSON.parse(localStorage.getItem("husillo.history") ?? "[]");
        return Array.isArray(kept) ? kept.map(String) : [];
    } catch {
        return [];
    }
}
