import assert from "node:assert/strict";
import { test } from "node:test";
import { PART, example, reportOf, sceneIn } from "husillo/tests/reports.js";
import { Modal } from "husillo/viewer/modal.js";
import { Model } from "husillo/viewer/model.js";
import { ends, event, placeAt, pointAt, points, sweep } from "husillo/viewer/path.js";
import { KINDS, read } from "husillo/viewer/scene.js";

/** @param {import("husillo/viewer/scene.js").Scene} scene */
function kinds(scene) {
    return Array.from(scene.kind, (kind) => KINDS[kind]);
}

const circles = await read(sceneIn(reportOf("circles", example("circles.nc"))));
const part = await read(sceneIn(reportOf("part", PART, "-m", "router")));

test("each move has its line, its kind and its ends", () => {
    assert.deepEqual(Array.from(part.line), [3, 4, 5, 6, 7, 8, 10, 12, 13, 14, 16, 17]);
    assert.deepEqual(kinds(part).slice(0, 4), ["rapid", "feed", "feed", "feed"]);
    const zero = part.axes.map((axis) => axis.zero_nm);
    const at = (/** @type {number} */ move) =>
        ends(part, move)[1].map((nm, axis) => nm - zero[axis]);
    assert.deepEqual(at(2), [50e6, 10e6, -2e6]);
    assert.deepEqual(at(3), [60e6, 20e6, -2e6]);
    assert.deepEqual(at(11), [0, 0, 5e6]);
    for (let move = 1; move < part.count; move++) {
        assert.deepEqual(ends(part, move)[0], ends(part, move - 1)[1], `move ${move}`);
        assert.ok(part.begin[move] >= part.end[move - 1], `move ${move}`);
    }
});

test("arcs in all planes sweep what they were programmed to", () => {
    const angle = (/** @type {number} */ move) => {
        const arc = part.arcs.get(move);
        assert.ok(arc);
        return Math.round((sweep(arc, ...ends(part, move)) * 180) / Math.PI);
    };
    assert.equal(angle(3), 90);
    assert.equal(angle(5), -360);
    // G18: seen from +Y, X is to the left of Z, so the plane is Z and X.
    assert.deepEqual(part.arcs.get(9)?.plane, [2, 0]);
    assert.equal(Math.abs(angle(9)), 180);
    const middle = pointAt(part, 5, 0.5).map((nm, axis) => nm - part.axes[axis].zero_nm);
    assert.deepEqual(middle.map(Math.round), [44e6, 40e6, -3e6]);
    const all = points(part, 5);
    assert.ok(all.length > 100 && all.every((at) => at.every(Number.isFinite)));
});

test("the place at a time is on the path, and the tool follows", () => {
    const lengths = circles.axes.map((axis) => axis.step_nm);
    for (let move = 0; move < circles.count; move++) {
        for (const share of [0.1, 0.5, 0.9]) {
            const seconds = circles.begin[move] * (1 - share) + circles.end[move] * share;
            const { commanded, real, move: found } = placeAt(circles, seconds);
            assert.equal(found, move);
            const arc = circles.arcs.get(move);
            if (arc) {
                const [x, y] = [commanded[0] - arc.centre[0], commanded[1] - arc.centre[1]];
                const [from] = ends(circles, move);
                const radius = Math.hypot(from[0] - arc.centre[0], from[1] - arc.centre[1]);
                // A sample may be in the middle of a chord of a thousandth of the circle.
                assert.ok(Math.abs(Math.hypot(x, y) - radius) < 1e-5 * radius + lengths[0]);
            }
            real.forEach((at, axis) => assert.ok(Math.abs(at - commanded[axis]) < 1000));
        }
    }
    const last = placeAt(circles, circles.seconds);
    assert.deepEqual(
        last.real.map((nm) => Math.round(nm)),
        [0, 0, 98000]
    );
});

test("take-ups belong to their moves, and steps by event stop at them", () => {
    const takeUps = circles.stands.filter((stand) => stand.axis >= 0);
    assert.equal(takeUps.length, 14);
    assert.ok(takeUps.every(({ move, begin }) => begin >= circles.begin[move]));
    const first = takeUps[0].begin;
    assert.equal(event(circles, first - 0.001, 1), first);
    assert.equal(event(circles, first + 0.001, -1), first);
    const dwell = part.stands.filter((stand) => stand.axis < 0);
    assert.equal(dwell.length, 1);
    assert.equal(part.line[dwell[0].move], 8);
});

test("a line selects its moves, a time selects its line", () => {
    const model = new Model(part);
    model.selectLine(5);
    assert.deepEqual([model.moves, model.seconds], [[2], part.begin[2]]);
    model.stepLine(1);
    assert.deepEqual([model.line, model.moves], [6, [3]]);
    model.stepLine(-1);
    model.stepLine(-1);
    assert.equal(model.line, 4);
    model.goTo(part.begin[9] + 0.01);
    assert.equal(model.line, 14);
    model.goTo(1e9);
    assert.equal(model.seconds, part.seconds);
    model.stepLine(1);
    model.selectLine(1);
    assert.deepEqual(model.moves, []);
});

test("the state at a line has the words in force", () => {
    const modal = new Modal(part.lines);
    assert.deepEqual(modal.at(5), "G1 G17 G21 G90 G94 M3 F900 S12000".split(" "));
    assert.equal(modal.at(14).includes("G18"), true);
    const long = new Modal(
        Array.from({ length: 2000 }, (_, index) => `G1 X1 F${index} (F9) ;F8`)
    );
    assert.deepEqual(long.at(1500), ["G1", "F1499"]);
    assert.deepEqual(long.at(7), ["G1", "F6"]);
});

test("speeds, accelerations and deviations are there", () => {
    const { feed, acceleration, jerk } = part.bands;
    const most = (/** @type {import("husillo/viewer/scene.js").Band} */ band) =>
        band.high.reduce((a, b, index) => (band.isThere[index] ? Math.max(a, b) : a), 0);
    assert.ok(Math.abs(most(feed) - 15e6) < 0.4e6, String(most(feed)));
    assert.ok(most(acceleration) > 1e8 && most(jerk) > 0);
    assert.ok(Math.abs(most(circles.bands.deviation) - 70) <= 1);
    assert.ok(circles.deviation.some((nm) => nm > 0));
});

test("what is no scene is refused with a reason", async () => {
    await assert.rejects(read("AAAA"));
    const text = sceneIn(reportOf("circles", example("circles.nc")));
    await assert.rejects(read(text.slice(0, text.length / 2 - ((text.length / 2) % 4))));
});
