/**
 * The steps are those of the program `husillo` on this computer, bit by bit.
 */

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { husillo as program } from "../../view/tests/reports.js";
import { example, good, husillo, rounded } from "./common.js";

/** Arcs and helices in all planes, reversals with lash, a dwell, inches. */
const HELIX = `G21 G90 G17 G94 F60
G0 X4 Y3
G3 X6 Y3 Z0.4 I1 J0
G2 X6 Y3 Z0 I-1 J0 F90
G4 P0.25
G18 G2 X5 Z0.4 I-0.5 K0.2
G19 G3 Y2.8 Z0.6 J-0.2 K0
G17 G20 G1 X0.2 Y0.11 F3
G21 G91 G1 X-0.5 Y-0.3
M2
`;

/** @type {[string, string, string][]} */
const PROGRAMS = [
    ["circles.nc", example("circles.nc"), "micromill"],
    ["gear.nc", example("gear.nc"), "micromill"],
    ["ornament.nc", example("ornament.nc"), "micromill"],
    ["star.nc", example("star.nc"), "micromill"],
    ["spirograph.nc", example("spirograph.nc"), "router"],
    ["turning.nc", example("turning.nc"), "lathe"],
    ["thread.nc", example("thread.nc"), "lathe"],
    ["helix.nc", HELIX, "micromill"],
    ["helix.nc", HELIX, "router"],
    ["helix.nc", HELIX, "free6"],
];

const folder = mkdtempSync(join(tmpdir(), "husillo-web-"));
after(() => rmSync(folder, { recursive: true }));

/** @param {string[]} words */
function printed(...words) {
    const most = 2 ** 31;
    return execFileSync(program(), words, { cwd: folder, maxBuffer: most, stdio: "pipe" });
}

/** @param {import("../index.js").Run} run */
function listed(run) {
    let [text, from, events, entries] = ["", 0, 0, 1];
    while (from < entries) {
        const rows = good(run.steps(from, 100_000));
        const { axes, delta, wait_ticks: waits } = rows;
        entries = rows.entries;
        waits.forEach((wait, index) => {
            const own = delta.subarray(index * axes, (index + 1) * axes);
            if (own.some((step) => step !== 0)) events++;
            text += `${events},${wait},${own.join()}\n`;
        });
        from += waits.length;
        assert.ok(waits.length, "no entry before the end");
    }
    return text;
}

for (const [name, text, machine] of PROGRAMS) {
    test(`${name} on ${machine}`, () => {
        writeFileSync(join(folder, name), text);
        const zero = name === "helix.nc" ? ["--zero", "fit"] : [];
        const args = [name, "-m", machine, ...zero];
        const expected = printed("steps", ...args, "-o", "-").toString();
        const run = good(husillo.simulate(text, { name, machine, zero: zero[1] }));
        assert.equal(good(run.csv()), expected);
        assert.equal(listed(run), expected.slice(expected.indexOf("\n") + 1));
        const totals = JSON.parse(printed("run", ...args, "--format", "json").toString());
        for (const key of Object.keys(totals)) {
            const own = /** @type {any} */ (run.results)[key];
            assert.deepEqual(rounded(own), rounded(totals[key]), key);
        }
        run.close();
    });
}

test("positions and levels at a step are those of the list", () => {
    writeFileSync(join(folder, "helix.nc"), HELIX);
    const args = ["helix.nc", "-m", "micromill", "--zero", "fit", "--levels", "-o", "-"];
    const rows = printed("steps", ...args).toString().trim().split("\n").slice(1);
    const run = good(husillo.simulate(HELIX, { machine: "micromill", zero: "fit" }));
    const start = good(run.at(0));
    assert.ok(start);
    /** After each event: ticks and levels. @type {Map<number, {ticks: number, last: number[]}>} */
    const after = new Map();
    let ticks = 0;
    for (const row of rows) {
        const [event, wait, x, y, z, ...levels] = row.split(",").map(Number);
        ticks += wait;
        // Of the rows of an event, the one with its step; a wait comes behind it.
        if (x || y || z) after.set(event, { ticks, last: levels });
    }
    assert.equal(after.size, run.results.events);
    let previous = start;
    for (let event = 1; event <= run.results.events; event += 1) {
        if (event > 2000 && event % 101) continue;
        const at = good(run.at(event));
        const wanted = after.get(event);
        assert.ok(at && wanted);
        assert.deepEqual([at.event, at.ticks, at.levels], [event, wanted.ticks, wanted.last]);
        const seconds = at.ticks / run.results.ticks_per_second;
        assert.equal(good(run.atTime(seconds)).event, event);
        if (event === previous.event + 1) {
            const moved = at.tool.some((step, axis) => step !== previous.tool[axis]);
            const sent = at.commanded.some((step, axis) => step !== previous.commanded[axis]);
            assert.equal(sent, !at.is_take_up);
            assert.ok(moved || at.is_take_up || sent);
        }
        previous = at;
    }
    // Backwards, and beyond the end.
    assert.deepEqual(good(run.at(0)), start);
    assert.equal(run.at(run.results.events + 1), undefined);
    assert.equal(good(run.atTime(1e9)).event, run.results.events);
    run.close();
    assert.ok("error" in /** @type {any} */ (run.at(1)));
});
