/**
 * An emulated device, and a cable to it that a test pulls.
 */

import { spawn } from "node:child_process";
import { connect, createServer } from "node:net";
import { createInterface } from "node:readline";
import { husillo } from "husillo/tests/reports.js";

/** The cable. */
export class Cable {
    /** @param {number} device the port of the device */
    constructor(device) {
        this.device = device;
        this.isPulled = false;
        /** Both ends of the connections. @type {Set<import("node:net").Socket>} */
        this.ends = new Set();
        this.server = createServer((client) => this.connected(client));
    }

    /**
     * A cable to an emulated device. Both end with the test.
     *
     * @param {import("node:test").TestContext} t
     * @param {string} machine
     */
    static async to(t, machine) {
        const all = ["emulate", machine, "--listen", "127.0.0.1:0", "--for", "600"];
        const child = spawn(husillo(), all, { stdio: ["pipe", "pipe", "inherit"] });
        t.after(() => child.kill("SIGKILL"));
        const told = await new Promise((resolve) =>
            createInterface(child.stdout).once("line", resolve)
        );
        const cable = new Cable(Number(/tcp:[^ ;]+:(\d+)/.exec(told)?.[1]));
        await new Promise((resolve) => cable.server.listen(0, "127.0.0.1", () => resolve(null)));
        t.after(() => {
            cable.pull();
            cable.server.close();
        });
        return cable;
    }

    /** What `husillo serve --port` opens. */
    get port() {
        const address = this.server.address();
        return `tcp:127.0.0.1:${address && typeof address === "object" ? address.port : 0}`;
    }

    /** @param {import("node:net").Socket} client */
    connected(client) {
        if (this.isPulled) {
            client.destroy();
            return;
        }
        const device = connect(this.device, "127.0.0.1");
        for (const [end, other] of [
            [client, device],
            [device, client],
        ]) {
            this.ends.add(end);
            end.setNoDelay(true);
            end.pipe(other);
            // An end that goes takes the other one with it.
            end.on("error", () => {});
            end.on("close", () => {
                this.ends.delete(end);
                other.destroy();
            });
        }
    }

    pull() {
        this.isPulled = true;
        for (const end of this.ends) end.destroy();
    }

    plug() {
        this.isPulled = false;
    }
}
