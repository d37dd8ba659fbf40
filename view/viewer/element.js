/**
 * Makes elements of a page.
 */

/**
 * An element with attributes and children. An attribute that is `false` or `undefined` is left out,
 * a function becomes a listener: `onclick`.
 *
 * @typedef {string | number | boolean | undefined | ((event: any) => void)} Value
 */

/**
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, Value>} attributes
 * @param {(Node | string)[]} children
 * @returns {HTMLElementTagNameMap[T]}
 */
export function element(tag, attributes = {}, ...children) {
    const made = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
        if (typeof value === "function") made.addEventListener(name.slice(2), value);
        else if (value === true) made.setAttribute(name, "");
        else if (value !== undefined && value !== false) made.setAttribute(name, String(value));
    }
    made.append(...children);
    return made;
}

/**
 * A button.
 *
 * @param {string} text
 * @param {() => void} act
 * @param {Record<string, string | boolean>} [attributes]
 */
export function button(text, act, attributes = {}) {
    return element("button", { type: "button", onclick: act, ...attributes }, text);
}

/**
 * Fits the pixels of a canvas to its size on the page.
 *
 * @param {HTMLCanvasElement} canvas
 * @returns {{width: number, height: number, ratio: number}} its size in pixels of the page
 */
export function fitCanvas(canvas) {
    const ratio = window.devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = canvas;
    const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
    // A size that is set, even to the same value, clears the canvas.
    if (canvas.width !== across) canvas.width = across;
    if (canvas.height !== down) canvas.height = down;
    return { width: Math.max(1, width), height: Math.max(1, height), ratio };
}
