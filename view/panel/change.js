/**
 * Changes of elements that are made only where something differs. States arrive up to 80 times
 * a second.
 */

/**
 * Sets the text of an element.
 *
 * @param {Element} of
 * @param {string} text
 */
export function put(of, text) {
    if (of.textContent !== text) of.textContent = text;
}

/**
 * Sets the classes of an element.
 *
 * @param {Element} of
 * @param {...string} names
 */
export function toggle(of, ...names) {
    const text = names.filter(Boolean).join(" ");
    if (of.className !== text) of.className = text;
}

/**
 * Enables or disables a control.
 *
 * @param {HTMLButtonElement | HTMLInputElement | HTMLSelectElement | HTMLTextAreaElement} control
 * @param {boolean} isDisabled
 */
export function disable(control, isDisabled) {
    if (control.disabled !== isDisabled) control.disabled = isDisabled;
}

/**
 * Sets the value of a field, unless the operator is in it.
 *
 * @param {HTMLInputElement} field
 * @param {string} value
 */
export function fill(field, value) {
    if (document.activeElement !== field && field.value !== value) field.value = value;
}
