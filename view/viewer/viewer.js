/**
 * The viewer of a scene: picture, program, time, values and charts, in one element.
 */

import { Charts } from "husillo/viewer/charts.js";
import { element } from "husillo/viewer/element.js";
import { lookOf } from "husillo/viewer/look.js";
import { Material } from "husillo/viewer/material.js";
import { Model } from "husillo/viewer/model.js";
import { PathView } from "husillo/viewer/pathview.js";
import { ProgramList } from "husillo/viewer/program.js";
import { KINDS } from "husillo/viewer/scene.js";
import { Timeline } from "husillo/viewer/timeline.js";
import { Values } from "husillo/viewer/values.js";
import { kindName, wordsOf } from "husillo/viewer/words.js";

/** @typedef {import("husillo/viewer/scene.js").Scene} Scene */

/**
 * @typedef {object} Options
 * @property {string} [language] such as `es`; that of the browser without it
 * @property {"canvas" | "webgl"} [renderer]
 *
 * @typedef {object} Viewer
 * @property {Model} model
 * @property {PathView} path
 * @property {Timeline} timeline
 */

/**
 * Puts a viewer into an element.
 *
 * @param {HTMLElement} place
 * @param {Scene} scene
 * @param {Options} [options]
 * @returns {Viewer}
 */
export function mount(place, scene, options = {}) {
    const language = options.language ?? navigator.language ?? "en";
    const words = wordsOf(language);
    const model = new Model(scene);
    const path = new PathView(model, words, options);
    const program = new ProgramList(model, words);
    const timeline = new Timeline(model, words);
    const values = new Values(model, words);
    const charts = new Charts(model, words);
    const live = element("p", { class: "live", role: "status", "aria-live": "polite" });
    place.lang = language.startsWith("es") ? "es" : "en";
    place.classList.add("viewer");
    place.replaceChildren(
        element("h2", {}, words.path),
        ...(scene.isWhole ? [] : [element("p", { class: "warning" }, words.cut)]),
        element(
            "div",
            { class: "panes" },
            element("div", { class: "pane" }, path.root, legend(words), timeline.root),
            element(
                "div",
                { class: "pane" },
                element("h3", {}, words.program),
                program.root,
                values.root
            )
        ),
        charts.root,
        new Material(model, words).root,
        live
    );
    place.hidden = false;
    program.fill();
    speak(model, words, timeline, live);
    return { model, path, timeline };
}

/**
 * Says what is selected, but not every position while it plays.
 *
 * @param {Model} model
 * @param {import("husillo/viewer/words.js").Words} words
 * @param {Timeline} timeline
 * @param {HTMLElement} live
 */
function speak(model, words, timeline, live) {
    let said = 0;
    model.listen(() => {
        if (timeline.isPlaying || model.line === said) return;
        said = model.line;
        const move = model.moves[0];
        const kind =
            move === undefined ? "" : `, ${kindName(words, KINDS[model.scene.kind[move]])}`;
        live.textContent = said
            ? `${words.line} ${said}${kind}: ${model.scene.lines[said - 1]}`
            : "";
    });
}

/**
 * The meaning of colours and patterns.
 *
 * @param {import("husillo/viewer/words.js").Words} words
 */
function legend(words) {
    const look = lookOf(document.documentElement);
    const entries = /** @type {[string, string, string][]} */ ([
        ["jog", words.jog, look.kinds[0].dash.join(" ")],
        ["rapid", words.rapid, ""],
        ["feed", words.feedKind, ""],
        ["take-up", words.takeUp, ""],
        ["limit", words.area, ""],
    ]);
    return element(
        "ul",
        { class: "legend" },
        ...entries.map(([name, text]) =>
            element(
                "li",
                {},
                element("span", { class: `key ${name}`, "aria-hidden": "true" }),
                text
            )
        )
    );
}
