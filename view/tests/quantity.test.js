import assert from "node:assert/strict";
import { test } from "node:test";
import { duration, length, millimetres } from "husillo/viewer/quantity.js";
import { open, violations } from "husillo/tests/browser.js";

test("quantities have units and no sign of zero", () => {
    assert.equal(length(70), "70 nm");
    assert.equal(length(204_000), "204 um");
    assert.equal(length(-2_500_000), "-2.5 mm");
    assert.equal(millimetres(-0.4), "0.0000");
    assert.equal(millimetres(-1_250_000), "-1.2500");
    assert.equal(duration(3725.25), "1:02:05.3");
    assert.equal(duration(59.99), "0:01:00.0");
});

test("a page imports a module by its name", async (t) => {
    const page = await open(t, {
        body: "<main><h1>Length</h1><p></p></main>",
        script: `import { length } from "husillo/viewer/quantity.js";
            document.querySelector("p").textContent = length(140);`,
    });
    assert.equal(await page.$eval("p", (p) => p.textContent), "140 nm");
    assert.deepEqual(await violations(page), []);
});
