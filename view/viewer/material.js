/**
 * The material from above, at the present time: depth, cuts that are too deep, material that was
 * left, cuts in a rapid.
 */

import { button, element, fitCanvas } from "husillo/viewer/element.js";
import { lookOf, parts } from "husillo/viewer/look.js";
import { length, trimmed } from "husillo/viewer/quantity.js";
import { roundUp } from "husillo/viewer/rulers.js";
import { boxOf } from "husillo/viewer/segments.js";
import { Cutting } from "husillo/viewer/stock.js";

/** @typedef {import("husillo/viewer/model.js").Model} Model */
/** @typedef {import("husillo/viewer/words.js").Words} Words */

/** The part is this many tools wide if its tool is not known. */
const TOOLS_WIDE = 30;

/** The material. */
export class Material {
    /**
     * @param {Model} model
     * @param {Words} words
     */
    constructor(model, words) {
        this.model = model;
        this.words = words;
        this.box = boxOf(model.scene);
        const wide = Math.max(
            1,
            ...[0, 1].map((axis) => this.box.high[axis] - this.box.low[axis])
        );
        const diameter = model.scene.toolDiameter ?? roundUp(wide / TOOLS_WIDE);
        this.input = element("input", {
            type: "number",
            min: 0,
            step: "any",
            value: diameter / 1e6,
            onchange: () => this.begin(),
        });
        this.canvas = element("canvas", { class: "material", role: "img" });
        this.text = element("p", { class: "found" });
        /** @type {Cutting | undefined} */
        this.cutting = undefined;
        this.frame = 0;
        this.body = element("div", { hidden: true }, this.canvas, this.text);
        const label = element("label", {}, `${words.diameter}, mm `, this.input);
        this.root = element(
            "section",
            { class: "cutting", "aria-label": words.cutting },
            element(
                "div",
                { class: "bar" },
                element("h3", {}, words.cutting),
                label,
                button(words.stock, () => this.begin())
            ),
            this.body
        );
        model.listen(() => this.later());
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () =>
            this.later()
        );
    }

    /** Begins with the diameter of the input. */
    begin() {
        const { scene } = this.model;
        const diameter = Number(this.input.value) * 1e6;
        if (!(diameter > 0) || this.box.isEmpty) return;
        this.cutting = new Cutting(scene, this.box, diameter, scene.axes[2]?.zero_nm ?? 0);
        this.body.hidden = false;
        this.later();
    }

    /** Draws with the next picture, once for all changes before it. */
    later() {
        if (!this.cutting || this.frame) return;
        this.frame = requestAnimationFrame(() => {
            this.frame = 0;
            this.draw();
        });
    }

    /** Differences below this are no faults: two steps, nm. */
    get tolerance() {
        return 2 * Math.max(...this.model.scene.axes.map((axis) => axis.step_nm));
    }

    draw() {
        const { cutting, canvas, words } = this;
        const context = canvas.getContext("2d");
        if (!cutting || !context) return;
        cutting.goTo(this.model.seconds);
        const { columns, rows } = cutting.real;
        canvas.style.aspectRatio = `${columns} / ${rows}`;
        const { width, height } = fitCanvas(canvas);
        const picture = document.createElement("canvas");
        [picture.width, picture.height] = [columns, rows];
        picture.getContext("2d")?.putImageData(this.image(), 0, 0);
        const ratio = canvas.width / width;
        context.setTransform(ratio, 0, 0, ratio, 0, 0);
        context.imageSmoothingEnabled = false;
        context.drawImage(picture, 0, 0, width, height);
        const found = cutting.faults(this.tolerance);
        const area = (/** @type {number} */ square) => `${trimmed(square / 1e12, 2)} mm²`;
        this.text.textContent = [
            `${words.removed} ${trimmed(cutting.real.removed / 1e18, 3)} mm³`,
            `${words.gouge} ${area(found.gouge)}, ${length(found.deepest)}`,
            `${words.uncut} ${area(found.uncut)}, ${length(found.highest)}`,
            `${words.crossed} ${area(found.crossed)}`,
        ].join("; ");
        canvas.setAttribute("aria-label", `${words.cutting}: ${this.text.textContent}`);
    }

    /** One pixel per cell, Y up. Faults have stripes, so that they do not depend on colour. */
    image() {
        const cutting = /** @type {Cutting} */ (this.cutting);
        const { columns, rows, heights, top } = cutting.real;
        const look = lookOf(this.canvas);
        const [stock, deep] = [parts(look.line), parts(look.kinds[2].colour)];
        const faults = { gouge: parts(look.limit), uncut: parts(look.kinds[1].colour) };
        let least = top - 1;
        for (const height of heights) least = Math.min(least, height);
        const image = new ImageData(columns, rows);
        const { tolerance } = this;
        for (let row = 0; row < rows; row++) {
            for (let column = 0; column < columns; column++) {
                const cell = row * columns + column;
                const fault = cutting.fault(cell, tolerance);
                const slope = fault === "uncut" ? column + row : column - row;
                const isStripe = fault && ((slope % 6) + 6) % 6 < 3;
                const depth = (top - heights[cell]) / (top - least);
                // Light from the upper left.
                const next = heights[cell + 1] ?? heights[cell];
                const shade =
                    1 - Math.max(-0.25, Math.min(0.25, (heights[cell] - next) / (top - least)));
                const at = ((rows - 1 - row) * columns + column) * 4;
                for (let part = 0; part < 3; part++) {
                    const plain = stock[part] + (deep[part] - stock[part]) * depth;
                    const marked = fault === "uncut" ? faults.uncut[part] : faults.gouge[part];
                    image.data[at + part] =
                        255 * (isStripe ? marked : Math.min(1, plain * shade));
                }
                image.data[at + 3] = 255;
            }
        }
        return image;
    }
}
