import assert from "node:assert/strict";
import { test } from "node:test";
import { Hold } from "husillo/panel/hold.js";
import { lengthOf, lengthText, numberOf } from "husillo/panel/units.js";

/** A hold whose motion is written down, and whose timer is driven by the test. */
function made() {
    /** @type {string[]} */
    const log = [];
    /** @type {{act: (() => void) | undefined, mayMove: boolean}} */
    const outside = { act: undefined, mayMove: true };
    const hold = new Hold(
        {
            begin: (direction) => {
                log.push(JSON.stringify(direction));
                return outside.mayMove;
            },
            renew: () => log.push("renew"),
            end: (reason) => log.push(`end: ${reason}`),
        },
        {
            setInterval: (act) => (outside.act = act),
            clearInterval: () => (outside.act = undefined),
        }
    );
    return { hold, log, outside };
}

test("a hold begins once, is renewed, and ends once", () => {
    const { hold, log, outside } = made();
    hold.press("key", { X: 1 });
    hold.press("key", { X: 1 });
    outside.act?.();
    hold.release("key", "keyup");
    hold.release("key", "keyup");
    hold.end("blur");
    assert.deepEqual(log, ['{"X":1}', "renew", "end: keyup"]);
    assert.equal(outside.act, undefined);
});

test("two inputs move together, opposite ones stand", () => {
    const { hold, log } = made();
    hold.press("right", { X: 1 });
    hold.press("up", { Y: 1 });
    hold.release("up", "keyup");
    hold.press("left", { X: -1 });
    hold.release("right", "keyup");
    hold.release("left", "keyup");
    assert.deepEqual(log, [
        '{"X":1}',
        '{"X":1,"Y":1}',
        '{"X":1}',
        "end: opposite",
        '{"X":-1}',
        "end: keyup",
    ]);
});

test("a refused motion is not renewed", () => {
    const { hold, outside } = made();
    outside.mayMove = false;
    hold.press("key", { X: 1 });
    assert.equal(outside.act, undefined);
    assert.equal(hold.isActive, false);
});

test("what is still held after a stop does not move again until it was let go", () => {
    const { hold, log } = made();
    hold.steer("stick", { X: 1 });
    hold.end("stop");
    hold.steer("stick", { X: 1 });
    hold.steer("stick", { Y: 1 });
    assert.deepEqual(log, ['{"X":1}', "end: stop"]);
    hold.release("stick", "released");
    hold.steer("stick", { Y: 1 });
    assert.deepEqual(log.slice(2), ['{"Y":1}']);
});

test("lengths are read and written in both units", () => {
    assert.equal(lengthText(25.4, "in"), "1.0000");
    assert.equal(lengthText(-0.0001, "mm"), "0.000");
    assert.equal(lengthText(null, "mm"), "–");
    assert.equal(lengthOf("0,5", "in"), 12.7);
    assert.equal(numberOf("1e3"), undefined);
    assert.equal(numberOf(""), undefined);
    assert.equal(numberOf("-.5"), -0.5);
});
