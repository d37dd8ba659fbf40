import assert from "node:assert/strict";
import { test } from "node:test";
import { open, picture, violations } from "husillo/tests/browser.js";
import { press, says, textOf } from "husillo/tests/panels.js";
import { home, isIdle, served, state, until } from "husillo/tests/served.js";

test("connect, home, jog and release, zero and undo", async (t) => {
    const { page } = await served(t);
    await home(page);
    await says(page, ".state", "IDLE");
    const before = await state(page);
    await page.hover('[data-jog="X-"]');
    await page.$eval('[data-jog="X-"]', (one) => one.scrollIntoView({ block: "center" }));
    await page.hover('[data-jog="X-"]');
    await page.mouse.down();
    // On a busy computer the page may not renew its lease in time, so that the jog is short.
    await until(page, ({ machine_mm }) => machine_mm[0] < before.machine_mm[0] - 0.2);
    const released = Date.now();
    await page.mouse.up();
    const stopped = await until(page, isIdle);
    t.diagnostic(`the page shows that it stands ${Date.now() - released} ms after the release`);
    assert.equal(stopped.jog, null);
    // It stands: a second later it is where it was.
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 1000)));
    assert.deepEqual((await state(page)).machine_mm, stopped.machine_mm);
    await press(page, "button::-p-aria(Zero all axes)");
    await until(page, ({ undo, work_mm }) => undo === 1 && String(work_mm) === "0,0,0");
    assert.equal(await textOf(page, '[data-work="X"]'), "0.000");
    await press(page, "button::-p-text(Undo zero)");
    const atFirst = String(stopped.work_mm);
    await until(page, ({ undo, work_mm }) => undo === 0 && String(work_mm) === atFirst);
    await page.keyboard.press("ArrowLeft");
    await press(page, "button::-p-aria(1 mm)");
    await press(page, '[data-jog="Z-"]');
    await until(page, ({ machine_mm }) => machine_mm[2] === stopped.machine_mm[2] - 1);
    await page.type("input.mono", "G21 G91 G0 X-1.5\n");
    await until(page, ({ machine_mm }) => machine_mm[0] < stopped.machine_mm[0] - 1.4);
    // A line is refused while the machine moves.
    await until(page, isIdle);
    await page.type("input.mono", "G90\n");
    await says(page, ".log", "> G90");
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-by-hand");
});

test("others watch, a reload goes on, a killed server is said", async (t) => {
    const expected = /WebSocket|ERR_CONNECTION|failed: /;
    const { page, server } = await served(t, { scheme: "dark", expected });
    const other = await open(t, { address: server.address, expected });
    await says(other, ".operator", "Watching");
    assert.equal(await other.$eval('[data-jog="X+"]', (one) => one.matches(":disabled")), true);
    await page.reload();
    await page.waitForFunction(() => Reflect.get(window, "husillo").state);
    await until(page, ({ clients }) => clients === 2);
    await press(other, "button::-p-text(Take control)");
    await says(other, ".operator", "You operate");
    await says(page, ".operator", "Watching");
    await until(page, ({ link }) => link === "up");
    // A page in the background is not drawn.
    await page.bringToFront();
    await picture(page, "serve-watching");
    server.kill();
    await says(page, ".state", "NO LINK");
    await says(page, ".notices", "emergency stop");
    await picture(page, "serve-lost");
    assert.deepEqual(await violations(page), []);
});

test("a long line is paused, resumed and stopped", async (t) => {
    const { page } = await served(t);
    await home(page);
    await page.type("input.mono", "G21 G91 G1 X-40 F300\n");
    await until(page, ({ state }) => state === "Run");
    await press(page, "button.pause");
    await until(page, ({ state, detail }) => state === "Hold" && detail === 0);
    await press(page, "button.resume");
    await until(page, ({ state }) => state === "Run");
    await press(page, "button.stop");
    await until(page, ({ state, stopping }) => state !== "Run" && !stopping);
    const stopped = await state(page);
    assert.notEqual(stopped.state, "Alarm", "it has braked, so the position is valid");
});
