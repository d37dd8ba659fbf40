import assert from "node:assert/strict";
import { readFileSync, statSync } from "node:fs";
import { test } from "node:test";
import { pathToFileURL } from "node:url";
import { open, picture, violations } from "husillo/tests/browser.js";
import { PART, example, reliefProgram, reportOf } from "husillo/tests/reports.js";

const PAGES = {
    circles: reportOf("circles", example("circles.nc")),
    part: reportOf("part", PART, "-m", "router"),
};

/**
 * Opens a report from its file, with the network off.
 *
 * @param {import("node:test").TestContext} t
 * @param {keyof typeof PAGES} name
 * @param {import("husillo/tests/browser.js").Wanted} [wanted]
 */
async function report(t, name, wanted = {}) {
    const address = pathToFileURL(PAGES[name]).href;
    const page = await open(t, { address, offline: true, height: 1500, ...wanted });
    if (wanted.scripts !== false) {
        await page.waitForSelector('.stage[data-drawn="whole"]');
    }
    return page;
}

/**
 * The number of pixels of each colour variable on the canvas of the path.
 *
 * @param {import("puppeteer-core").Page} page
 * @returns {Promise<Record<string, number>>}
 */
function inks(page) {
    return page.evaluate(() => {
        const canvas = /** @type {HTMLCanvasElement} */ (document.querySelector("canvas.path"));
        const copy = document.createElement("canvas");
        [copy.width, copy.height] = [canvas.width, canvas.height];
        const context = /** @type {CanvasRenderingContext2D} */ (copy.getContext("2d"));
        context.drawImage(canvas, 0, 0);
        const { data } = context.getImageData(0, 0, copy.width, copy.height);
        const style = getComputedStyle(document.documentElement);
        /** @type {Record<string, number>} */
        const counts = {};
        for (const name of ["rapid", "feed", "ground"]) {
            const hex = style.getPropertyValue(`--${name}`).trim().slice(1);
            const full = hex.length === 3 ? [...hex].map((c) => c + c).join("") : hex;
            const wanted = [0, 2, 4].map((at) => parseInt(full.slice(at, at + 2), 16));
            counts[name] = 0;
            for (let at = 0; at < data.length; at += 4) {
                const off = wanted.map((part, index) => Math.abs(data[at + index] - part));
                if (Math.max(...off) < 40) counts[name]++;
            }
        }
        return counts;
    });
}

/** @param {import("puppeteer-core").Page} page */
function state(page) {
    return page.evaluate(() => {
        // @ts-ignore: the report puts it there.
        const { model } = window.husillo;
        return { line: model.line, moves: model.moves, seconds: model.seconds };
    });
}

test("the file contains everything, and is small", () => {
    for (const page of Object.values(PAGES)) {
        const text = readFileSync(page, "utf8");
        assert.ok(!/https?:|src=|href="(?!data:)/.test(text));
        assert.ok(statSync(page).size < 1_500_000, page);
    }
});

for (const scheme of /** @type {const} */ (["light", "dark"])) {
    test(`the path is drawn in its colours: ${scheme}`, async (t) => {
        const page = await report(t, "circles", { scheme });
        const counts = await inks(page);
        assert.ok(counts.feed > 1500 && counts.rapid > 200, JSON.stringify(counts));
        await picture(page, `report-${scheme}`);
        assert.deepEqual(await violations(page), []);
    });
}

test("it is drawn after a resize, and sharp on a fine screen", async (t) => {
    const page = await report(t, "circles", { scale: 2 });
    const fine = await inks(page);
    assert.ok(fine.feed > 5000, JSON.stringify(fine));
    await page.setViewport({ width: 700, height: 900, deviceScaleFactor: 2 });
    await page.waitForFunction(
        () => document.querySelector("canvas.path")?.clientWidth ?? 0 < 690
    );
    await page.waitForSelector('.stage[data-drawn="whole"]');
    assert.ok((await inks(page)).feed > 2000);
});

test("WebGL2 draws the same as Canvas 2D", async (t) => {
    const counts = [];
    for (const renderer of /** @type {const} */ (["canvas", "webgl"])) {
        const page = await report(t, "part");
        await page.evaluate(async (renderer) => {
            // @ts-ignore: the import map of the report has them.
            const { read } = await import("husillo/viewer/scene.js");
            // @ts-ignore: as above.
            const { mount } = await import("husillo/viewer/viewer.js");
            const place = /** @type {HTMLElement} */ (document.getElementById("viewer"));
            const scene = document.getElementById("scene")?.textContent ?? "";
            const viewer = mount(place, await read(scene), { renderer });
            if (viewer.path.renderer.name !== renderer)
                throw new Error(viewer.path.renderer.name);
        }, renderer);
        await page.waitForSelector('.stage[data-drawn="whole"]');
        counts.push(await inks(page));
        await picture(page, `report-${renderer}`);
    }
    const [canvas, webgl] = counts;
    for (const name of ["feed", "rapid"]) {
        const ratio = webgl[name] / canvas[name];
        assert.ok(canvas[name] > 300 && ratio > 0.5 && ratio < 2, JSON.stringify(counts));
    }
});

test("a page without WebGL works", async (t) => {
    const page = await report(t, "circles", { webgl: false });
    assert.ok((await inks(page)).feed > 1500);
});

test("without scripts the pictures and tables are there", async (t) => {
    const page = await report(t, "circles", { scripts: false });
    // Scripts of the test itself do not run either, so the accessibility tree is asked.
    const tree = JSON.stringify(await page.accessibility.snapshot());
    for (const text of ["Tool path in X and Y", "Extents"])
        assert.ok(tree.includes(text), text);
    await picture(page, "report-still");
});

test("a click on a line selects its move, a click on a move its line", async (t) => {
    const page = await report(t, "circles");
    await page.click('[data-line="11"]');
    assert.deepEqual(
        await state(page).then(({ line, moves }) => [line, moves.length]),
        [11, 1]
    );
    const selected = await page.$eval('[aria-selected="true"]', (row) => row.id);
    assert.equal(selected, "line-11");
    const at = await page.evaluate(() => {
        // @ts-ignore: the report puts it there.
        const { path, model } = window.husillo;
        const frame = path.stage.getBoundingClientRect();
        // The largest circle at its right end; the middle circle is selected.
        const [x, y] = path.camera.project([
            model.scene.to[0][2],
            model.scene.to[1][2] + 1e5,
            0,
        ]);
        return [frame.left + x, frame.top + y];
    });
    await page.mouse.click(at[0], at[1]);
    assert.equal((await state(page)).line, 7);
});

test("the keyboard does everything", async (t) => {
    const page = await report(t, "part");
    await page.focus(".program");
    for (const key of /** @type {const} */ (["ArrowDown", "ArrowDown", "ArrowDown"])) {
        await page.keyboard.press(key);
    }
    assert.equal((await state(page)).line, 3);
    await page.keyboard.press("End");
    await page.keyboard.press("Home");
    assert.equal((await state(page)).line, 1);
    await page.focus('input[type="range"]');
    await page.keyboard.press("PageDown");
    await page.keyboard.press("PageDown");
    assert.equal((await state(page)).line, 5);
    await page.keyboard.press("ArrowRight");
    assert.ok((await state(page)).seconds > 0);
    await page.focus(".stage");
    const scale = () => page.evaluate(() => Reflect.get(window, "husillo").path.camera.scale);
    const before = await scale();
    await page.keyboard.press("+");
    assert.ok((await scale()) > before);
    await page.keyboard.down("Shift");
    await page.keyboard.press("ArrowUp");
    await page.keyboard.up("Shift");
    await page.keyboard.press("f");
    const live = await page.$eval(".live[role=status]", (text) => text.textContent);
    assert.match(live ?? "", /^Line \d+/);
});

test("it plays, and steps by line and by event", async (t) => {
    const page = await report(t, "part");
    const press = (/** @type {string} */ name) =>
        page.click(`.timeline button::-p-aria(${name})`);
    await press("Next event");
    const first = (await state(page)).seconds;
    await press("Next event");
    assert.ok((await state(page)).seconds > first);
    await press("Next line");
    const { line } = await state(page);
    await press("Previous line");
    assert.ok((await state(page)).line < line);
    await page.select(".timeline select", "3000");
    await press("Play");
    await page.waitForFunction(() => {
        const { model } = Reflect.get(window, "husillo");
        return model.seconds === model.scene.seconds;
    });
    assert.match(
        await page.$eval(".clock", (clock) => clock.textContent ?? ""),
        /^(\S+) \/ \1$/
    );
});

test("charts show values and select a span", async (t) => {
    const page = await report(t, "part");
    const canvas = await page.$("canvas.chart");
    const box = await canvas?.boundingBox();
    assert.ok(box);
    await page.mouse.move(box.x + box.width / 2, box.y + 40);
    const text = await page.$eval(".hover", (output) => output.textContent);
    assert.match(text ?? "", /Speed \S+ mm\/min, Acceleration \S+ mm\/s², Jerk .* Deviation/);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width * 0.75, box.y + 40, { steps: 4 });
    await page.mouse.up();
    const span = await page.evaluate(() => Reflect.get(window, "husillo").model.span);
    const whole = await page.evaluate(() => Reflect.get(window, "husillo").model.scene.seconds);
    assert.ok(span[0] > 0.4 * whole && span[1] < 0.85 * whole, String(span));
    const rows = await page.$$eval(".charts tbody tr", (all) =>
        all.map((row) => row.textContent)
    );
    assert.equal(rows.length, 4);
    await page.click(".charts button");
    assert.deepEqual(await page.evaluate(() => Reflect.get(window, "husillo").model.span), [
        0,
        whole,
    ]);
});

test("a distance is measured between two points of the path", async (t) => {
    const page = await report(t, "part");
    await page.click(".path-view button::-p-aria(XY)");
    await page.click(".path-view button::-p-aria(Measure)");
    for (const move of [1, 2]) {
        const [x, y] = await page.evaluate((move) => {
            const { path, model } = Reflect.get(window, "husillo");
            const frame = path.stage.getBoundingClientRect();
            const { to } = model.scene;
            const [x, y] = path.camera.project([to[0][move], to[1][move], to[2][move]]);
            return [frame.left + x, frame.top + y];
        }, move);
        await page.mouse.click(x + 2, y - 1);
    }
    const note = await page.$eval(".note", (one) => one.textContent);
    assert.equal(note, "Distance 40 mm: X 40 mm, Y 0 nm, Z 0 nm");
    await picture(page, "report-measured");
});

test("it fits a telephone, and its controls fit a finger", async (t) => {
    const page = await report(t, "part", { width: 360, height: 740 });
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 360, `${wide} pixels`);
    const small = await page.$$eval(".viewer button, .viewer select, .viewer input", (all) =>
        all
            .map((one) => one.getBoundingClientRect())
            .filter((box) => box.width < 44 || box.height < 44)
            .map((box) => `${box.width} x ${box.height}`)
    );
    assert.deepEqual(small, []);
    await picture(page, "report-telephone");
    assert.deepEqual(await violations(page), []);
});

test("it speaks Spanish", async (t) => {
    const page = await report(t, "circles", { language: "es-ES", reduced: true });
    const lang = await page.$eval("#viewer", (viewer) => viewer.getAttribute("lang"));
    const text = await page.$eval("#viewer", (viewer) => viewer.textContent);
    assert.equal(lang, "es");
    assert.match(text ?? "", /Trayectoria.*Encuadrar pieza.*Reproducir/s);
    assert.deepEqual(await violations(page), []);
});

test("on paper there are the pictures and tables, not the controls", async (t) => {
    const page = await report(t, "circles");
    await page.emulateMediaType("print");
    const shown = await page.evaluate(() =>
        [".viewer", ".still"].map((name) => {
            const found = document.querySelector(name);
            return found ? getComputedStyle(found).display : "";
        })
    );
    assert.deepEqual(shown, ["none", "block"]);
});

test("a program of 200,000 lines has a report of at most 8 MB, with every move", async (t) => {
    const path = reportOf("relief", reliefProgram(200_000), "-m", "router");
    assert.ok(statSync(path).size < 8_000_000, `${statSync(path).size} bytes`);
    const page = await open(t, { address: pathToFileURL(path).href, offline: true });
    await page.waitForSelector('.stage[data-drawn="whole"]');
    const counts = await page.evaluate(() => {
        const { path, model } = Reflect.get(window, "husillo");
        path.drawMoving();
        const rows = document.querySelectorAll(".program [role=option]").length;
        return { moves: model.scene.count, moving: path.renderer.work, rows };
    });
    assert.ok(counts.moves > 199_990 && counts.moves <= 200_003, `${counts.moves}`);
    assert.ok(counts.moving > 1000 && counts.moving <= 12_000, `${counts.moving}`);
    assert.ok(counts.rows < 60, `${counts.rows}`);
    await page.evaluate(() => Reflect.get(window, "husillo").model.selectLine(150_000));
    await page.waitForSelector('[data-line="150000"][aria-selected="true"]');
});
