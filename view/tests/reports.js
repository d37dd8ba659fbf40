/**
 * Reports of programs, made by the program `husillo`.
 */

import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { PICTURES, ROOT } from "husillo/tests/browser.js";

/** The path of the program: `HUSILLO`, or the one that was built last. */
export function husillo() {
    const builds = ["release", "debug"].map((build) =>
        join(ROOT, "../target", build, "husillo")
    );
    const found = process.env.HUSILLO ?? builds.find((path) => existsSync(path));
    if (!found) throw new Error("no husillo: cargo build -p husillo-host --release");
    return found;
}

/**
 * Makes the report of a program, and returns its path.
 *
 * @param {string} name
 * @param {string} text its program
 * @param {string[]} more arguments
 */
export function reportOf(name, text, ...more) {
    mkdirSync(PICTURES, { recursive: true });
    const [source, page] = [join(PICTURES, `${name}.nc`), join(PICTURES, `${name}.html`)];
    writeFileSync(source, text);
    execFileSync(husillo(), ["run", source, "-o", page, ...more], { stdio: "pipe" });
    return page;
}

/**
 * The text of the scene of a report.
 *
 * @param {string} page
 */
export function sceneIn(page) {
    const found = /id="scene">([^<]*)</.exec(readFileSync(page, "utf8"));
    if (!found) throw new Error(`${page} has no scene`);
    return found[1];
}

/** An example of the repository. @param {string} name */
export function example(name) {
    return readFileSync(join(ROOT, "../examples", name), "utf8");
}

/** A part in three dimensions: rapids, feeds, arcs in all planes, a dwell. */
export const PART = `G21 G90 G17 G94
M3 S12000
G0 X10 Y10 Z5
G1 Z-2 F300
G1 X50 F900
G3 X60 Y20 I0 J10
G1 Y40
G2 X60 Y40 I-8 J0 Z-4
G4 P0.5
G0 Z5
G18
G0 X20 Y50
G1 Z-1 F300
G2 X40 Z-1 I10 K0
G17
G0 Z5
G0 X0 Y0
M5
M2
`;

/**
 * A relief in passes over 75 x 80 mm.
 *
 * @param {number} lines
 */
export function reliefProgram(lines) {
    const [passes, perPass] = [400, lines / 400];
    const text = ["G21 G90 G17 G94", "M3 S12000", "G0 X0 Y0 Z5", "G1 Z0 F600"];
    for (let line = 0; line < lines; line++) {
        const pass = Math.floor(line / perPass);
        const step = line % perPass;
        const x = ((pass % 2 ? perPass - 1 - step : step) * 75) / perPass;
        const y = (pass * 80) / passes;
        const z = -1 + 0.8 * Math.sin(x / 4) * Math.cos(y / 5) + 0.01 * Math.sin(line * 1.3);
        text.push(`N${line} G1 X${x.toFixed(3)} Y${y.toFixed(3)} Z${z.toFixed(3)} F1500`);
    }
    return [...text, "G0 Z5", "M5", "M2", ""].join("\n");
}
