/**
 * The picture of the path: 3D and three plane views, with the pointer and from the keyboard.
 */

import { Camera, VIEWS } from "husillo/viewer/camera.js";
import { CanvasRenderer } from "husillo/viewer/canvas.js";
import { button, element, fitCanvas } from "husillo/viewer/element.js";
import { lookOf } from "husillo/viewer/look.js";
import { overlay } from "husillo/viewer/overlay.js";
import { ends } from "husillo/viewer/path.js";
import { nearest } from "husillo/viewer/pick.js";
import { length } from "husillo/viewer/quantity.js";
import { Box, boxOf, levelFor, levelsOf, segmentsOf } from "husillo/viewer/segments.js";
import { WebGlRenderer } from "husillo/viewer/webgl.js";

/** @typedef {import("husillo/viewer/model.js").Model} Model */
/** @typedef {import("husillo/viewer/words.js").Words} Words */

/** After this time without a change the picture is at rest, milliseconds. */
const REST = 160;
/** How near to a line a click counts, pixels. */
const NEAR = 10;

/** The picture. */
export class PathView {
    /**
     * @param {Model} model
     * @param {Words} words
     * @param {{renderer?: "canvas" | "webgl"}} [options] the renderer, if it is not to be chosen
     */
    constructor(model, words, options = {}) {
        this.model = model;
        this.words = words;
        this.camera = new Camera();
        this.box = boxOf(model.scene);
        this.centre = this.box.centre;
        this.whole = segmentsOf(model.scene, this.centre);
        /** @type {number[][]} */
        this.measured = [];
        this.isMeasuring = false;
        this.path = element("canvas", { class: "path", "aria-hidden": "true" });
        this.over = element("canvas", { role: "img" });
        this.stage = element(
            "div",
            {
                class: "stage",
                tabindex: 0,
                role: "application",
                "aria-label": `${words.path}. ${words.pathHelp}`,
            },
            this.path,
            this.over
        );
        this.bar = this.makeBar();
        this.root = element("div", { class: "path-view" }, this.bar, this.stage);
        const { renderer } = options;
        const webgl =
            renderer === "canvas" ? undefined : WebGlRenderer.of(this.path, !!renderer);
        this.renderer = webgl ?? new CanvasRenderer(this.path);
        /** @type {import("husillo/viewer/segments.js").Level[] | undefined} */
        this.levels = undefined;
        this.timer = 0;
        this.frame = 0;
        this.pointers = new Map();
        this.listen();
    }

    makeBar() {
        const { words } = this;
        const views = /** @type {import("husillo/viewer/camera.js").View[]} */ (
            Object.keys(VIEWS)
        );
        this.views = views.map((view) => button(view, () => this.look(view)));
        this.measureButton = button(words.measure, () => this.measure(), {
            "aria-pressed": "false",
        });
        this.note = element("span", { class: "note", role: "status" });
        return element(
            "div",
            { class: "bar", role: "toolbar", "aria-label": words.view },
            ...this.views,
            button(words.fitPart, () => this.fitPart()),
            button(words.fitTable, () => this.fitTable()),
            button("+", () => this.zoom(1.4), { "aria-label": words.zoomIn }),
            button("−", () => this.zoom(1 / 1.4), { "aria-label": words.zoomOut }),
            this.measureButton,
            this.note
        );
    }

    listen() {
        const { stage, model } = this;
        stage.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
        stage.addEventListener("pointerdown", (event) => this.press(event));
        stage.addEventListener("pointermove", (event) => this.drag(event));
        for (const name of /** @type {const} */ (["pointerup", "pointercancel"])) {
            stage.addEventListener(name, (event) => this.release(event));
        }
        stage.addEventListener("keydown", (event) => this.key(event));
        stage.addEventListener("contextmenu", (event) => event.preventDefault());
        const theme = matchMedia("(prefers-color-scheme: dark)");
        theme.addEventListener("change", () => this.draw());
        model.listen(() => this.drawOver());
        new ResizeObserver(() => this.resized()).observe(stage);
    }

    resized() {
        const { width, height } = fitCanvas(this.over);
        fitCanvas(this.path);
        const isFirst = this.camera.width === 1;
        [this.camera.width, this.camera.height] = [width, height];
        if (isFirst) {
            this.look(this.isFlat ? "XY" : "3D");
        }
        this.draw();
    }

    /** Whether the part is so flat that it is seen best from above. */
    get isFlat() {
        const [x, y, z] = this.box.low.map((low, axis) => this.box.high[axis] - low);
        return z < 0.1 * Math.max(x, y);
    }

    /** @param {import("husillo/viewer/camera.js").View} view */
    look(view) {
        this.camera.look(view);
        this.fitPart();
    }

    fitPart() {
        this.camera.fit(this.box);
        this.draw();
    }

    fitTable() {
        const box = new Box();
        const limits = [0, 1, 2].map((axis) => this.model.scene.axes[axis]?.travel_nm);
        for (const side of [0, 1]) {
            box.add(
                limits.map(
                    (limit, axis) => limit?.[side] ?? [this.box.low, this.box.high][side][axis]
                )
            );
        }
        this.camera.fit(box);
        this.draw();
    }

    /** @param {number} factor */
    zoom(factor) {
        this.camera.zoom(factor);
        this.moved();
    }

    /** Begins or ends to measure. */
    measure() {
        this.isMeasuring = !this.isMeasuring;
        this.measured = [];
        this.measureButton?.setAttribute("aria-pressed", String(this.isMeasuring));
        this.say(this.isMeasuring ? this.words.measureHelp : "");
        this.drawOver();
    }

    /** @param {string} text */
    say(text) {
        if (this.note) this.note.textContent = text;
    }

    /** The camera has moved: draws what the pixels show, and the whole when it rests. */
    moved() {
        clearTimeout(this.timer);
        this.timer = window.setTimeout(() => this.draw(), REST);
        if (this.frame) return;
        this.frame = requestAnimationFrame(() => {
            this.frame = 0;
            this.drawMoving();
        });
    }

    /** Draws the reduced picture. */
    drawMoving() {
        const { camera, renderer, box } = this;
        const size = Math.max(1, ...box.low.map((low, axis) => box.high[axis] - low));
        this.levels ??= levelsOf(this.whole, size, renderer.most);
        const { levels } = this;
        const { segments } = levelFor(levels, 1 / camera.scale, renderer.most);
        renderer.draw(segments, this.centre, camera, lookOf(this.stage));
        this.drawOver();
    }

    /** Draws the whole picture. */
    draw() {
        clearTimeout(this.timer);
        this.stage.dataset.drawn = "no";
        this.renderer.draw(this.whole, this.centre, this.camera, lookOf(this.stage), () => {
            this.stage.dataset.drawn = "whole";
        });
        this.drawOver();
    }

    drawOver() {
        const context = this.over.getContext("2d");
        if (!context || this.camera.width === 1) return;
        const { scene, moves } = this.model;
        const ratio = this.over.width / this.camera.width;
        context.setTransform(ratio, 0, 0, ratio, 0, 0);
        const { commanded, real } = this.model.place;
        overlay(context, scene, this.camera, lookOf(this.stage), {
            selected: moves,
            commanded,
            real,
            measured: this.measured,
        });
        const { view } = this.camera;
        for (const one of this.views ?? []) {
            one.setAttribute("aria-pressed", String(one.textContent === view));
        }
        this.over.setAttribute("aria-label", this.summary());
    }

    /** The picture as text. */
    summary() {
        const { scene } = this.model;
        const extents = [0, 1, 2]
            .filter((axis) => scene.axes[axis])
            .map((axis) => {
                const zero = scene.axes[axis].zero_nm;
                const [low, high] = [this.box.low[axis] - zero, this.box.high[axis] - zero];
                const { from, to } = this.words;
                return `${scene.axes[axis].letter} ${from} ${length(low)} ${to} ${length(high)}`;
            });
        return this.box.isEmpty
            ? this.words.noMoves
            : `${this.words.path}: ${extents.join(", ")}`;
    }

    /** @param {WheelEvent} event */
    wheel(event) {
        event.preventDefault();
        const [x, y] = this.where(event);
        this.camera.zoom(Math.exp(-event.deltaY * 0.0015), x, y);
        this.moved();
    }

    /**
     * @param {MouseEvent} event
     * @returns {[number, number]}
     */
    where(event) {
        const frame = this.stage.getBoundingClientRect();
        return [event.clientX - frame.left, event.clientY - frame.top];
    }

    /** @param {PointerEvent} event */
    press(event) {
        this.stage.setPointerCapture(event.pointerId);
        this.pointers.set(event.pointerId, this.where(event));
        this.hasDragged = this.pointers.size > 1;
    }

    /** @param {PointerEvent} event */
    drag(event) {
        const last = this.pointers.get(event.pointerId);
        if (!last) return;
        const at = this.where(event);
        const [dx, dy] = [at[0] - last[0], at[1] - last[1]];
        if (!this.hasDragged && Math.hypot(dx, dy) < 4) return;
        this.hasDragged = true;
        if (this.pointers.size === 2) this.pinch(event.pointerId, at);
        else if (this.turns(event)) this.camera.orbit(-dx * 0.008, -dy * 0.008);
        else this.camera.pan(dx, dy);
        this.pointers.set(event.pointerId, at);
        this.moved();
    }

    /**
     * Whether a drag turns the picture: with the right button or Shift, in 3D with the left one.
     *
     * @param {PointerEvent} event
     */
    turns(event) {
        const isTurned = this.camera.view === undefined || this.camera.view === "3D";
        const asks = event.shiftKey || (event.buttons & 2) !== 0;
        return asks !== (isTurned && (event.buttons & 4) === 0);
    }

    /**
     * @param {number} id
     * @param {[number, number]} at
     */
    pinch(id, at) {
        const [[, other]] = [...this.pointers].filter(([one]) => one !== id);
        const last = this.pointers.get(id);
        const before = Math.hypot(last[0] - other[0], last[1] - other[1]);
        const now = Math.hypot(at[0] - other[0], at[1] - other[1]);
        const middle = [(at[0] + other[0]) / 2, (at[1] + other[1]) / 2];
        if (before > 0) this.camera.zoom(now / before, middle[0], middle[1]);
        this.camera.pan((at[0] - last[0]) / 2, (at[1] - last[1]) / 2);
    }

    /** @param {PointerEvent} event */
    release(event) {
        const wasClick = this.pointers.delete(event.pointerId) && !this.hasDragged;
        if (!wasClick || event.type !== "pointerup") return;
        const [x, y] = this.where(event);
        const found = nearest(this.whole, this.centre, this.camera, x, y, NEAR);
        if (this.isMeasuring)
            this.mark(found ? this.held(found, x, y) : this.camera.under(x, y));
        else if (found) this.model.selectMove(found.move);
    }

    /**
     * The end of a move, if it is near to the pointer, else the point on the move.
     *
     * @param {import("husillo/viewer/pick.js").Found} found
     * @param {number} x
     * @param {number} y
     */
    held(found, x, y) {
        const far = (/** @type {number[]} */ at) => {
            const [u, v] = this.camera.project(at);
            return Math.hypot(u - x, v - y);
        };
        const [near] = ends(this.model.scene, found.move).sort((a, b) => far(a) - far(b));
        return far(near) <= NEAR ? near : found.at;
    }

    /** @param {number[]} at */
    mark(at) {
        this.measured = this.measured.length === 1 ? [this.measured[0], at] : [at];
        if (this.measured.length === 2) {
            const [from, to] = this.measured;
            const parts = ["X", "Y", "Z"].map(
                (name, axis) => `${name} ${length(to[axis] - from[axis])}`
            );
            const whole = length(Math.hypot(...from.map((part, axis) => to[axis] - part)));
            this.say(`${this.words.measured} ${whole}: ${parts.join(", ")}`);
        }
        this.drawOver();
    }

    /** @param {KeyboardEvent} event */
    key(event) {
        if (event.ctrlKey || event.altKey || event.metaKey) return;
        const act = this.actOf(event);
        if (!act) return;
        event.preventDefault();
        act();
    }

    /**
     * @param {KeyboardEvent} event
     * @returns {(() => void) | undefined}
     */
    actOf({ key, shiftKey }) {
        const arrows = /** @type {Record<string, [number, number]>} */ ({
            ArrowLeft: [1, 0],
            ArrowRight: [-1, 0],
            ArrowUp: [0, 1],
            ArrowDown: [0, -1],
        });
        const arrow = arrows[key];
        if (arrow) {
            const [x, y] = arrow;
            return () => {
                if (shiftKey) this.camera.orbit(x * 0.12, y * 0.12);
                else this.camera.pan(x * 40, y * 40);
                this.moved();
            };
        }
        switch (key.toLowerCase()) {
            case "+":
            case "=":
                return () => this.zoom(1.25);
            case "-":
                return () => this.zoom(0.8);
            case "f":
                return () => this.fitPart();
            case "t":
                return () => this.fitTable();
            case "m":
                return () => this.measure();
            default:
                return undefined;
        }
    }
}
