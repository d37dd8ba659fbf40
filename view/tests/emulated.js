/**
 * An emulated mill with a panel, to which a server connects, for tests.
 */

import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { husillo } from "husillo/tests/reports.js";

/**
 * Starts one at a free port of this computer.
 *
 * @param {import("node:test").TestContext} t
 * @param {"grbl" | "grblhal"} controller
 * @returns {Promise<{port: string, panel: (line: string) => void}>} `panel` sends a line of its
 * panel, such as `tilt 10 -4`
 */
export function emulated(t, controller) {
    const wanted = ["--listen", "127.0.0.1:0", "--speed", "20", "--for", "900"];
    const child = spawn(husillo(), ["emulate", controller, ...wanted], {
        stdio: ["pipe", "pipe", "inherit"],
    });
    t.after(() => child.kill("SIGKILL"));
    const panel = (/** @type {string} */ line) => void child.stdin.write(`${line}\n`);
    return new Promise((resolve, reject) => {
        child.on("exit", () => reject(new Error("the emulated mill has ended")));
        createInterface(child.stdout).on("line", (line) => {
            const port = /tcp:[0-9.:]+/.exec(line)?.[0];
            if (port) resolve({ port, panel });
        });
    });
}

/**
 * Sends a line by hand and waits for its answer.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} text
 */
export function line(page, text) {
    return page.evaluate(
        (text) => Reflect.get(window, "husillo").request("line", { text }),
        text
    );
}

/**
 * Lets the page see the probe closed once, so that it knows that the probe works.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {(line: string) => void} panel of the emulated mill
 */
export async function tryProbe(page, panel) {
    const closed = (/** @type {boolean} */ is) =>
        page.waitForFunction(
            (is) => Reflect.get(window, "husillo").state?.switches.includes("P") === is,
            {},
            is
        );
    panel("close probe");
    await closed(true);
    panel("free probe");
    await closed(false);
}
