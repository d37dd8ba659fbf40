import assert from "node:assert/strict";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { open, picture, violations } from "husillo/tests/browser.js";
import { Cable } from "husillo/tests/cable.js";
import { press, says, textOf } from "husillo/tests/panels.js";
import { isIdle, served, until } from "husillo/tests/served.js";

/** The pad of the measuring machine. Other machines have pads of their own, which are hidden. */
const PAD = "section:not([hidden]) ";

/**
 * Sets the text of a field as typing does.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} field
 * @param {string} text
 */
function write(page, field, text) {
    return page.$eval(
        field,
        (one, text) => {
            /** @type {any} */ (one).value = text;
            one.dispatchEvent(new Event("input", { bubbles: true }));
        },
        text
    );
}

/** The centre of the stick. @param {import("puppeteer-core").Page} page */
async function centreOf(page) {
    await page.$eval("[data-stick]", (one) => one.scrollIntoView({ block: "center" }));
    return page.$eval("[data-stick]", (one) => {
        const { left, top, width, height } = one.getBoundingClientRect();
        return { x: left + width / 2, y: top + height / 2, far: width / 2 };
    });
}

/** @param {any} state */
const work = ({ measuring }) => measuring.axes.map((/** @type {any} */ { work }) => work);

/**
 * Holds the stick until the goal is reached. On a busy computer a jog may end, or not begin,
 * because its page did not renew it in time. Then the stick is released and held again.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {[number, number]} centre
 * @param {[number, number]} by
 * @param {(state: any) => boolean} isReached
 */
async function steer(page, [x, y], [right, down], isReached) {
    await page.mouse.move(x + right, y + down);
    for (let times = 0; times < 100; times++) {
        const seen = await until(page, (state) => isReached(state) || isIdle(state));
        if (isReached(seen)) return;
        // No button is pressed.
        await page.mouse.reset();
        await page.mouse.move(x, y);
        await page.mouse.down();
        await page.mouse.move(x + right, y + down);
        await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
    }
    throw new Error("the stick does not reach its goal");
}

test("a measuring machine is steered, moved, zeroed, and touches", async (t) => {
    const { page } = await served(t, {}, "-m", "cmm3", "--speed", "4");
    await until(page, ({ measuring }) => measuring);
    const cards = await page.$$eval(".card", (all) =>
        all.filter((one) => one.checkVisibility()).map((one) => one.getAttribute("aria-label"))
    );
    assert.deepEqual(cards, [
        "Live plot",
        "Measuring routine",
        "Bytes of the line",
        "Console",
        "Position",
        "Move by hand",
        "Contact probe",
        "Keys",
    ]);
    await says(page, ".notices", "Not every axis is homed");
    const hasLine = await page.$eval('[placeholder^="G1"]', (one) => one.checkVisibility());
    assert.ok(!hasLine, "its modules take no lines of G-code");
    await press(page, "button::-p-aria([name='Home'][role='button'])");
    await until(page, ({ state }) => state === "Home");
    const isHomed = (/** @type {any} */ { machine }) => machine !== null;
    await until(page, (state) => isIdle(state) && state.measuring.axes.every(isHomed));
    // The stick: a small deflection is slow, a large one fast, in two axes at once.
    const { x, y, far } = await centreOf(page);
    await steer(page, [x, y], [0.3 * far, 0], (state) => work(state)[0] > 0.1);
    assert.equal(await page.$eval("[data-stick]", (one) => one.getAttribute("data-stick")), "held");
    await steer(page, [x, y], [0.68 * far, -0.68 * far], (state) => work(state)[1] > 1);
    await page.mouse.up();
    const stopped = await until(page, isIdle);
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
    const later = await until(page, isIdle);
    work(stopped).forEach((/** @type {number} */ before, /** @type {number} */ axis) =>
        assert.ok(Math.abs(work(later)[axis] - before) < 0.01)
    );
    // Keys, and the key that stops.
    const before = work(later)[1];
    await page.keyboard.down("ArrowDown");
    await until(page, (state) => state.state === "Jog" && work(state)[1] < before - 0.05);
    await page.keyboard.press("Escape");
    await until(page, (state) => isIdle(state) && !state.stopping);
    await page.keyboard.up("ArrowDown");
    // A target, its error, and cancel.
    // So far that it has not ended before it is cancelled, on a busy computer either.
    await write(page, '[data-target="X"]', "150");
    await press(page, "button::-p-aria(Go to target)");
    await until(page, ({ state, measuring }) => state === "Run" && measuring.axes[0].error > 20);
    await press(page, "button::-p-aria(Cancel move)");
    const cancelled = await until(page, isIdle);
    assert.ok(work(cancelled)[0] < 149);
    await press(page, "button::-p-aria(X = 0: make this position zero)");
    await until(page, (state) => isIdle(state) && Math.abs(work(state)[0]) < 0.01);
    await write(page, '[data-target="X"]', "-1,5");
    await press(page, "button::-p-aria(Go to target)");
    await until(page, (state) => isIdle(state) && Math.abs(work(state)[0] + 1.5) < 0.01);
    const shown = Number(await textOf(page, '[data-scale="X"]'));
    assert.ok(Math.abs(shown + 1.5) < 0.01, `${shown}`);
    // The bytes of the line.
    await press(page, "summary::-p-text(Bytes of the line)");
    await says(page, '[data-value="bytes"]', "> aa 0");
    // The tip.
    await write(page, '[data-touch="plus"]', "0.008");
    await press(page, "button::-p-aria(Set tip)");
    await until(page, ({ measuring }) => measuring.tip.pre_travel[0] === 0.008);
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-measuring");
});

test("one axis touches a face: trigger, contact and pre-travel", async (t) => {
    const { page } = await served(t, {}, "-m", "cmm", "--speed", "2");
    await until(page, ({ measuring }) => measuring?.unit === "counts");
    await says(page, ".routine .message", "Routines are in mm");
    await write(page, '[data-target="X"]', "2000");
    await press(page, "button::-p-aria(Go to target)");
    await until(page, (state) => isIdle(state) && Math.abs(work(state)[0] - 2000) < 3);
    assert.equal(await textOf(page, '[data-value="probe"]'), "free");
    await press(page, "button::-p-aria([name='Touch'][role='button'])");
    await until(page, ({ state }) => state === "Probe");
    await says(page, ".state", "TOUCHING");
    await until(page, (state) => isIdle(state) && state.measuring.touch);
    assert.equal(await textOf(page, '[data-value="trigger"]'), "X 3018");
    assert.equal(await textOf(page, '[data-value="contact"]'), "X 3018");
    await write(page, '[data-touch="reference"]', "3000");
    await press(page, "button::-p-aria([name='Touch'][role='button'])");
    await until(page, ({ measuring }) => measuring.tip.pre_travel[0] === 18);
    await until(page, isIdle);
    assert.equal(await textOf(page, '[data-value="contact"]'), "X 3000");
    assert.equal(await textOf(page, '[data-value="pre-travel"]'), "18");
});

test("a routine is written, drawn, run, judged and reported", async (t) => {
    const wanted = { width: 390, scheme: /** @type {const} */ ("dark"), language: "es-MX" };
    const { page, server } = await served(t, wanted, "-m", "cmm3", "--speed", "40");
    await until(page, ({ measuring }) => measuring);
    await write(page, ".routine textarea", "bore B at x1 y1 z1\n");
    await says(page, ".routine .findings", "diameter");
    const isDisabled = await page.$eval(
        ".routine button.main",
        (one) => /** @type {any} */ (one).disabled
    );
    assert.ok(isDisabled, "a routine with a mistake cannot be started");
    const text =
        "safe z -10\nclearance 1\nsearch 2\n" +
        "plane top towards -z at x14 y14 z-20 at x20 y14 z-20 at x14 y20 z-20\n" +
        "point left towards +x at x10 y30 z-25 x 10 +-0.05\n" +
        "point wrong towards +y at x30 y10 z-25 y 11 +-0.02\n";
    await page.evaluate((text) => {
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([text], "block.routine"));
        window.dispatchEvent(new DragEvent("drop", { dataTransfer, cancelable: true }));
    }, text);
    await page.waitForSelector('[data-feature="wrong"]');
    const drawn = await page.$$eval(".routine-drawing [data-feature]", (all) => all.length);
    assert.equal(drawn, 3);
    // Nothing moves before the second step.
    await press(page, "button::-p-aria(Ejecutar la rutina…)");
    await says(page, ".routine .confirm", "3 elementos");
    assert.ok(isIdle(await until(page, isIdle)));
    await press(page, "button::-p-aria(Empezar)");
    await until(page, ({ measuring }) => measuring.routine?.phase === "running");
    const done = await until(
        page,
        (state) => isIdle(state) && state.measuring.routine.phase === "done"
    );
    assert.equal(done.measuring.routine.is_good, false);
    await says(page, ".features", "✗ fuera de tolerancia");
    await says(page, ".features", "✓ dentro");
    await page.waitForSelector(".routine-drawing .good [class=mark]");
    assert.equal(await page.$$eval(".routine-drawing .bad", (all) => all.length), 1);
    // A page that has written none gets the routine of the machine.
    const watcher = await open(t, { address: server.address });
    await watcher.waitForSelector('.routine-drawing .bad[data-feature="wrong"]');
    assert.equal(await watcher.$eval(".routine textarea", (one) => one.value), text);
    await page.bringToFront();
    // Features in other coordinates are drawn apart.
    await write(page, ".routine textarea", `${text}zero x\npoint after towards +y at x1 y1 z1\n`);
    await page.waitForSelector('.routine-drawing [data-feature="after"]');
    assert.equal(await page.$$eval(".routine-drawing [data-feature]", (all) => all.length), 1);
    await page.select(".routine select", "1");
    await page.waitForSelector(".routine-drawing .good [class=mark]");
    assert.equal(await page.$$eval(".routine-drawing [data-feature]", (all) => all.length), 3);
    const report = await page.$eval(".routine a[download]", (one) => one.getAttribute("href"));
    const text2 = await page.evaluate(async (href) => {
        const got = await fetch(String(href));
        return got.text();
    }, report);
    assert.match(text2, /block\.routine/);
    assert.deepEqual(await violations(page), []);
    await picture(page, "serve-routine");
});

test("a reload stops a jog, and the routine is still there", async (t) => {
    const { page } = await served(t, {}, "-m", "cmm3");
    await until(page, ({ measuring }) => measuring);
    await write(page, ".routine textarea", "goto x1\n");
    await page.$eval(`${PAD}[data-jog="X+"]`, (one) => one.scrollIntoView({ block: "center" }));
    await page.hover(`${PAD}[data-jog="X+"]`);
    await page.mouse.down();
    await until(page, ({ state }) => state === "Jog");
    await page.reload();
    await page.waitForFunction(() => Reflect.get(window, "husillo")?.state?.measuring);
    const first = await until(page, isIdle);
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
    const later = await until(page, isIdle);
    assert.ok(Math.abs(work(later)[0] - work(first)[0]) < 0.05);
    assert.equal(await page.$eval(".routine textarea", (one) => one.value), "goto x1\n");
    await page.mouse.up();
});

test("a routine is started as it was shown, and a mistake is that of its form", async (t) => {
    const { page } = await served(t, {}, "-m", "cmm3", "--port", "sim", "--port", "sim");
    await until(page, ({ measuring }) => measuring);
    const asked = (/** @type {boolean} */ isShown) =>
        page.waitForFunction(
            (isShown) => document.querySelector(".routine .confirm")?.checkVisibility() === isShown,
            {},
            isShown
        );
    await write(page, ".routine textarea", "goto x1\n");
    await press(page, "button::-p-aria(Run the routine…)");
    await asked(true);
    await write(page, ".routine textarea", "goto x2\n");
    await asked(false);
    await press(page, "button::-p-aria(Run the routine…)");
    await asked(true);
    await press(page, "[role=tab]:nth-child(2)");
    await until(page, ({ machine }) => machine === 2);
    await asked(false);
    // A touch has a mistake. The tip has none.
    await write(page, '[data-touch="reference"]', "near");
    await press(page, "button::-p-aria([name='Touch'][role='button'])");
    await page.waitForSelector('[data-touch="reference"][aria-invalid="true"]');
    await write(page, '[data-touch="plus"]', "0.008");
    await press(page, "button::-p-aria(Set tip)");
    await until(page, ({ measuring }) => measuring.tip.pre_travel[0] === 0.008);
});

test("a pulled cable and a killed server move nothing on and lose no position", async (t) => {
    const folder = mkdtempSync(join(tmpdir(), "husillo-panel-"));
    process.env.XDG_STATE_HOME = folder;
    t.after(() => {
        delete process.env.XDG_STATE_HOME;
        rmSync(folder, { recursive: true });
    });
    const cable = await Cable.to(t, "cmm3");
    const wanted = { expected: /WebSocket|ERR_CONNECTION|failed: / };
    const machine = ["-m", "cmm3", "--port", cable.port];
    const fromHome = (/** @type {any} */ { measuring }) => measuring?.axes[0].machine ?? null;
    const { page, server } = await served(t, wanted, ...machine);
    await until(page, ({ measuring }) => measuring);
    await press(page, "button::-p-aria([name='Home X'][role='button'])");
    await until(page, (state) => isIdle(state) && fromHome(state) !== null);
    /** Holds a button until the axis has moved, and gives where it is. */
    const jog = async () => {
        const before = fromHome(await until(page, (state) => isIdle(state)));
        const held = `${PAD}[data-jog="X+"]`;
        await page.$eval(held, (one) => one.scrollIntoView({ block: "center" }));
        await page.hover(held);
        await page.mouse.down();
        const is = await until(page, (state) => fromHome(state) > before + 0.1);
        return fromHome(is);
    };
    /** Where the axis stands: near where it was last seen. @param {any} on @param {number} seen */
    const stands = async (on, seen) => {
        const is = fromHome(await until(on, (state) => isIdle(state) && fromHome(state) !== null));
        assert.ok(is > seen - 0.01 && is < seen + 0.5, `${seen} ${is}`);
        await on.evaluate(() => new Promise((resolve) => setTimeout(resolve, 500)));
        assert.ok(Math.abs(fromHome(await until(on, isIdle)) - is) < 0.01, "it moves on");
    };
    const pulledAt = await jog();
    cable.pull();
    await until(page, ({ link }) => link === "lost");
    await says(page, ".state", "CONTROLLER LOST");
    await says(page, ".notices", "use the emergency stop of the machine");
    await page.mouse.up();
    cable.plug();
    await until(page, ({ link }) => link === "up");
    await stands(page, pulledAt);
    const killedAt = await jog();
    server.kill();
    await says(page, ".state", "NO LINK");
    await says(page, ".notices", "Motion by hand has stopped");
    await page.mouse.up();
    const { page: other } = await served(t, wanted, ...machine);
    await stands(other, killedAt);
});
