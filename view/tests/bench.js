/**
 * Measures the pictures per second of a path of a million segments that moves, in headless Chromium
 * without a graphics processor: `npm run bench`.
 */

import { test } from "node:test";
import { open } from "husillo/tests/browser.js";

const SCRIPT = `
    import { relief } from "husillo/tests/paths.js";
    import { Camera } from "husillo/viewer/camera.js";
    import { CanvasRenderer } from "husillo/viewer/canvas.js";
    import { lookOf } from "husillo/viewer/look.js";
    import { Box, levelFor, levelsOf } from "husillo/viewer/segments.js";

    const canvas = document.querySelector("canvas");
    const renderer = new CanvasRenderer(canvas);
    let begin = performance.now();
    const whole = relief(1_000_000, 1000);
    const made = performance.now() - begin;
    begin = performance.now();
    const levels = levelsOf(whole, 100e6, renderer.most);
    const reduced = performance.now() - begin;
    const camera = new Camera();
    [camera.width, camera.height] = [800, 600];
    camera.look("3D");
    const box = new Box();
    box.add([-50e6, -40e6, -3e6]);
    box.add([50e6, 40e6, 3e6]);
    camera.fit(box);
    const look = lookOf(canvas);
    const times = [];
    for (let frame = 0; frame < 60; frame++) {
        await new Promise((resolve) => requestAnimationFrame(resolve));
        const start = performance.now();
        camera.orbit(0.02, 0.003);
        const level = levelFor(levels, 1 / camera.scale, renderer.most);
        renderer.draw(level.segments, [0, 0, 0], camera, look);
        // Reading a pixel waits until all are drawn.
        renderer.context.getImageData(0, 0, 1, 1);
        times.push(performance.now() - start);
    }
    begin = performance.now();
    await new Promise((resolve) => renderer.draw(whole, [0, 0, 0], camera, look, resolve));
    const rest = performance.now() - begin;
    times.sort((a, b) => a - b);
    window.result = {
        drawn: levels[0].segments.count, levels: levels.length, reduced, rest,
        median: times[30], slowest: times[59],
    };
`;

test("a million segments", async (t) => {
    const page = await open(t, {
        body: '<canvas width="800" height="600"></canvas>',
        script: SCRIPT,
    });
    await page.waitForFunction("window.result", { timeout: 120_000 });
    const result = await page.evaluate(() => Reflect.get(window, "result"));
    for (const [name, value] of Object.entries(result)) {
        t.diagnostic(
            `${name} ${Number(value).toFixed(1)}${name[0] < "m" && name !== "rest" ? "" : " ms"}`
        );
    }
    t.diagnostic(`${(1000 / result.median).toFixed(0)} pictures per second`);
});
