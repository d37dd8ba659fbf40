/**
 * The package as its users get it: packed, unpacked into a project, and used with its types.
 */

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, test } from "node:test";
import { fileURLToPath } from "node:url";

const HERE = fileURLToPath(new URL("..", import.meta.url));
const folder = mkdtempSync(join(tmpdir(), "husillo-pack-"));
after(() => rmSync(folder, { recursive: true }));

test("the tarball works in a project of its own", () => {
    const run = (/** @type {string} */ program, /** @type {string[]} */ ...words) =>
        execFileSync(program, words, { cwd: folder, stdio: "pipe" }).toString();
    const packed = run("npm", "pack", "--json", HERE);
    const [{ filename, files }] = JSON.parse(packed);
    const names = files.map((/** @type {any} */ file) => file.path).sort();
    const expected = ["LICENSE-APACHE", "LICENSE-MIT", "README.md", "husillo.js"];
    expected.push("husillo.wasm", "index.d.ts", "package.json");
    assert.deepEqual(names, expected);
    writeFileSync(join(folder, "package.json"), '{"name":"user","type":"module"}');
    run("npm", "install", "--offline", "--no-audit", "--no-fund", join(folder, filename));
    const inside = join(folder, "node_modules/husillo");
    for (const licence of ["LICENSE-APACHE", "LICENSE-MIT"]) {
        assert.ok(statSync(join(inside, licence)).size > 500, licence);
    }
    // The example of the README, as a program in TypeScript and as it is.
    const readme = readFileSync(join(inside, "README.md"), "utf8");
    const example = /```js\n([^]*?)```/.exec(readme)?.[1];
    assert.ok(example);
    writeFileSync(join(folder, "use.mts"), example);
    writeFileSync(join(folder, "use.mjs"), example);
    const tsc = join(HERE, "../view/node_modules/.bin/tsc");
    const options = ["--noEmit", "--strict", "--target", "es2022", "--module", "nodenext"];
    run(tsc, ...options, "use.mts");
    assert.match(run("node", "use.mjs"), /^\d+ step events in \d+\.\d+ s\n/);
});

test("the page is one file", () => {
    const page = join(HERE, "../target/web/husillo.html");
    mkdirSync(join(HERE, "../target/web"), { recursive: true });
    execFileSync("node", [join(HERE, "inline.js"), page]);
    assert.ok(statSync(page).size < 2_000_000);
    assert.doesNotMatch(readFileSync(page, "utf8"), /<(link|script)[^>]*(href|src)="(?!data:)/);
});
