/**
 * Findings, commands, comparisons, holes, tuning; errors as values; memory.
 */

import assert from "node:assert/strict";
import { test } from "node:test";
import { husillo as program } from "../../view/tests/reports.js";
import { execFileSync } from "node:child_process";
import { Husillo } from "../husillo.js";
import { example, good, husillo, rounded } from "./common.js";

/** What the program on this computer prints. @param {string[]} words */
function printed(words, status = 0) {
    const cwd = new URL("../../examples/", import.meta.url);
    try {
        return JSON.parse(execFileSync(program(), words, { cwd, stdio: "pipe" }).toString());
    } catch (error) {
        const failed = /** @type {any} */ (error);
        assert.equal(failed.status, status, String(failed.stderr));
        return JSON.parse(failed.stdout.toString());
    }
}

test("a check has the findings of the program", () => {
    const words = ["check", "circles.nc", "-m", "micromill", "--format", "json"];
    const expected = printed(words);
    const text = example("circles.nc");
    const checked = good(husillo.check(text, { name: "circles.nc", machine: "micromill" }));
    assert.deepEqual(checked.findings, expected.findings);
    assert.deepEqual([checked.errors, checked.warnings], [0, expected.warnings]);
    const wrong = good(husillo.check("G1 X1 Q\nG0 X[\n"));
    assert.equal(wrong.errors, wrong.findings.filter((of) => of.severity === "error").length);
    assert.deepEqual(wrong.findings.map((of) => of.line).slice(0, 2), [1, 2]);
});

test("a program with errors does not run, and says why", () => {
    const refused = husillo.simulate("G2 X1 R0.1\n");
    assert.ok("error" in refused && refused.findings.length > 0);
    for (const options of [
        { machine: "nosuch" },
        { machine: { text: "schema = 9" } },
        { zero: "Q5" },
        { dialect: "klingon" },
        /** @type {any} */ ({ nosuch: 1 }),
    ]) {
        const made = husillo.simulate("G0 X1\n", options);
        assert.ok("error" in made && made.error, JSON.stringify(options));
    }
    // Bytes that are no text are findings, not faults.
    const bytes = Uint8Array.from({ length: 5000 }, (_, index) => (index * 7919) % 256);
    assert.ok(good(husillo.check(bytes)).errors > 0);
    assert.ok("error" in husillo.check(Uint8Array.of(0xff, 0xfe, 71, 0)));
});

test("commands are those of the program", () => {
    const { commands } = good(husillo.commands("G21\nG1 X2 F100\nG2 X4 I1\n"));
    assert.deepEqual(commands.map((of) => of.line), [2, 3]);
});

test("subroutines come from the given files", () => {
    const files = { "bore.ngc": "o<bore> sub\nG0 X#1\no<bore> endsub\n" };
    assert.equal(good(husillo.check("o<bore> call [3]\nM2\n", { files })).errors, 0);
    assert.ok(good(husillo.check("o<bore> call [3]\nM2\n")).errors > 0);
});

test("every machine is there, with its file", () => {
    const machines = husillo.machines();
    assert.ok(machines.length >= 9);
    for (const { name, axes } of machines) {
        const text = good(husillo.machineText(name));
        const own = good(husillo.check("", { machine: { text } }));
        assert.equal(own.errors, 0, name);
        assert.ok(axes.length >= 3, name);
    }
    assert.ok("error" in /** @type {any} */ (husillo.machineText("nosuch")));
});

test("interpolators are compared as by the program", () => {
    const circle = good(husillo.compare({ move: { circle: { radius: 30 } } }));
    const expected = printed(["compare", "circle", "--format", "json"]);
    assert.deepEqual(rounded(circle.methods), rounded(expected.methods));
    const text = example("circles.nc");
    const made = good(husillo.compare({ program: text, machine: "micromill" }));
    const words = ["compare", "circles.nc", "-m", "micromill", "--format", "json"];
    assert.deepEqual(rounded(made.methods), rounded(printed(words).methods));
    assert.ok("error" in husillo.compare({ move: { line: [0, 0] } }));
});

test("a drill file is read as by the program, and becomes one", () => {
    const board = good(husillo.holes(example("board.drl"), { name: "board.drl" }));
    const expected = printed(["holes", "board.drl", "--format", "json"]);
    assert.deepEqual(board, expected);
    const { gcode } = good(husillo.holes(example("board.drl"), { depth_mm: 1.8 }));
    assert.ok(gcode);
    assert.equal(good(husillo.check(gcode)).errors, 0);
    assert.ok("error" in husillo.holes(example("board.drl"), { depth_mm: -1 }));
});

test("a servo is tuned as by the program", () => {
    const words = ["tune", "--method", "step", "--size", "100", "--format", "json"];
    const gains = ["--p", "100", "--i", "0", "--d", "10000"];
    const page = ["-o", "/dev/null"];
    const expected = printed([...words, ...gains, ...page]);
    const made = good(husillo.tune({ p: 100, i: 0, d: 10000, size: 100 }));
    assert.deepEqual(made.outcome.step, expected.step);
    assert.ok(made.traces[0].points.length > 100);
    const found = good(husillo.tune({ method: "relay" }));
    assert.match(found.outcome.toml ?? "", /gains = /);
    assert.ok("error" in husillo.tune({ size: 100000 }));
    assert.ok("error" in husillo.tune({ method: /** @type {any} */ ("luck") }));
});

test("memory is freed", () => {
    const text = example("gear.nc");
    const once = () => {
        const run = good(husillo.simulate(text, { machine: "micromill" }));
        good(run.at(1000));
        good(run.scene());
        run.close();
    };
    for (let turn = 0; turn < 3; turn++) once();
    const { memory } = /** @type {any} */ (husillo);
    const before = memory.buffer.byteLength;
    for (let turn = 0; turn < 20; turn++) once();
    assert.equal(memory.buffer.byteLength, before);
});

test("a trap is an error, and the next call works", () => {
    const own = new Husillo(/** @type {any} */ (husillo).module);
    const run = good(own.simulate("G1 X1 F100\n"));
    const real = own.wasm.call;
    own.wasm = { ...own.wasm, call: () => real(1, 2 ** 31) };
    const failed = own.check("G0 X1\n");
    assert.ok("error" in failed && failed.error, JSON.stringify(failed));
    assert.equal(good(own.check("G0 X1\n")).errors, 0);
    assert.ok("error" in /** @type {any} */ (run.at(1)));
});
