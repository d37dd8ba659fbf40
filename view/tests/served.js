/**
 * The real `husillo serve` with a simulated machine, for tests.
 */

import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { open } from "husillo/tests/browser.js";
import { press, says } from "husillo/tests/panels.js";
import { husillo } from "husillo/tests/reports.js";

/** What takes longer than this does not come, milliseconds. */
const PATIENCE = Number(process.env.PATIENCE ?? 120_000);

/** What ends the servers. @type {Set<() => void>} */
const kills = new Set();
process.once("exit", () => kills.forEach((kill) => kill()));

/**
 * Starts `husillo serve` on a free port, and gives the address of its page.
 *
 * @param {...string} more arguments
 * @returns {Promise<{
 *     address: string, kill: () => void, signal: (name: NodeJS.Signals) => void
 * }>}
 */
function serve(...more) {
    const all = ["serve", "--listen", "127.0.0.1:0", "--format", "json", ...more];
    const child = spawn(husillo(), all, { stdio: ["ignore", "pipe", "inherit"] });
    const kill = () => child.kill("SIGKILL");
    const signal = (/** @type {NodeJS.Signals} */ name) => child.kill(name);
    return new Promise((resolve, reject) => {
        const stuck = setTimeout(() => reject(new Error("husillo serve is stuck")), PATIENCE);
        child.on("exit", (code) => reject(new Error(`husillo serve has ended: ${code}`)));
        createInterface(child.stdout).on("line", (line) => {
            const { kind, url } = JSON.parse(line);
            if (kind !== "open") return;
            clearTimeout(stuck);
            // A test whose page has failed does not end its server: it ends with the tests.
            kills.add(kill);
            child.unref();
            /** @type {import("node:net").Socket} */ (child.stdout).unref();
            resolve({ address: url, kill, signal });
        });
    });
}

/**
 * Starts a server with a simulated machine, and opens its panel.
 *
 * @param {import("node:test").TestContext} t
 * @param {import("husillo/tests/browser.js").Wanted} [wanted]
 * @param {...string} more arguments of the server
 */
export async function served(t, wanted = {}, ...more) {
    const server = await serve(...more);
    const { address } = server;
    try {
        const page = await open(t, { address, width: 1280, height: 1400, ...wanted });
        // After the page: a page that loses its server prints errors.
        t.after(() => server.kill());
        await page.waitForFunction(() => Reflect.get(window, "husillo").isOperator);
        return { page, server };
    } catch (error) {
        server.kill();
        throw error;
    }
}

/** The last state. @param {import("puppeteer-core").Page} page */
export function state(page) {
    return page.evaluate(() => Reflect.get(window, "husillo").state);
}

/**
 * Waits for a state with a property, and gives it.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {(state: any) => unknown} has
 */
export async function until(page, has) {
    const end = Date.now() + PATIENCE;
    for (;;) {
        const now = await state(page);
        if (now && has(now)) return now;
        if (Date.now() > end) throw new Error(`no state with ${has}: ${JSON.stringify(now)}`);
        await page.evaluate(() => new Promise((resolve) => setTimeout(resolve, 20)));
    }
}

/** @param {any} state */
export const isIdle = ({ state }) => state === "Idle";

/**
 * Homes the machine, which is locked when it is switched on.
 *
 * @param {import("puppeteer-core").Page} page
 */
export async function home(page) {
    await until(page, ({ state }) => state === "Alarm");
    await says(page, ".state", "LOCKED");
    await press(page, "button::-p-aria(Home)");
    await until(page, ({ state }) => state === "Home");
    return until(page, isIdle);
}
