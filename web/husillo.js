/**
 * husillo: reads G-code, checks it, and simulates stepper machines to the step. `index.d.ts` has
 * the types with their documentation.
 */

/** The exports of the module of WebAssembly. */
const NAMES = ["allocate", "call", "answer_length", "forget", "panic"];

/**
 * What a call without an answer returns.
 *
 * @param {string} error
 */
function failed(error) {
    return { body: { error, findings: [] }, data: new Uint8Array() };
}

/**
 * Loads the module: from beside this file, or from what is given.
 *
 * @param {URL | string | Response | BufferSource | WebAssembly.Module} [source]
 */
export async function load(source) {
    return new Husillo(await compiled(source ?? new URL("./husillo.wasm", import.meta.url)));
}

/** @param {any} source */
async function compiled(source) {
    if (source instanceof WebAssembly.Module) return source;
    if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) {
        return WebAssembly.compile(/** @type {BufferSource} */ (source));
    }
    const isFile = String(source.href ?? source).startsWith("file:");
    // fetch() of node has no files.
    if (isFile && typeof process !== "undefined" && process.versions?.node) {
        const { readFile } = await import("node:fs/promises");
        return WebAssembly.compile(await readFile(new URL(source)));
    }
    const response = source instanceof Response ? source : await fetch(source);
    if (!response.ok) throw new Error(`${response.url}: ${response.status}`);
    // Not compileStreaming(): some servers have no type for this file.
    return WebAssembly.compile(await response.arrayBuffer());
}

/** The simulator. Its memory is that of one instance of the module. */
export class Husillo {
    /** @param {WebAssembly.Module} module */
    constructor(module) {
        this.module = module;
        const [wasm, memory] = this.start();
        /** @type {any} */
        this.wasm = wasm;
        /** @type {WebAssembly.Memory} */
        this.memory = memory;
        // Runs of an instance that has failed are closed.
        this.instance = {};
    }

    /**
     * Makes an instance.
     *
     * @returns {[any, WebAssembly.Memory]}
     */
    start() {
        const { exports } = new WebAssembly.Instance(this.module, {});
        const wasm = Object.fromEntries(
            NAMES.map((name) => [name, exports[`husillo_${name}`]])
        );
        return [wasm, /** @type {any} */ (exports.memory)];
    }

    /**
     * @param {any} header
     * @param {string | Uint8Array} [data]
     * @returns {{body: any, data: Uint8Array}}
     */
    call(header, data = new Uint8Array()) {
        const text = new TextEncoder().encode(JSON.stringify(header));
        const bytes = typeof data === "string" ? new TextEncoder().encode(data) : data;
        const length = 4 + text.length + bytes.length;
        try {
            const address = this.wasm.allocate(length) >>> 0;
            if (!address) return failed(`no memory for ${length} bytes`);
            const request = new Uint8Array(this.memory.buffer, address, length);
            new DataView(this.memory.buffer).setUint32(address, text.length, true);
            request.set(text, 4);
            request.set(bytes, 4 + text.length);
            return this.answer(this.wasm.call(address, length) >>> 0);
        } catch (fault) {
            const answer = this.fault(fault);
            [this.wasm, this.memory] = this.start();
            this.instance = {};
            return answer;
        }
    }

    /** @param {number} address */
    answer(address) {
        const length = this.wasm.answer_length();
        const answer = new Uint8Array(this.memory.buffer, address, length).slice();
        this.wasm.forget();
        const end = 4 + new DataView(answer.buffer).getUint32(0, true);
        const body = JSON.parse(new TextDecoder().decode(answer.subarray(4, end)));
        return { body, data: answer.subarray(end) };
    }

    /** @param {unknown} fault */
    fault(fault) {
        try {
            return this.answer(this.wasm.panic() >>> 0);
        } catch {
            return failed(String(fault));
        }
    }

    machines() {
        return this.call({ call: "machines" }).body.machines;
    }

    /** @param {string} name */
    machineText(name) {
        const { body } = this.call({ call: "machine_text", name });
        return "error" in body ? body : body.text;
    }

    /**
     * @param {string | Uint8Array} program
     * @param {any} [options]
     */
    check(program, options) {
        return this.call({ call: "check", ...plain(options) }, program).body;
    }

    /**
     * @param {string | Uint8Array} program
     * @param {any} [options]
     */
    commands(program, options) {
        const { body, data } = this.call({ call: "commands", ...plain(options) }, program);
        if ("error" in body) return body;
        const lines = new TextDecoder().decode(data).split("\n");
        return { ...body, commands: lines.filter(Boolean).map((line) => JSON.parse(line)) };
    }

    /**
     * @param {string | Uint8Array} program
     * @param {any} [options]
     */
    simulate(program, options) {
        const { body } = this.call({ call: "simulate", ...plain(options) }, program);
        return "error" in body ? body : new Run(this, body);
    }

    /** @param {any} what */
    compare(what) {
        const { program, move, weights, only, ...options } = what;
        const one = move && ofMove(move);
        const header = { call: "compare", one, weights, only };
        if (program === undefined) return this.call(header).body;
        return this.call({ ...header, program: plain(options) }, program).body;
    }

    /**
     * @param {string | Uint8Array} file
     * @param {any} [options]
     */
    holes(file, options = {}) {
        const { depth_mm, ...rest } = options;
        const { body, data } = this.call({ call: "holes", ...rest, depth_mm }, file);
        if ("error" in body || depth_mm === undefined) return body;
        return { ...body, gcode: new TextDecoder().decode(data) };
    }

    /** @param {any} [experiment] */
    tune(experiment) {
        return this.call({ call: "tune", ...experiment }).body;
    }
}

/** A simulated run. */
export class Run {
    /**
     * @param {Husillo} husillo
     * @param {any} body
     */
    constructor(husillo, body) {
        const { run, ...results } = body;
        this.husillo = husillo;
        this.instance = husillo.instance;
        this.number = run;
        this.results = results;
    }

    /**
     * @param {any} header
     * @returns {{body: any, data: Uint8Array}}
     */
    call(header) {
        if (this.instance !== this.husillo.instance) return failed("this run is closed");
        return this.husillo.call({ ...header, run: this.number });
    }

    scene() {
        const { body, data } = this.call({ call: "scene" });
        return "error" in body ? body : data;
    }

    /** @param {number} event */
    at(event) {
        const { body } = this.call({ call: "at", event: whole(event) });
        return "error" in body ? body : body.at ?? undefined;
    }

    /** @param {number} seconds */
    atTime(seconds) {
        // The time of an event is not below its ticks for a rounding.
        const ticks = whole(seconds * this.results.ticks_per_second + 1e-3);
        const { body } = this.call({ call: "at_ticks", ticks });
        return "error" in body ? body : body.at;
    }

    /**
     * @param {number} [from]
     * @param {number} [count]
     */
    steps(from = 0, count = 2 ** 20) {
        const header = { call: "rows", from: whole(from), count: whole(count) };
        const { body, data } = this.call(header);
        if ("error" in body) return body;
        const split = 4 * body.count;
        return {
            axes: body.axes,
            entries: body.entries,
            wait_ticks: new Uint32Array(data.slice(0, split).buffer),
            delta: new Int8Array(data.slice(split).buffer),
        };
    }

    /** @param {{levels?: boolean}} [options] */
    csv({ levels = false } = {}) {
        const { body, data } = this.call({ call: "csv", levels });
        return "error" in body ? body : new TextDecoder().decode(data);
    }

    close() {
        this.call({ call: "close" });
    }
}

/** @param {number} number */
function whole(number) {
    return Math.min(Math.max(0, Math.floor(number) || 0), Number.MAX_SAFE_INTEGER);
}

/** @param {any} [options] */
function plain(options = {}) {
    const { machine, ...rest } = options;
    if (machine && typeof machine === "object") return { ...rest, machine_text: machine.text };
    return machine === undefined ? rest : { ...rest, machine };
}

/** @param {any} move */
function ofMove(move) {
    if (move.line) return { line: move.line };
    if (move.circle) return { circle: { clockwise: false, ...move.circle } };
    return { arc: { clockwise: false, ...move.arc } };
}
