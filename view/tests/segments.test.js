import assert from "node:assert/strict";
import { test } from "node:test";
import { relief } from "husillo/tests/paths.js";
import { Camera, VIEWS } from "husillo/viewer/camera.js";
import { clip } from "husillo/viewer/canvas.js";
import { nearest } from "husillo/viewer/pick.js";
import { roundUp } from "husillo/viewer/rulers.js";
import { Box, levelFor, levelsOf, thinned } from "husillo/viewer/segments.js";

/** Pixels of the canvas. */
const [WIDTH, HEIGHT] = [800, 600];

/** @param {import("husillo/viewer/camera.js").View} view */
function camera(view) {
    const made = new Camera();
    [made.width, made.height] = [WIDTH, HEIGHT];
    made.look(view);
    const box = new Box();
    box.add([-50e6, -40e6, -3e6]);
    box.add([50e6, 40e6, 3e6]);
    made.fit(box);
    return made;
}

/**
 * The cells of a coarse picture that segments touch.
 *
 * @param {import("husillo/viewer/segments.js").Segments} segments
 * @param {Camera} seen
 * @param {number} cell pixels
 */
function touched(segments, seen, cell) {
    const cells = new Set();
    for (let index = 0; index < segments.count; index++) {
        const at = index * 6;
        const [x, y] = seen.project(segments.ends.subarray(at, at + 3));
        const [u, v] = seen.project(segments.ends.subarray(at + 3, at + 6));
        const parts = Math.max(1, Math.ceil(Math.hypot(u - x, v - y) / (cell / 2)));
        for (let part = 0; part <= parts; part++) {
            const share = part / parts;
            const [column, row] = [x + (u - x) * share, y + (v - y) * share];
            cells.add(Math.floor(column / cell) * 10_000 + Math.floor(row / cell));
        }
    }
    return cells;
}

test("a million segments that move are a bounded number of them", () => {
    const whole = relief(1_000_000, 1000);
    for (const most of [12_000, 200_000]) {
        const levels = levelsOf(whole, 100e6, most);
        assert.ok(levels[0].segments.count <= most, String(levels[0].segments.count));
        assert.equal(levels[levels.length - 1].segments, whole);
        for (const view of /** @type {const} */ (["XY", "XZ", "YZ", "3D"])) {
            for (const zoom of [1, 10, 1000]) {
                const seen = camera(view);
                seen.zoom(zoom);
                const level = levelFor(levels, 1 / seen.scale, most);
                assert.ok(level.segments.count <= most);
            }
        }
    }
});

test("the reduced picture touches the same places", () => {
    const whole = relief(1_000_000, 1000);
    const seen = camera("3D");
    const { segments } = levelFor(levelsOf(whole, 100e6, 12_000), 1 / seen.scale, 12_000);
    const [all, some] = [whole, segments].map((of) => touched(of, seen, 16));
    const missing = [...all].filter((cell) => !some.has(cell)).length;
    const added = [...some].filter((cell) => !all.has(cell)).length;
    assert.ok(all.size > 500);
    assert.ok(missing < 0.05 * all.size, `${missing} of ${all.size} are missing`);
    assert.ok(added < 0.05 * all.size, `${added} of ${all.size} are added`);
});

test("a path that is small enough is not reduced", () => {
    const small = relief(900, 9);
    assert.deepEqual(levelsOf(small, 100e6, 12_000), [{ cell: 0, segments: small }]);
});

test("what is joined keeps its ends and its kinds", () => {
    const whole = relief(10_000, 10);
    const fewer = thinned(whole, 1e6);
    assert.ok(fewer.count < whole.count / 4);
    assert.deepEqual(fewer.ends.slice(0, 3), whole.ends.slice(0, 3));
    const rapids = (/** @type {Uint8Array} */ kinds) =>
        kinds.filter((kind) => kind === 1).length;
    assert.equal(rapids(fewer.kinds), 10);
});

test("the camera and its inverse agree in every view", () => {
    for (const view of /** @type {const} */ (["XY", "XZ", "YZ", "3D"])) {
        const seen = camera(view);
        seen.pan(13, -7);
        seen.zoom(3, 100, 200);
        for (const [x, y] of [
            [0, 0],
            [400, 300],
            [799, 1],
        ]) {
            const [u, v] = seen.project(seen.under(x, y));
            assert.ok(Math.hypot(u - x, v - y) < 1e-6, view);
        }
        const [right, up, eye] = seen.axes;
        const cross = [
            right[1] * up[2] - right[2] * up[1],
            right[2] * up[0] - right[0] * up[2],
            right[0] * up[1] - right[1] * up[0],
        ];
        cross.forEach((part, axis) => assert.ok(Math.abs(part - eye[axis]) < 1e-12, view));
    }
    assert.deepEqual(Object.keys(VIEWS), ["XY", "XZ", "YZ", "3D"]);
    const right = camera("YZ").axes[0].map((part) => Math.round(part) + 0);
    assert.deepEqual(right, [0, 1, 0]);
});

test("a zoom keeps the point under the pointer", () => {
    const seen = camera("XY");
    const before = seen.under(123, 456);
    seen.zoom(7, 123, 456);
    const after = seen.under(123, 456);
    before.forEach((nm, axis) => assert.ok(Math.abs(nm - after[axis]) < 1e-3));
});

test("lines are clipped to a frame, whatever their length", () => {
    const edges = [0, 0, 100, 50];
    assert.deepEqual(clip(10, 10, 20, 20, edges), [10, 10, 20, 20]);
    assert.deepEqual(clip(-1e9, 25, 1e9, 25, edges), [0, 25, 100, 25]);
    assert.equal(clip(-10, 10, -5, 40, edges), undefined);
    assert.equal(clip(0, 60, 100, 51, edges), undefined);
    const slanted = clip(-10, -10, 200, 200, edges);
    assert.deepEqual(slanted?.map(Math.round), [0, 0, 50, 50]);
});

test("the nearest segment is found, and the point on it", () => {
    const path = relief(1000, 10);
    const seen = camera("XY");
    const at = Array.from(path.ends.subarray(550 * 6 + 3, 550 * 6 + 6));
    const [x, y] = seen.project(at);
    const found = nearest(path, [0, 0, 0], seen, x + 1, y + 1, 10);
    assert.ok(found && Math.abs(found.move - 550) <= 1, JSON.stringify(found));
    assert.ok(found.distance < 1.5);
    at.forEach((nm, axis) => assert.ok(Math.abs(nm - found.at[axis]) < 0.3e6));
    assert.equal(nearest(path, [0, 0, 0], seen, 2, 2, 10), undefined);
});

test("marks have round distances", () => {
    assert.deepEqual([0.9, 1, 1.1, 3, 7000, 0.00012].map(roundUp), [1, 1, 2, 5, 10000, 0.0002]);
});
