// `husillo emulate` in the background. The program is that of the variable HUSILLO.

import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";

/** An emulated mill behind a pseudo-terminal. */
export class Emulated {
  /** @param {string} machine @param {string[]} options */
  constructor(machine, ...options) {
    this.folder = mkdtempSync(join(tmpdir(), "husillo-cncjs-"));
    this.port = join(this.folder, "line");
    const program = process.env.HUSILLO;
    if (!program) throw new Error("the variable HUSILLO has no program");
    this.process = spawn(program, ["emulate", machine, "--link", this.port, ...options], {
      stdio: ["pipe", "pipe", "inherit"],
    });
    this.lines = createInterface({ input: this.process.stdout });
  }

  /** Resolves when the port is there. */
  async started() {
    await new Promise((resolve, reject) => {
      this.lines.once("line", resolve);
      this.process.once("exit", () => reject(new Error("the emulation has not started")));
    });
    return this;
  }

  stop() {
    this.process.kill();
    rmSync(this.folder, { recursive: true, force: true });
  }
}
