import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import { PICTURES, open, picture, violations } from "husillo/tests/browser.js";
import { press, says } from "husillo/tests/panels.js";
import { home, served, state, until } from "husillo/tests/served.js";

/** A part of some seconds within the travel of the simulated mill. */
const PART = `G21 G90 G17 G94
G0 X5 Y5
G1 X25 F600
G1 Y15
G2 X15 Y15 I-5 J0
G1 X5
G1 Y5
G0 X0 Y0
`;

/**
 * Drops a program on the page.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} text
 */
function drop(page, text) {
    return page.evaluate((text) => {
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([text], "part.nc"));
        window.dispatchEvent(new DragEvent("drop", { dataTransfer, cancelable: true }));
    }, text);
}

test("findings, fix, preview, run, hold, resume, override and STOP", async (t) => {
    const { page, server } = await served(t);
    await home(page);
    // The work zero in the middle of the travel, so that the part fits.
    await page.type("input.mono", "G53 G0 X-60 Y-60 Z-20\n");
    await until(page, (now) => now.machine_mm[1] < -59 && now.state === "Idle");
    await press(page, "button::-p-aria(Zero all axes)");
    await until(page, ({ undo }) => undo === 1);
    await drop(page, PART.replace("G1 Y15", "G1 Y15 X"));
    await says(page, ".findings", "Line 4:");
    const start = await page.$("button::-p-aria(Start …)");
    assert.equal(await start?.evaluate((one) => one.matches(":disabled")), true);
    await drop(page, PART);
    await page.waitForSelector('.stage[data-drawn="whole"]');
    await says(page, ".summary", "no errors");
    await press(page, "button::-p-aria(Start …)");
    await says(page, ".confirm", "part.nc");
    assert.equal((await state(page)).state, "Idle");
    await picture(page, "serve-start");
    await press(page, "button::-p-aria(Start now)");
    await until(page, ({ program }) => program?.line >= 3);
    await press(page, "button::-p-aria(Pause)");
    const held = await until(page, ({ state, detail }) => state === "Hold" && detail === 0);
    await says(page, ".state", "ON HOLD");
    assert.ok(held.program.progress < 1);
    await press(page, "button::-p-aria(Resume)");
    await until(page, ({ state }) => state === "Run");
    await page.$eval('input[aria-label="Override: Feed"]', (slider) => {
        slider.value = "50";
        slider.dispatchEvent(new Event("input"));
    });
    await until(page, ({ override }) => override.feed === 50);
    await picture(page, "serve-run");
    await page.keyboard.press("Escape");
    const stopped = await until(page, ({ state }) => state !== "Run" && state !== "Hold");
    assert.equal(stopped.program.phase, "stopped");
    assert.deepEqual(await violations(page), []);
    assert.ok(server.address.length > 32);
    await page.setViewport({ width: 360, height: 740 });
    await page.screenshot({ path: join(PICTURES, "serve-telephone.png"), fullPage: true });
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 360);
});

test("a stopped run goes on from its line, with the state shown first", async (t) => {
    const { page } = await served(t);
    await home(page);
    await page.type("input.mono", "G53 G0 X-60 Y-60 Z-20\n");
    await until(page, (now) => now.machine_mm[1] < -59 && now.state === "Idle");
    await press(page, "button::-p-aria(Zero all axes)");
    await until(page, ({ undo }) => undo === 1);
    await drop(page, PART.replace("G0 X5 Y5", "G0 X5 Y5\nM3 S500"));
    await page.waitForSelector('.stage[data-drawn="whole"]');
    await press(page, "button::-p-aria(Start …)");
    await press(page, "button::-p-aria(Start now)");
    await until(page, ({ program, work_mm }) => program?.line >= 4 && work_mm[0] > 8);
    await page.keyboard.press("Escape");
    const stopped = await until(page, ({ state, program }) =>
        state === "Idle" && program.phase === "stopped"
    );
    await press(page, `button::-p-aria(Go on from line ${stopped.program.resume_line})`);
    await says(page, ".confirm", "State before this line:");
    await says(page, ".confirm", "absolute (G90)");
    await says(page, ".confirm", "G0 Z0");
    assert.equal(String((await state(page)).work_mm), String(stopped.work_mm));
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-from-line");
    await press(page, "button::-p-aria(Start now)");
    const done = await until(page, ({ state, program }) =>
        state === "Idle" && program.phase === "done"
    );
    assert.equal(String(done.work_mm), "0,0,0");
    assert.equal(done.program.resume_line, null);
    assert.equal(done.program.runs, 2);
    await picture(page, "serve-done");
    const link = await page.waitForSelector("a::-p-text(Report of the run)");
    const address = await link?.evaluate((one) => /** @type {any} */ (one).href);
    const report = await open(t, { address, width: 1280, height: 1400 });
    await report.waitForSelector('.stage[data-drawn="whole"]');
    const text = await report.evaluate(() => document.body.textContent ?? "");
    for (const what of ["On the machine", "part.nc", "from line", "lines made", "alarms0"]) {
        assert.ok(text.includes(what), what);
    }
    assert.deepEqual(await violations(report), []);
    await picture(report, "serve-report");
});
