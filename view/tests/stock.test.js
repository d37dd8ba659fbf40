import assert from "node:assert/strict";
import { test } from "node:test";
import { reportOf, sceneIn } from "husillo/tests/reports.js";
import { read } from "husillo/viewer/scene.js";
import { boxOf } from "husillo/viewer/segments.js";
import { Cutting, Stock } from "husillo/viewer/stock.js";

test("a slot has the volume of its shape", () => {
    const stock = new Stock([-10e6, -10e6], [30e6, 10e6], 0, 800);
    stock.cut([0, 0, -2e6], [20e6, 0, -2e6], 3e6);
    // A rectangle and two half discs, 2 mm deep.
    const expected = (20 * 6 + Math.PI * 9) * 2;
    assert.ok(Math.abs(stock.removed / 1e18 - expected) < 0.01 * expected);
    const before = stock.removed;
    stock.cut([0, 0, -1e6], [20e6, 0, -1e6], 3e6);
    assert.equal(stock.removed, before);
});

test("a sloped move leaves what its flat tool leaves", () => {
    const stock = new Stock([-10e6, -10e6], [30e6, 10e6], 0, 400);
    stock.cut([0, 0, 0], [20e6, 0, -2e6], 1e6);
    const row = Math.floor(stock.rows / 2) * stock.columns;
    const at = (/** @type {number} */ mm) => stock.heights[row + Math.floor((mm + 10) * 10)];
    // Descending, the lowest point over X is reached with the rear edge of the tool.
    assert.ok(Math.abs(at(10) + 1.1e6) < 0.02e6, String(at(10)));
    assert.equal(at(-5), 0);
    assert.ok(Math.abs(at(20.5) + 2e6) < 1);
});

const PROGRAM = `G21 G90 G17 G94
G0 X10 Y10 Z5
G1 Z-1 F300
G1 X40 F600
G1 Y30
G0 X20
G0 Z5
M2
`;

/** @param {string[]} more */
async function cutting(...more) {
    const page = reportOf(`stock${more.length}`, PROGRAM, "-m", "router", ...more);
    const scene = await read(sceneIn(page));
    const zero = scene.axes[2].zero_nm;
    const made = new Cutting(scene, boxOf(scene), 4e6, zero);
    made.goTo(scene.seconds);
    return made;
}

test("a rapid through the stock is found, and nothing else", async () => {
    const { gouge, uncut, crossed } = (await cutting()).faults(10_000);
    assert.deepEqual([gouge, uncut], [0, 0]);
    // 20 mm wide 4 mm, with an end like the tool, without what the feed had cut before.
    const expected = 18 * 4 + (Math.PI * 4) / 2;
    assert.ok(Math.abs(crossed / 1e12 - expected) < 0.1 * expected, `${crossed / 1e12}`);
});

test("going back gives the stock of that time", async () => {
    const made = await cutting();
    const { scene } = made;
    made.goTo(scene.begin[3] - 1e-6);
    const early = made.real.removed;
    made.goTo(scene.seconds);
    assert.ok(made.real.removed > early);
    made.goTo(scene.begin[3] - 1e-6);
    assert.equal(made.real.removed, early);
});
