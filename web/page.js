/**
 * The page: a program in, its findings, path, figures, comparisons out. Nothing leaves it.
 */

import { unpackBytes } from "husillo/viewer/container.js";
import { button, element } from "husillo/viewer/element.js";
import { Scene } from "husillo/viewer/scene.js";
import { mount } from "husillo/viewer/viewer.js";
import { drawn } from "husillo/web/curve.js";
import { load } from "husillo/web/husillo.js";
import { stepsOf } from "husillo/web/steps.js";

const EXAMPLE = `(a slot, a pocket corner and a helix)
G21 G90 G17 F120
G0 Z1
G0 X2 Y2
G1 Z-0.2
G1 X8
G3 X10 Y4 I0 J2
G1 Y8
G2 X10 Y8 Z-0.6 I-1 J0
G0 Z1
G0 X0 Y0
M2
`;

/** A longer program is not put into the text field, where each change would take seconds. */
const LONGEST_TEXT = 500_000;

/** Milliseconds after the last key before the program is checked. */
const PAUSE = 300;

/**
 * @template {HTMLElement} T
 * @param {string} id
 * @returns {T}
 */
const byId = (id) => /** @type {any} */ (document.getElementById(id));

/** The text of a field. @param {string} id */
const valueOf = (id) => /** @type {HTMLInputElement} */ (byId(id)).value;

/** @type {HTMLTextAreaElement} */
const program = byId("program");
/** @type {HTMLSelectElement} */
const machine = byId("machine");
/** @type {HTMLTextAreaElement} */
const own = byId("own");
/** @type {HTMLInputElement} */
const zero = byId("zero");
/** @type {HTMLInputElement} */
const depth = byId("depth");
const status = byId("status");

let name = "program.nc";
/** A program that is too long for the text field. @type {string | undefined} */
let long;
/** @type {any} */
let run;
/** @type {any} */
let husillo;
let timer = 0;

/** The module: in the page, or beside it. */
async function source() {
    const embedded = document.getElementById("wasm");
    if (!embedded) return new URL("./husillo.wasm", document.baseURI);
    const bytes = Uint8Array.from(atob(embedded.textContent ?? ""), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
}

const textNow = () => long ?? program.value;

/** Takes a text as the program. @param {string} text */
function put(text) {
    long = text.length > LONGEST_TEXT ? text : undefined;
    program.hidden = long !== undefined;
    byId("long").hidden = !program.hidden;
    program.value = long === undefined ? text : "";
    byId("long-name").textContent = `${name}: the program is listed beside its path.`;
}

function options() {
    const isOwn = machine.value === "own";
    return {
        name,
        machine: isOwn ? { text: own.value } : machine.value,
        zero: zero.value.trim() || undefined,
    };
}

/** @param {any[]} findings */
function list(findings) {
    const items = findings.map((of) => {
        const place = of.line ? `${of.line}:${of.column}: ` : "";
        const text = `${place}${of.severity}[${of.code}]: ${of.message}`;
        const why = [...of.notes, of.help].filter(Boolean).join("; ");
        const line = of.line
            ? button(text, () => goTo(of.line), { class: "finding" })
            : element("span", {}, text);
        return element("li", { class: of.severity }, line, why ? `: ${why}` : "");
    });
    byId("findings").replaceChildren(...items);
}

/** @param {number} line */
function goTo(line) {
    const lines = program.value.split("\n");
    const from = lines.slice(0, line - 1).reduce((sum, text) => sum + text.length + 1, 0);
    program.focus();
    program.setSelectionRange(from, from + (lines[line - 1] ?? "").length);
}

/**
 * @param {string[]} heads
 * @param {(string | number)[][]} rows
 */
function table(heads, rows) {
    const cells = (/** @type {"td" | "th"} */ tag, /** @type {(string | number)[]} */ row) =>
        element("tr", {}, ...row.map((text) => element(tag, {}, String(text))));
    return element(
        "table",
        {},
        element("thead", {}, cells("th", heads)),
        element("tbody", {}, ...rows.map((row) => cells("td", row)))
    );
}

/** @param {number} nm */
const mm = (nm) => (nm / 1e6).toFixed(3);

/** @param {any} results */
function totals(results) {
    const axes = Array.from(results.axes, (letter, axis) => [
        letter,
        mm(results.min_nm[axis]),
        mm(results.max_nm[axis]),
        mm(results.end_nm[axis]),
        results.reversals[axis],
    ]);
    const figures = [
        ["time", `${results.duration_s.toFixed(2)} s`],
        ["step events", results.events.toLocaleString("en")],
        ["feed path", `${mm(results.feed_nm)} mm`],
        ["rapid path", `${mm(results.rapid_nm)} mm`],
        ["largest deviation", `${(results.max_deviation_nm / 1e3).toFixed(2)} µm`],
        ["lost steps", results.lost_steps],
    ];
    byId("totals").replaceChildren(
        table(["figure", "value"], figures),
        table(["axis", "from mm", "to mm", "end mm", "take-ups"], axes)
    );
}

/** Checks, simulates and draws the program. */
function show() {
    const begin = performance.now();
    run?.close();
    run = undefined;
    const viewer = byId("viewer");
    const made = husillo.simulate(textNow(), options());
    if ("error" in made) {
        list(made.findings);
        byId("totals").replaceChildren();
        viewer.replaceChildren();
        viewer.hidden = true;
        status.textContent = made.error;
        return;
    }
    run = made;
    const { results } = made;
    list(results.findings);
    totals(results);
    const scene = made.scene();
    const { model } = mount(viewer, new Scene(unpackBytes(scene)));
    model.steps = stepsOf(made);
    Object.assign(window, { husillo, model });
    const seconds = ((performance.now() - begin) / 1000).toFixed(2);
    const notes = results.notes.map((/** @type {string} */ note) => `; ${note}`).join("");
    status.textContent = `${name} on ${results.machine}: checked and drawn in ${seconds} s${notes}`;
}

function later() {
    clearTimeout(timer);
    status.textContent = "…";
    timer = window.setTimeout(show, PAUSE);
}

/**
 * Takes a dropped or chosen file. A drill file becomes a program.
 *
 * @param {File | undefined} file
 */
async function take(file) {
    if (!file) return;
    const text = await file.text();
    if (/\.toml$/i.test(file.name)) {
        own.value = text;
        machine.value = "own";
        own.hidden = false;
    } else if (/\.(drl|xln|exc|drd|ncd|drill)$/i.test(file.name)) {
        const board = husillo.holes(text, {
            name: file.name,
            shortest: true,
            depth_mm: Number(depth.value),
        });
        if ("error" in board) {
            list(board.findings);
            status.textContent = board.error;
            return;
        }
        name = `${file.name}.nc`;
        put(board.gcode);
    } else {
        name = file.name;
        put(text);
    }
    show();
}

function compare() {
    const radius = Number(valueOf("radius"));
    const what = valueOf("what") === "circle"
        ? { move: { circle: { radius } } }
        : { program: textNow(), ...options() };
    const made = husillo.compare(what);
    if ("error" in made) {
        byId("methods").replaceChildren(made.error);
        return;
    }
    const rows = made.methods.map((/** @type {any} */ of) => [
        of.method,
        of.shape,
        of.moves,
        of.max_error_blu.toFixed(3),
        of.rms_error_blu.toFixed(3),
        of.instructions.cortex_m4f?.toFixed(0) ?? "-",
        of.points.total.toFixed(0),
    ]);
    const heads = ["method", "shape", "moves", "largest error", "RMS", "M4F", "points"];
    byId("methods").replaceChildren(table(heads, rows), ...made.notes);
}

function tune() {
    const number = (/** @type {string} */ id) => Number(valueOf(id));
    const method = valueOf("method");
    const gains = { p: number("p"), i: number("i"), d: number("d") };
    const made = husillo.tune({
        method,
        size: number("size"),
        ...(method === "step" ? gains : {}),
    });
    const place = byId("response");
    if ("error" in made) {
        place.replaceChildren(made.error);
        return;
    }
    const { step, toml, notes = [], aborted } = made.outcome;
    const rows = step ? Object.entries(step).map(([key, value]) => [key, value ?? "-"]) : [];
    const trace = made.traces.at(-1);
    place.replaceChildren(
        ...(aborted ? [element("p", {}, aborted)] : []),
        ...(toml ? [element("pre", {}, toml)] : []),
        ...(trace ? [drawn(trace)] : []),
        table(["figure", "value"], rows),
        ...notes.map((/** @type {string} */ note) => element("p", {}, note))
    );
}

function listen() {
    program.addEventListener("input", later);
    own.addEventListener("input", later);
    zero.addEventListener("input", later);
    machine.addEventListener("change", () => {
        own.hidden = machine.value !== "own";
        if (!own.hidden && !own.value) own.value = husillo.machineText("micromill");
        later();
    });
    byId("file").addEventListener("change", (event) => {
        void take(/** @type {any} */ (event.target).files[0]);
    });
    document.addEventListener("dragover", (event) => event.preventDefault());
    document.addEventListener("drop", (event) => {
        event.preventDefault();
        void take(event.dataTransfer?.files[0]);
    });
    byId("another").addEventListener("click", () => {
        name = "program.nc";
        put("");
        program.focus();
    });
    byId("compare").addEventListener("click", compare);
    byId("tune").addEventListener("click", tune);
}

try {
    husillo = await load(await source());
    for (const of of husillo.machines()) {
        machine.append(element("option", { value: of.name }, `${of.name}: ${of.title}`));
    }
    machine.append(element("option", { value: "own" }, "a machine file of your own"));
    program.value ||= EXAMPLE;
    listen();
    show();
    performance.mark("husillo-ready");
} catch (error) {
    status.textContent = `this browser cannot run the simulator: ${error}`;
}
