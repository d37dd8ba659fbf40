/**
 * The values at an instant, as text: positions, speeds, modal state.
 */

import { element } from "husillo/viewer/element.js";
import { Modal } from "husillo/viewer/modal.js";
import { length, millimetres, trimmed } from "husillo/viewer/quantity.js";
import { KINDS } from "husillo/viewer/scene.js";
import { kindName } from "husillo/viewer/words.js";

/** @typedef {import("husillo/viewer/model.js").Model} Model */
/** @typedef {import("husillo/viewer/words.js").Words} Words */

/** The letters of axes that turn. Their unit is the degree. */
const ROTARY = "ABC";

/** The values. */
export class Values {
    /**
     * @param {Model} model
     * @param {Words} words
     */
    constructor(model, words) {
        this.model = model;
        this.words = words;
        this.modal = new Modal(model.scene.lines);
        this.rows = element("tbody");
        this.list = element("dl");
        const heads = [words.axis, words.work, words.machine, words.lag];
        this.root = element(
            "section",
            { class: "values", "aria-label": words.values },
            element("h3", {}, words.values),
            element(
                "table",
                {},
                element(
                    "thead",
                    {},
                    element(
                        "tr",
                        {},
                        ...heads.map((text) => element("th", { scope: "col" }, text))
                    )
                ),
                this.rows
            ),
            this.list
        );
        model.listen(() => this.show());
        this.show();
    }

    show() {
        const { scene, seconds, line, place } = this.model;
        const { commanded, real, move } = place;
        this.rows.replaceChildren(
            ...scene.axes.map((axis, index) => {
                const isRotary = ROTARY.includes(axis.letter);
                const lag = real[index] - commanded[index];
                const cells = [
                    millimetres(real[index] - axis.zero_nm),
                    millimetres(real[index]),
                    isRotary ? trimmed(lag / 1e6, 4) : length(lag),
                ];
                return element(
                    "tr",
                    {},
                    element("th", { scope: "row" }, axis.letter),
                    ...cells.map((text) => element("td", {}, text))
                );
            })
        );
        this.list.replaceChildren(
            ...this.facts(move, seconds, line).map(([name, value]) =>
                element("div", {}, element("dt", {}, name), element("dd", {}, value))
            )
        );
    }

    /**
     * @param {number} move
     * @param {number} seconds
     * @param {number} line
     * @returns {[string, string][]}
     */
    facts(move, seconds, line) {
        const { scene } = this.model;
        const { words } = this;
        if (move < 0) return [[words.move, words.start]];
        const stand = this.standAt(move, seconds);
        const isMoving = seconds <= scene.end[move];
        const kind = kindName(words, KINDS[scene.kind[move]]);
        const feed = scene.feed[move]
            ? `F ${trimmed((scene.feed[move] * 60) / 1e6, 3)} mm/min`
            : "—";
        return [
            [words.move, `${move + 1}: ${stand ?? (isMoving ? kind : words.still)}`],
            [words.speedChart, isMoving && !stand ? this.speedAt(seconds) : "0 mm/min"],
            [words.feed, feed],
            [words.deviation, length(scene.deviation[move] ?? 0)],
            [words.spindle, scene.rpm[move] ? `${trimmed(scene.rpm[move], 1)} rpm` : "—"],
            [words.state, this.modal.at(line).join(" ") || "—"],
        ];
    }

    /** @param {number} seconds */
    speedAt(seconds) {
        const { feed, rapid } = this.model.scene.bands;
        for (const band of [feed, rapid]) {
            const column = Math.floor(seconds / band.seconds);
            if (band.isThere[column])
                return `${trimmed((band.high[column] * 60) / 1e6, 3)} mm/min`;
        }
        return "—";
    }

    /**
     * @param {number} move
     * @param {number} seconds
     */
    standAt(move, seconds) {
        const { stands, begin, end } = this.model.scene;
        const stand = stands.filter((one) => one.begin <= seconds && one.move === move).pop();
        if (!stand) return undefined;
        if (stand.axis < 0) {
            return seconds < (begin[move + 1] ?? Infinity) && seconds >= end[move]
                ? this.words.dwell
                : undefined;
        }
        // The tool stands still during a take-up.
        const { scene } = this.model;
        const index = Math.floor(seconds / scene.sampleSeconds);
        const isStill = scene.tool.every((steps) => steps[index] === steps[index + 1]);
        return isStill ? this.words.takeUp : undefined;
    }
}
