/**
 * Draws segments with WebGL2: each segment is two triangles, and one call draws them all.
 */

import { parts } from "husillo/viewer/look.js";

/** @typedef {import("husillo/viewer/segments.js").Segments} Segments */
/** @typedef {import("husillo/viewer/camera.js").Camera} Camera */
/** @typedef {import("husillo/viewer/look.js").Look} Look */

const VERTEX = `#version 300 es
    in vec2 corner;
    in vec3 from;
    in vec3 to;
    in float kind;
    in float along;
    uniform vec3 right;
    uniform vec3 up;
    uniform vec3 eye;
    uniform vec2 shift;
    uniform vec2 size;
    uniform vec4 strokes[5];
    uniform float scale;
    uniform float ratio;
    out float at;
    flat out int which;
    void main() {
        which = int(kind);
        vec2 a = shift + vec2(dot(from, right), dot(from, up));
        vec2 b = shift + vec2(dot(to, right), dot(to, up));
        vec2 line = b - a;
        float pixels = length(line);
        vec2 along_it = pixels > 0.0 ? line / pixels : vec2(1.0, 0.0);
        vec2 across = vec2(-along_it.y, along_it.x);
        float half_width = 0.5 * strokes[which].w;
        vec2 place = mix(a, b, corner.x) + across * (corner.y * half_width)
            + along_it * ((corner.x * 2.0 - 1.0) * 0.25);
        at = along * scale + corner.x * pixels;
        float depth = dot(mix(from, to, corner.x), eye);
        gl_Position = vec4(2.0 * place / size, -0.5 * depth, 1.0);
    }`;

const FRAGMENT = `#version 300 es
    precision highp float;
    in float at;
    flat in int which;
    uniform vec4 strokes[5];
    uniform vec2 dashes[5];
    out vec4 colour;
    void main() {
        vec2 dash = dashes[which];
        float period = dash.x + dash.y;
        if (period > 0.0 && mod(at, period) > dash.x) discard;
        colour = vec4(strokes[which].rgb, 1.0);
    }`;

/** A renderer with WebGL2. */
export class WebGlRenderer {
    /**
     * @param {HTMLCanvasElement} canvas
     * @param {boolean} evenIfSlow also where WebGL2 is emulated
     * @returns {WebGlRenderer | undefined} `undefined` without WebGL2
     */
    static of(canvas, evenIfSlow) {
        // A canvas that has had one kind of context cannot have another.
        if (!evenIfSlow && !isFast()) return undefined;
        const context = canvas.getContext("webgl2", {
            antialias: true,
            preserveDrawingBuffer: true,
        });
        return context ? new WebGlRenderer(canvas, context) : undefined;
    }

    /**
     * @param {HTMLCanvasElement} canvas
     * @param {WebGL2RenderingContext} gl
     */
    constructor(canvas, gl) {
        this.canvas = canvas;
        this.gl = gl;
        this.name = "webgl";
        /** Most segments of a picture that moves. */
        this.most = 200_000;
        /** Segments of the last picture. */
        this.work = 0;
        this.program = programOf(gl);
        /** @type {Map<Segments, WebGLVertexArrayObject>} */
        this.arrays = new Map();
    }

    /**
     * @param {Segments} segments
     * @param {number[]} centre
     * @param {Camera} camera
     * @param {Look} look
     * @param {() => void} [done]
     */
    draw(segments, centre, camera, look, done) {
        const { gl, program, canvas } = this;
        gl.viewport(0, 0, canvas.width, canvas.height);
        gl.clearColor(...parts(look.ground), 1);
        gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
        gl.useProgram(program);
        /** @param {string} name */
        const place = (name) => gl.getUniformLocation(program, name);
        const [right, up, eye] = camera.axes;
        const { scale, width, height } = camera;
        gl.uniform3fv(
            place("right"),
            right.map((part) => part * scale)
        );
        gl.uniform3fv(
            place("up"),
            up.map((part) => part * scale)
        );
        // The depth only decides what is in front. It stays within -1 to 1.
        gl.uniform3fv(
            place("eye"),
            eye.map((part) => part / (1 + reach(segments)))
        );
        const [x, y] = camera.project(centre);
        gl.uniform2f(place("shift"), x - width / 2, height / 2 - y);
        gl.uniform2f(place("size"), width, height);
        gl.uniform1f(place("scale"), scale);
        const strokes = look.kinds.flatMap((kind) => [...parts(kind.colour), kind.width]);
        gl.uniform4fv(place("strokes"), strokes);
        gl.uniform2fv(
            place("dashes"),
            look.kinds.flatMap(({ dash }) => (dash.length ? dash : [0, 0]))
        );
        gl.enable(gl.DEPTH_TEST);
        gl.depthFunc(gl.LEQUAL);
        gl.bindVertexArray(this.arrayOf(segments));
        gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, segments.count);
        this.work = segments.count;
        done?.();
    }

    /**
     * Frees the memory of segments that are not drawn again.
     *
     * @param {Segments} segments
     */
    forget(segments) {
        this.gl.deleteVertexArray(this.arrays.get(segments) ?? null);
        this.arrays.delete(segments);
    }

    /** @param {Segments} segments */
    arrayOf(segments) {
        const known = this.arrays.get(segments);
        if (known) return known;
        const { gl } = this;
        const array = /** @type {WebGLVertexArrayObject} */ (gl.createVertexArray());
        gl.bindVertexArray(array);
        this.feed("corner", new Float32Array([0, -1, 0, 1, 1, -1, 1, 1]), 2, 0, 0, 0);
        const { ends, kinds, along } = segments;
        const buffer = this.feed("from", ends, 3, 24, 0, 1);
        this.feed("to", buffer, 3, 24, 12, 1);
        this.feed("kind", kinds, 1, 0, 0, 1);
        this.feed("along", along, 1, 0, 0, 1);
        this.arrays.set(segments, array);
        return array;
    }

    /**
     * Gives an attribute its values.
     *
     * @param {string} name
     * @param {Float32Array | Uint8Array | WebGLBuffer} values or the buffer that has them
     * @param {number} size
     * @param {number} stride
     * @param {number} offset
     * @param {number} divisor
     */
    feed(name, values, size, stride, offset, divisor) {
        const { gl, program } = this;
        const isBuffer = values instanceof WebGLBuffer;
        const buffer = isBuffer ? values : gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        if (!isBuffer) gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
        const type = values instanceof Uint8Array ? gl.UNSIGNED_BYTE : gl.FLOAT;
        const place = gl.getAttribLocation(program, name);
        gl.enableVertexAttribArray(place);
        gl.vertexAttribPointer(place, size, type, false, stride, offset);
        gl.vertexAttribDivisor(place, divisor);
        return buffer;
    }
}

/** Whether a graphics processor draws, and not an emulation, which is slower than Canvas 2D. */
function isFast() {
    const probe = document.createElement("canvas").getContext("webgl2", {
        failIfMajorPerformanceCaveat: true,
    });
    if (!probe) return false;
    const details = probe.getExtension("WEBGL_debug_renderer_info");
    const name = probe.getParameter(details?.UNMASKED_RENDERER_WEBGL ?? probe.RENDERER);
    probe.getExtension("WEBGL_lose_context")?.loseContext();
    return !/swiftshader|llvmpipe|software|basic render/i.test(String(name));
}

/** @type {WeakMap<Segments, number>} */
const reaches = new WeakMap();

/**
 * The largest distance of a point from the centre.
 *
 * @param {Segments} segments
 */
function reach(segments) {
    const known = reaches.get(segments);
    if (known !== undefined) return known;
    let most = 0;
    for (const part of segments.ends) most = Math.max(most, Math.abs(part));
    const found = most * Math.sqrt(3);
    reaches.set(segments, found);
    return found;
}

/** @param {WebGL2RenderingContext} gl */
function programOf(gl) {
    const program = gl.createProgram();
    for (const [type, source] of /** @type {const} */ ([
        [gl.VERTEX_SHADER, VERTEX],
        [gl.FRAGMENT_SHADER, FRAGMENT],
    ])) {
        const shader = /** @type {WebGLShader} */ (gl.createShader(type));
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) {
        throw new Error(gl.getProgramInfoLog(program) ?? "the shaders do not link");
    }
    return program;
}
