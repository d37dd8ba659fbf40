import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import { test } from "node:test";
import { PICTURES, picture, violations } from "husillo/tests/browser.js";
import { panel, press, says, textOf } from "husillo/tests/panels.js";
import { PART, reportOf, sceneIn } from "husillo/tests/reports.js";
import { applied, offsetOf } from "husillo/panel/fixes.js";

const SCENE = sceneIn(reportOf("panel-part", PART, "-m", "router"));
const LINES = PART.split("\n").length - 1;

const LOADED = {
    name: "part.nc",
    lines: LINES,
    errors: 0,
    warnings: 0,
    load: 1,
    phase: "loaded",
    line: null,
    sent: 0,
    answered: 0,
    of: LINES,
    time_s: 95.2,
    elapsed_s: 0,
    remaining_s: 95.2,
    progress: 0,
    single_block: false,
    breakpoints: [],
    waits_before: null,
    message: null,
};

/** What a start at a line would do. */
const FROM_LINE = {
    name: "part.nc",
    lines: 10,
    time_s: 20,
    before: ["G21 G90 G94 G17 G54", "G0 Z5", "M3 S12000"],
    state: {
        modal: ["G17", "G21", "G90", "G94", "G1", "G54", "M3", "M9"],
        offset: "G54",
        tool: 2,
        programmed: { feed: 900, rpm: 12000 },
        work_mm: [52, 40, -4],
    },
    warnings: ["the lines before select another tool: put it in first"],
};

const WRONG = PART.replace("G1 Z-2 F300", "G1 Z-2 U4 F300");
const FINDING = {
    code: "E0201",
    severity: "error",
    line: 4,
    column: 8,
    end_column: 10,
    message: "unknown word `U`",
    help: "remove the word",
    fixes: [{ line: 4, column: 8, end_column: 11, text: "" }],
};

/**
 * A server that takes programs as `husillo serve` does: one with a `U` has an error.
 *
 * @param {import("husillo/tests/fake_server.js").FakeServer} server
 */
function takesPrograms(server) {
    let text = "";
    let load = 0;
    server.files["GET /machines/1/program"] = () => text;
    server.files["GET /machines/1/scene"] = () => SCENE;
    server.files["POST /machines/1/program"] = (body) => {
        text = body;
        const errors = body.includes("U4") ? 1 : 0;
        const program = { ...LOADED, errors, load: ++load };
        setTimeout(() => server.change({ program }));
        return {
            name: "part.nc",
            lines: LINES,
            errors,
            warnings: 0,
            is_complete: true,
            findings: errors ? [FINDING] : [],
            time_s: errors ? null : 95.2,
            has_scene: !errors,
            bounds_mm: errors ? null : { least: [0, 0, -4], most: [60, 50, 5] },
        };
    };
}

/**
 * Opens a panel with a program, chosen with the file field.
 *
 * @param {import("node:test").TestContext} t
 * @param {string} text
 * @param {import("husillo/tests/browser.js").Wanted} [wanted]
 */
async function loaded(t, text, wanted = {}) {
    const opened = await panel(t, wanted, { prepare: takesPrograms });
    const path = join(PICTURES, "part.nc");
    writeFileSync(path, text);
    const field = await opened.page.$("input[type=file]");
    await field?.uploadFile(path);
    return opened;
}

/** @param {import("puppeteer-core").Page} page */
function drawn(page) {
    return page.waitForSelector('.stage[data-drawn="whole"]');
}

test("a fix takes the place of its columns, an offset counts characters", () => {
    const fix = { line: 2, column: 2, end_column: 4, text: "X" };
    assert.equal(applied("a\nñbcd\nz", [fix]), "a\nñXd\nz");
    assert.equal(offsetOf("a\n𝒳bc", 2, 2), 4);
});

test("findings have their place and a fix, before anything moves", async (t) => {
    const { page, server } = await loaded(t, WRONG);
    await says(page, ".findings", "Line 4:8 error E0201: unknown word");
    await says(page, ".summary", "errors: 1");
    const start = await page.$("button::-p-aria(Start …)");
    assert.equal(await start?.evaluate((one) => one.matches(":disabled")), true);
    await says(page, ".findings code", "G1 Z-2 F300");
    await press(page, "button::-p-aria(Show the place)");
    const selected = await page.$eval("textarea.source", (one) =>
        one.value.slice(one.selectionStart, one.selectionEnd)
    );
    assert.equal(selected, "U4");
    assert.deepEqual(await violations(page), []);
    await picture(page, "panel-findings");
    await press(page, "button::-p-aria(Apply this fix)");
    await drawn(page);
    await says(page, ".summary", "no errors");
    const text = await (await fetch(`${server.address.replace(/#.*/, "")}machines/1/program`, {
        headers: { authorization: "Bearer 0123456789abcdef0123456789abcdef" },
    })).text();
    assert.equal(text, PART);
});

test("a file is dropped on the page, and previewed", async (t) => {
    const { page } = await panel(t, { height: 1600 }, { prepare: takesPrograms });
    await page.evaluate((text) => {
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([text], "part.nc"));
        window.dispatchEvent(new DragEvent("drop", { dataTransfer, cancelable: true }));
    }, PART);
    await drawn(page);
    await says(page, ".summary", `part.nc: ${LINES} lines · no errors · 0:01:35.2`);
    await says(page, ".summary", "X 0.000…60.000");
    assert.deepEqual(await violations(page), []);
    await picture(page, "panel-program");
});

test("a start has two steps, and a stray key starts nothing", async (t) => {
    const { page, server } = await loaded(t, PART);
    await drawn(page);
    const plan = { name: "part.nc", lines: 17, time_s: 95.2, from: null, before: ["G21 G90"] };
    server.verbs.run = () => ({ ...plan, warnings: ["the tool is below the work zero"] });
    await press(page, "button::-p-aria(Start …)");
    assert.equal((await server.next("run")).confirmed, false);
    await says(page, ".confirm", "the tool is below the work zero");
    await page.keyboard.press("Enter");
    await page.keyboard.press("KeyA");
    assert.equal(server.count("run"), 0);
    assert.deepEqual(await violations(page), []);
    await picture(page, "panel-start");
    await press(page, "button::-p-aria(Start now)");
    assert.equal((await server.next("run")).confirmed, true);
});

test("a start that was asked for is not that of another machine or program", async (t) => {
    const names = ["mill", "router"];
    const { page, server } = await panel(t, {}, { names, prepare: takesPrograms });
    server.files["GET /machines/2/program"] = () => PART;
    server.files["GET /machines/2/scene"] = () => SCENE;
    server.files["GET /machines/1/program"] = () => PART;
    server.verbs.run = () => ({ name: "part.nc", lines: 17, time_s: 95.2, from: null });
    server.change({ program: LOADED }, 1);
    server.change({ program: LOADED }, 2);
    await drawn(page);
    const ask = "button::-p-aria(Start …)";
    await press(page, ask);
    await page.waitForSelector(".confirm:not([hidden])");
    await press(page, "[role=tab]::-p-aria(router)");
    await says(page, "h1", "router");
    assert.equal(await page.$(".confirm:not([hidden])"), null);
    await drawn(page);
    await press(page, ask);
    await page.waitForSelector(".confirm:not([hidden])");
    server.change({ program: { ...LOADED, load: 2 } }, 2);
    await page.waitForFunction(() => !document.querySelector(".confirm:not([hidden])"));
});

test("it shows what runs: line, progress, time, hold and resume", async (t) => {
    const { page, server } = await loaded(t, PART);
    await drawn(page);
    const running = { ...LOADED, phase: "running", line: 6, progress: 0.42, remaining_s: 55 };
    server.change({ state: "Run", program: running, work_mm: [55, 12, -2] });
    await page.waitForSelector('[data-line="6"][aria-selected="true"]');
    await says(page, ".current", `Line 6 / ${LINES}: G3 X60 Y20 I0 J10`);
    await says(page, ".times", "Running · 42 % · elapsed 0:00:00.0 · remaining 0:00:55.0");
    const at = await page.evaluate(() => Reflect.get(window, "husillo").state.work_mm);
    assert.deepEqual(at, [55, 12, -2]);
    await press(page, "button::-p-aria(Pause)");
    await server.next("hold");
    server.change({ state: "Hold", detail: 0, program: { ...running, phase: "held" } });
    await says(page, ".state", "ON HOLD");
    await press(page, "button::-p-aria(Resume)");
    await server.next("resume");
    const links = () =>
        page.$$eval('a[href*="/report"]', (all) =>
            all.filter((one) => one.checkVisibility()).map((one) => one.getAttribute("href"))
        );
    assert.deepEqual(await links(), []);
    const done = { ...LOADED, phase: "done", progress: 1, runs: 3 };
    server.change({ state: "Idle", detail: null, program: done });
    await says(page, ".times", "Done · 100 %");
    const [open, save] = await links();
    assert.match(open ?? "", /\/machines\/1\/report\?token=[0-9a-f]{32}&run=3$/);
    assert.equal(save, open);
    assert.deepEqual(await violations(page), []);
    await picture(page, "panel-done");
});

test("single block, breakpoints, and a start from a line with its state", async (t) => {
    const { page, server } = await loaded(t, PART);
    await drawn(page);
    await press(page, "label::-p-text(Single block)");
    assert.equal((await server.next("single_block")).on, true);
    await page.$eval('[data-line="8"]', (row) => /** @type {HTMLElement} */ (row).click());
    await press(page, "button::-p-aria(Wait before line 8)");
    assert.deepEqual((await server.next("breakpoints")).lines, [8]);
    server.change({ program: { ...LOADED, breakpoints: [8], single_block: true } });
    await says(page, "body", "Do not wait before line 8");
    server.verbs.run = ({ from }) => ({ ...FROM_LINE, from });
    await press(page, "button::-p-aria(Start from line 8)");
    const asked = await server.next("run");
    assert.deepEqual([asked.from, asked.confirmed], [8, false]);
    await says(page, ".confirm", "line at feed (G1)");
    await says(page, ".confirm", "per minute (G94), 900 mm/min");
    await says(page, ".confirm", "clockwise (M3), 12000 rpm");
    await says(page, ".confirm", "X 52.000  Y 40.000  Z -4.000 mm");
    await says(page, ".confirm", "M3 S12000");
    await says(page, ".confirm", "Line 8: G2 X60 Y40 I-8 J0 Z-4");
    await says(page, ".confirm .error", "another tool");
    assert.deepEqual(await violations(page), []);
    await picture(page, "panel-from-line");
    await press(page, "button::-p-aria(Start now)");
    const started = await server.next("run");
    assert.deepEqual([started.from, started.confirmed], [8, true]);
});

test("an interrupted program is offered to go on, with the line and its state", async (t) => {
    const { page, server } = await loaded(t, PART);
    await drawn(page);
    const goOn = "button::-p-text(Go on from line)";
    assert.equal(await page.$eval(goOn, (one) => one.checkVisibility()), false);
    const stopped = { ...LOADED, phase: "stopped", resume_line: 6 };
    const message = "stopped; all lines before line 6 are made";
    server.change({ program: { ...stopped, message } });
    server.verbs.run = ({ from }) => ({ ...FROM_LINE, from });
    await press(page, "button::-p-aria(Go on from line 6)");
    assert.equal((await server.next("run")).from, 6);
    await says(page, ".confirm", "Line 6: ");
    await press(page, "button::-p-aria(Cancel)");
    assert.equal(server.count("run"), 0);
    server.change({ program: { ...stopped, phase: "running" } });
    await page.waitForFunction(
        () =>
            ![...document.querySelectorAll("button")].some(
                (one) => one.textContent?.includes("Go on from") && one.checkVisibility()
            )
    );
});

test("a program and its findings survive a reload, on a telephone too", async (t) => {
    const { page } = await loaded(t, WRONG, { width: 360, height: 740, scheme: "dark" });
    await says(page, ".findings", "E0201");
    await page.reload();
    await says(page, ".findings", "E0201");
    assert.match(await page.$eval("textarea.source", (one) => one.value), /U4/);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 360, `${wide} pixels`);
    await press(page, "button::-p-aria(Apply this fix)");
    await drawn(page);
    assert.equal(await textOf(page, ".findings"), "");
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 360);
    assert.deepEqual(await violations(page), []);
    await page.screenshot({ path: join(PICTURES, "panel-telephone-dark.png"), fullPage: true });
});
