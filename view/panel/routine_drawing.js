/**
 * The drawing of a routine: where its features and touches should be, and what was measured.
 * Verdicts have a colour and a sign.
 */

import { button, element } from "husillo/viewer/element.js";

/** @typedef {import("husillo/panel/words.js").Words} Words */

/**
 * @typedef {object} Sketch a feature before it is measured, mm
 * @property {string} kind
 * @property {string} feature
 * @property {number} line
 * @property {number} coordinates_from the line from which its coordinates are in force
 * @property {{at: number[], towards: number[]}[]} touches
 * @property {{centre: number[], diameter: number} | null} round
 *
 * @typedef {object} Dimension
 * @property {string} figure
 * @property {string} unit
 * @property {number} actual
 * @property {number} [nominal]
 * @property {number} [deviation]
 * @property {boolean | null} [in_tolerance]
 *
 * @typedef {object} Feature what was measured
 * @property {string} feature
 * @property {string} kind
 * @property {number} line
 * @property {boolean} in_tolerance
 * @property {Dimension[]} dimensions
 * @property {{x: number, y: number, z: number, residual: number}[]} points
 */

const SVG = "http://www.w3.org/2000/svg";
/** The planes: the axis to the right, and the one up. */
const PLANES = /** @type {const} */ ({ XY: [0, 1], XZ: [0, 2], YZ: [1, 2] });
/** Size of the drawing, and its margin, in its own units. */
const [WIDTH, HEIGHT, MARGIN] = [640, 400, 30];
/** Length of the arrow of a touch. */
const ARROW = 14;

/** @typedef {keyof typeof PLANES} Plane */

/** The drawing. */
export class RoutineDrawing {
    /** @param {Words} words */
    constructor(words) {
        this.words = words;
        /** @type {Plane} */
        this.plane = "XY";
        /** @type {Sketch[]} */
        this.sketch = [];
        /** @type {Feature[]} */
        this.features = [];
        /** The line that is carried out. @type {number | null} */
        this.line = null;
        /** Features before and after a change of the frame are not drawn together. */
        this.frames = element("select", { "aria-label": words.drawingCoordinates });
        this.frames.addEventListener("change", () => {
            this.chosen = Number(this.frames.value);
            this.show();
        });
        /** The line from which the chosen coordinates are in force. @type {number | null} */
        this.chosen = null;
        this.choice = element(
            "label",
            { class: "field" },
            words.drawingCoordinates,
            this.frames
        );
        this.key = "";
        this.svg = svg("svg", {
            class: "routine-drawing",
            role: "img",
            viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
        });
        this.planes = /** @type {Plane[]} */ (Object.keys(PLANES)).map((plane) => ({
            plane,
            button: button(plane, () => {
                this.plane = plane;
                this.show();
            }),
        }));
        this.empty = element("p", { class: "soft" }, words.drawingEmpty);
        this.root = element(
            "div",
            {},
            element(
                "div",
                { class: "items" },
                ...this.planes.map((one) => one.button),
                this.choice
            ),
            this.svg,
            this.empty,
            element("p", { class: "soft" }, words.drawingHelp)
        );
        this.show();
    }

    /** The lines from which coordinates with features are in force. */
    get starts() {
        return [...new Set(this.sketch.map((one) => one.coordinates_from))];
    }

    /** The chosen coordinates, or those of the line that is carried out, or the last ones. */
    get from() {
        const { starts, chosen, line } = this;
        if (chosen !== null && starts.includes(chosen)) return chosen;
        return starts.filter((start) => line === null || start <= line).pop() ?? starts[0];
    }

    /** Shows between which coordinates there is a choice. */
    showFrames() {
        const { starts, frames, from } = this;
        this.choice.hidden = starts.length < 2;
        if (frames.dataset.starts !== starts.join()) {
            frames.dataset.starts = starts.join();
            frames.replaceChildren(
                ...starts.map((start) => element("option", { value: start }, String(start)))
            );
        }
        frames.value = String(from);
    }

    /** Draws what has changed. */
    show() {
        const { plane, features, line, words, from } = this;
        this.showFrames();
        const sketch = this.sketch.filter((one) => one.coordinates_from === from);
        for (const one of this.planes) {
            one.button.setAttribute("aria-pressed", String(one.plane === plane));
        }
        const key = JSON.stringify([plane, sketch, features, line]);
        if (key === this.key) return;
        this.key = key;
        this.empty.hidden = sketch.length > 0;
        this.svg.toggleAttribute("hidden", sketch.length === 0);
        const good = features.filter((one) => one.in_tolerance).length;
        const label = `${words.drawing} ${plane}: ${this.sketch.length} ${words.features}, ` +
            `${features.length} ${words.measuredCount}, ${good} ${words.goodCount}`;
        this.svg.setAttribute("aria-label", label);
        this.draw(sketch);
    }

    /** @param {Sketch[]} sketch */
    draw(sketch) {
        const { features, line } = this;
        const [across, up] = PLANES[this.plane];
        const all = sketch.flatMap(({ touches, round }) => {
            const points = touches.map(({ at }) => [at[across], at[up]]);
            if (!round) return points;
            const { centre, diameter } = round;
            const half = diameter / 2;
            return [
                ...points,
                [centre[across] - half, centre[up] - half],
                [centre[across] + half, centre[up] + half],
            ];
        });
        const bounds = [0, 1].map((axis) => {
            const values = all.map((point) => point[axis]);
            return [Math.min(...values, Infinity), Math.max(...values, -Infinity)];
        });
        const span = bounds.map(([low, high]) => Math.max(high - low, 1));
        const scale = Math.min((WIDTH - 2 * MARGIN) / span[0], (HEIGHT - 2 * MARGIN) / span[1]);
        const middle = bounds.map(([low, high]) => (low + high) / 2);
        const place = (/** @type {number} */ a, /** @type {number} */ b) => [
            WIDTH / 2 + (a - middle[0]) * scale,
            HEIGHT / 2 - (b - middle[1]) * scale,
        ];
        const parts = sketch.map((one) => {
            const found = features.find(({ feature }) => feature === one.feature);
            const verdict = found ? (found.in_tolerance ? "good" : "bad") : "";
            const group = svg("g", {
                class: [verdict, one.line === line ? "now" : ""].filter(Boolean).join(" "),
                "data-feature": one.feature,
            });
            if (one.round && this.plane === "XY") {
                const [cx, cy] = place(one.round.centre[across], one.round.centre[up]);
                const r = (one.round.diameter / 2) * scale;
                group.append(svg("circle", { cx, cy, r, class: "shape" }));
            }
            for (const { at, towards } of one.touches) {
                const [x, y] = place(at[across], at[up]);
                const size = Math.hypot(...towards) || 1;
                const [dx, dy] = [towards[across] / size, -towards[up] / size];
                if (Math.hypot(dx, dy) > 0.1) {
                    const [x1, y1] = [x - dx * ARROW, y - dy * ARROW];
                    group.append(svg("line", { x1, y1, x2: x, y2: y }));
                }
                group.append(svg("circle", { cx: x, cy: y, r: 2.5 }));
            }
            for (const point of found?.points ?? []) {
                const at = [point.x, point.y, point.z];
                const [x, y] = place(at[across], at[up]);
                group.append(svg("path", { d: `M${x - 4} ${y - 4}l8 8m0 -8l-8 8`, class: "mark" }));
            }
            const [first] = one.touches;
            const at = one.round?.centre ?? first.at;
            const [x, y] = place(at[across], at[up]);
            const sign = verdict === "good" ? " ✓" : verdict === "bad" ? " ✗" : "";
            const text = svg("text", { x: x + 6, y: y - 6 });
            text.textContent = one.feature + sign;
            group.append(text);
            return group;
        });
        this.svg.replaceChildren(...parts);
    }
}

/**
 * @param {string} tag
 * @param {Record<string, string | number>} attributes
 */
function svg(tag, attributes) {
    const made = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
    return made;
}
