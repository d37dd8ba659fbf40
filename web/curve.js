/**
 * A step response as a picture.
 */

const SPACE = "http://www.w3.org/2000/svg";
const [WIDTH, HEIGHT] = [600, 240];

/**
 * @param {string} tag
 * @param {Record<string, string | number>} attributes
 */
function shape(tag, attributes) {
    const made = document.createElementNS(SPACE, tag);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, String(value));
    return made;
}

/**
 * @param {{title: string, target: number | null, points: [number, number][]}} trace
 */
export function drawn({ title, target, points }) {
    const picture = shape("svg", {
        viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
        role: "img",
        "aria-label": title,
        class: "response",
    });
    const all = points.map(([, at]) => at).concat(target ?? []);
    const [low, high] = [Math.min(...all), Math.max(...all)];
    const end = points.at(-1)?.[0] || 1;
    const y = (/** @type {number} */ at) =>
        10 + ((HEIGHT - 20) * (high - at)) / Math.max(1, high - low);
    const place = (/** @type {[number, number]} */ [us, at]) =>
        `${((WIDTH * us) / end).toFixed(1)},${y(at).toFixed(1)}`;
    if (target !== null) {
        picture.append(
            shape("line", { x1: 0, x2: WIDTH, y1: y(target), y2: y(target), class: "target" })
        );
    }
    picture.append(shape("polyline", { points: points.map(place).join(" "), class: "real" }));
    return picture;
}
