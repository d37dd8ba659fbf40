/**
 * Pages of the panel for tests, with a fake server behind them.
 */

import { open } from "husillo/tests/browser.js";
import { FakeServer } from "husillo/tests/fake_server.js";

/**
 * Starts a fake server, and opens the panel of its first machine, in control.
 *
 * @param {import("node:test").TestContext} t
 * @param {import("husillo/tests/browser.js").Wanted} [wanted]
 * @param {{
 *     names?: string[],
 *     prepare?: (server: FakeServer) => void,
 *     expected?: RegExp
 * }} [options] names of the machines; what the server needs before the page is opened; errors of
 * the browser that the test expects
 */
export async function panel(t, wanted = {}, options = {}) {
    const server = new FakeServer(options.names ?? ["mill"]);
    options.prepare?.(server);
    await server.start();
    const page = await open(t, {
        address: server.address,
        expected: options.expected,
        width: 1280,
        height: 1000,
        ...wanted,
    });
    // After the page: a page that loses its server prints errors.
    t.after(() => server.stop());
    await server.next("take");
    await page.waitForFunction(() => Reflect.get(window, "husillo").isOperator);
    return { page, server };
}

/**
 * Waits until an element of the page has a text.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} selector
 * @param {string} text
 */
export async function says(page, selector, text) {
    try {
        await page.waitForFunction(
            (selector, text) => document.querySelector(selector)?.textContent?.includes(text),
            {},
            selector,
            text
        );
    } catch (error) {
        const said = await page.$$eval(selector, (all) => all[0]?.textContent ?? "nothing");
        throw new Error(`${selector} says "${said}" instead of "${text}"`, { cause: error });
    }
}

/**
 * The text of an element.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} selector
 */
export function textOf(page, selector) {
    return page.$eval(selector, (one) => one.textContent ?? "");
}

/**
 * Clicks an element in the middle of the window, once it can be operated.
 *
 * @param {import("puppeteer-core").Page} page
 * @param {string} selector
 */
export async function press(page, selector) {
    const found = await page.waitForSelector(selector);
    if (!found) throw new Error(selector);
    await page.waitForFunction((one) => !one.matches(":disabled"), {}, found);
    await found.evaluate((one) => one.scrollIntoView({ block: "center" }));
    await found.click();
}
