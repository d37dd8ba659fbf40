import assert from "node:assert/strict";
import { test } from "node:test";
import { picture, violations } from "husillo/tests/browser.js";
import { Cable } from "husillo/tests/cable.js";
import { press, says, textOf } from "husillo/tests/panels.js";
import { isIdle, served, state, until } from "husillo/tests/served.js";

/** The buttons of the microfactory. Other machines have pads of their own, which are hidden. */
const jog = (/** @type {string} */ name) => `section:not([hidden]) [data-jog="${name}"]`;
const ALL = ["X+", "X-", "Y+", "Y-", "Z+", "Z-", "C+", "C-"];
const STEPS = "section:not([hidden]) .field input[size='5']";
const ZIGZAG = "300 700\n300 -500\n300 500\n300 -700\n-1200 0\n";

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
async function home(page) {
    await until(page, ({ factory }) => factory);
    await press(page, "section[aria-label='Move by hand']:not([hidden]) button.main");
    await until(page, ({ state }) => state === "Home");
    return until(page, ({ state, factory }) => state === "Idle" && factory.is_homed);
}

/**
 * The buttons that are grey.
 *
 * @param {import("puppeteer-core").Page} page
 */
function grey(page) {
    return page.$$eval("section:not([hidden]) [data-jog]", (all) =>
        all.filter((one) => one.matches(":disabled")).map((one) => one.getAttribute("data-jog"))
    );
}

/**
 * @param {import("puppeteer-core").Page} page
 * @param {string} name
 * @param {boolean} isLit
 */
function lamp(page, name, isLit) {
    return page.waitForFunction(
        (name, isLit) =>
            document
                .querySelector(`[data-lamp="${name}"]`)
                ?.classList.contains("lit") === isLit,
        {},
        name,
        isLit
    );
}

test("a microfactory is homed, moved by its eight buttons and by steps", async (t) => {
    const { page } = await served(t, {}, "-m", "microfactory", "--speed", "4");
    await until(page, ({ factory }) => factory);
    const cards = await page.$$eval(".card", (all) =>
        all.filter((one) => one.checkVisibility()).map((one) => one.getAttribute("aria-label"))
    );
    assert.deepEqual(cards, [
        "Live plot",
        "Program",
        "Console",
        "Microfactory",
        "Move by hand",
        "Keys",
    ]);
    await says(page, ".notices", "not homed");
    await home(page);
    await lamp(page, "homed", true);
    await says(page, '[data-length="X"]', "0.0000");
    assert.deepEqual(await grey(page), []);
    assert.equal(await page.$$eval("section:not([hidden]) [data-jog]", (all) => all.length), 8);
    // Hold the spindle: the seven others are grey.
    await page.$eval(jog("C-"), (one) => one.scrollIntoView({ block: "center" }));
    await page.hover(jog("C-"));
    await page.mouse.down();
    await until(page, ({ state, factory }) => state === "Jog" && factory.steps[3] < -100);
    await lamp(page, "moving", true);
    const others = await grey(page);
    assert.deepEqual(others.sort(), ALL.filter((name) => name !== "C-").sort());
    await page.mouse.up();
    await until(page, isIdle);
    const greyOne = "section:not([hidden]) [data-jog]:disabled";
    await page.waitForFunction((one) => !document.querySelector(one), {}, greyOne);
    // A key, and a second one: one motor moves at a time.
    await page.keyboard.down("ArrowRight");
    await until(page, ({ state, factory }) => state === "Jog" && factory.steps[0] > 100);
    await page.keyboard.down("ArrowUp");
    const both = await until(page, isIdle);
    await page.keyboard.up("ArrowUp");
    await page.keyboard.up("ArrowRight");
    assert.equal(both.factory.steps[1], 0);
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 700)));
    const { factory: before } = await state(page);
    // A number of steps.
    await press(page, "button::-p-aria(Number of steps)");
    await page.select("section:not([hidden]) .field select", "Z");
    for (const [text, valid] of /** @type {const} */ ([
        ["0", false],
        ["256", false],
        ["77", true],
    ])) {
        await page.$eval(STEPS, (one, text) => {
            const field = /** @type {HTMLInputElement} */ (one);
            field.value = text;
            field.dispatchEvent(new Event("input"));
        }, text);
        const isOff = await page.$eval("button::-p-aria(Enter)", (one) => one.matches(":disabled"));
        assert.equal(isOff, !valid, text);
    }
    await press(page, "button::-p-aria(Enter)");
    await until(page, ({ state, factory }) => state === "Idle" && factory.steps[2] === 77);
    assert.equal((await state(page)).factory.steps[0], before.steps[0]);
    await says(page, '[data-steps="Z"]', "77");
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-microfactory-steps");
});

test("a figure is corrected, drawn, cut, and has a report", async (t) => {
    const { page } = await served(t, {}, "-m", "microfactory", "--speed", "2");
    await home(page);
    await drop(page, "zigzag.fig", ZIGZAG.replace("-500", "down"));
    await until(page, ({ program }) => program?.errors === 1);
    await says(page, ".findings", "a move is two numbers");
    assert.equal(
        await page.$eval("button::-p-text(Figure …)", (one) => one.matches(":disabled")),
        true
    );
    await page.$eval("textarea.source", (one, text) => {
        /** @type {any} */ (one).value = text;
    }, ZIGZAG);
    await press(page, "button::-p-aria(Check again)");
    await until(page, ({ program }) => program?.errors === 0 && program.lines === 5);
    await page.waitForSelector(".preview canvas");
    await says(page, ".summary", "5 moves");
    await press(page, "button::-p-text(Figure …)");
    await says(page, ".confirm", "5 moves");
    await says(page, ".confirm", "until the tool touches");
    await press(page, ".confirm button.main");
    await until(page, ({ program, factory }) => factory.contact && program.line > 1);
    assert.equal((await grey(page)).length, 8);
    await lamp(page, "contact", true);
    assert.match(await textOf(page, ".current"), /^Move [2-5] \/ 5$/);
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-microfactory-figure");
    await until(page, ({ program }) => program.phase === "done");
    await says(page, "a[target=_blank]", "Report");
    await says(page, ".message", "5 moves cut");
});

test("an emergency stop holds until the reset, and any page can press it", async (t) => {
    const { page, server } = await served(t, {}, "-m", "microfactory", "--speed", "2");
    await home(page);
    const other = await page.browser().newPage();
    await other.goto(server.address);
    await until(other, ({ factory }) => factory?.is_homed);
    await page.bringToFront();
    await drop(page, "zigzag.fig", ZIGZAG);
    await until(page, ({ program }) => program?.errors === 0);
    await press(page, "button::-p-text(Figure …)");
    await press(page, ".confirm button.main");
    await until(page, ({ factory }) => factory.contact);
    await other.bringToFront();
    await press(other, "button.emergency");
    await until(other, ({ state, factory }) => state === "Alarm" && factory.is_latched);
    await other.close();
    await page.bringToFront();
    await says(page, ".state", "EMERGENCY STOP");
    await says(page, ".notices", "Nothing moves");
    await lamp(page, "emergency", true);
    assert.equal((await grey(page)).length, 8);
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-microfactory-emergency");
    await press(page, "button::-p-aria(Reset the machine)");
    await until(page, ({ state, factory }) => state === "Idle" && !factory.is_latched);
    await lamp(page, "homed", false);
    await home(page);
});

test("an emergency stop without a link acts when the controller answers again", async (t) => {
    const cable = await Cable.to(t, "microfactory");
    const { page } = await served(t, {}, "-m", "microfactory", "--port", cable.port);
    await until(page, ({ factory }) => factory);
    cable.pull();
    await until(page, ({ link }) => link === "lost");
    await press(page, "button.emergency");
    await until(page, ({ emergency_waits }) => emergency_waits);
    await says(page, ".notices", "has not confirmed it");
    await says(page, ".notices", "Use the button at the machine");
    assert.deepEqual(await violations(page), []);
    cable.plug();
    await until(page, ({ factory }) => factory?.is_latched);
    await says(page, ".state", "EMERGENCY STOP");
    assert.ok(!(await state(page)).emergency_waits);
});

test("at the width of a phone, dark and in Spanish", async (t) => {
    const wanted = { scheme: /** @type {const} */ ("dark"), language: "es-MX", width: 360 };
    const { page } = await served(t, wanted, "-m", "microfactory", "--speed", "20");
    await until(page, ({ factory }) => factory);
    await drop(page, "figura.fig", ZIGZAG);
    await until(page, ({ program }) => program?.errors === 0);
    await says(page, '[data-value="factory-status"]', "desde donde se encendió");
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 360, `${wide} pixels`);
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-microfactory-phone");
});
