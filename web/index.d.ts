/**
 * husillo: reads G-code, checks it, and simulates stepper machines to the step. Lengths are in
 * nanometres (millionths of a degree for rotary axes) and steps, times in seconds and timer ticks.
 *
 * Functions do not throw for what a user may do wrong: they return a {@link Failed}, which has the
 * key `error`.
 */

/** Why there is no result. */
export interface Failed {
    error: string;
    /** The errors of the program or of the machine file. */
    findings: Finding[];
}

/** An error or a warning. */
export interface Finding {
    /** Such as `E0301`. */
    code: string;
    severity: "error" | "warning";
    /** `null` for a finding about the whole program; the same for line, column and end. */
    file: string | null;
    /** From 1. */
    line: number | null;
    /** First column in characters, from 1. */
    column: number | null;
    /** Column behind the last character. */
    end: number | null;
    message: string;
    label: string | null;
    notes: string[];
    help: string | null;
    /** Changes that remove it. */
    fixes: { line: number; column: number; end: number; text: string }[];
}

/** How a program is read, and for which machine. */
export interface Options {
    /** Name in messages; its ending may decide the language. Without it `program.nc`. */
    name?: string;
    /** Name of a built-in machine, or the text of a machine file. Without it `free`. */
    machine?: string | { text: string };
    /** `rs274`, `grbl`, `lathe`, `lathe-a`, `iso`, `printer`, `micromill` or `drill`. */
    dialect?: string;
    /** Position of work zero: `X20Y15`, `fit`, `centre` or `corner`. */
    zero?: string;
    /** Most findings. Without it 1000. */
    limit?: number;
    /** The controller compensates backlash. It does without this option. */
    compensation?: boolean;
    /** The screws have the backlash of `[simulated_backlash]` of the machine file. */
    worn?: boolean;
    /** Texts of files of subroutines, by name. */
    files?: Record<string, string>;
}

/** A built-in machine. */
export interface Machine {
    name: string;
    title: string;
    ticks_per_second: number;
    axes: { letter: string; step_nm: number; travel_nm: [number, number] | null }[];
}

/** The result of a check. */
export interface Checked {
    schema: "husillo.check/1";
    file: string;
    machine?: string;
    errors: number;
    warnings: number;
    findings: Finding[];
    /** What was done without being asked for, such as a move to the middle of the table. */
    notes: string[];
    feed_nm?: number;
    rapid_nm?: number;
    /** By axis. */
    reversals?: number[];
}

/** A command, as `husillo commands --format json` prints it. */
export interface Command {
    schema: "husillo.commands/1";
    line: number;
    [key: string]: unknown;
}

/** The figures of a run. Arrays are by axis. */
export interface Results {
    schema: "husillo.run/1";
    file: string;
    machine: string;
    /** The letters of the axes. */
    axes: string;
    /** Step events, those of take-ups of backlash included. */
    events: number;
    duration_s: number;
    ticks: number;
    ticks_per_second: number;
    nm_per_step: number[];
    /** Position of work zero in machine coordinates at the end. */
    zero_nm: number[];
    /** From work zero. */
    end_nm: number[];
    min_nm: number[];
    max_nm: number[];
    max_deviation_nm: number;
    rms_deviation_nm: number;
    reversals: number[];
    lost_steps: number;
    losses?: string[];
    encoders?: string[];
    probes?: { is_touched: boolean; position_nm: number[]; machine_nm: number[] }[];
    feed_nm: number;
    rapid_nm: number;
    errors: number;
    warnings: number;
    findings: Finding[];
    notes: string[];
}

/** The machine after a step event. */
export interface Instant {
    /** Number of step events so far. */
    event: number;
    ticks: number;
    /** Position of the controller, steps of each axis. */
    commanded: number[];
    /** Position of the tool, steps of each axis. */
    tool: number[];
    /** Inputs of the driver of each axis; bit 0 is the first input. */
    levels: number[];
    /** The event took up backlash. */
    is_take_up: boolean;
}

/** Entries as columns: step events, and waits without a step, which have zeros. */
export interface Rows {
    /** Number of axes. */
    axes: number;
    /** Number of entries of the whole run. */
    entries: number;
    /** Ticks between the entry before and this one. */
    wait_ticks: Uint32Array;
    /** -1, 0 or 1: the axes of the first entry, then those of the second. */
    delta: Int8Array;
}

/** A simulated run. It is freed by `close`. */
export class Run {
    private constructor();
    readonly results: Results;
    /** What the viewer shows: bytes for `unpackBytes` of `viewer/container.js`. */
    scene(): Uint8Array | Failed;
    /** The machine after this number of step events; `undefined` beyond the end. */
    at(event: number): Instant | undefined | Failed;
    /** The machine at a time in seconds; at the end after it. */
    atTime(seconds: number): Instant | Failed;
    /** Up to `count` entries from number `from` on. There may be fewer: go on behind them. */
    steps(from?: number, count?: number): Rows | Failed;
    /** All steps as text: what `husillo steps` prints. */
    csv(options?: { levels?: boolean }): string | Failed;
    close(): void;
}

/** One move for {@link Husillo.compare}, in steps. */
export type Move =
    | { line: number[] }
    | { circle: { radius: number; clockwise?: boolean } }
    | {
          arc: {
              from: [number, number];
              to: [number, number];
              centre: [number, number];
              clockwise?: boolean;
          };
      };

/** A method of interpolation with its figures. Errors are in steps (BLU). */
export interface Method {
    method: string;
    shape: string;
    moves: number;
    iterations: number;
    moving: number;
    max_error_blu: number;
    rms_error_blu: number;
    additions: number;
    tests: number;
    instructions: {
        cortex_m0: number | null;
        cortex_m4f: number | null;
        riscv: number | null;
    };
    points: { error: number; total: number; [criterion: string]: number };
    [key: string]: unknown;
}

export interface Comparison {
    schema: "husillo.compare/1";
    title: string;
    methods: Method[];
    notes: string[];
}

/** A drill file, in mm. */
export interface Board {
    schema: "husillo.holes/1";
    /** X, Y and diameter. */
    holes: [number, number, number | null][];
    slots: unknown[];
    tools: { number: number; diameter: number | null; plated: boolean | null }[];
    units: string;
    units_reason: string;
    zeros: "leading" | "trailing";
    zeros_reason: string;
    digits: string;
    digits_reason: string;
    errors: number;
    warnings: number;
    findings: Finding[];
    /** The program, if a depth was given. */
    gcode?: string;
}

/** An experiment with the simulated axis of the measuring machine. */
export interface Experiment {
    /** Without it `step`: a step with the given gains. The others find gains. */
    method?: "step" | "ultimate" | "relay" | "stepwise";
    p?: number;
    i?: number;
    d?: number;
    integral_limit?: number;
    /** Length of the step, counts. */
    size?: number;
}

export interface Tuned {
    schema: "husillo.tune/1";
    outcome: {
        method: string;
        step?: {
            from: number;
            goal: number;
            rise_ms: number | null;
            overshoot_percent: number | null;
            settling_ms: number | null;
            steady_error: number;
            peak_current: number;
        };
        /** The resulting gains, as a line of a machine file. */
        toml?: string;
        notes?: string[];
        aborted?: string | null;
        [key: string]: unknown;
    };
    /** Points are microseconds and counts. */
    traces: { title: string; target: number | null; points: [number, number][] }[];
}

/** The simulator. */
export class Husillo {
    constructor(module: WebAssembly.Module);
    /** The built-in machines. */
    machines(): Machine[];
    /** The text of the file of a built-in machine. */
    machineText(name: string): string | Failed;
    /** Checks a program, or a drill file by its name. Nothing runs. */
    check(program: string | Uint8Array, options?: Options): Checked | Failed;
    /** The commands of a program. */
    commands(
        program: string | Uint8Array,
        options?: Options
    ): { errors: number; warnings: number; findings: Finding[]; commands: Command[] } | Failed;
    /** Checks and simulates a program. One with errors is a {@link Failed}. */
    simulate(program: string | Uint8Array, options?: Options): Run | Failed;
    /** Compares interpolators for one move, or for the moves of a program. */
    compare(
        what: { weights?: string; only?: string } & (
            | { move: Move }
            | ({ program: string | Uint8Array } & Options)
        )
    ): Comparison | Failed;
    /** Reads a drill file; with a depth, also as a program in G-code. */
    holes(
        file: string | Uint8Array,
        options?: { name?: string; shortest?: boolean; depth_mm?: number }
    ): Board | Failed;
    /** Tunes a servo axis. */
    tune(experiment?: Experiment): Tuned | Failed;
}

/** Loads the simulator: from beside this file, or from what is given. */
export function load(
    source?: URL | string | Response | BufferSource | WebAssembly.Module
): Promise<Husillo>;
