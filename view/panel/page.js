/**
 * Puts the parts of the panel together.
 */

import { element } from "husillo/viewer/element.js";
import { Console } from "husillo/panel/console.js";
import { Gamepads } from "husillo/panel/gamepad.js";
import { Header } from "husillo/panel/header.js";
import { Jog } from "husillo/panel/jog.js";
import { Keys } from "husillo/panel/keys.js";
import { Notices } from "husillo/panel/notices.js";
import { Positions } from "husillo/panel/positions.js";
import { Outputs, Speeds } from "husillo/panel/speeds.js";
import { Stop } from "husillo/panel/stop.js";
import { Units } from "husillo/panel/units.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */

/**
 * @param {HTMLElement} place
 * @param {Desk} desk
 * @param {import("husillo/panel/words.js").Words} words
 */
export function fillPage(place, desk, words) {
    const units = new Units();
    const jog = new Jog(desk, words, units);
    const stop = new Stop(desk, words, () => jog.hold.end("stop"));
    const header = new Header(desk, words, stop.root);
    const notices = new Notices(desk, words);
    const positions = new Positions(desk, words, units);
    const speeds = new Speeds(desk, words, units);
    const outputs = new Outputs(desk, words);
    const lines = new Console(desk, words);
    const keys = new Keys(desk, words, {
        jog,
        positions,
        speeds,
        start: () => {},
        pause: () => pause(desk),
    });
    const pad = new Gamepads(words, jog, () => stop.stop());
    keys.root.append(pad.root);
    place.classList.add("panel");
    place.replaceChildren(
        header.root,
        element(
            "main",
            { id: "machine" },
            element("div", { class: "column left" }, notices.list, lines.root, outputs.root),
            element(
                "div",
                { class: "column right" },
                positions.root,
                jog.root,
                speeds.root,
                keys.root
            )
        ),
        notices.live
    );
}

/** Pauses what runs, and resumes what is held. @param {Desk} desk */
function pause(desk) {
    const { state } = desk;
    if (state?.state === "Hold" || state?.program?.phase === "waiting") desk.command("resume");
    else if (state?.state === "Run") desk.command("hold");
}
