/**
 * Draws segments with Canvas 2D. It works everywhere; a large path at rest is drawn in slices, so
 * that the page stays responsive.
 */

/** @typedef {import("husillo/viewer/segments.js").Segments} Segments */
/** @typedef {import("husillo/viewer/camera.js").Camera} Camera */
/** @typedef {import("husillo/viewer/look.js").Look} Look */

/** Segments per slice. */
const SLICE = 40_000;
/** A point nearer to the last one is left out, pixels. */
const LEAST = 0.4;
/** Drawn beyond the edge, pixels. */
const MARGIN = 60;

/** A renderer with Canvas 2D. */
export class CanvasRenderer {
    /** @param {HTMLCanvasElement} canvas */
    constructor(canvas) {
        this.canvas = canvas;
        this.context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d"));
        this.name = "canvas";
        /** Most segments of a picture that moves. */
        this.most = 12_000;
        /** Segments looked at for the last picture. */
        this.work = 0;
        this.turn = 0;
    }

    /**
     * Draws a picture. `done` is called when the last slice is there.
     *
     * @param {Segments} segments
     * @param {number[]} centre
     * @param {Camera} camera
     * @param {Look} look
     * @param {() => void} [done]
     */
    draw(segments, centre, camera, look, done) {
        const turn = ++this.turn;
        const { context } = this;
        const ratio = this.canvas.width / camera.width;
        context.setTransform(ratio, 0, 0, ratio, 0, 0);
        context.fillStyle = look.ground;
        context.fillRect(0, 0, camera.width, camera.height);
        this.work = 0;
        const slice = new Slice(context, segments, centre, camera, look);
        const next = (/** @type {number} */ from) => {
            if (turn !== this.turn) return;
            const to = Math.min(from + SLICE, segments.count);
            slice.draw(from, to);
            this.work += to - from;
            if (to < segments.count) requestAnimationFrame(() => next(to));
            else done?.();
        };
        next(0);
    }

    /** @param {Segments} _ */
    forget(_) {}
}

/** What is the same for all segments of a picture. */
class Slice {
    /**
     * @param {CanvasRenderingContext2D} context
     * @param {Segments} segments
     * @param {number[]} centre
     * @param {Camera} camera
     * @param {Look} look
     */
    constructor(context, segments, centre, camera, look) {
        this.context = context;
        this.segments = segments;
        this.look = look;
        const [right, up] = camera.axes;
        this.x = right.map((part) => part * camera.scale);
        this.y = up.map((part) => -part * camera.scale);
        const [left, top] = camera.project(centre);
        this.left = left;
        this.top = top;
        this.edges = [-MARGIN, -MARGIN, camera.width + MARGIN, camera.height + MARGIN];
    }

    /**
     * @param {number} from
     * @param {number} to
     */
    draw(from, to) {
        const order = [0, 1, 4, 3, 2];
        for (const kind of order) {
            const { colour, width, dash } = this.look.kinds[kind];
            const { context } = this;
            context.strokeStyle = colour;
            context.lineWidth = width;
            context.setLineDash(dash);
            context.lineJoin = "round";
            context.beginPath();
            this.trace(kind, from, to);
            context.stroke();
        }
        this.context.setLineDash([]);
    }

    /**
     * Adds the segments of a kind to the path of the context.
     *
     * @param {number} kind
     * @param {number} from
     * @param {number} to
     */
    trace(kind, from, to) {
        const { context, left, top, x, y } = this;
        const { ends, kinds } = this.segments;
        let [lastX, lastY, isOpen] = [NaN, NaN, false];
        for (let index = from; index < to; index++) {
            if (kinds[index] !== kind) continue;
            const at = index * 6;
            const [a, b, c] = [ends[at], ends[at + 1], ends[at + 2]];
            const [d, e, f] = [ends[at + 3], ends[at + 4], ends[at + 5]];
            const x0 = left + a * x[0] + b * x[1] + c * x[2];
            const y0 = top + a * y[0] + b * y[1] + c * y[2];
            const x1 = left + d * x[0] + e * x[1] + f * x[2];
            const y1 = top + d * y[0] + e * y[1] + f * y[2];
            const clipped = clip(x0, y0, x1, y1, this.edges);
            if (!clipped) {
                isOpen = false;
                continue;
            }
            const [u, v, w, z] = clipped;
            const follows =
                isOpen && Math.abs(u - lastX) < LEAST && Math.abs(v - lastY) < LEAST;
            const isShort = Math.abs(w - u) < LEAST && Math.abs(z - v) < LEAST;
            if (follows && isShort) continue;
            if (!follows) context.moveTo(u, v);
            // A line of no length has no ink.
            context.lineTo(isShort ? w + LEAST : w, z);
            [lastX, lastY, isOpen] = [w, z, true];
        }
    }
}

/**
 * The part of a line inside of a frame; `undefined` if there is none. The method is that of Y.-D.
 * Liang and B. Barsky, "A new concept and method for line clipping", 1984. Dashes of a line
 * that is a thousand times as long as the canvas would take seconds.
 *
 * @param {number} x0
 * @param {number} y0
 * @param {number} x1
 * @param {number} y1
 * @param {number[]} edges left, top, right, bottom
 * @returns {[number, number, number, number] | undefined}
 */
export function clip(x0, y0, x1, y1, [left, top, right, bottom]) {
    const isInside =
        x0 >= left &&
        x0 <= right &&
        y0 >= top &&
        y0 <= bottom &&
        x1 >= left &&
        x1 <= right &&
        y1 >= top &&
        y1 <= bottom;
    if (isInside) return [x0, y0, x1, y1];
    let [begin, end] = [0, 1];
    const [dx, dy] = [x1 - x0, y1 - y0];
    const sides = [
        [-dx, x0 - left],
        [dx, right - x0],
        [-dy, y0 - top],
        [dy, bottom - y0],
    ];
    for (const [towards, distance] of sides) {
        if (towards === 0) {
            if (distance < 0) return undefined;
        } else if (towards < 0) begin = Math.max(begin, distance / towards);
        else end = Math.min(end, distance / towards);
        if (begin > end) return undefined;
    }
    return [x0 + begin * dx, y0 + begin * dy, x0 + end * dx, y0 + end * dy];
}
