/**
 * The board view of the drill: the holes on the table, which of them are drilled, where the drill
 * is, what was taught; the place of the board, by angle, mirror and measured holes.
 */

import { button, element } from "husillo/viewer/element.js";
import { lookOf } from "husillo/viewer/look.js";
import { duration } from "husillo/viewer/quantity.js";
import { disable, put } from "husillo/panel/change.js";
import { numberOf } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/**
 * @typedef {object} Hole
 * @property {[number, number]} at_mm
 * @property {number} part index of its tool
 * @property {[number, number] | null} file_mm
 *
 * @typedef {object} Reference
 * @property {[number, number]} file_mm
 * @property {[number, number]} measured_mm
 *
 * @typedef {object} Placing
 * @property {number[]} only
 * @property {"x" | "y" | null} mirror
 * @property {number} turn_degrees
 * @property {Reference[]} references
 * @property {boolean} stretch
 * @property {boolean} corner
 * @property {boolean} shortest
 * @property {boolean} tango
 *
 * @typedef {object} Board
 * @property {boolean} is_drill_file
 * @property {Placing} placing
 * @property {{tool: number, diameter_mm: number | null, holes: number}[]} tools
 * @property {Hole[]} holes
 * @property {{turn_degrees: number, scale_ppm: [number, number], skew_ppm: number | null,
 *     residual_mm: number} | null} fit
 * @property {number} travel_mm
 * @property {number} time_s
 */

/** Colours of tools repeat after as many. */
const COLOURS = 6;
/** Margin around what is shown, as a part of it. */
const MARGIN = 0.06;
/** Height of the picture as a part of its width. */
const SHAPE = 0.5;
/** A click chooses the hole within this distance, pixels. */
const NEAR = 24;
/** Drawn diameter of a hole whose diameter is not known, mm. */
const UNKNOWN_MM = 0.8;

/** The board view. */
export class DrillBoard {
    /**
     * @param {Desk} desk
     * @param {Words} words
     * @param {import("husillo/panel/program.js").Program} program
     */
    constructor(desk, words, program) {
        this.desk = desk;
        this.words = words;
        this.program = program;
        /** @type {Board | undefined} */
        this.board = undefined;
        /** Which program of which machine the board is of. */
        this.shown = "";
        this.isWhole = false;
        this.isDue = false;
        /** Measured holes that are not applied yet. @type {Reference[] | undefined} */
        this.measurements = undefined;
        /** The chosen hole, from 1; 0: none. */
        this.chosen = 0;
        /** @type {((x: number, y: number) => [number, number]) | undefined} */
        this.place = undefined;
        this.canvas = element("canvas", { role: "img", class: "mill-plot drill-board" });
        this.canvas.addEventListener("click", ({ offsetX, offsetY }) =>
            this.chooseAt(offsetX, offsetY)
        );
        const { drill } = words;
        this.fitBoard = button(drill.fitBoard, () => this.fit(false));
        this.fitTable = button(drill.fitTable, () => this.fit(true));
        this.number = element("input", { inputmode: "numeric", size: 5 });
        this.number.addEventListener("input", () => this.choose(Number(this.number.value)));
        this.facts = element("p", { class: "soft number" });
        this.about = element("p", { class: "number", "data-value": "hole", role: "status" });
        this.go = button(drill.goThere, () => this.goThere());
        this.measured = button(drill.isHere, () => this.measure());
        this.from = button(words.startFrom, () => this.program.run.ask(this.chosen));
        this.tools = element("ul", { class: "legend tools" });
        this.records = element("p", { class: "items" });
        this.references = element("ul", { class: "references" });
        this.fitText = element("p", { class: "number", "data-value": "fit" });
        this.placing = this.placingForm();
        this.root = element(
            "section",
            { class: "card", "aria-label": drill.board },
            element("h2", {}, drill.board),
            element("div", { class: "items" }, this.fitBoard, this.fitTable),
            this.canvas,
            this.facts,
            this.tools,
            element(
                "div",
                { class: "items" },
                element("label", { class: "field" }, drill.holeNumber, this.number),
                this.go,
                this.from
            ),
            this.about,
            this.placing,
            this.records
        );
        desk.listen(() => this.show());
        new ResizeObserver(() => this.later()).observe(this.canvas);
        window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () =>
            this.later()
        );
        this.show();
    }

    /** The fields of the place. */
    placingForm() {
        const { drill } = this.words;
        this.mirror = element(
            "select",
            { "aria-label": drill.mirror },
            element("option", { value: "" }, drill.mirrorNone),
            element("option", { value: "x" }, `${drill.mirror} X`),
            element("option", { value: "y" }, `${drill.mirror} Y`)
        );
        this.turn = element("input", { inputmode: "decimal", size: 5, value: "0" });
        this.only = element("input", { size: 6, placeholder: "1, 2" });
        const check = () => element("input", { type: "checkbox" });
        this.corner = check();
        this.shortest = check();
        this.tango = check();
        this.stretch = check();
        const checks = /** @type {[HTMLInputElement, string][]} */ ([
            [this.corner, drill.corner],
            [this.shortest, drill.shortest],
            [this.tango, drill.tango],
            [this.stretch, drill.stretch],
        ]);
        this.apply = button(drill.place, () => this.send(this.fields()));
        this.forget = button(drill.forget, () => this.send({ ...this.fields(), references: [] }));
        return element(
            "details",
            {},
            element("summary", {}, drill.placeName),
            element(
                "div",
                { class: "items" },
                this.mirror,
                element("label", { class: "field" }, drill.turn, this.turn),
                element("label", { class: "field" }, drill.only, this.only)
            ),
            element(
                "div",
                { class: "items" },
                ...checks.map(([field, text]) =>
                    element("label", { class: "check" }, field, text)
                )
            ),
            element("h3", {}, drill.registration),
            element("p", { class: "soft" }, drill.registrationHelp),
            element("div", { class: "items" }, this.measured, this.forget),
            this.references,
            this.fitText,
            element("div", { class: "items" }, this.apply)
        );
    }

    /** @param {boolean} isWhole */
    fit(isWhole) {
        this.isWhole = isWhole;
        this.show();
    }

    /** The holes. */
    get holes() {
        return this.board?.holes ?? [];
    }

    /** What the fields have. @returns {Placing} */
    fields() {
        const mirror = /** @type {"x" | "y" | ""} */ (this.mirror?.value ?? "");
        const only = (this.only?.value ?? "").split(/[^0-9]+/).filter(Boolean);
        return {
            only: only.map(Number),
            mirror: mirror === "" ? null : mirror,
            turn_degrees: numberOf(this.turn?.value ?? "") ?? 0,
            references: this.listed,
            stretch: this.stretch?.checked ?? false,
            corner: this.corner?.checked ?? false,
            shortest: this.shortest?.checked ?? false,
            tango: this.tango?.checked ?? false,
        };
    }

    /**
     * The measured holes that are listed, also those that were not applied yet.
     *
     * @returns {Reference[]}
     */
    get listed() {
        return this.measurements ?? this.board?.placing.references ?? [];
    }

    /** @param {Placing} placing */
    async send(placing) {
        const report = await this.desk.command("place", { placing });
        if (!report) return;
        this.program.checked = report;
        this.program.keep();
        this.program.fillFindings();
    }

    /** The chosen hole is where the drill is now. */
    measure() {
        const hole = this.holes[this.chosen - 1];
        const [x, y] = this.desk.state?.work_mm ?? [];
        if (!hole?.file_mm || x === undefined) return;
        const key = String(hole.file_mm);
        const others = this.listed.filter((one) => String(one.file_mm) !== key);
        this.measurements = [...others, { file_mm: hole.file_mm, measured_mm: [x, y] }];
        this.fillReferences();
        this.show();
    }

    goThere() {
        const hole = this.holes[this.chosen - 1];
        if (!hole) return;
        const [x, y] = hole.at_mm;
        this.desk.command("goto", { to_mm: { x, y }, frame: "work" });
    }

    /**
     * @param {number} x pixel of the picture
     * @param {number} y
     */
    chooseAt(x, y) {
        const { place } = this;
        if (!place) return;
        let best = NEAR;
        let found = 0;
        this.holes.forEach((hole, index) => {
            const [a, b] = place(...hole.at_mm);
            const apart = Math.hypot(a - x, b - y);
            if (apart < best) [best, found] = [apart, index + 1];
        });
        if (found > 0) {
            this.number.value = String(found);
            this.choose(found);
        }
    }

    /** @param {number} number */
    choose(number) {
        this.chosen = this.holes[number - 1] ? number : 0;
        this.show();
    }

    show() {
        const { desk, words } = this;
        this.root.hidden = desk.family !== "drill";
        if (this.root.hidden) return;
        const program = desk.state?.program;
        const key = program ? `${desk.machine?.info.machine}/${program.load}` : "none";
        if (desk.state !== undefined && key !== this.shown) {
            this.shown = key;
            this.load(program !== undefined && program !== null).catch((error) =>
                desk.refuse(error.message)
            );
        }
        this.fitBoard.setAttribute("aria-pressed", String(!this.isWhole));
        this.fitTable.setAttribute("aria-pressed", String(this.isWhole));
        const hole = this.holes[this.chosen - 1];
        put(this.about, hole ? this.holeText(this.chosen) : words.drill.chooseHole);
        const may = desk.mayCommand && desk.isIdle;
        const isManual = desk.state?.drill?.is_manual ?? false;
        disable(this.go, !may || !isManual || !hole);
        disable(this.measured, !may || !hole?.file_mm || !desk.state?.drill?.is_homed);
        disable(this.from, !may || !hole || program?.errors !== 0);
        put(this.from, `${words.drill.startFromHole} ${hole ? this.chosen : ""}`.trim());
        disable(this.apply ?? this.go, !may || !program);
        disable(this.forget ?? this.go, !may || this.listed.length === 0);
        this.placing.hidden = !this.board?.is_drill_file;
        const done = program?.sent ?? 0;
        const taught = desk.state?.drill?.taught_mm.length ?? 0;
        const texts = [
            `${this.holes.length} ${words.drill.holes}`,
            ...(desk.isUnderWay || done > 0 ? [`${done} ${words.drill.drilled}`] : []),
            ...(taught > 0 ? [`${taught} ${words.drill.taughtHoles}`] : []),
            ...(this.board ? [`${this.board.travel_mm.toFixed(1)} mm`] : []),
            ...(this.board && this.holes.length > 0 ? [duration(this.board.time_s)] : []),
        ];
        put(this.facts, texts.join(" · "));
        const label = `${words.drill.board}: ${this.facts.textContent}`;
        if (this.canvas.getAttribute("aria-label") !== label) {
            this.canvas.setAttribute("aria-label", label);
        }
        this.later();
    }

    /** A hole in words. @param {number} number */
    holeText(number) {
        const { board, words } = this;
        const hole = this.holes[number - 1];
        if (!hole) return "";
        const [x, y] = hole.at_mm;
        const tool = toolText(board?.tools[hole.part]);
        const file = hole.file_mm?.map((mm) => mm.toFixed(3)).join(", ");
        return [
            `${words.drill.hole} ${number}: X${x.toFixed(3)} Y${y.toFixed(3)}`,
            ...(tool ? [tool] : []),
            ...(file ? [`${words.drill.inFile} ${file}`] : []),
        ].join(", ");
    }

    /** @param {boolean} hasProgram */
    async load(hasProgram) {
        const { desk, shown } = this;
        this.board = undefined;
        this.measurements = undefined;
        this.chosen = 0;
        this.number.value = "";
        if (hasProgram) {
            const answer = await desk.link.fetch(desk.path("board"));
            if (this.shown !== shown) return;
            this.board = answer.ok ? await answer.json() : undefined;
        }
        this.fillFields();
        this.fillTools();
        this.fillReferences();
        this.show();
        desk.changed();
    }

    fillFields() {
        const { board } = this;
        const { mirror, turn, only, corner, shortest, tango, stretch } = this;
        if (!board || !mirror || !turn || !only) return;
        const { placing, fit } = board;
        mirror.value = placing.mirror ?? "";
        turn.value = String(placing.turn_degrees);
        only.value = placing.only.join(", ");
        if (corner) corner.checked = placing.corner;
        if (shortest) shortest.checked = placing.shortest;
        if (tango) tango.checked = placing.tango;
        if (stretch) stretch.checked = placing.stretch;
        const { drill } = this.words;
        put(
            this.fitText,
            fit
                ? `${drill.turned} ${fit.turn_degrees.toFixed(3)}°, ` +
                      `X ${Math.round(fit.scale_ppm[0])} ppm, ` +
                      `Y ${Math.round(fit.scale_ppm[1])} ppm, ` +
                      `${drill.residual} ${fit.residual_mm.toFixed(3)} mm`
                : ""
        );
    }

    fillTools() {
        const { board, desk, words } = this;
        const tools = board && this.holes.length > 0 ? board.tools : [];
        this.tools.replaceChildren(
            ...tools.map((tool, index) =>
                element(
                    "li",
                    { class: `tool-${index % COLOURS}` },
                    `${toolText(tool) || words.program}: ${tool.holes} ${words.drill.holes}`
                )
            )
        );
        const { origin, token } = desk.link;
        this.records.replaceChildren(
            ...tools.map((tool, index) =>
                element(
                    "a",
                    {
                        href: `${origin}${desk.path("records")}?token=${token}&tool=${index}`,
                        download: `T${tool.tool}.cod`,
                    },
                    `${words.drill.saveRecords} T${tool.tool}.cod`
                )
            )
        );
    }

    fillReferences() {
        const { words, listed } = this;
        const text = (/** @type {[number, number]} */ [x, y]) => `${x.toFixed(3)}, ${y.toFixed(3)}`;
        this.references.replaceChildren(
            ...listed.map((one) =>
                element(
                    "li",
                    { class: "items" },
                    element("span", {}, `${text(one.file_mm)} → ${text(one.measured_mm)}`),
                    button(words.remove, () => {
                        this.measurements = listed.filter((other) => other !== one);
                        this.fillReferences();
                        this.show();
                    })
                )
            )
        );
    }

    /** Draws with the next picture of the browser. */
    later() {
        if (this.isDue) return;
        this.isDue = true;
        requestAnimationFrame(() => {
            this.isDue = false;
            if (!this.root.hidden) this.draw();
        });
    }

    /** Least and greatest X and Y of what is shown, mm. */
    bounds() {
        const travel = this.desk.machine?.info.travel_mm ?? [];
        const taught = this.desk.state?.drill?.taught_mm ?? [];
        const points = [...this.holes.map((hole) => hole.at_mm), ...taught];
        const zero = this.desk.state?.zero_mm ?? [];
        return [0, 1].map((axis) => {
            const table = (travel[axis] ?? [0, 1]).map((end) => end - (zero[axis] ?? 0));
            let [least, most] = this.isWhole || points.length === 0 ? table : [0, 0];
            for (const point of points) {
                least = Math.min(least, point[axis]);
                most = Math.max(most, point[axis]);
            }
            const half = Math.max(most - least, 2) / 2;
            return { middle: (least + most) / 2, half: half * (1 + MARGIN) + UNKNOWN_MM };
        });
    }

    draw() {
        const { canvas, desk } = this;
        const context = canvas.getContext("2d");
        const width = canvas.clientWidth;
        if (!context || width === 0) return;
        const ratio = window.devicePixelRatio || 1;
        const height = Math.round(width * SHAPE);
        if (canvas.width !== Math.round(width * ratio)) {
            canvas.width = Math.round(width * ratio);
            canvas.height = Math.round(height * ratio);
        }
        context.setTransform(ratio, 0, 0, ratio, 0, 0);
        const look = lookOf(canvas);
        context.fillStyle = look.ground;
        context.fillRect(0, 0, width, height);
        const [across, up] = this.bounds();
        const scale = Math.min(width / (2 * across.half), height / (2 * up.half));
        const place = (/** @type {number} */ x, /** @type {number} */ y) =>
            /** @type {[number, number]} */ ([
                width / 2 + (x - across.middle) * scale,
                height / 2 - (y - up.middle) * scale,
            ]);
        this.place = place;
        this.drawTable(context, look, place);
        this.drawHoles(context, look, place, scale);
        const at = desk.state?.work_mm;
        if (at) drawCross(context, look.ink, place(at[0], at[1]));
    }

    /**
     * @param {CanvasRenderingContext2D} context
     * @param {import("husillo/viewer/look.js").Look} look
     * @param {(x: number, y: number) => [number, number]} place
     */
    drawTable(context, look, place) {
        const [x, y] = this.desk.machine?.info.travel_mm ?? [];
        if (!x || !y) return;
        // Holes are measured from the zero of the work.
        const [zeroX = 0, zeroY = 0] = this.desk.state?.zero_mm ?? [];
        const [left, bottom] = place(x[0] - zeroX, y[0] - zeroY);
        const [right, top] = place(x[1] - zeroX, y[1] - zeroY);
        context.lineWidth = 1;
        context.setLineDash([]);
        context.strokeStyle = look.soft;
        context.strokeRect(left, top, right - left, bottom - top);
    }

    /**
     * Drilled holes are full, the others are rings; taught ones are squares.
     *
     * @param {CanvasRenderingContext2D} context
     * @param {import("husillo/viewer/look.js").Look} look
     * @param {(x: number, y: number) => [number, number]} place
     * @param {number} scale pixels of a mm
     */
    drawHoles(context, look, place, scale) {
        const { board, desk, canvas } = this;
        const style = getComputedStyle(canvas);
        const colours = Array.from({ length: COLOURS }, (_, index) =>
            style.getPropertyValue(`--tool-${index}`).trim()
        );
        const program = desk.state?.program;
        const isRun = program && program.phase !== "loaded";
        const done = isRun ? program.sent : 0;
        const next = isRun && desk.isUnderWay ? program.line : null;
        context.setLineDash([]);
        this.holes.forEach((hole, index) => {
            const [x, y] = place(...hole.at_mm);
            const diameter = board?.tools[hole.part]?.diameter_mm ?? UNKNOWN_MM;
            const radius = Math.max(3, (diameter * scale) / 2);
            context.strokeStyle = context.fillStyle = colours[hole.part % COLOURS] || look.ink;
            context.lineWidth = 1.5;
            context.beginPath();
            context.arc(x, y, radius, 0, 2 * Math.PI);
            if (index < done) context.fill();
            else context.stroke();
            if (index + 1 === this.chosen || index + 1 === next) {
                context.strokeStyle = look.ink;
                context.lineWidth = 2;
                context.beginPath();
                context.arc(x, y, radius + 4, 0, 2 * Math.PI);
                context.stroke();
            }
        });
        context.strokeStyle = look.ink;
        context.lineWidth = 1.5;
        for (const [x, y] of desk.state?.drill?.taught_mm ?? []) {
            const [a, b] = place(x, y);
            context.strokeRect(a - 5, b - 5, 10, 10);
        }
    }
}

/** @param {{tool: number, diameter_mm: number | null} | undefined} tool */
function toolText(tool) {
    if (!tool || tool.tool === 0) return "";
    return tool.diameter_mm === null ? `T${tool.tool}` : `T${tool.tool} ${tool.diameter_mm} mm`;
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {string} colour
 * @param {[number, number]} at
 */
function drawCross(context, colour, [x, y]) {
    context.setLineDash([]);
    context.lineWidth = 2;
    context.strokeStyle = colour;
    context.beginPath();
    context.moveTo(x - 8, y);
    context.lineTo(x + 8, y);
    context.moveTo(x, y - 8);
    context.lineTo(x, y + 8);
    context.stroke();
}
