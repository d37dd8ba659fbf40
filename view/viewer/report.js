/**
 * Starts the viewer of a report: reads the scene of the page, and takes the place of its pictures.
 */

import { read } from "husillo/viewer/scene.js";
import { mount } from "husillo/viewer/viewer.js";
import { wordsOf } from "husillo/viewer/words.js";

const scene = document.getElementById("scene");
const place = document.getElementById("viewer");
if (scene && place) {
    try {
        const viewer = mount(place, await read(scene.textContent ?? ""));
        document.documentElement.classList.add("live");
        // For tests, and for those who look at a report from the console.
        Object.assign(window, { husillo: viewer });
        performance.mark("husillo-ready");
    } catch (error) {
        // The pictures of the report stay.
        const reason = error instanceof Error ? error.message : String(error);
        place.textContent = `${wordsOf(navigator.language).broken}: ${reason}`;
        place.hidden = false;
    }
}
