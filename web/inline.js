/**
 * Writes the page as one file that needs no server: `node web/inline.js target/web/husillo.html`.
 * Modules are data addresses of the import map, the module of WebAssembly is text in an element.
 */

import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";
import { dirname } from "node:path";
import { gzipSync } from "node:zlib";

const HERE = new URL(".", import.meta.url);
const VIEWER = new URL("../view/viewer/", HERE);
const MODULES = ["page.js", "curve.js", "steps.js", "husillo.js"];

/** Only what the page itself contains is loaded or run. */
const POLICY =
    "default-src 'none';script-src 'unsafe-inline' 'wasm-unsafe-eval' data:;" +
    "style-src 'unsafe-inline';img-src data: blob:";

/** @param {URL} file */
const text = (file) => readFileSync(file, "utf8");

/** @param {string} source */
function address(source) {
    const escaped = source.replace(/[%#"\\<\x00-\x1f]/g, (one) =>
        `%${one.charCodeAt(0).toString(16).padStart(2, "0")}`
    );
    return `data:text/javascript;charset=utf-8,${escaped}`;
}

/** The page in one file. */
export function inlined() {
    const viewer = readdirSync(VIEWER).filter((file) => file.endsWith(".js"));
    const imports = Object.fromEntries([
        ...viewer.map((file) => [`husillo/viewer/${file}`, address(text(new URL(file, VIEWER)))]),
        ...MODULES.map((file) => [`husillo/web/${file}`, address(text(new URL(file, HERE)))]),
    ]);
    const wasm = gzipSync(readFileSync(new URL("husillo.wasm", HERE)), { level: 9 });
    const module = wasm.toString("base64");
    return text(new URL("index.html", HERE))
        .replace(
            '<meta charset="utf-8">',
            `$&\n<meta http-equiv="Content-Security-Policy" content="${POLICY}">`
        )
        .replace(/<link rel="stylesheet" href="([^"]*)">/g, (_, file) =>
            `<style>${text(new URL(file, HERE))}</style>`
        )
        .replace(/(<script type="importmap">)[^<]*/, (_, begin) =>
            begin + JSON.stringify({ imports })
        )
        .replace('<script type="module">', (begin) =>
            `<script type="application/x-husillo-wasm" id="wasm">${module}</script>\n${begin}`
        );
}

if (process.argv[2]) {
    mkdirSync(dirname(process.argv[2]), { recursive: true });
    writeFileSync(process.argv[2], inlined());
}
