import assert from "node:assert/strict";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { picture, violations } from "husillo/tests/browser.js";
import { press, says } from "husillo/tests/panels.js";
import { isIdle, served, until } from "husillo/tests/served.js";

test("the probe is tried, then the height of a plate becomes the work zero", async (t) => {
    const { page } = await served(t);
    await until(page, ({ state }) => state === "Alarm");
    await press(page, "button::-p-aria(Unlock)");
    await until(page, isIdle);
    await says(page, "#part-probing .why", "Touch the probe to the tool by hand once");
    // The plate of the simulated machine is 10 mm below.
    await page.type("input.mono", "G21 G0 Z-10.5\n");
    await until(page, (now) => isIdle(now) && now.switches.includes("P"));
    await says(page, "#part-probing .why", "The probe is closed now");
    await page.type("input.mono", "G0 Z-7\n");
    await until(page, (now) => isIdle(now) && now.machine_mm[2] === -7);
    await says(page, "#part-probing ol", "The probe works");
    await page.$$eval("#part-probing label", (labels) => {
        for (const label of labels) {
            const field = label.querySelector("input");
            if (field && label.textContent?.startsWith("Thickness")) field.value = "1.5";
        }
    });
    await press(page, "button::-p-aria(Start measuring)");
    await says(page, ".result", "Done: the height is set");
    // The next report has the new work zero.
    const done = await until(page, ({ undo, zero_mm }) => undo === 1 && zero_mm[2] !== 0);
    const plate = done.work_mm[2] - done.machine_mm[2] - 10;
    assert.ok(Math.abs(plate - 1.5) < 0.05, `the plate is at ${plate} mm`);
    assert.ok(done.modal.includes("G90"), "the distances are what they were");
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-probing");
});

test("a macro is written, kept in its file, and run", async (t) => {
    const folder = mkdtempSync(join(tmpdir(), "husillo-"));
    t.after(() => rmSync(folder, { recursive: true }));
    const file = join(folder, "macros.toml");
    const { page } = await served(t, {}, "--macros", file);
    await until(page, ({ state }) => state === "Alarm");
    await press(page, "button::-p-aria(Unlock)");
    await until(page, isIdle);
    await press(page, "[role=tab]::-p-aria(Macros)");
    await press(page, "summary::-p-text(New macro)");
    await page.type("#part-macros input", "Aside");
    await page.type("#part-macros textarea", "G53 G0 X-3\nG53 G0 Y-4");
    await press(page, "#part-macros button::-p-aria(Save)");
    await press(page, "button::-p-aria(Aside)");
    await until(page, (now) => isIdle(now) && String(now.machine_mm) === "-3,-4,0");
    assert.match(readFileSync(file, "utf8"), /name = "Aside"/);
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-macros");
    await page.reload();
    await page.waitForFunction(() => Reflect.get(window, "husillo").isOperator);
    await press(page, "[role=tab]::-p-aria(Macros)");
    await says(page, "#part-macros ul", "Aside");
    await press(page, "button::-p-aria(Remove: Aside)");
    await page.waitForFunction(
        () => !document.querySelector("#part-macros ul")?.textContent?.includes("Aside")
    );
});
