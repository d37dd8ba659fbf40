// The server of cncjs with an emulated mill: connects, homes, jogs, probes, streams 10,000 lines
// with a hold and overrides, resets in motion, and unlocks. Prints each step and its answer. Fails
// at the first error, unexpected alarm, or wrong position.

import { spawn } from "node:child_process";
import { mkdirSync, readFileSync } from "node:fs";
import { createServer } from "node:net";
import { join } from "node:path";
import jwt from "jsonwebtoken";
import connect from "socket.io-client";
import { Emulated } from "./emulated.js";
import { spiral } from "./program.js";

// A computer that is busy with other work needs longer than the machine does.
const PATIENCE_MS = 120_000;
const SPEED = "8";

/** @returns {Promise<number>} A port that nobody uses. */
function freePort() {
  return new Promise((resolve) => {
    const server = createServer();
    server.listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => resolve(port));
    });
  });
}

/** The server of cncjs, in a home folder of its own. */
class Server {
  constructor(home, port) {
    this.home = home;
    this.port = port;
    mkdirSync(home, { recursive: true });
    this.process = spawn(
      process.execPath,
      [join("node_modules", "cncjs", "bin", "cncjs"), "-p", String(port), "-H", "127.0.0.1"],
      { env: { ...process.env, HOME: home }, stdio: "ignore" },
    );
  }

  /** Waits for the server, and opens a socket as its page does. */
  async socket() {
    const until = Date.now() + PATIENCE_MS;
    for (;;) {
      try {
        await fetch(`http://127.0.0.1:${this.port}/`);
        break;
      } catch (error) {
        if (Date.now() > until) throw error;
        await new Promise((resolve) => setTimeout(resolve, 200));
      }
    }
    const { secret } = JSON.parse(readFileSync(join(this.home, ".cncrc"), "utf8"));
    const token = jwt.sign({ id: "", name: "" }, secret, { expiresIn: "1h" });
    return connect(`http://127.0.0.1:${this.port}`, { query: { token } });
  }
}

/** A session with the controller: the last state, and the lines that have come. */
class Session {
  constructor(socket, port) {
    this.socket = socket;
    this.port = port;
    this.lines = [];
    this.state = {};
    this.sender = {};
    this.workflow = "";
    this.alarms = 0;
    /** @type {Set<() => void>} */
    this.waiting = new Set();
    this.failed = null;
    const changed = () => this.waiting.forEach((check) => check());
    socket.on("serialport:read", (line) => {
      this.lines.push(line);
      if (/^error/.test(line)) this.failed = new Error(`the controller answered ${line}`);
      if (/^ALARM/.test(line)) this.alarms += 1;
      changed();
    });
    socket.on("controller:state", (_kind, state) => {
      this.state = state;
      changed();
    });
    socket.on("sender:status", (sender) => {
      this.sender = sender;
      changed();
    });
    socket.on("workflow:state", (workflow) => {
      this.workflow = workflow;
      changed();
    });
  }

  open() {
    const options = { controllerType: "Grbl", baudrate: 115200 };
    return new Promise((resolve, reject) => {
      this.socket.emit("open", this.port, options, (error) => (error ? reject(error) : resolve()));
    });
  }

  command(name, ...values) {
    this.socket.emit("command", this.port, name, ...values);
  }

  /** Resolves when `condition` holds. */
  until(what, condition) {
    return new Promise((resolve, reject) => {
      const check = () => {
        if (this.failed) done(reject, this.failed);
        else if (condition()) done(resolve);
      };
      const done = (finish, value) => {
        clearTimeout(timer);
        this.waiting.delete(check);
        finish(value);
      };
      const late = () => {
        const said = JSON.stringify([this.state.status, this.sender, this.lines.slice(-10)]);
        done(reject, new Error(`${what} did not happen: ${said}`));
      };
      const timer = setTimeout(late, PATIENCE_MS);
      this.waiting.add(check);
      check();
    });
  }

  get active() {
    return this.state.status?.activeState;
  }

  work() {
    const { x, y, z } = this.state.status.wpos;
    return [Number(x), Number(y), Number(z)];
  }

  /** The program of the sender has been answered, and the mill stands. */
  async finished() {
    await this.until("the end of the program", () => this.workflow === "idle");
    await this.until("Idle", () => this.active === "Idle");
  }

  async near(what, wanted) {
    const near = () => {
      const at = this.work();
      return wanted.every((value, axis) => value === null || Math.abs(at[axis] - value) < 0.011);
    };
    await this.until(`${what} at ${wanted}`, () => this.active === "Idle" && near());
  }

  /** Sends a line, and resolves when a line that fits `pattern` has come. */
  async ask(line, pattern) {
    const before = this.lines.length;
    this.command("gcode", [line]);
    let answer;
    await this.until(`the answer of ${line}`, () => {
      answer = this.lines.slice(before).find((text) => pattern.test(text));
      return answer !== undefined;
    });
    return answer;
  }

  async expect(alarms) {
    if (this.alarms !== alarms) throw new Error(`${this.alarms} alarms: ${this.lines.join("\n")}`);
  }
}

function say(step, answer) {
  console.log(`${step.padEnd(34)} ${answer}`);
}

async function run(session) {
  await session.open();
  await session.until("Idle", () => session.active === "Idle");
  say("open", session.active);
  for (const axis of [0, 1, 2]) {
    await session.ask(`$${110 + axis}=3000`, /^ok/);
    await session.ask(`$${120 + axis}=300`, /^ok/);
  }
  await session.ask("$22=1", /^ok/);
  say("$110=3000 to $22=1", "ok");

  session.command("homing");
  await session.until("homing", () => session.active === "Home");
  await session.until("the end of homing", () => session.active === "Idle");
  say("homing", `Idle at ${Object.values(session.state.status.mpos).slice(0, 3).join(" ")}`);
  await session.ask("G10 L20 P1 X0 Y0 Z0", /^ok/);
  await session.near("zero", [0, 0, 0]);

  await session.ask("$J=G91 G21 X-25 Y-12.5 F2000", /^ok/);
  await session.near("the jog", [-25, -12.5, 0]);
  say("$J=G91 G21 X-25 Y-12.5 F2000", `Idle at ${session.work().join(" ")}`);
  await session.ask("$J=G91 G21 X-150 F300", /^ok/);
  await session.until("Jog", () => session.active === "Jog" && session.work()[0] < -26);
  session.command("jogCancel");
  await session.until("the end of the jog", () => session.active === "Idle");
  const [cancelled] = session.work();
  if (cancelled < -100) throw new Error(`the jog went on to ${cancelled}`);
  say("$J=G91 G21 X-150 F300, jogCancel", "Idle before its end");

  const contact = await session.ask("G38.2 Z-40 F200", /^\[PRB:/);
  if (!/:1\]/.test(contact)) throw new Error(`no contact: ${contact}`);
  say("G38.2 Z-40 F200", contact);
  await session.until("Idle", () => session.active === "Idle");
  await session.ask("G10 L20 P1 X0 Y0 Z0", /^ok/);
  await session.ask("G0 Z5", /^ok/);
  await session.near("the retract", [0, 0, 5]);

  const program = spiral();
  const total = program.trimEnd().split("\n").length;
  await new Promise((resolve, reject) => {
    const done = (error) => (error ? reject(error) : resolve());
    session.command("gcode:load", "spiral.nc", program, {}, done);
    session.until("the program", () => session.sender.total >= total).then(resolve, reject);
  });
  session.command("gcode:start");
  await session.until("a fifth", () => session.sender.received > total / 5);
  session.command("feedhold");
  await session.until("Hold:0", () => /^Hold/.test(session.active));
  say("feedhold", `${session.active} after a fifth of ${total} lines`);
  session.command("cyclestart");
  await session.until("Run", () => session.active === "Run");
  session.command("feedOverride", 10);
  await session.until("110 %", () => Number(session.state.status.ov?.[0]) === 110);
  say("cyclestart, feedOverride 10", `${session.active}, Ov ${session.state.status.ov.join(",")}`);
  session.command("feedOverride", 0);
  await session.finished();
  await session.near("the end", [3, 4, 5]);
  const { received, sent } = session.sender;
  say("gcode:start, to the end", `${sent} sent, ${received} ok, Idle at ${session.work()}`);
  await session.expect(0);

  session.command("gcode:start");
  await session.until("motion", () => session.active === "Run" && session.sender.received > 200);
  // Slow, so that the axes do not rest between two lines on a busy computer.
  for (let turn = 0; turn < 9; turn++) session.command("feedOverride", -10);
  await session.until("10 %", () => Number(session.state.status.ov?.[0]) === 10);
  session.command("reset");
  await session.until("the alarm", () => session.active === "Alarm");
  say("reset in motion", `${session.active}, ${session.lines.findLast((l) => /^ALARM/.test(l))}`);
  session.command("unlock");
  await session.until("Idle", () => session.active === "Idle");
  say("unlock", session.active);
  await session.expect(1);
}

const emulated = await new Emulated("grbl", "--speed", SPEED).started();
const server = new Server(join(emulated.folder, "home"), await freePort());
let status = 0;
try {
  const session = new Session(await server.socket(), emulated.port);
  await run(session);
} catch (error) {
  console.error(error);
  status = 1;
} finally {
  server.process.kill();
  emulated.stop();
}
process.exit(status);
