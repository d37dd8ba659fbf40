import assert from "node:assert/strict";
import { test } from "node:test";
import { picture, violations } from "husillo/tests/browser.js";
import { emulated, tryProbe } from "husillo/tests/emulated.js";
import { press, says, textOf } from "husillo/tests/panels.js";
import { isIdle, served, state, until } from "husillo/tests/served.js";

/** Two tools. */
const PART = `G21 G90
T1 M6 (6 mm flat)
M3 S1000
G0 Z2
G0 X5 Y5
G1 Z-1 F300
G0 Z2
T2 M6 (V bit)
G0 X10
G1 Z-1
G0 Z3
`;

/** @param {import("puppeteer-core").Page} page @param {string} verb @param {object} fields */
function ask(page, verb, fields) {
    return page.evaluate(
        (verb, fields) => Reflect.get(window, "husillo").request(verb, fields),
        verb,
        fields
    );
}

/**
 * Drops a program on the page, and starts it.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} text
 */
async function start(page, text) {
    await page.evaluate((text) => {
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([text], "part.nc"));
        window.dispatchEvent(new DragEvent("drop", { dataTransfer, cancelable: true }));
    }, text);
    await says(page, ".summary", "no errors");
    await press(page, "button::-p-aria(Start …)");
    await says(page, ".confirm", "T2 (V bit)");
    await press(page, "button::-p-aria(Start now)");
}

/** Waits for the change to a tool. @param {any} page @param {number} tool */
function changing(page, tool) {
    return until(page, ({ program, state }) => program.change?.tool === tool && state !== "Run");
}

/** Moves by hand, and waits for the end. @param {any} page @param {object} by */
async function step(page, by) {
    const before = await state(page);
    await ask(page, "step", { move_mm: by, feed: 500 });
    await until(
        page,
        (now) =>
            now.state === before.state && String(now.machine_mm) !== String(before.machine_mm)
    );
}

/** Measures the tool with the wizard. @param {import("puppeteer-core").Page} page */
async function measure(page) {
    await press(page, ".tool-change button::-p-aria(Measure the length of the tool)");
    await press(page, "#part-probing button.main");
    await says(page, "#part-probing .result", "Done.");
    return textOf(page, "#part-probing .result");
}

test("a program waits for its tools, which are measured, and goes on", async (t) => {
    const { port, panel } = await emulated(t, "grbl");
    const { page } = await served(t, {}, "--port", port);
    await until(page, ({ work_mm }) => work_mm);
    await until(page, isIdle);
    await tryProbe(page, panel);
    await start(page, PART);
    await changing(page, 1);
    await says(page, ".tool-change h2", "T1 (6 mm flat)");
    await says(page, ".tool-change .error", "No tool was measured before");
    assert.match(await measure(page), /by 0\.000 mm/);
    await says(page, ".tool-change .soft", "contact of the first tool: machine Z -10.0");
    await press(page, "button::-p-aria(Go on with the program)");
    const waits = await changing(page, 2);
    assert.deepEqual(waits.work_mm, [5, 5, 2]);
    assert.equal(waits.program.phase, "waiting");
    assert.equal(waits.accessories.spindle, "off");
    await says(page, ".state", "CHANGE THE TOOL");
    // The next tool is 2 mm longer: its tip is 500 steps lower.
    panel("push z -500");
    await step(page, { x: -3, y: 1 });
    // The contact of the first tool outlasts a reload of the page.
    await page.reload();
    await page.waitForFunction(() => Reflect.get(window, "husillo").isOperator);
    await tryProbe(page, panel);
    assert.match(await measure(page), /by 2\.000 mm/);
    await says(page, ".tool-change .soft", "Length of the tool in effect: 2.000 mm");
    assert.deepEqual(await violations(page), []);
    await page.$eval(".tool-change", (one) => one.scrollIntoView({ block: "center" }));
    await picture(page, "serve-tool-change");
    await press(page, "button::-p-aria(Go on with the program)");
    const done = await until(page, ({ program }) => program.phase === "done");
    assert.deepEqual(done.work_mm, [10, 5, 3]);
    // The longer tool is that much higher.
    assert.deepEqual(done.machine_mm, [10, 5, 5]);
    assert.equal((await until(page, (now) => now.accessories)).accessories.spindle, "cw");
    // Up, over the place, spindle on, down, and on: as it was said.
    /** @type {string[]} */
    const sent = await page.evaluate(() =>
        Reflect.get(window, "husillo")
            .machine.lines.filter((/** @type {any} */ one) => one.from === "host")
            .map((/** @type {any} */ one) => one.text)
    );
    const back = sent.slice(sent.lastIndexOf("M5M9")).filter((text) => /^G0|^G1Z|^M3/.test(text));
    const over = back.findIndex((text) => text.includes("X5.000Y5.000"));
    assert.match(back[over - 1], /^G0Z/);
    assert.match(back[over + 1], /^M3S1000/);
});

test("a program that was stopped at a tool asks for it again", async (t) => {
    const { port, panel } = await emulated(t, "grbl");
    const { page } = await served(t, {}, "--port", port);
    await until(page, ({ work_mm }) => work_mm);
    await until(page, isIdle);
    await tryProbe(page, panel);
    await start(page, PART);
    await changing(page, 1);
    await press(page, "button::-p-aria(Go on with the program)");
    await changing(page, 2);
    await press(page, "button.stop");
    const stopped = await until(page, ({ program }) => program.phase === "stopped");
    assert.equal(stopped.program.resume_line, 8);
    assert.equal(stopped.program.change, null);
    await until(page, isIdle);
    await press(page, "button::-p-aria(Go on from line 8)");
    await press(page, "button::-p-aria(Start now)");
    await changing(page, 2);
    await press(page, "button::-p-aria(Go on with the program)");
    const done = await until(page, ({ program }) => program.phase === "done");
    assert.deepEqual(done.work_mm, [10, 5, 3]);
});

test("the controller of grblHAL changes and measures its tools", async (t) => {
    const { port, panel } = await emulated(t, "grblhal");
    const { page } = await served(t, {}, "--port", port);
    await until(page, ({ work_mm }) => work_mm);
    await until(page, isIdle);
    await ask(page, "settings_save", { values: { 341: "1" } });
    await start(page, PART);
    const first = await changing(page, 1);
    assert.deepEqual([first.state, first.program.change.kind], ["Tool", 1]);
    await says(page, ".tool-change ol", "Z is up");
    await press(page, "button::-p-aria(Measure the tool ($TPW))");
    await page.waitForFunction(() =>
        Reflect.get(window, "husillo").machine.lines.some((/** @type {any} */ one) =>
            one.text.startsWith("[PRB:")
        )
    );
    await until(page, ({ state }) => state === "Tool");
    await press(page, "button::-p-aria(Go on with the program)");
    await changing(page, 2);
    panel("push z -500");
    await step(page, { x: -3 });
    await press(page, "button::-p-aria(Measure the tool ($TPW))");
    await until(page, (now) => now.state === "Tool" && now.tool_length_mm === 2);
    assert.deepEqual(await violations(page), []);
    await page.$eval(".tool-change", (one) => one.scrollIntoView({ block: "center" }));
    await picture(page, "serve-tool-change-hal");
    await press(page, "button::-p-aria(Go on with the program)");
    const done = await until(page, ({ program }) => program.phase === "done");
    assert.deepEqual(done.work_mm.slice(0, 1).concat(done.work_mm[2]), [10, 3]);
    assert.equal(done.machine_mm[2], 5);
});
