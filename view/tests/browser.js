/**
 * The common harness of the tests in a browser: a server of this folder, Chromium, pages that fail
 * their test if they print an error.
 *
 *     const page = await open(t, { body: "<p>", script: "import 'husillo/viewer/x.js'" });
 */

import puppeteer from "puppeteer-core";
import { existsSync, mkdirSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { after } from "node:test";
import { extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

/** This package. */
export const ROOT = fileURLToPath(new URL("..", import.meta.url));

/** Where screenshots are kept. */
export const PICTURES = join(ROOT, "..", "target", "view");

const TYPES = /** @type {Record<string, string>} */ ({
    ".js": "text/javascript",
    ".css": "text/css",
    ".html": "text/html",
    ".json": "application/json",
    ".wasm": "application/wasm",
});

/** The import map of pages served from this folder. */
const MAP = '{"imports":{"husillo/":"/"}}';

/** A page that takes longer than this is stuck, milliseconds. */
const PATIENCE = Number(process.env.PATIENCE ?? 180_000);

/** @type {Promise<import("puppeteer-core").Browser> | undefined} */
let browser;
/** @type {import("node:http").Server | undefined} */
let server;
/** The pages that tests have made. */
const made = new Map();

/** Chromium of this machine: `CHROMIUM`, or one in the usual places. */
function chromium() {
    const places = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
    const found = process.env.CHROMIUM ?? places.find((place) => existsSync(place));
    if (!found) throw new Error("no Chromium: set CHROMIUM to its path");
    return found;
}

/** The browser. It starts with the first page. */
function started() {
    browser ??= puppeteer.launch({
        executablePath: chromium(),
        headless: true,
        // The machine may have other work to do.
        timeout: PATIENCE,
        protocolTimeout: 2 * PATIENCE,
        args: ["--no-sandbox", "--disable-gpu", "--force-color-profile=srgb"],
    });
    return browser;
}

/** The address of this folder, served. */
async function origin() {
    if (!server) {
        const begun = createServer((request, response) => {
            answer(request.url ?? "/").then(
                ([type, body]) => response.writeHead(200, { "content-type": type }).end(body),
                () => response.writeHead(404).end()
            );
        });
        await new Promise((resolve) => begun.listen(0, "127.0.0.1", () => resolve(null)));
        server = begun;
    }
    const address = server.address();
    if (!address || typeof address === "string") throw new Error("the server has no port");
    return `http://127.0.0.1:${address.port}`;
}

/**
 * @param {string} url
 * @returns {Promise<[string, string | Buffer]>}
 */
async function answer(url) {
    const path = decodeURIComponent(new URL(url, "http://x").pathname);
    const page = made.get(path);
    if (page) return ["text/html", page];
    const file = normalize(join(ROOT, path));
    if (!file.startsWith(ROOT)) throw new Error(path);
    return [TYPES[extname(file)] ?? "application/octet-stream", await readFile(file)];
}

after(async () => {
    if (browser) await (await browser).close();
    server?.closeAllConnections();
    server?.close();
});

/**
 * A page of a test.
 *
 * @typedef {object} Wanted
 * @property {string} [body] content of the element `body`, with the viewer's style
 * @property {string} [script] a module that the page runs
 * @property {string} [address] another page instead: a path on the server or a whole address
 * @property {number} [width] pixels
 * @property {number} [height] pixels
 * @property {number} [scale] device pixels per pixel
 * @property {"light" | "dark"} [scheme] colours
 * @property {boolean} [reduced] whether the user asks for less motion
 * @property {boolean} [scripts] false: scripts do not run
 * @property {boolean} [webgl] false: the page has no WebGL
 * @property {boolean} [offline] whether the network is off
 * @property {string} [language] such as `es-ES`
 * @property {boolean} [touch] whether the screen takes touches
 * @property {RegExp} [expected] errors of the browser that do not fail the test
 */

/**
 * Opens a page. Its test fails if the page prints an error, or asks for a file that is missing.
 *
 * @param {import("node:test").TestContext} t
 * @param {Wanted} wanted
 */
export async function open(t, wanted) {
    const page = await (await started()).newPage();
    page.setDefaultTimeout(PATIENCE);
    /** @type {string[]} */
    const errors = [];
    page.on("console", (message) => {
        const text = message.text();
        if (message.type() !== "error" || wanted.expected?.test(text)) return;
        // A resource that is missing is not named in the text.
        errors.push(`${text} (${message.location().url ?? "?"})`);
    });
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("requestfailed", (request) => {
        const text = `failed: ${request.url()}`;
        if (!wanted.expected?.test(text)) errors.push(text);
    });
    t.after(async () => {
        await page.close();
        if (errors.length) throw new Error(`the page printed ${errors.join("; ")}`);
    });
    await page.setViewport({
        width: wanted.width ?? 1200,
        height: wanted.height ?? 800,
        deviceScaleFactor: wanted.scale ?? 1,
        hasTouch: wanted.touch ?? false,
    });
    await page.emulateMediaFeatures([
        { name: "prefers-color-scheme", value: wanted.scheme ?? "light" },
        { name: "prefers-reduced-motion", value: wanted.reduced ? "reduce" : "no-preference" },
    ]);
    if (wanted.scripts === false) await page.setJavaScriptEnabled(false);
    if (wanted.language) await speak(page, wanted.language);
    if (wanted.webgl === false) await page.evaluateOnNewDocument(withoutWebGl);
    if (wanted.offline) await page.setOfflineMode(true);
    await page.goto(await address(wanted), { waitUntil: "load" });
    return page;
}

/** @param {Wanted} wanted */
async function address(wanted) {
    if (wanted.address?.includes(":")) return wanted.address;
    const path = wanted.address ?? `/made/${made.size}.html`;
    if (!wanted.address) made.set(path, whole(wanted));
    return (await origin()) + path;
}

/** @param {Wanted} wanted */
function whole({ body, script }) {
    return `<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>test</title>
        <meta name="viewport" content="width=device-width,initial-scale=1">
        <link rel="icon" href="data:,"><link rel="stylesheet" href="/viewer/colours.css">
        <link rel="stylesheet" href="/viewer/viewer.css">
        <script type="importmap">${MAP}</script></head><body>${body ?? ""}
        <script type="module">${script ?? ""}</script></body></html>`;
}

/**
 * @param {import("puppeteer-core").Page} page
 * @param {string} language
 */
async function speak(page, language) {
    await page.setExtraHTTPHeaders({ "accept-language": language });
    await page.evaluateOnNewDocument((tag) => {
        Object.defineProperty(navigator, "language", { get: () => tag });
        Object.defineProperty(navigator, "languages", { get: () => [tag] });
    }, language);
}

function withoutWebGl() {
    const real = HTMLCanvasElement.prototype.getContext;
    /** @param {[string, any?]} args */
    const context = function (...args) {
        // @ts-ignore: `this` is the canvas.
        return args[0].startsWith("webgl") ? null : real.apply(this, args);
    };
    // @ts-ignore: the overloads of the real one.
    HTMLCanvasElement.prototype.getContext = context;
}

/**
 * Keeps a screenshot in `target/view`.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} name
 */
export async function picture(page, name) {
    mkdirSync(PICTURES, { recursive: true });
    await page.screenshot({ path: join(PICTURES, `${name}.png`) });
}

/**
 * What axe-core finds on a page: one line per violation.
 *
 * @param {import("puppeteer-core").Page} page
 * @returns {Promise<string[]>}
 */
export async function violations(page) {
    await page.addScriptTag({ path: join(ROOT, "node_modules/axe-core/axe.min.js") });
    return page.evaluate(async () => {
        // @ts-ignore: `axe` is the script's.
        const found = await axe.run(document);
        return found.violations.map(
            (/** @type {any} */ violation) =>
                `${violation.id}: ${violation.nodes.map((/** @type {any} */ n) => n.html).join()}`
        );
    });
}
