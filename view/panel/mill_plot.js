/**
 * The live plot of the micro mill, of the microfactory and of measuring machines: each motion is
 * drawn while it is made, in the three colours of the original mill. Jogs and steps are grey,
 * rapids and homing yellow, feeds blue; patterns carry the meaning without colour.
 */

import { button, element } from "husillo/viewer/element.js";
import { put } from "husillo/panel/change.js";
import { lookOf } from "husillo/viewer/look.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/words.js").Words} Words */

/** The planes: the axis to the right, and the one up. */
const PLANES = /** @type {const} */ ({ XY: [0, 1], XZ: [0, 2], YZ: [1, 2] });
/** Margin around what is shown, as a part of it. */
const MARGIN = 0.08;
/** Least width of what is shown, mm. */
const LEAST_MM = 0.05;
/** Height of the picture as a part of its width. */
const SHAPE = 0.62;

/** @typedef {keyof typeof PLANES} Plane */

/** The plot. */
export class MillPlot {
    /**
     * @param {Desk} desk
     * @param {Words} words
     */
    constructor(desk, words) {
        this.desk = desk;
        this.words = words;
        /** The plane that the operator has chosen. @type {Plane | undefined} */
        this.chosen = undefined;
        this.isWhole = false;
        this.isDue = false;
        this.canvas = element("canvas", { role: "img", class: "mill-plot" });
        this.planes = /** @type {Plane[]} */ (Object.keys(PLANES)).map((plane) => ({
            plane,
            button: button(plane, () => {
                this.chosen = plane;
                this.show();
            }),
        }));
        this.fitPath = button(words.fitPath, () => this.fit(false));
        this.fitArea = button(words.fitArea, () => this.fit(true));
        this.text = element("p", { class: "soft number" });
        const names = /** @type {[string, string][]} */ ([
            ["jog", words.plotJog],
            ["rapid", words.plotRapid],
            ["feed", words.plotFeed],
        ]);
        this.root = element(
            "section",
            { class: "card", "aria-label": words.plot },
            element("h2", {}, words.plot),
            element(
                "div",
                { class: "items" },
                ...this.planes.map((one) => one.button),
                this.fitPath,
                this.fitArea
            ),
            this.canvas,
            this.text,
            element(
                "ul",
                { class: "legend" },
                ...names.map(([kind, name]) => element("li", { class: kind }, name))
            )
        );
        desk.listen(() => this.show());
        new ResizeObserver(() => this.later()).observe(this.canvas);
        window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () =>
            this.later()
        );
        this.show();
    }

    /** The plane that is shown: at first that of the figures of the machine. @returns {Plane} */
    get plane() {
        return this.chosen ?? (this.desk.family === "microfactory" ? "XZ" : "XY");
    }

    /** @param {boolean} isWhole */
    fit(isWhole) {
        this.isWhole = isWhole;
        this.show();
    }

    show() {
        const { desk, words } = this;
        // The path of one axis is no picture.
        const isFlat = (desk.machine?.info.axes.length ?? 0) > 1;
        const families = ["micromill", "microfactory", "measuring"];
        this.root.hidden = !families.includes(desk.family) || !isFlat;
        if (this.root.hidden) return;
        for (const { plane, button } of this.planes) {
            button.setAttribute("aria-pressed", String(plane === this.plane));
        }
        this.fitPath.setAttribute("aria-pressed", String(!this.isWhole));
        this.fitArea.setAttribute("aria-pressed", String(this.isWhole));
        this.fitArea.hidden = !desk.machine?.info.travel_mm;
        const count = desk.machine?.path.length ?? 0;
        const from = desk.state?.machine_mm ? words.fromMachineZero : words.fromPowerOn;
        put(this.text, `${this.plane}, ${from}: ${count} ${words.points}`);
        const label = `${words.plot}: ${this.text.textContent}`;
        if (this.canvas.getAttribute("aria-label") !== label) {
            this.canvas.setAttribute("aria-label", label);
        }
        this.later();
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

    /** Least and greatest of both axes of the plane, mm. */
    bounds() {
        const { desk, isWhole } = this;
        const axes = PLANES[this.plane];
        const travel = desk.machine?.info.travel_mm ?? [];
        const path = desk.machine?.path ?? [];
        return axes.map((axis) => {
            const area = travel[axis];
            let [least, most] = isWhole && area ? area : [Infinity, -Infinity];
            for (const point of path) {
                const mm = point[axis + 1] / 1e6;
                if (mm < least) least = mm;
                if (mm > most) most = mm;
            }
            if (least > most) [least, most] = [0, 1];
            const middle = (least + most) / 2;
            const half = Math.max(most - least, LEAST_MM) / 2;
            return { middle, half: half * (1 + MARGIN) };
        });
    }

    draw() {
        const { canvas, desk } = this;
        const context = canvas.getContext("2d");
        if (!context) return;
        const ratio = window.devicePixelRatio || 1;
        const width = canvas.clientWidth;
        const height = Math.round(width * SHAPE);
        if (width === 0) return;
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
        const place = (/** @type {number} */ a, /** @type {number} */ b) =>
            /** @type {[number, number]} */ ([
                width / 2 + (a - across.middle) * scale,
                height / 2 - (b - up.middle) * scale,
            ]);
        this.drawArea(context, look, place);
        this.drawPath(context, look, place);
        const at = desk.machine?.path.at(-1);
        if (at) this.drawTool(context, look, place, at);
    }

    /**
     * The work area, once its place is known.
     *
     * @param {CanvasRenderingContext2D} context
     * @param {import("husillo/viewer/look.js").Look} look
     * @param {(a: number, b: number) => [number, number]} place
     */
    drawArea(context, look, place) {
        const { desk } = this;
        const [a, b] = PLANES[this.plane].map((axis) => desk.machine?.info.travel_mm?.[axis]);
        if (!a || !b || !desk.state?.mill?.is_homed) return;
        const [left, bottom] = place(a[0], b[0]);
        const [right, top] = place(a[1], b[1]);
        context.setLineDash([]);
        context.lineWidth = 1;
        context.strokeStyle = look.soft;
        context.strokeRect(left, top, right - left, bottom - top);
    }

    /**
     * @param {CanvasRenderingContext2D} context
     * @param {import("husillo/viewer/look.js").Look} look
     * @param {(a: number, b: number) => [number, number]} place
     */
    drawPath(context, look, place) {
        const path = this.desk.machine?.path ?? [];
        const [across, up] = PLANES[this.plane];
        let kind = -1;
        context.beginPath();
        const stroke = () => {
            const pen = look.kinds[kind];
            if (!pen) return;
            context.strokeStyle = pen.colour;
            context.lineWidth = pen.width;
            context.setLineDash(pen.dash);
            context.stroke();
        };
        path.forEach((point, index) => {
            const now = point[0];
            const here = place(point[across + 1] / 1e6, point[up + 1] / 1e6);
            if (now < 0) {
                stroke();
                kind = now;
                context.beginPath();
                context.moveTo(...here);
                return;
            }
            if (now !== kind) {
                stroke();
                kind = now;
                context.beginPath();
                const before = path[index - 1] ?? point;
                context.moveTo(...place(before[across + 1] / 1e6, before[up + 1] / 1e6));
            }
            context.lineTo(...here);
        });
        stroke();
    }

    /**
     * @param {CanvasRenderingContext2D} context
     * @param {import("husillo/viewer/look.js").Look} look
     * @param {(a: number, b: number) => [number, number]} place
     * @param {number[]} at
     */
    drawTool(context, look, place, at) {
        const [across, up] = PLANES[this.plane];
        // The state is newer than the last point of the path.
        const now = this.desk.state?.machine_mm ?? at.slice(1).map((nm) => nm / 1e6);
        const [x, y] = place(now[across], now[up]);
        context.setLineDash([]);
        context.lineWidth = 2;
        context.strokeStyle = look.ink;
        context.beginPath();
        context.moveTo(x - 8, y);
        context.lineTo(x + 8, y);
        context.moveTo(x, y - 8);
        context.lineTo(x, y + 8);
        context.stroke();
    }
}
