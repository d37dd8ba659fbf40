/**
 * A height map as a picture and as a table: colours between its points, and the heights as text.
 */

import { element } from "husillo/viewer/element.js";

/** @typedef {import("husillo/panel/words.js").Words} Words */

/** Fields of colour between two points. */
const PARTS = 6;
/** Width of the picture, and its least and greatest height. */
const WIDE = 480;
const HIGH = /** @type {const} */ ([140, 480]);
/** Room around the points, for their texts. */
const ROOM = 34;
/** Columns of a map whose heights fit into the picture. The table has them all. */
const READABLE = 8;

/**
 * A map of a controller.
 *
 * @typedef {object} HeightGrid
 * @property {boolean} isOn
 * @property {[number, number, number, number]} area first point, width and depth, mm
 * @property {number} columns
 * @property {number} rows
 * @property {number[][]} heights mm, of each row
 */

/**
 * Reads a line of the answer to `$Z`.
 *
 * @param {string} text
 * @param {HeightGrid | undefined} grid what was read before
 * @returns {HeightGrid | undefined}
 */
export function readMap(text, grid) {
    // A reset and homing do that.
    if (grid && /^\[MSG:Height map off\]$/i.test(text)) return { ...grid, isOn: false };
    const [, head, rest] = /^\[(MAP|HEIGHTS):(.*)\]$/.exec(text) ?? [];
    const numbers = (rest ?? "").split(",").map(Number);
    if (numbers.some(Number.isNaN)) return grid;
    if (head === "MAP" && numbers.length === 7) {
        const [isOn, x, y, width, depth, columns, rows] = numbers;
        // Without a map all are 0.
        if (columns === 0) return undefined;
        return { isOn: isOn === 1, area: [x, y, width, depth], columns, rows, heights: [] };
    }
    const [row, ...heights] = numbers;
    if (head === "HEIGHTS" && grid && heights.length === grid.columns) grid.heights[row] = heights;
    return grid;
}

/** Whether all rows of a map were read. @param {HeightGrid | undefined} grid */
export function isWhole(grid) {
    return grid !== undefined && grid.heights.filter(Boolean).length === grid.rows;
}

/** Lowest and highest point, mm. @param {HeightGrid} grid */
export function rangeOf({ heights }) {
    const all = heights.flat();
    return { low: Math.min(...all), high: Math.max(...all) };
}

/**
 * The height between the points, as the controller interpolates it.
 *
 * @param {HeightGrid} grid
 * @param {number} across columns from the first one
 * @param {number} up rows from the first one
 */
export function heightAt({ heights, columns, rows }, across, up) {
    const column = Math.min(Math.floor(across), columns - 2);
    const row = Math.min(Math.floor(up), rows - 2);
    const [x, y] = [across - column, up - row];
    /** @type {(of: number[]) => number} */
    const along = (of) => of[column] * (1 - x) + of[column + 1] * x;
    return along(heights[row]) * (1 - y) + along(heights[row + 1]) * y;
}

/**
 * The picture: the farthest row is on top, as on the table of the machine.
 *
 * @param {HeightGrid} grid
 * @param {Words} words
 */
export function drawMap(grid, words) {
    const { area, columns, rows, heights } = grid;
    const [, , width, depth] = area;
    const wide = WIDE - 2 * ROOM;
    const high = Math.max(HIGH[0], Math.min(HIGH[1], (wide * depth) / width));
    const { low, high: top } = rangeOf(grid);
    const [dx, dy] = [wide / (columns - 1), high / (rows - 1)];
    /** @type {(column: number, row: number) => [number, number]} */
    const place = (column, row) => [ROOM + column * dx, ROOM + high - row * dy];
    const fields = [];
    for (let row = 0; row < (rows - 1) * PARTS; row += 1) {
        for (let column = 0; column < (columns - 1) * PARTS; column += 1) {
            const [across, up] = [(column + 0.5) / PARTS, (row + 0.5) / PARTS];
            const part = top > low ? (heightAt(grid, across, up) - low) / (top - low) : 0;
            const [x, y] = place(column / PARTS, (row + 1) / PARTS);
            // A little larger, so that no lines show between them.
            const size = { width: dx / PARTS + 0.5, height: dy / PARTS + 0.5 };
            fields.push(drawn("rect", { x, y, ...size, style: `--part: ${percent(part)}` }));
        }
    }
    const points = heights.flatMap((all, row) =>
        all.flatMap((height, column) => {
            const [x, y] = place(column, row);
            const dot = drawn("circle", { cx: x, cy: y, r: 2.5 });
            if (columns > READABLE) return [dot];
            const text = drawn("text", { x, y: y - 7 });
            text.textContent = height.toFixed(3);
            return [dot, text];
        })
    );
    const viewBox = `0 0 ${WIDE} ${high + 2 * ROOM}`;
    const label = `${words.mapPicture}: ${rangeText(grid, words)}`;
    const picture = drawn("svg", { viewBox, class: "height-map", role: "img" });
    picture.setAttribute("aria-label", label);
    picture.append(...fields, ...points);
    return picture;
}

/** @param {number} part */
function percent(part) {
    return `${Math.round(part * 100)}%`;
}

/**
 * @param {string} tag
 * @param {Record<string, string | number>} attributes
 */
function drawn(tag, attributes) {
    const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
    return made;
}

/**
 * Lowest and highest point as text.
 *
 * @param {HeightGrid} grid
 * @param {Words} words
 */
export function rangeText(grid, words) {
    const { low, high } = rangeOf(grid);
    return `${words.mapLowest} ${low.toFixed(3)} mm, ${words.mapHighest} ${high.toFixed(3)} mm`;
}

/**
 * The rows of the table, with their heads.
 *
 * @param {HeightGrid} grid
 * @param {Words} words
 * @returns {HTMLElement[]}
 */
export function tableOf(grid, words) {
    const [x, y, width, depth] = grid.area;
    /** @type {(from: number, size: number, part: number) => string} */
    const at = (from, size, part) => (from + size * part).toFixed(1);
    const columns = Array.from({ length: grid.columns }, (_, column) =>
        at(x, width, column / (grid.columns - 1))
    );
    const rows = grid.heights.map((heights, row) =>
        element(
            "tr",
            {},
            element("th", { scope: "row" }, `Y ${at(y, depth, row / (grid.rows - 1))}`),
            ...heights.map((height) => element("td", { class: "number" }, height.toFixed(3)))
        )
    );
    const heads = columns.map((text) => element("th", { scope: "col" }, `X ${text}`));
    return [
        element("caption", {}, `${rangeText(grid, words)}. ${words.mapFrame}`),
        element("thead", {}, element("tr", {}, element("td", {}), ...heads)),
        // The farthest row is on top, as in the picture.
        element("tbody", {}, ...rows.reverse()),
    ];
}
