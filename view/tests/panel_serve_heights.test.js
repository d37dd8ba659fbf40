import assert from "node:assert/strict";
import { test } from "node:test";
import { picture, violations } from "husillo/tests/browser.js";
import { emulated, line, tryProbe } from "husillo/tests/emulated.js";
import { press, says } from "husillo/tests/panels.js";
import { isIdle, served, until } from "husillo/tests/served.js";

/** The plate rises by these parts of 1000 along X and along Y. */
const TILT = /** @type {const} */ ([10, -4]);

/** The first point, the size, the columns and the rows of the map. */
const GRID = { x: "5", y: "5", width: "20", depth: "10", columns: "3", rows: "2" };

/** The plate at a place, from the first point, mm. @param {number} x @param {number} y */
const plate = (x, y) => (TILT[0] * (x - 5) + TILT[1] * (y - 5)) / 1000;

/**
 * @param {import("puppeteer-core").Page} page
 * @param {Record<string, string>} values
 */
async function fill(page, values) {
    for (const [name, value] of Object.entries(values)) {
        await page.$eval(
            `[data-map="${name}"]`,
            (one, value) => void (/** @type {any} */ (one).value = value),
            value
        );
    }
}

/**
 * Moves there, and tells whether the tool touches the plate.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} to
 */
async function touches(page, to) {
    await line(page, to);
    await line(page, "G4 P0");
    // A report from after the motion: there are twenty in a second.
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
    const now = await until(page, isIdle);
    return now.switches.includes("P");
}

test("a map is measured on a tilted plate, applied, switched off, and deleted", async (t) => {
    const { port, panel } = await emulated(t, "grbl");
    panel(`tilt ${TILT.join(" ")}`);
    const { page } = await served(t, {}, "--port", port);
    await until(page, ({ work_mm }) => work_mm);
    await until(page, isIdle);
    await press(page, "#tab-heights");
    await says(page, "#part-heights .why", "Touch the probe to the tool by hand once");
    await tryProbe(page, panel);
    await press(page, "button::-p-aria(Read the map)");
    await says(page, "#part-heights .result", "no map");
    // The plate is 10 mm below.
    await fill(page, { ...GRID, down: "14", feed: "300" });
    await press(page, "button::-p-aria(Measure the map)");
    await says(page, "#part-heights .result", "Measured");
    const shown = await page.$$eval(".heights td.number", (all) =>
        all.map((one) => Number(one.textContent))
    );
    // The farthest row is on top.
    const places = [15, 5].flatMap((y) => [5, 15, 25].map((x) => plate(x, y)));
    assert.equal(shown.length, 6);
    // A step of Z is 4 um, and the plate too has whole steps.
    shown.forEach((is, at) => assert.ok(Math.abs(is - places[at]) < 0.009, `${shown}`));
    const texts = await page.$$eval(".height-map text", (all) =>
        all.map((one) => Number(one.textContent))
    );
    assert.deepEqual([...texts].sort(), [...shown].sort());
    await press(page, "button::-p-aria(Zero Z at the first point)");
    await says(page, "#part-heights .result", "Z is zero");
    // 2 mm above the surface, which is Z 0. A report after that has the new zero.
    await until(page, (now) => isIdle(now) && Math.abs(now.work_mm[2] - 2) < 0.01);
    await press(page, "button::-p-aria(Map on)");
    await says(page, "#part-heights .result", "map is on");
    const pressed = await page.$eval("button::-p-aria(Map on)", (one) =>
        one.getAttribute("aria-pressed")
    );
    assert.equal(pressed, "true");
    // Everywhere the surface is at Z 0, also between the points.
    for (const place of ["X25 Y5", "X12 Y8", "X19.5 Y14"]) {
        assert.equal(await touches(page, `G0 ${place} Z0.02`), false, place);
        assert.equal(await touches(page, "G1 Z-0.02 F100"), true, place);
        await line(page, "G0 Z2");
    }
    await until(page, (now) => isIdle(now) && Math.abs(now.work_mm[2] - 2) < 0.01);
    assert.deepEqual(await violations(page), []);
    await page.$eval("#part-heights", (one) => one.scrollIntoView({ block: "end" }));
    await picture(page, "serve-heights");
    await press(page, "button::-p-aria(Map off)");
    await says(page, "#part-heights .result", "map is off");
    // Without the map the plate is 0.2 mm higher here than at the first point.
    assert.equal(await touches(page, "G0 X25 Y5 Z0.3"), false);
    assert.equal(await touches(page, "G1 Z0.1 F100"), true);
    await line(page, "G0 Z2");
    await until(page, (now) => isIdle(now) && Math.abs(now.work_mm[2] - 2) < 0.01);
    await press(page, "button::-p-aria(Delete the map)");
    await says(page, "#part-heights .result", "no map");
    assert.equal(await page.$(".height-map"), null);
});

/** The page of before called itself without end here: a test fails if its page prints an error. */
test("STOP ends the measurement of a map, and so does a point without a contact", async (t) => {
    const { port, panel } = await emulated(t, "grbl");
    const { page } = await served(t, {}, "--port", port);
    await until(page, ({ work_mm }) => work_mm);
    await until(page, isIdle);
    await tryProbe(page, panel);
    await press(page, "#tab-heights");
    await fill(page, { columns: "9", rows: "9", down: "14", feed: "60" });
    await press(page, "button::-p-aria(Measure the map)");
    await until(page, ({ state, machine_mm }) => state !== "Idle" && machine_mm[2] < -1);
    await press(page, "button.stop");
    await until(page, ({ state, stopping }) => !stopping && state === "Idle");
    await page.waitForFunction(
        () => !document.querySelector("#part-heights .result")?.textContent?.startsWith("…")
    );
    const first = await until(page, ({ machine_mm }) => machine_mm);
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
    const later = await until(page, ({ machine_mm }) => machine_mm);
    assert.deepEqual(later.machine_mm, first.machine_mm);
    // The plate is deeper than that.
    await fill(page, { ...GRID, down: "3", feed: "300" });
    await press(page, "button::-p-aria(Measure the map)");
    await until(page, ({ state }) => state === "Alarm");
    await says(page, "#part-heights .result", "Refused");
    await press(page, "button::-p-aria(Unlock)");
    await until(page, isIdle);
    await page.waitForFunction(
        () => !document.querySelector("#part-heights button")?.matches(":disabled")
    );
});
