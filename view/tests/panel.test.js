import assert from "node:assert/strict";
import { test } from "node:test";
import { picture, violations } from "husillo/tests/browser.js";
import { panel, press, says, textOf } from "husillo/tests/panels.js";

const JOG_X = '[data-jog="X+"]';

for (const scheme of /** @type {const} */ (["light", "dark"])) {
    test(`it shows the state, and has no violation: ${scheme}`, async (t) => {
        const { page, server } = await panel(t, { scheme });
        server.print("controller", "Grbl 1.1h ['$' for help]");
        server.change({ switches: ["P"], state: "Run", feed: 600, rpm: 1200 });
        await says(page, ".state", "RUNNING");
        assert.equal(await textOf(page, '[data-work="Y"]'), "2.250");
        assert.equal(await textOf(page, '[data-machine="X"]'), "10.000");
        assert.equal(await textOf(page, '[data-value="feed"]'), "600 mm/min");
        assert.equal(await textOf(page, '[data-value="rpm"]'), "1200 rpm");
        assert.match(await textOf(page, '[data-switch="P"]'), /probe: closed/);
        await says(page, ".log", "Grbl 1.1h");
        await press(page, "button::-p-aria(inch)");
        await says(page, '[data-machine="X"]', "0.3937");
        assert.deepEqual(await violations(page), []);
        await picture(page, `panel-${scheme}`);
    });
}

test("STOP works by mouse, touch, Escape and space", async (t) => {
    const { page, server } = await panel(t, { touch: true });
    await press(page, "button.stop");
    assert.equal((await server.next("stop")).machine, 1);
    await page.tap("button.stop");
    await server.next("stop");
    await page.keyboard.press("Escape");
    await server.next("stop");
    await page.keyboard.press("Space");
    await server.next("stop");
    await page.focus("button.stop");
    await page.keyboard.press("Enter");
    await server.next("stop");
    assert.equal(server.count("stop"), 0, "one STOP for each");
    // In a text field a space is text, and Escape stops.
    await page.type("input.mono", "G0 X1");
    await page.keyboard.press("Escape");
    await server.next("stop");
    assert.equal(server.count("stop"), 0);
    assert.equal(await page.$eval("input.mono", (field) => field.value), "G0 X1");
    // A space operates a button while nothing moves, and stops while something does.
    await page.focus("button::-p-aria(Give control)");
    server.change({ state: "Run" });
    await says(page, ".state", "RUNNING");
    await page.keyboard.press("Space");
    await server.next("stop");
    assert.equal(server.count("give"), 0);
});

test("a button that is held moves, with a lease, and stops when it is let go", async (t) => {
    const { page, server } = await panel(t);
    await page.hover(JOG_X);
    await page.mouse.down();
    const begun = await server.next("jog");
    assert.deepEqual(begun.axes, { x: 1 });
    assert.equal(begun.feed, 600);
    server.change({ state: "Jog", jog: { client: 1, jog: begun.jog } });
    for (let times = 0; times < 4; times++) {
        assert.equal((await server.next("renew")).jog, begun.jog);
    }
    await page.mouse.up();
    assert.equal((await server.next("release")).jog, begun.jog);
    server.change({ state: "Idle", jog: null });
    // Leaving the button is letting go.
    await page.mouse.down();
    const second = await server.next("jog");
    assert.ok(second.jog > begun.jog);
    await page.mouse.move(5, 5);
    assert.equal((await server.next("release")).jog, second.jog);
    await page.mouse.up();
});

test("keys move while they are held: two axes, no repetition, no typing", async (t) => {
    const { page, server } = await panel(t);
    await page.keyboard.down("ArrowRight");
    assert.deepEqual((await server.next("jog")).axes, { x: 1 });
    // The browser repeats a key that is held.
    await page.keyboard.down("ArrowRight");
    await page.keyboard.down("PageDown");
    assert.deepEqual((await server.next("jog")).axes, { x: 1, z: -1 });
    await page.keyboard.up("ArrowRight");
    assert.deepEqual((await server.next("jog")).axes, { z: -1 });
    await page.keyboard.up("PageDown");
    await server.next("release");
    await page.keyboard.down("Shift");
    await page.keyboard.down("ArrowUp");
    assert.equal((await server.next("jog")).feed, 1800);
    await page.keyboard.up("ArrowUp");
    await page.keyboard.up("Shift");
    await server.next("release");
    await page.focus("input.mono");
    await says(page, ".keys-badge", "typing");
    await page.keyboard.press("ArrowRight");
    await page.keyboard.type("G4 P1\n");
    assert.equal((await server.next("line")).text, "G4 P1");
    assert.equal(server.count("jog"), 0);
});

const LOSSES = /** @type {Record<string, (page: import("puppeteer-core").Page) => unknown>} */ ({
    blur: (page) => page.evaluate(() => void window.dispatchEvent(new Event("blur"))),
    pointercancel: (page) =>
        page.evaluate(() => {
            const event = new PointerEvent("pointercancel", { pointerId: 1, bubbles: true });
            document.querySelector('[data-jog="X+"]')?.dispatchEvent(event);
        }),
    hidden: (page) =>
        page.evaluate(() => {
            Object.defineProperty(document, "hidden", { value: true, configurable: true });
            document.dispatchEvent(new Event("visibilitychange"));
        }),
    STOP: (page) => page.keyboard.press("Escape"),
});
for (const [name, lose] of Object.entries(LOSSES)) {
    test(`a held button stops at ${name}`, async (t) => {
        const { page, server } = await panel(t);
        await page.hover(JOG_X);
        await page.mouse.down();
        const { jog } = await server.next("jog");
        await server.next("renew");
        await lose(page);
        assert.equal((await server.next("release")).jog, jog);
        // No renewal follows.
        server.requests.length = 0;
        await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 300)));
        assert.equal(server.count("renew"), 0);
        await page.mouse.up();
    });
}

test("a jog that the server has ended is not renewed", async (t) => {
    const { page, server } = await panel(t);
    await page.keyboard.down("ArrowLeft");
    const { jog } = await server.next("jog");
    server.change({ state: "Jog", jog: { client: 1, jog } });
    await server.next("renew");
    server.change({ state: "Idle", jog: null });
    await server.next("release");
    server.requests.length = 0;
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 300)));
    assert.equal(server.count("renew"), 0);
    await page.keyboard.up("ArrowLeft");
});

test("steps, go to, home, unlock, zero and undo", async (t) => {
    const { page, server } = await panel(t);
    await press(page, "button::-p-aria(0.1 mm)");
    await press(page, '[data-jog="Z-"]');
    assert.deepEqual((await server.next("step")).move_mm, { z: -0.1 });
    await press(page, "summary::-p-text(Go to a position)");
    await page.type('[aria-label="Move by hand"] details input', "12,5");
    await press(page, "button::-p-aria(Go)");
    const { to_mm, frame } = await server.next("goto");
    assert.deepEqual([to_mm, frame], [{ x: 12.5 }, "work"]);
    await press(page, "button::-p-aria(Home)");
    await server.next("home");
    await press(page, "button::-p-aria(Set the work coordinate of Y)");
    assert.deepEqual((await server.next("zero")).at_mm, { y: 0 });
    server.change({ undo: 1 });
    await says(page, "body", "Undo zero (1)");
    await press(page, "button::-p-text(Undo zero)");
    await server.next("undo_zero");
    await page.evaluate(() => /** @type {any} */ (document.activeElement)?.blur());
    await page.keyboard.down("Alt");
    await page.keyboard.press("KeyX");
    await page.keyboard.up("Alt");
    assert.deepEqual((await server.next("zero")).at_mm, { x: 0 });
    server.change({ state: "Alarm", alarm: { number: 1, text: "Hard limit" } });
    await says(page, ".state", "ALARM 1");
    await says(page, ".notices", "A limit switch was reached");
    assert.match(await textOf(page, ".pads + .why"), /home or unlock/);
    await press(page, "button::-p-aria(Unlock)");
    await server.next("unlock");
});

test("overrides, accessories and the line's history", async (t) => {
    const { page, server } = await panel(t);
    await page.$eval('input[aria-label="Override: Feed"]', (slider) => {
        slider.value = "150";
        slider.dispatchEvent(new Event("input"));
    });
    const { what, percent } = await server.next("override");
    assert.deepEqual([what, percent], ["feed", 150]);
    await press(page, "button::-p-aria(Back to 100 %: Feed)");
    assert.equal((await server.next("override")).percent, 100);
    await press(page, "button::-p-text(Flood)");
    assert.equal((await server.next("line")).text, "M8");
    server.verbs.line = ({ text }) => (text === "G99" ? new Error("error:20: unknown code") : null);
    for (const line of ["G0 X1", "G99"]) {
        await page.click("input.mono", { clickCount: 3 });
        await page.type("input.mono", `${line}\n`);
        await server.next("line");
    }
    await says(page, "body", "G99: error:20: unknown code");
    // The refused line is in the field again.
    await page.keyboard.press("ArrowUp");
    await page.keyboard.press("ArrowUp");
    assert.equal(await page.$eval("input.mono", (field) => field.value), "G0 X1");
});

test("another page watches, takes control, and a reload keeps everything", async (t) => {
    const { page, server } = await panel(t);
    server.change({ operator: 99 });
    await says(page, ".operator", "Watching");
    assert.match(await textOf(page, ".pads + .why"), /watches/);
    assert.equal(await page.$eval(JOG_X, (one) => one.matches(":disabled")), true);
    await press(page, "button::-p-text(Take control)");
    assert.equal((await server.next("take")).force, true);
    await says(page, ".operator", "You operate");
    await press(page, "button::-p-text(Give control)");
    await server.next("give");
    await says(page, ".operator", "Nobody operates");
    await page.reload();
    await server.next("take");
    await says(page, ".operator", "You operate");
    assert.equal(await textOf(page, '[data-work="X"]'), "1.500");
});

test("a lost link and a lost controller are said, with what is safe to do", async (t) => {
    const expected = /WebSocket|ERR_CONNECTION|failed: /;
    const { page, server } = await panel(t, {}, { expected });
    server.change({ link: "lost", why: "the port is gone", state: null, machine_mm: null });
    await says(page, ".state", "CONTROLLER LOST");
    await says(page, ".notices", "the port is gone");
    await says(page, ".notices", "emergency stop");
    server.change({ link: "up", state: "Idle", why: null, machine_mm: [0, 0, 0] });
    await says(page, ".state", "IDLE");
    await page.keyboard.down("ArrowLeft");
    await server.next("jog");
    await server.stop();
    await says(page, ".state", "NO LINK");
    await says(page, ".notices", "A program that ran goes on");
    // The last position is an old one.
    assert.equal(await textOf(page, '.stale [data-machine="X"]'), "0.000");
    const zero = await page.$("table.positions button");
    assert.equal(await zero?.evaluate((one) => one.matches(":disabled")), true);
    const { active, renewals } = await page.evaluate(() => {
        const { link } = Reflect.get(window, "husillo");
        return { active: link.status, renewals: link.pending.size };
    });
    assert.deepEqual([active, renewals], ["lost", 0]);
    await page.keyboard.up("ArrowLeft");
    assert.deepEqual(await violations(page), []);
    await server.start(server.port);
    await server.next("take");
    await says(page, ".state", "IDLE");
    assert.equal(server.count("jog"), 0, "nothing moves by itself");
});

test("a wrong token is said", async (t) => {
    const { page, server } = await panel(t, {}, { expected: /403|WebSocket|failed: / });
    await page.evaluate(() => sessionStorage.setItem("token", "wrong"));
    await page.goto(server.address.replace(/#.*/, "#wrong"));
    await page.reload();
    await says(page, ".notices", "no valid token");
});

test("several machines are tabs", async (t) => {
    const { page, server } = await panel(t, {}, { names: ["mill", "router"] });
    // The tab of another machine ends what is held on this one.
    await page.keyboard.down("ArrowLeft");
    const { jog } = await server.next("jog");
    await press(page, "[role=tab]::-p-aria(router)");
    const released = await server.next("release");
    assert.deepEqual([released.machine, released.jog], [1, jog]);
    await page.keyboard.up("ArrowLeft");
    server.change({ state: "Run" }, 2);
    await says(page, ".state", "RUNNING");
    assert.equal(await textOf(page, "h1"), "router");
    await page.keyboard.press("ArrowLeft");
    await says(page, ".state", "IDLE");
    await page.keyboard.press("Escape");
    assert.equal((await server.next("stop")).machine, 1);
    await press(page, "button::-p-aria(STOP all machines)");
    assert.equal((await server.next("stop")).machine, undefined);
    assert.deepEqual(await violations(page), []);
});

test("a gamepad moves with its dead man's button", async (t) => {
    const { page, server } = await panel(t);
    await page.evaluate(() => {
        const buttons = Array.from({ length: 16 }, () => ({ pressed: false }));
        const pad = { id: "test", axes: [0, 0, 0, 0], buttons };
        Object.assign(window, { pad });
        Object.defineProperty(navigator, "getGamepads", { value: () => [pad, null] });
        window.dispatchEvent(new Event("gamepadconnected"));
        pad.axes = [0.95, -0.4, 0, 0];
    });
    await says(page, "[data-gamepad=there]", "test");
    assert.equal(server.count("jog"), 0);
    await page.evaluate(() => (Reflect.get(window, "pad").buttons[5].pressed = true));
    assert.deepEqual((await server.next("jog")).axes, { x: 1, y: 0.5 });
    await page.evaluate(() => (Reflect.get(window, "pad").buttons[5].pressed = false));
    await server.next("release");
    // STOP ends the motion, and the stick that is still held does not begin it again.
    await page.evaluate(() => (Reflect.get(window, "pad").buttons[5].pressed = true));
    await server.next("jog");
    await page.keyboard.press("Escape");
    await server.next("release");
    await server.next("stop");
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 200)));
    assert.equal(server.count("jog"), 0);
    await page.evaluate(() => (Reflect.get(window, "pad").buttons[1].pressed = true));
    await server.next("stop");
});

test("it fits a telephone, and its controls fit a finger", async (t) => {
    const { page } = await panel(t, { width: 360, height: 740 });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 360, `${wide} pixels`);
    const small = await page.$$eval(".panel button, .panel select, .panel input", (all) =>
        all
            .map((one) => one.closest("label.check") ?? one)
            .map((one) => ({ html: one.outerHTML, box: one.getBoundingClientRect() }))
            .filter(({ box }) => box.width > 0 && (box.width < 43.9 || box.height < 43.9))
            .map(({ html, box }) => `${html.slice(0, 90)} ${box.width} x ${box.height}`)
    );
    assert.deepEqual(small, []);
    // STOP stays, wherever one scrolls.
    await page.evaluate(() => window.scrollTo(0, document.body.scrollHeight));
    const seen = await page.$eval("button.stop", (stop) => {
        const { left, top, width, height } = stop.getBoundingClientRect();
        const at = document.elementFromPoint(left + width / 2, top + height / 2);
        return top >= 0 && (at === stop || stop.contains(at));
    });
    assert.ok(seen);
    await page.evaluate(() => window.scrollTo(0, 0));
    assert.deepEqual(await violations(page), []);
    await picture(page, "panel-telephone");
});

test("it speaks Spanish", async (t) => {
    const { page, server } = await panel(t, { language: "es-MX" });
    await says(page, ".state", "EN REPOSO");
    assert.equal(await textOf(page, "button.stop"), "PARO Esc, espacio");
    server.change({ state: "Alarm", alarm: { number: 2, text: "Soft limit" } });
    await says(page, ".notices", "fuera del recorrido");
    assert.deepEqual(await violations(page), []);
});

test("the live region speaks of states, not of positions", async (t) => {
    const { page, server } = await panel(t);
    await says(page, ".live", "IDLE");
    await page.evaluate(() => {
        Object.assign(window, { said: 0 });
        new MutationObserver(() => Reflect.set(window, "said", Reflect.get(window, "said") + 1))
            .observe(/** @type {Element} */ (document.querySelector(".live")), {
                childList: true,
                characterData: true,
                subtree: true,
            });
    });
    for (let x = 0; x < 20; x++) server.change({ work_mm: [x, 0, 0] });
    server.change({ state: "Run" });
    await says(page, ".live", "RUNNING");
    assert.equal(await page.evaluate(() => Reflect.get(window, "said")), 1);
});
