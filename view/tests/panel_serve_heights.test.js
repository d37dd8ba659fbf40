import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { test } from "node:test";
import { picture, violations } from "husillo/tests/browser.js";
import { press, says, textOf } from "husillo/tests/panels.js";
import { husillo } from "husillo/tests/reports.js";
import { isIdle, served, until } from "husillo/tests/served.js";

/**
 * An emulated mill at a port, with the lines of its panel.
 *
 * @param {import("node:test").TestContext} t
 * @param {...string} panel
 * @returns {Promise<string>} the port
 */
function emulated(t, ...panel) {
    const args = ["emulate", "grbl", "--listen", "127.0.0.1:0", "--speed", "20", "--for", "900"];
    const child = spawn(husillo(), args, { stdio: ["pipe", "pipe", "inherit"] });
    t.after(() => child.kill("SIGKILL"));
    for (const line of panel) child.stdin.write(`${line}\n`);
    return new Promise((resolve, reject) => {
        child.on("exit", () => reject(new Error("the emulated mill has ended")));
        createInterface(child.stdout).on("line", (line) => {
            const port = /tcp:[0-9.:]+/.exec(line)?.[0];
            if (port) resolve(port);
        });
    });
}

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

test("a height map is measured, zeroed, switched on and off, and deleted", async (t) => {
    // The plate is 10 mm below, and rises by 10 steps per 1000 steps of X.
    const port = await emulated(t, "tilt 10 0");
    const { page } = await served(t, {}, "--port", port);
    await until(page, ({ work_mm }) => work_mm);
    await until(page, isIdle);
    await press(page, "#tab-heights");
    await press(page, "button::-p-aria(Read the map)");
    await says(page, "#part-heights .result", "no map");
    const grid = { width: "20", depth: "10", columns: "3", rows: "2", travel: "2", down: "12" };
    await fill(page, { ...grid, feed: "300" });
    await press(page, "button::-p-aria(Measure the map)");
    await says(page, "#part-heights .result", "Measured");
    await page.waitForSelector(".heights td.number");
    const shown = await page.$$eval(".heights td.number", (all) =>
        all.map((one) => Number(one.textContent))
    );
    // Two rows of 0, 10 and 20 mm.
    assert.equal(shown.length, 6);
    const slope = shown[2] - shown[0];
    assert.ok(slope > 0.1 && slope < 0.5, `${shown}`);
    assert.ok(Math.abs(shown[1] - slope / 2) < 0.01, `${shown}`);
    await press(page, "button::-p-aria(Zero Z at the first point)");
    await says(page, "#part-heights .result", "Z is zero");
    const zeroed = await until(page, isIdle);
    // 2 mm above the surface, which is Z 0.
    assert.ok(Math.abs(zeroed.work_mm[2] - 2) < 0.05, `${zeroed.work_mm}`);
    await press(page, "button::-p-aria(Map on)");
    await says(page, "#part-heights .result", "map is on");
    const pressed = await page.$eval("button::-p-aria(Map on)", (one) =>
        one.getAttribute("aria-pressed")
    );
    assert.equal(pressed, "true");
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-heights");
    await press(page, "button::-p-aria(Map off)");
    await says(page, "#part-heights .result", "map is off");
    await press(page, "button::-p-aria(Delete the map)");
    await says(page, "#part-heights .result", "no map");
    assert.equal(await page.$eval(".heights", (one) => /** @type {any} */ (one).hidden), true);
});

test("STOP ends the measurement of a map", async (t) => {
    const port = await emulated(t);
    const { page } = await served(t, {}, "--port", port);
    await until(page, ({ work_mm }) => work_mm);
    await until(page, isIdle);
    await press(page, "#tab-heights");
    await fill(page, { columns: "9", rows: "9", travel: "2", down: "12", feed: "60" });
    await press(page, "button::-p-aria(Measure the map)");
    const moving = await until(
        page,
        ({ state, machine_mm }) => state !== "Idle" && machine_mm[2] < -1
    );
    assert.ok(moving.machine_mm[2] < 0);
    await press(page, "button.stop");
    await until(page, ({ state, stopping }) => !stopping && state !== "Run");
    assert.match(await textOf(page, "#part-heights .result"), /./);
    const first = await until(page, ({ machine_mm }) => machine_mm);
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
    const later = await until(page, ({ machine_mm }) => machine_mm);
    assert.deepEqual(later.machine_mm, first.machine_mm);
});
