/**
 * What belongs to one machine does not act on another one, and a link that is dead is noticed.
 */

import assert from "node:assert/strict";
import { test } from "node:test";
import { panel, press, says, textOf } from "husillo/tests/panels.js";
import { served, until } from "husillo/tests/served.js";

const TWO = { names: ["mill", "router"] };
const OTHER = "[role=tab]::-p-aria(router)";

test("a probe that works is that of one machine", async (t) => {
    const { page, server } = await panel(t, {}, TWO);
    await press(page, "[role=tab]::-p-aria(Probing)");
    server.change({ switches: ["P"] });
    await says(page, "#part-probing", "closed");
    server.change({ switches: [] });
    const mayStart = () =>
        page.$eval("#part-probing button.main", (one) => !one.matches(":disabled"));
    await page.waitForFunction(
        () => !document.querySelector("#part-probing button.main")?.matches(":disabled")
    );
    await press(page, OTHER);
    await says(page, "h1", "router");
    assert.equal(await mayStart(), false);
});

test("a stick that is held does not move the machine that is chosen next", async (t) => {
    const { page, server } = await panel(t, {}, {
        ...TWO,
        prepare: (server) => (server.infos[1].family = "micromill"),
    });
    await page.evaluate(() => {
        const buttons = Array.from({ length: 16 }, () => ({ pressed: false }));
        const pad = { id: "test", axes: [0.95, 0, 0, 0], buttons };
        Object.assign(window, { pad });
        Object.defineProperty(navigator, "getGamepads", { value: () => [pad, null] });
        window.dispatchEvent(new Event("gamepadconnected"));
        buttons[5].pressed = true;
    });
    assert.equal((await server.next("jog")).machine, 1);
    await press(page, OTHER);
    assert.equal((await server.next("release")).machine, 1);
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 300)));
    assert.equal(server.count("jog"), 0);
});

test("an override that was just set is that of one machine", async (t) => {
    const { page, server } = await panel(t, {}, TWO);
    const percent = "output[data-override=feed]";
    await page.$eval('input[aria-label^="Override: "]', (field) => {
        const slider = /** @type {HTMLInputElement} */ (field);
        slider.value = "150";
        slider.dispatchEvent(new Event("input"));
    });
    assert.equal(await textOf(page, percent), "150 %");
    await press(page, OTHER);
    await says(page, "h1", "router");
    assert.equal(await textOf(page, percent), "100 %");
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 300)));
    assert.ok(server.requests.every((one) => one.do !== "override" || one.machine === 1));
});

test("settings that come late are not shown for another machine", async (t) => {
    const { page, server } = await panel(t, {}, TWO);
    await press(page, "[role=tab]::-p-aria(Settings)");
    /** @type {any} */
    let late;
    server.verbs.settings = () => new Promise((resolve) => (late = resolve));
    const { reply } = server;
    server.reply = async (client, request, data) =>
        reply.call(server, client, request, await data);
    await press(page, "button::-p-aria(Read settings)");
    await server.next("settings");
    await press(page, OTHER);
    await says(page, "h1", "router");
    late({ settings: [{ number: 110, value: "500", name: "rate", unit: "", kind: "number" }] });
    await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 300)));
    assert.equal(await page.$("#setting-110"), null);
});

test("a server that hangs is a lost link, and is found again", async (t) => {
    const expected = /WebSocket|ERR_CONNECTION|failed: /;
    const { page, server } = await served(t, { expected });
    server.signal("SIGSTOP");
    await says(page, ".state", "NO LINK");
    server.signal("SIGCONT");
    await until(page, ({ link }) => link === "up");
});
