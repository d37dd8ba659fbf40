/**
 * A gamepad moves the machine: left stick X and Y, right stick Z, while a shoulder button is held.
 * Button B stops.
 */

import { element } from "husillo/viewer/element.js";
import { put } from "husillo/panel/change.js";

/** Deflection below which a stick counts as released. */
const DEAD = 0.2;
/** Steps of the deflection, so that a trembling hand does not change the motion all the time. */
const LEVELS = 4;
/** The buttons, in the standard mapping. */
const [B, LEFT_SHOULDER, RIGHT_SHOULDER] = [1, 4, 5];

/** The gamepads. */
export class Gamepads {
    /**
     * @param {import("husillo/panel/words.js").Words} words
     * @param {() => import("husillo/panel/by_hand.js").ByHand} jog that of the shown machine
     * @param {() => void} stop
     */
    constructor(words, jog, stop) {
        this.words = words;
        this.jog = jog;
        this.stop = stop;
        this.isWatching = false;
        this.wasStop = false;
        /** What it moved last. */
        this.last = jog();
        this.root = element("p", { class: "soft", "data-gamepad": "none" });
        put(this.root, window.isSecureContext ? words.gamepadNone : words.gamepadInsecure);
        window.addEventListener("gamepadconnected", () => this.watch());
        window.addEventListener("gamepaddisconnected", () =>
            jog().hold.release("gamepad", "gone")
        );
        if (window.isSecureContext && this.pads.length > 0) this.watch();
    }

    /** @returns {Gamepad[]} */
    get pads() {
        return [...(navigator.getGamepads?.() ?? [])].filter((pad) => pad !== null);
    }

    watch() {
        if (this.isWatching) return;
        this.isWatching = true;
        const look = () => {
            this.isWatching = this.pads.length > 0;
            this.look();
            if (this.isWatching) requestAnimationFrame(look);
        };
        look();
    }

    look() {
        const { words } = this;
        const jog = this.jog();
        if (jog !== this.last) {
            // It must be let go before it moves another machine.
            this.last.hold.release("gamepad", "another");
            this.last = jog;
            jog.hold.ended.add("gamepad");
        }
        const [pad] = this.pads;
        this.root.dataset.gamepad = pad ? "there" : "none";
        const there = `${words.gamepad}: ${pad?.id}. ${words.gamepadHelp}`;
        put(this.root, pad ? there : words.gamepadNone);
        if (!pad) return jog.hold.release("gamepad", "gone");
        const isStop = pad.buttons[B]?.pressed ?? false;
        if (isStop && !this.wasStop) this.stop();
        this.wasStop = isStop;
        const isAlive = [LEFT_SHOULDER, RIGHT_SHOULDER].some((one) => pad.buttons[one]?.pressed);
        const direction = isAlive && !isStop ? directionOf(pad) : {};
        if (Object.keys(direction).length === 0) return jog.hold.release("gamepad", "released");
        jog.isFast = false;
        jog.hold.steer("gamepad", direction);
    }
}

/**
 * The direction of the sticks. Up is +Y and +Z.
 *
 * @param {Gamepad} pad
 */
function directionOf(pad) {
    const [x = 0, y = 0, , z = 0] = pad.axes;
    /** @type {import("husillo/panel/hold.js").Direction} */
    const direction = {};
    for (const [letter, value] of /** @type {[string, number][]} */ ([
        ["X", x],
        ["Y", -y],
        ["Z", -z],
    ])) {
        if (Math.abs(value) < DEAD) continue;
        direction[letter] = Math.ceil(Math.abs(value) * LEVELS) / LEVELS * Math.sign(value);
    }
    return direction;
}
