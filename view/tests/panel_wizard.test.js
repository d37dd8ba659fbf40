import assert from "node:assert/strict";
import { test } from "node:test";
import { picture, violations } from "husillo/tests/browser.js";
import { panel, press, says } from "husillo/tests/panels.js";
import { VALUES, centre, corner, height, toolLength } from "husillo/panel/probing.js";

/** A machine with a solid: whether a tip with its centre at a place touches it. */
class Solid {
    /**
     * @param {Record<"x" | "y" | "z", number>} at
     * @param {(at: Record<"x" | "y" | "z", number>) => boolean} touches
     */
    constructor(at, touches) {
        this.at = at;
        this.touches = touches;
        /** Work zero. */
        this.work = { x: 0, y: 0, z: 0 };
        this.length = NaN;
    }

    /**
     * @param {"x" | "y" | "z"} axis
     * @param {number} by
     * @param {boolean} isSearch
     */
    move(axis, by, isSearch) {
        const steps = Math.round(Math.abs(by) * 1000);
        for (let step = 0; step < steps; step++) {
            if (this.touches(this.at)) {
                if (isSearch) return true;
                throw new Error(`crash at ${JSON.stringify(this.at)}`);
            }
            this.at[axis] += Math.sign(by) / 1000;
        }
        return false;
    }

    /** @type {import("husillo/panel/probing.js").Rig["touch"]} */
    async touch(axis, by, _feed, back, set) {
        assert.ok(this.move(axis, by, true), `no contact in ${axis}`);
        const contact = this.at[axis];
        if (set !== undefined) this.work[axis] = contact - set;
        this.at[axis] -= Math.sign(by) * back;
        return contact;
    }

    /** @type {import("husillo/panel/probing.js").Rig["beside"]} */
    async beside(axis, by) {
        assert.ok(!this.move(axis, by, true), "contact beside the part");
    }

    /** @type {import("husillo/panel/probing.js").Rig["away"]} */
    async away(axis, by) {
        this.move(axis, by, false);
    }

    /** @type {import("husillo/panel/probing.js").Rig["to"]} */
    async to(axis, position) {
        this.move(axis, position - this.at[axis], false);
    }

    /** @type {import("husillo/panel/probing.js").Rig["zero"]} */
    async zero(at) {
        for (const [axis, value] of Object.entries(at)) {
            const letter = /** @type {"x" | "y" | "z"} */ (axis);
            this.work[letter] = this.at[letter] - value;
        }
    }

    /** @param {number} length */
    async offset(length) {
        this.length = length;
    }
}

/**
 * @param {number} actual
 * @param {number} expected
 */
function near(actual, expected) {
    assert.ok(Math.abs(actual - expected) < 0.005, `${actual}, not ${expected}`);
}

test("the height is that below the plate", async () => {
    const machine = new Solid({ x: 0, y: 0, z: 5 }, ({ z }) => z <= -3);
    await height(machine, { ...VALUES, thickness: 1.5 });
    near(machine.work.z, -4.5);
    near(machine.at.z, -1);
});

for (const [x, y] of /** @type {[1 | -1, 1 | -1][]} */ ([
    [-1, -1],
    [1, -1],
    [-1, 1],
    [1, 1],
])) {
    test(`the corner ${x} ${y} of a block is found, without a crash`, async () => {
        // A block from 100 to 150 and from 40 to 70, its top at -10; a tip of 3 mm.
        const inside = (/** @type {number} */ at, /** @type {number[]} */ [low, high]) =>
            at >= low - 1.5 && at <= high + 1.5;
        const machine = new Solid(
            { x: x < 0 ? 103 : 147, y: y < 0 ? 43 : 67, z: -8 },
            (at) => inside(at.x, [100, 150]) && inside(at.y, [40, 70]) && at.z <= -10
        );
        await corner(machine, VALUES, [x, y]);
        near(machine.work.x, x < 0 ? 100 : 150);
        near(machine.work.y, y < 0 ? 40 : 70);
        near(machine.at.z, -8);
    });
}

test("the centre of a hole is found from anywhere in it, with its diameter", async () => {
    const machine = new Solid(
        { x: 53, y: 28, z: 0 },
        ({ x, y }) => Math.hypot(x - 50, y - 30) >= 10 - 1.5
    );
    const sizes = await centre(machine, VALUES);
    near(machine.work.x, 50);
    near(machine.work.y, 30);
    near(sizes.x, 20);
    near(sizes.y, 20);
});

test("the second tool has the difference of both as its offset", async () => {
    const machine = new Solid({ x: 0, y: 0, z: 0 }, ({ z }) => z <= -10);
    const first = await toolLength(machine, VALUES);
    assert.equal(machine.length, 0);
    machine.at.z = 0;
    machine.touches = ({ z }) => z <= -7.5;
    await toolLength(machine, VALUES, first);
    near(machine.length, 2.5);
});

test("the page says the next step, tests the probe, and measures the height", async (t) => {
    const { page, server } = await panel(t);
    await says(page, "#part-probing", "Put the plate on the part");
    await says(page, "#part-probing .why", "Touch the probe to the tool by hand once");
    server.change({ switches: ["P"] });
    await says(page, "#part-probing .why", "The probe is closed now");
    server.change({ switches: [] });
    await says(page, "#part-probing ol", "The probe works");
    server.verbs.probe = () => ({ at_mm: [10, 20, -8.25], touched: true });
    await press(page, "button::-p-aria(Start measuring)");
    const first = await server.next("probe");
    assert.deepEqual([first.axis, first.by_mm, first.feed, first.back_mm], ["z", -20, 100, 2]);
    const second = await server.next("probe");
    assert.deepEqual([second.by_mm, second.feed, second.set_mm], [-4, 25, 0]);
    await says(page, ".result", "Done: the height is set");
    assert.deepEqual(await violations(page), []);
    await picture(page, "panel-wizard");
    // A probe without a contact: nothing further is sent.
    server.verbs.probe = () => new Error("alarm 5: no contact");
    await press(page, "button::-p-aria(Start measuring)");
    await server.next("probe");
    await says(page, ".result", "alarm 5: no contact. The measurement has ended here");
    assert.equal(server.count("probe"), 0);
});

test("STOP ends a measurement of several moves", async (t) => {
    const { page, server } = await panel(t);
    server.change({ switches: ["P"] });
    await says(page, "#part-probing .why", "closed");
    server.change({ switches: [] });
    await press(page, "button::-p-aria(Corner)");
    await press(page, "button::-p-aria(Start measuring)");
    assert.deepEqual((await server.next("step")).move_mm, { x: -10 });
    server.change({ state: "Jog", machine_mm: [5, 20, -5] });
    await page.keyboard.press("Escape");
    await server.next("stop");
    await says(page, ".result", "Stopped");
    server.change({ state: "Idle" });
    await says(page, ".state", "IDLE");
    assert.equal(server.count("line"), 0);
});

test("settings have meaning and limits, and a difference before they are written", async (t) => {
    const { page, server } = await panel(t);
    const setting = (/** @type {string} */ value) => ({
        settings: [
            {
                number: 110,
                value,
                name: "X-axis maximum rate",
                unit: "mm/min",
                kind: "number",
                least: 0,
                most: null,
                meaning: "the fastest that X goes",
            },
        ],
    });
    server.verbs.settings = () => setting("500.000");
    server.verbs.settings_diff = ({ values }) => ({
        changes: [
            { number: 110, from: "500.000", to: values[110], name: "rate", unit: "mm/min" },
        ],
        refused: [],
    });
    server.verbs.settings_save = ({ values }) => setting(values[110]);
    await press(page, "[role=tab]::-p-aria(Settings)");
    await press(page, "button::-p-aria(Read settings)");
    await says(page, ".settings", "the fastest that X goes");
    await says(page, ".settings", "≥ 0");
    await page.$eval("#setting-110", (/** @type {any} */ field) => {
        field.value = "-1";
        field.dispatchEvent(new Event("input"));
    });
    assert.equal(await page.$eval("#setting-110", (one) => one.ariaInvalid), "true");
    await page.$eval("#setting-110", (/** @type {any} */ field) => {
        field.value = "800";
        field.dispatchEvent(new Event("input"));
    });
    await press(page, "button::-p-aria(Show changes …)");
    await says(page, "#part-settings .confirm", "500.000 → 800 mm/min");
    assert.equal(server.count("settings_save"), 0);
    assert.deepEqual(await violations(page), []);
    await picture(page, "panel-settings");
    await press(page, "button::-p-aria(Write to the controller)");
    assert.deepEqual((await server.next("settings_save")).values, { 110: "800" });
    await says(page, "#part-settings", "Written, and read back");
});

test("macros are kept, changed and run", async (t) => {
    /** @type {any[]} */
    let macros = [{ name: "Park", text: "G53 G0 Z0" }];
    const { page, server } = await panel(t, {}, {
        prepare: (server) => {
            server.verbs.macros = () => macros;
            server.verbs.macro_save = ({ name, text }) => (macros = [...macros, { name, text }]);
            server.verbs.macro_delete = ({ name }) =>
                (macros = macros.filter((one) => one.name !== name));
        },
    });
    await press(page, "[role=tab]::-p-aria(Macros)");
    await press(page, "button::-p-aria(Park)");
    assert.equal((await server.next("macro_run")).name, "Park");
    await press(page, "summary::-p-text(New macro)");
    await page.type("#part-macros input", "Lift");
    await page.type("#part-macros textarea", "G91 G0 Z5\nG90");
    await press(page, "#part-macros button::-p-aria(Save)");
    assert.equal((await server.next("macro_save")).text, "G91 G0 Z5\nG90");
    await says(page, "#part-macros ul", "Lift");
    assert.deepEqual(await violations(page), []);
    await press(page, "button::-p-aria(Remove: Park)");
    await page.waitForFunction(
        () => !document.querySelector("#part-macros ul")?.textContent?.includes("Park")
    );
});

test("what the server does not offer is not shown", async (t) => {
    const { page } = await panel(t, {}, {
        prepare: (server) => {
            server.offers = ["settings"];
        },
    });
    const isShown = (/** @type {string} */ place) =>
        page.$eval(place, (one) => one.checkVisibility());
    assert.equal(await isShown("#tab-settings"), true);
    assert.equal(await isShown("#tab-probing"), false);
    assert.equal(await isShown("#tab-macros"), false);
    assert.equal(await isShown(".drop"), false);
});
