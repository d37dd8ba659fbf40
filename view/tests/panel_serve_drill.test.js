import assert from "node:assert/strict";
import { test } from "node:test";
import { picture, violations } from "husillo/tests/browser.js";
import { press, says, textOf } from "husillo/tests/panels.js";
import { isIdle, served, state, until } from "husillo/tests/served.js";

/** The button of the drill. Other machines have a pad of their own, which is hidden. */
const X_PLUS = 'section:not([hidden]) [data-jog="X+"]';
const BOARD = [
    "M48",
    "METRIC,TZ",
    "T1C0.8",
    "T2C1.0",
    "%",
    "T1",
    "X10.0Y10.0",
    "X14.0Y10.0",
    "T2",
    "X10.0Y14.0",
    "M30",
    "",
].join("\n");

/**
 * Drops a file on the page.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} name
 * @param {string} text
 */
function drop(page, name, text) {
    return page.evaluate(
        (name, text) => {
            const dataTransfer = new DataTransfer();
            dataTransfer.items.add(new File([text], name));
            window.dispatchEvent(new DragEvent("drop", { dataTransfer, cancelable: true }));
        },
        name,
        text
    );
}

/** @param {import("puppeteer-core").Page} page */
async function enterManual(page) {
    await press(page, "section[aria-label='Move by hand'] button.main");
    await until(page, ({ state }) => state === "Home");
    return until(page, ({ state, drill }) => state === "Idle" && drill.is_manual);
}

/**
 * @param {import("puppeteer-core").Page} page
 * @param {string} selector
 */
function isLit(page, selector) {
    return page.waitForFunction(
        (selector) => document.querySelector(selector)?.classList.contains("lit"),
        {},
        selector
    );
}

test("a drill is moved by hand with the keys of the original, and taught", async (t) => {
    const { page } = await served(t, {}, "-m", "drill", "--speed", "8");
    await until(page, ({ drill }) => drill?.is_homed);
    const cards = await page.$$eval(".card", (all) =>
        all.filter((one) => one.checkVisibility()).map((one) => one.getAttribute("aria-label"))
    );
    assert.deepEqual(cards, [
        "Drill",
        "Board",
        "Program",
        "Console",
        "Position",
        "Move by hand",
        "Keys",
    ]);
    await says(page, '[data-value="drill-status"]', "command mode");
    await isLit(page, '[data-lamp="ready"]');
    // Nothing moves before the manual mode.
    assert.equal(await page.$eval(X_PLUS, (one) => one.matches(":disabled")), true);
    await says(page, "[aria-label='Move by hand']:not([hidden]) .why", "manual mode first");
    await enterManual(page);
    await isLit(page, '[data-lamp="manual"]');
    // Hold a button, and a key.
    await page.$eval(X_PLUS, (one) => one.scrollIntoView({ block: "center" }));
    await page.hover(X_PLUS);
    await page.mouse.down();
    await until(page, ({ state, work_mm: [x] }) => state === "Jog" && x > 1);
    await isLit(page, '[data-lamp="x"]');
    await page.mouse.up();
    await until(page, isIdle);
    await page.focus(".screen");
    await page.keyboard.down("ArrowUp");
    await until(page, ({ work_mm: [, y] }) => y > 1);
    await page.keyboard.up("ArrowUp");
    const stopped = await until(page, isIdle);
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
    assert.deepEqual((await state(page)).drill.steps, stopped.drill.steps);
    // Tab makes the step larger by one, and Shift+Tab smaller.
    await page.focus(".screen");
    for (let at = 0; at < 4; at++) await page.keyboard.press("Tab");
    await page.keyboard.down("Shift");
    await page.keyboard.press("Tab");
    await page.keyboard.up("Shift");
    await says(page, '[data-value="step-length"]', "0.0280 mm");
    const [x, y] = stopped.drill.steps;
    await page.keyboard.press("ArrowRight");
    await until(page, ({ state, drill }) => state === "Idle" && drill.steps[0] === x + 3);
    await page.keyboard.press("ArrowDown");
    await until(page, ({ state, drill }) => state === "Idle" && drill.steps[1] === y - 3);
    // The spindle, and the units.
    await page.keyboard.press("Home");
    await until(page, ({ state, drill }) => state === "Idle" && drill.spindle);
    await isLit(page, '[data-lamp="drill"]');
    await page.keyboard.press("End");
    await until(page, ({ state, drill }) => state === "Idle" && !drill.spindle);
    await page.keyboard.press("F5");
    await says(page, '[data-value="drill-status"]', " in ");
    await page.keyboard.press("F5");
    await page.keyboard.press("F3");
    await says(page, "[aria-label='Move by hand']:not([hidden]) .why[role=status]", "works");
    // Z leaves its sensor, and returns.
    await page.keyboard.press("PageDown");
    await until(page, ({ state, drill }) => state === "Idle" && drill.z === "between");
    await says(page, '[data-value="drill-status"]', "between its sensors");
    await page.keyboard.press("PageUp");
    await until(page, ({ state, drill }) => state === "Idle" && drill.z === "up");
    // Teach two holes, and load them.
    await press(page, "button::-p-aria(Teach this hole)");
    await until(page, ({ drill }) => drill.taught_mm.length === 1);
    await press(page, "button::-p-aria(50 steps)");
    await press(page, X_PLUS);
    await until(page, ({ state, drill }) => state === "Idle" && drill.steps[0] === x + 53);
    await press(page, "button::-p-aria(Teach this hole)");
    await until(page, ({ drill }) => drill.taught_mm.length === 2);
    await press(page, "button::-p-aria(Load the taught program)");
    await until(page, ({ program }) => program?.name === "taught.txt" && program.lines === 2);
    await says(page, ".summary", "2 holes");
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-drill-manual");
    // The zero of the operator, and F1 back to the switches.
    await page.focus(".screen");
    await page.keyboard.press("F2");
    await until(page, ({ work_mm, zero_mm }) => String(work_mm) === "0,0" && zero_mm[0] > 1);
    await page.keyboard.press("F1");
    await until(page, ({ state, zero_mm }) => state === "Idle" && zero_mm[0] === 0);
    await page.keyboard.press("F6");
    assert.equal(
        await page.evaluate(() => document.activeElement?.textContent),
        "Leave manual mode"
    );
});

test("a board is corrected, registered, drilled, stopped, and goes on", async (t) => {
    const { page } = await served(t, {}, "-m", "drill", "--speed", "20");
    await until(page, ({ drill }) => drill?.is_homed);
    // An error with its place, before anything moves.
    await drop(page, "board.drl", BOARD.replace("X14.0Y10.0", "X14.0Y90.0"));
    await until(page, ({ program }) => program?.errors === 1);
    await says(page, ".findings", "off the table");
    const start = "nav button::-p-text(Start …)";
    assert.equal(await page.$eval(start, (one) => one.matches(":disabled")), true);
    await page.$eval("textarea.source", (one, text) => {
        /** @type {any} */ (one).value = text;
    }, BOARD);
    await press(page, "button::-p-aria(Check again)");
    await until(page, ({ program }) => program?.errors === 0 && program.lines === 3);
    await says(page, ".tools", "T1 0.8 mm");
    assert.equal(await page.$$eval(".tools li", (all) => all.length), 2);
    assert.equal(await page.$$eval("a[download$='.cod']", (all) => all.length), 2);
    // Two holes are measured half a millimetre to the right.
    await enterManual(page);
    await press(page, ".card details summary::-p-text(Place on the table)");
    const choose = async (/** @type {string} */ number) => {
        await page.$eval("input[size='5'][inputmode=numeric]", (one, number) => {
            const field = /** @type {HTMLInputElement} */ (one);
            field.value = number;
            field.dispatchEvent(new Event("input"));
        }, number);
        await says(page, '[data-value="hole"]', `Hole ${number}:`);
    };
    for (const [number, at] of /** @type {const} */ ([["1", 1070], ["2", 1498]])) {
        await choose(number);
        await press(page, "button::-p-aria(Move there)");
        await until(page, ({ state, drill }) => state === "Idle" && drill.steps[0] === at);
        await press(page, "button::-p-aria(50 steps)");
        await press(page, X_PLUS);
        await until(page, ({ state, drill }) => state === "Idle" && drill.steps[0] === at + 50);
        await press(page, "button::-p-aria(The drill is over this hole)");
    }
    assert.equal(await page.$$eval(".references li", (all) => all.length), 2);
    await press(page, "button::-p-aria(Place the board)");
    await says(page, '[data-value="fit"]', "largest deviation 0.000 mm");
    await choose("1");
    await says(page, '[data-value="hole"]', "X10.467");
    // Start in two steps; STOP with the drill in the board.
    await press(page, start);
    await says(page, ".confirm", "put in T1 (0.8 mm)");
    await press(page, ".confirm button.main");
    await until(page, ({ program, drill }) => program.line === 2 && drill.lights.includes("drill"));
    await says(page, ".current", "Hole 2 / 3");
    await page.keyboard.press("Escape");
    const end = await until(page, ({ program }) => program.phase === "stopped");
    assert.equal(end.program.resume_line, 2);
    await until(page, ({ state, drill }) => state === "Idle" && drill.z === "up" && drill.is_homed);
    await press(page, "button::-p-text(Go on from hole 2)");
    await says(page, ".confirm", "2 holes");
    await press(page, ".confirm button.main");
    await until(page, ({ program }) => program.phase === "waiting" && program.waits_before === 3);
    await says(page, ".message", "put in T2 (1 mm)");
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-drill-board");
    await press(page, "button::-p-aria(Resume)");
    await until(page, ({ program }) => program.phase === "done" && program.sent === 3);
    await says(page, "a[target=_blank]", "Report");
});

test("at the width of a phone, dark and in Spanish", async (t) => {
    const wanted = { scheme: /** @type {const} */ ("dark"), language: "es-MX", width: 360 };
    const { page } = await served(t, wanted, "-m", "drill", "--speed", "20");
    await until(page, ({ drill }) => drill?.is_homed);
    await drop(page, "placa.drl", BOARD);
    await until(page, ({ program }) => program?.errors === 0);
    await says(page, '[data-value="drill-status"]', "modo de órdenes");
    await says(page, ".tools", "2 agujeros");
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 360, `${wide} pixels`);
    assert.equal(await textOf(page, "button.stop"), "PARO Esc, espacio");
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-drill-phone");
});

test("a drill that is jogged stops when its page is closed", async (t) => {
    const { page, server } = await served(t, {}, "-m", "drill", "--speed", "2");
    await until(page, ({ drill }) => drill?.is_homed);
    await enterManual(page);
    const other = await page.browser().newPage();
    await other.goto(server.address);
    await until(other, ({ drill }) => drill?.is_manual);
    await page.bringToFront();
    await page.focus(".screen");
    await page.keyboard.down("ArrowRight");
    await until(page, ({ state, work_mm: [x] }) => state === "Jog" && x > 0.5);
    await page.goto("about:blank");
    const end = await until(other, ({ state }) => state === "Idle");
    await other.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
    assert.deepEqual((await state(other)).drill.steps, end.drill.steps);
    await other.close();
});
