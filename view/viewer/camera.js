/**
 * A parallel projection: where points of the machine appear on the canvas. Z points up.
 */

/** @typedef {import("husillo/viewer/segments.js").Box} Box */

/** Named views: the turn about Z and the tilt from above, radians. */
export const VIEWS = /** @type {const} */ ({
    XY: [0, 0],
    XZ: [0, -Math.PI / 2],
    YZ: [Math.PI / 2, -Math.PI / 2],
    "3D": [-0.6, -0.95],
});

/** @typedef {keyof typeof VIEWS} View */

/** A camera. */
export class Camera {
    constructor() {
        /** Turn about Z, radians. */
        this.turn = 0;
        /** Tilt about the horizontal of the canvas: 0 from above, -90 degrees from the front. */
        this.tilt = 0;
        /** Point of the machine in the middle of the canvas, nm. */
        this.target = [0, 0, 0];
        /** Pixels per nanometre. */
        this.scale = 1e-5;
        this.width = 1;
        this.height = 1;
    }

    /** @param {View} view */
    look(view) {
        [this.turn, this.tilt] = VIEWS[view];
    }

    /** The view that it has now; `undefined` between them. */
    get view() {
        const all = /** @type {[View, readonly [number, number]][]} */ (Object.entries(VIEWS));
        const found = all.find(([, [turn, tilt]]) => turn === this.turn && tilt === this.tilt);
        return found?.[0];
    }

    /** Unit vectors of the canvas in the frame of the machine: right, up, and towards the eye. */
    get axes() {
        const [s, c] = [Math.sin(this.turn), Math.cos(this.turn)];
        const [t, u] = [Math.sin(this.tilt), Math.cos(this.tilt)];
        return [
            [c, s, 0],
            [-s * u, c * u, -t],
            [-s * t, c * t, u],
        ];
    }

    /**
     * Pixels of a point, from the upper left corner.
     *
     * @param {ArrayLike<number>} at
     * @returns {[number, number]}
     */
    project(at) {
        const [right, up] = this.axes;
        const off = this.target.map((target, axis) => (at[axis] ?? 0) - target);
        return [
            this.width / 2 + this.scale * dot(off, right),
            this.height / 2 - this.scale * dot(off, up),
        ];
    }

    /**
     * The point under a pixel, in the plane of the target that faces the eye.
     *
     * @param {number} x
     * @param {number} y
     */
    under(x, y) {
        const [right, up] = this.axes;
        const [u, v] = [(x - this.width / 2) / this.scale, (this.height / 2 - y) / this.scale];
        return this.target.map((target, axis) => target + u * right[axis] + v * up[axis]);
    }

    /**
     * @param {number} x pixels
     * @param {number} y
     */
    pan(x, y) {
        const [right, up] = this.axes;
        for (let axis = 0; axis < 3; axis++) {
            this.target[axis] -= (x * right[axis] - y * up[axis]) / this.scale;
        }
    }

    /**
     * Zooms around a pixel, which keeps its place.
     *
     * @param {number} factor
     * @param {number} x
     * @param {number} y
     */
    zoom(factor, x = this.width / 2, y = this.height / 2) {
        const before = this.under(x, y);
        this.scale = Math.min(10, Math.max(1e-10, this.scale * factor));
        const after = this.under(x, y);
        for (let axis = 0; axis < 3; axis++) this.target[axis] += before[axis] - after[axis];
    }

    /**
     * @param {number} turn radians
     * @param {number} tilt
     */
    orbit(turn, tilt) {
        this.turn += turn;
        this.tilt = Math.min(0, Math.max(-Math.PI, this.tilt + tilt));
    }

    /**
     * Shows a box whole.
     *
     * @param {Box} box
     */
    fit(box) {
        if (box.isEmpty) return;
        this.target = box.centre;
        const [right, up] = this.axes;
        let [width, height] = [0, 0];
        for (const corner of box.corners) {
            const off = this.target.map((target, axis) => corner[axis] - target);
            width = Math.max(width, 2 * Math.abs(dot(off, right)));
            height = Math.max(height, 2 * Math.abs(dot(off, up)));
        }
        // The margin has the rulers.
        const [across, down] = [Math.max(40, this.width - 110), Math.max(40, this.height - 90)];
        this.scale = Math.min(across / Math.max(width, 1), down / Math.max(height, 1));
    }
}

/**
 * @param {number[]} a
 * @param {number[]} b
 */
function dot(a, b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
