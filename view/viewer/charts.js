/**
 * Charts over a common time: speed, acceleration, jerk, deviation. The pointer shows values, a drag
 * selects a span, and a table says least, most and mean of it.
 */

import { button, element, fitCanvas } from "husillo/viewer/element.js";
import { lookOf } from "husillo/viewer/look.js";
import { duration, trimmed } from "husillo/viewer/quantity.js";
import { roundUp } from "husillo/viewer/rulers.js";

/** @typedef {import("husillo/viewer/model.js").Model} Model */
/** @typedef {import("husillo/viewer/words.js").Words} Words */
/** @typedef {import("husillo/viewer/scene.js").Band} Band */

/**
 * @typedef {object} Series
 * @property {Band} band
 * @property {number} kind index of `KINDS` whose colour it has
 *
 * @typedef {object} Chart
 * @property {keyof Words} title
 * @property {string} unit
 * @property {number} scale nanometres per unit
 * @property {Series[]} series
 */

/** Indices of `KINDS`. */
const [JOG, RAPID, FEED] = [0, 1, 2];
/** Space for numbers at the left, pixels. */
const LEFT = 64;

/** The charts. */
export class Charts {
    /**
     * @param {Model} model
     * @param {Words} words
     */
    constructor(model, words) {
        this.model = model;
        this.words = words;
        const { bands } = model.scene;
        const all = /** @type {Chart[]} */ ([
            {
                title: "speedChart",
                unit: "mm/min",
                scale: 1e6 / 60,
                series: [
                    { band: bands.programmed, kind: JOG },
                    { band: bands.rapid, kind: RAPID },
                    { band: bands.feed, kind: FEED },
                ],
            },
            {
                title: "accelerationChart",
                unit: "mm/s²",
                scale: 1e6,
                series: [{ band: bands.acceleration, kind: FEED }],
            },
            {
                title: "jerkChart",
                unit: "mm/s³",
                scale: 1e6,
                series: [{ band: bands.jerk, kind: FEED }],
            },
            {
                title: "deviationChart",
                unit: "um",
                scale: 1e3,
                series: [{ band: bands.deviation, kind: FEED }],
            },
        ]);
        this.charts = all.filter((chart) =>
            chart.series.some(({ band }) => band.high.length > 0)
        );
        this.canvases = this.charts.map((chart) => this.canvasOf(chart));
        this.output = element("output", { class: "hover" });
        this.table = element("tbody");
        this.root = element(
            "section",
            { class: "charts", "aria-label": words.charts },
            element(
                "div",
                { class: "bar" },
                element("h3", {}, words.charts),
                button(words.whole, () => model.show()),
                this.output
            ),
            ...this.canvases,
            this.tableElement()
        );
        /** The begin of a drag, seconds. @type {number | undefined} */
        this.drag = undefined;
        /** @type {[number, number] | undefined} */
        this.marked = undefined;
        model.listen(() => this.draw());
        new ResizeObserver(() => this.draw()).observe(this.root);
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () =>
            this.draw()
        );
    }

    tableElement() {
        const { words } = this;
        const heads = ["", words.least, words.most, words.mean].map((text) =>
            text ? element("th", { scope: "col" }, text) : element("td")
        );
        return element(
            "table",
            {},
            element("caption", {}, words.span),
            element("thead", {}, element("tr", {}, ...heads)),
            this.table
        );
    }

    /** @param {Chart} chart */
    canvasOf(chart) {
        const { words } = this;
        const canvas = element("canvas", {
            class: "chart",
            tabindex: 0,
            role: "application",
            "aria-label": `${words[chart.title]}, ${chart.unit}. ${words.chartHelp}`,
        });
        canvas.addEventListener("pointerdown", (event) => {
            canvas.setPointerCapture(event.pointerId);
            this.drag = this.secondsAt(canvas, event.offsetX);
        });
        canvas.addEventListener("pointermove", (event) => this.hover(canvas, event.offsetX));
        canvas.addEventListener("pointerleave", () => (this.output.textContent = ""));
        canvas.addEventListener("pointerup", (event) => this.drop(canvas, event.offsetX));
        canvas.addEventListener("pointercancel", () => (this.drag = this.marked = undefined));
        canvas.addEventListener("keydown", (event) => this.key(event));
        return canvas;
    }

    /**
     * @param {HTMLCanvasElement} canvas
     * @param {number} x
     */
    secondsAt(canvas, x) {
        const [from, to] = this.model.span;
        const part = (x - LEFT) / Math.max(1, canvas.clientWidth - LEFT);
        return from + Math.min(1, Math.max(0, part)) * (to - from);
    }

    /**
     * @param {HTMLCanvasElement} canvas
     * @param {number} x
     */
    hover(canvas, x) {
        const seconds = this.secondsAt(canvas, x);
        this.output.textContent = `${duration(seconds)}: ${this.valuesAt(seconds).join(", ")}`;
        if (this.drag === undefined) return;
        this.marked = /** @type {[number, number]} */ (
            [this.drag, seconds].sort((a, b) => a - b)
        );
        this.draw();
    }

    /**
     * The values at a time, as text.
     *
     * @param {number} seconds
     */
    valuesAt(seconds) {
        return this.charts.map((chart) => {
            const found = valueAt(chart, seconds);
            const text = found === undefined ? "—" : number(found / chart.scale);
            return `${this.words[chart.title]} ${text} ${chart.unit}`;
        });
    }

    /**
     * @param {HTMLCanvasElement} canvas
     * @param {number} x
     */
    drop(canvas, x) {
        const [from, to] = this.marked ?? [0, 0];
        const [begin, end] = this.model.span;
        const isSpan = this.marked && to - from > (end - begin) / 100;
        const seconds = this.secondsAt(canvas, x);
        this.drag = this.marked = undefined;
        if (isSpan) this.model.show([from, to]);
        else this.model.goTo(seconds);
    }

    /** @param {KeyboardEvent} event */
    key(event) {
        const { model } = this;
        const [from, to] = model.span;
        const step = ((to - from) / 100) * (event.shiftKey ? 10 : 1);
        const acts = /** @type {Record<string, () => void>} */ ({
            ArrowLeft: () => model.goTo(model.seconds - step),
            ArrowRight: () => model.goTo(model.seconds + step),
            "+": () => this.zoom(0.5),
            "-": () => this.zoom(2),
            Escape: () => model.show(),
        });
        const act = acts[event.key];
        if (!act) return;
        event.preventDefault();
        act();
    }

    /** @param {number} factor of the span, around the present time */
    zoom(factor) {
        const { model } = this;
        const [from, to] = model.span;
        const half = ((to - from) * factor) / 2;
        const low = Math.max(0, model.seconds - half);
        model.show([low, Math.min(model.scene.seconds, low + 2 * half)]);
    }

    draw() {
        this.charts.forEach((chart, index) => this.drawOne(chart, this.canvases[index]));
        this.table.replaceChildren(...this.charts.map((chart) => this.rowOf(chart)));
    }

    /** @param {Chart} chart */
    rowOf(chart) {
        const { least, most, mean } = summary(chart, this.model.span);
        const cells = [least, most, mean].map((value) =>
            element("td", {}, Number.isFinite(value) ? number(value / chart.scale) : "—")
        );
        const name = `${this.words[chart.title]}, ${chart.unit}`;
        return element("tr", {}, element("th", { scope: "row" }, name), ...cells);
    }

    /**
     * @param {Chart} chart
     * @param {HTMLCanvasElement} canvas
     */
    drawOne(chart, canvas) {
        const { width, height, ratio } = fitCanvas(canvas);
        const context = canvas.getContext("2d");
        if (!context || width < LEFT) return;
        const look = lookOf(canvas);
        context.setTransform(ratio, 0, 0, ratio, 0, 0);
        context.fillStyle = look.ground;
        context.fillRect(0, 0, width, height);
        const { span, seconds } = this.model;
        const { least, most } = summary(chart, span);
        const [low, high] = [Math.min(0, least), Math.max(most, least + 1, 1)];
        const y = (/** @type {number} */ value) =>
            height - 6 - ((value - low) / (high - low)) * (height - 26);
        const x = (/** @type {number} */ time) =>
            LEFT + ((time - span[0]) / (span[1] - span[0] || 1)) * (width - LEFT);
        grid(context, look, chart, [low, high], y, width);
        context.save();
        context.beginPath();
        context.rect(LEFT, 0, width - LEFT, height);
        context.clip();
        for (const { band, kind } of chart.series) {
            context.strokeStyle = context.fillStyle = look.kinds[kind].colour;
            context.setLineDash(kind === JOG ? [2, 3] : []);
            bandOf(context, band, span, x, y);
        }
        context.setLineDash([]);
        this.marks(context, look, x, height, seconds);
        context.restore();
        context.font = "600 12px system-ui, sans-serif";
        context.textAlign = "left";
        context.fillStyle = look.ink;
        context.fillText(`${this.words[chart.title]}, ${chart.unit}`, LEFT + 6, 10);
    }

    /**
     * @param {CanvasRenderingContext2D} context
     * @param {import("husillo/viewer/look.js").Look} look
     * @param {(seconds: number) => number} x
     * @param {number} height
     * @param {number} seconds
     */
    marks(context, look, x, height, seconds) {
        if (this.marked) {
            context.globalAlpha = 0.25;
            context.fillStyle = look.accent;
            const [from, to] = this.marked.map(x);
            context.fillRect(from, 0, to - from, height);
            context.globalAlpha = 1;
        }
        context.strokeStyle = look.ink;
        context.lineWidth = 1.5;
        context.beginPath();
        context.moveTo(x(seconds), 0);
        context.lineTo(x(seconds), height);
        context.stroke();
    }
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {import("husillo/viewer/look.js").Look} look
 * @param {Chart} chart
 * @param {[number, number]} range
 * @param {(value: number) => number} y
 * @param {number} width
 */
function grid(context, look, chart, [low, high], y, width) {
    const step = roundUp((high - low) / chart.scale / 4) * chart.scale;
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.strokeStyle = look.line;
    context.fillStyle = look.soft;
    context.lineWidth = 1;
    context.beginPath();
    for (let mark = Math.ceil(low / step); mark * step <= high; mark++) {
        const at = Math.round(y(mark * step)) + 0.5;
        context.moveTo(LEFT, at);
        context.lineTo(width, at);
        context.fillText(number((mark * step) / chart.scale), LEFT - 6, at);
    }
    context.stroke();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {Band} band
 * @param {[number, number]} span
 * @param {(seconds: number) => number} x
 * @param {(value: number) => number} y
 */
function bandOf(context, band, span, x, y) {
    const [first, last] = columnsOf(band, span);
    context.lineWidth = 1.5;
    context.beginPath();
    let isOpen = false;
    for (let column = first; column < last; column++) {
        if (!band.isThere[column]) {
            isOpen = false;
            continue;
        }
        const [left, right] = [x(column * band.seconds), x((column + 1) * band.seconds)];
        const [top, bottom] = [y(band.high[column]), y(band.low[column])];
        if (isOpen) context.lineTo(left, top);
        else context.moveTo(left, top);
        context.lineTo(right, top);
        if (bottom - top > 1)
            context.fillRect(left, top, Math.max(1, right - left), bottom - top);
        isOpen = true;
    }
    context.stroke();
}

/**
 * @param {Band} band
 * @param {[number, number]} span
 */
function columnsOf(band, span) {
    const last = Math.min(band.high.length, Math.ceil(span[1] / band.seconds));
    return [Math.max(0, Math.floor(span[0] / band.seconds)), last];
}

/**
 * Least, most and mean of the largest values in a span, nm. The programmed feed is no measurement.
 *
 * @param {Chart} chart
 * @param {[number, number]} span
 */
export function summary(chart, span) {
    let [least, most, sum, count] = [Infinity, -Infinity, 0, 0];
    for (const { band } of chart.series) {
        if (band.name === "programmed") continue;
        const [first, last] = columnsOf(band, span);
        for (let column = first; column < last; column++) {
            if (!band.isThere[column]) continue;
            least = Math.min(least, band.low[column]);
            most = Math.max(most, band.high[column]);
            sum += (band.low[column] + band.high[column]) / 2;
            count++;
        }
    }
    return { least, most, mean: sum / count };
}

/**
 * @param {Chart} chart
 * @param {number} seconds
 */
export function valueAt(chart, seconds) {
    for (const { band } of [...chart.series].reverse()) {
        const column = Math.min(Math.floor(seconds / band.seconds), band.high.length - 1);
        if (band.isThere[column] && band.name !== "programmed") {
            const [low, high] = [band.low[column], band.high[column]];
            return Math.abs(low) > Math.abs(high) ? low : high;
        }
    }
    return undefined;
}

/**
 * A number with four digits that count.
 *
 * @param {number} value
 */
function number(value) {
    return trimmed(value, Math.max(0, 3 - Math.floor(Math.log10(Math.abs(value) || 1))));
}
