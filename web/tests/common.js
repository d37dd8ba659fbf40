/**
 * What the tests of this folder share.
 */

import { readFileSync } from "node:fs";
import { load } from "../husillo.js";

/** The simulator of this folder. @type {import("../index.js").Husillo} */
export const husillo = /** @type {any} */ (await load());

/** An example of the repository. @param {string} name */
export function example(name) {
    return readFileSync(new URL(`../../examples/${name}`, import.meta.url), "utf8");
}

/**
 * A value that is no failure.
 *
 * @template T
 * @param {T} value
 * @returns {Exclude<T, import("../index.js").Failed>}
 */
export function good(value) {
    const failed = value && typeof value === "object" && "error" in value && value.error;
    if (failed) throw new Error(String(failed));
    return /** @type {any} */ (value);
}

/**
 * A value whose fractions have nine digits. The functions of angles differ in the last digits
 * between computers, so the figures do, but not the steps.
 *
 * @param {unknown} value
 */
export function rounded(value) {
    return JSON.parse(
        JSON.stringify(value, (_, of) =>
            typeof of === "number" && !Number.isInteger(of) ? Number(of.toPrecision(9)) : of
        )
    );
}
