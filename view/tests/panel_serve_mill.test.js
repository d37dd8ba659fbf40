import assert from "node:assert/strict";
import { test } from "node:test";
import { picture, violations } from "husillo/tests/browser.js";
import { press, says, textOf } from "husillo/tests/panels.js";
import { isIdle, served, state, until } from "husillo/tests/served.js";

/** The button of the mill. Other machines have a pad of their own, which is hidden. */
const X_PLUS = 'section:not([hidden]) [data-jog="X+"]';

/** @param {import("puppeteer-core").Page} page */
async function homed(page) {
    await until(page, ({ mill }) => mill);
    await says(page, ".notices", "not homed");
    await press(page, "button::-p-aria(Home)");
    await until(page, ({ state }) => state === "Home");
    return until(page, ({ state, mill }) => state === "Idle" && mill.is_homed);
}

/**
 * The colours of the plot that are drawn, by the names of their motions.
 *
 * @param {import("puppeteer-core").Page} page
 */
function drawn(page) {
    return page.$eval("canvas.mill-plot", (canvas) => {
        const plot = /** @type {HTMLCanvasElement} */ (canvas);
        const style = getComputedStyle(plot);
        const { data } = plot.getContext("2d")?.getImageData(0, 0, plot.width, plot.height) ?? {
            data: [],
        };
        return ["--jog", "--rapid", "--feed"].filter((name) => {
            const hex = style.getPropertyValue(name).trim();
            const full = hex.length === 4 ? hex.replace(/[0-9a-f]/g, "$&$&") : hex;
            const wanted = [1, 3, 5].map((at) => parseInt(full.slice(at, at + 2), 16));
            for (let at = 0; at < data.length; at += 4) {
                if (wanted.every((part, index) => Math.abs(data[at + index] - part) < 12)) {
                    return true;
                }
            }
            return false;
        });
    });
}

test("a mill is homed, jogged, stepped, zeroed, sent a line, and stopped", async (t) => {
    const { page } = await served(t, {}, "-m", "micromill", "--speed", "4");
    const cards = await page.$$eval(".card", (all) =>
        all.filter((one) => one.checkVisibility()).map((one) => one.getAttribute("aria-label"))
    );
    assert.deepEqual(cards, [
        "Live plot",
        "Program",
        "Confirmation",
        "Console",
        "Position",
        "Move by hand",
        "Speeds",
        "Backlash",
        "Keys",
    ]);
    const found = await homed(page);
    assert.deepEqual(found.machine_mm, [0, 0, 0]);
    // The page draws a state after it has got it.
    const isHome = () => document.querySelector('[data-machine="X"]')?.textContent === "0.00000";
    await page.waitForFunction(isHome);
    // Two axes at once, held with the mouse and a key.
    await page.$eval(X_PLUS, (one) => one.scrollIntoView({ block: "center" }));
    await page.hover(X_PLUS);
    await page.mouse.down();
    await until(page, ({ state }) => state === "Jog");
    await page.keyboard.down("ArrowUp");
    await until(page, ({ machine_mm: [x, y] }) => x > 0.02 && y > 0.02);
    await page.keyboard.press("]");
    await until(page, ({ mill }) => mill.jog_hz === 180);
    await says(page, '[data-value="jog-hz"]', "180");
    await page.keyboard.up("ArrowUp");
    await page.mouse.up();
    const stopped = await until(page, isIdle);
    assert.equal(stopped.jog, null);
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 600)));
    assert.deepEqual((await state(page)).mill.motor_steps, stopped.mill.motor_steps);
    // Steps.
    await press(page, "button::-p-aria(100 steps)");
    const [x] = (await state(page)).mill.motor_steps;
    await press(page, X_PLUS);
    await until(page, ({ state, mill }) => state === "Idle" && mill.motor_steps[0] === x + 100);
    await press(page, "button::-p-aria(Hold to move)");
    // The work zero of all axes.
    await press(page, "button::-p-aria(Zero all axes)");
    const zeroed = await until(page, ({ work_mm }) => String(work_mm) === "0,0,0");
    assert.deepEqual(zeroed.zero_mm, zeroed.machine_mm);
    await says(page, '[data-zero="X"]', zeroed.zero_mm[0].toFixed(5));
    // A string, and its confirmation.
    await page.type("input.mono", "G01X00100.00F14;\n");
    const isThere = (/** @type {any} */ { work_mm: [x] }) => Math.abs(x - 0.1) < 1e-3;
    await until(page, (state) => isIdle(state) && isThere(state));
    assert.equal(await textOf(page, '[data-value="sent"]'), "G01X00100.00F14;");
    assert.equal(await textOf(page, '[data-value="echo"]'), "G01X00100.00F14;");
    await says(page, '[data-value="outcome"]', "done");
    assert.equal(await page.$eval('[data-value="echo"]', (one) => one.className), "mono confirmed");
    // The backlash.
    await page.$eval('[data-um="X"]', (one) => (/** @type {any} */ (one).value = "200"));
    await press(page, "button::-p-aria([name='Set'][role='button'])");
    await until(page, ({ mill }) => mill.backlash_um[0] === 200);
    // A long move, ended by STOP.
    await page.type("input.mono", "G01Y01000.00F14;\n");
    await until(page, ({ state, mill }) => state === "Run" && mill.step_hz > 0);
    await press(page, "button.stop");
    const end = await until(page, ({ state, stopping }) => state === "Idle" && !stopping);
    assert.ok(end.mill.is_homed && end.work_mm[1] < 1, "the position is valid");
    assert.deepEqual(await drawn(page), ["--jog", "--rapid", "--feed"]);
    await page.setViewport({ width: 1280, height: 1400, deviceScaleFactor: 2 });
    await press(page, "button::-p-aria(Fit work area)");
    await page.waitForFunction(() => {
        const plot = document.querySelector("canvas.mill-plot");
        return plot instanceof HTMLCanvasElement && plot.width > plot.clientWidth * 1.9;
    });
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-mill");
});

test("a mill runs a program, and the page is in Spanish", async (t) => {
    const wanted = { scheme: /** @type {const} */ ("dark"), language: "es-MX" };
    const { page } = await served(t, wanted, "-m", "micromill", "--speed", "10");
    await until(page, ({ mill }) => mill);
    await says(page, ".notices", "no ha buscado su origen");
    await press(page, "button::-p-aria(Buscar origen)");
    await until(page, ({ mill, state }) => mill.is_homed && state === "Idle");
    const text = "G21 G90\nG1 X0.1 F1.4\nG1 Y0.1\nG1 X0 Y0\nM30\n";
    await page.evaluate((text) => {
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([text], "triangle.nc"));
        window.dispatchEvent(new DragEvent("drop", { dataTransfer, cancelable: true }));
    }, text);
    await until(page, ({ program }) => program?.errors === 0);
    await page.keyboard.down("Control");
    await page.keyboard.press("Enter");
    await page.keyboard.up("Control");
    await press(page, ".confirm button.main");
    await until(page, ({ program }) => program.phase === "running" && program.line === 3);
    await says(page, ".current", "G1 Y0.1");
    await until(page, ({ program }) => program.phase === "done");
    await says(page, '[data-value="outcome"]', "hecho");
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-mill-program");
});
