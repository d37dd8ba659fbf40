/**
 * Starts the panel: takes the token of the address, puts the page together, and connects.
 */

import { Desk } from "husillo/panel/desk.js";
import { fillPage } from "husillo/panel/page.js";
import { isSpanish, wordsOf } from "husillo/panel/words.js";

const token = location.hash.slice(1) || (sessionStorage.getItem("token") ?? "");
// A reload without the part behind # goes on.
sessionStorage.setItem("token", token);
const language = navigator.language ?? "en";
document.documentElement.lang = isSpanish(language) ? "es" : "en";
const desk = new Desk(location.origin, token);
const place = document.getElementById("panel");
if (place) {
    fillPage(place, desk, wordsOf(language));
    desk.link.open();
    // For tests, and for those who look at the page from the console.
    Object.assign(window, { husillo: desk });
}
