/**
 * A server that speaks the protocol of `husillo serve`, with machines that a test drives: it keeps
 * what the pages have asked for, and says what the test lets it say.
 */

import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { extname, join, normalize } from "node:path";
import { WebSocketServer } from "ws";
import { ROOT } from "husillo/tests/browser.js";

const TYPES = /** @type {Record<string, string>} */ ({
    ".js": "text/javascript",
    ".css": "text/css",
    ".html": "text/html",
    ".svg": "image/svg+xml",
});

/** A request that takes longer than this does not come, milliseconds. */
const PATIENCE = Number(process.env.PATIENCE ?? 60_000);

/** The token of every fake server. */
export const TOKEN = "0123456789abcdef0123456789abcdef";

/** The policy of `husillo serve`: the page must work under it. */
const POLICY =
    "default-src 'self'; connect-src 'self'; style-src 'self' 'unsafe-inline'; " +
    "script-src 'self' 'unsafe-inline' blob:; img-src 'self' data: blob:";

/** A state in which everything is well. */
export const IDLE = {
    link: "up",
    why: null,
    controller: "Grbl 1.1h ['$' for help]",
    state: "Idle",
    detail: null,
    alarm: null,
    advice: null,
    axes: ["X", "Y", "Z"],
    machine_mm: [10, 20, -5],
    work_mm: [1.5, 2.25, -0.001],
    zero_mm: [8.5, 17.75, -4.999],
    feed: 0,
    rpm: 0,
    override: { feed: 100, rapid: 100, spindle: 100 },
    accessories: { spindle: "off", flood: false, mist: false },
    switches: [],
    modal: ["G0", "G54", "G17", "G21", "G90", "G94", "M5", "M9"],
    offset: "G54",
    tool: 0,
    programmed: { feed: 0, rpm: 0 },
    operator: null,
    clients: 1,
    jog: null,
    stopping: false,
    undo: 0,
    probe: null,
    program: null,
};

/**
 * @typedef {Record<string, any>} Request
 * @typedef {(request: Request, client: number) => any} Answer the data; an Error is a refusal
 */

export class FakeServer {
    /** @param {string[]} names of the machines */
    constructor(names) {
        /** What the pages asked for, in order. @type {Request[]} */
        this.requests = [];
        /** Parts of the page that work. */
        this.offers = ["program", "from", "report", "probing", "heights", "settings", "macros"];
        /** What a verb does besides being kept. @type {Record<string, Answer>} */
        this.verbs = {};
        /** Requests of files: their answers. @type {Record<string, (body: string) => any>} */
        this.files = {};
        this.infos = names.map((name, index) => ({
            machine: index + 1,
            name,
            port: "sim",
            is_simulated: true,
            axes: ["X", "Y", "Z"],
            family: "grbl",
        }));
        /** @type {Record<string, any>[]} */
        this.states = names.map(() => ({ ...IDLE }));
        this.number = 0;
        this.clients = 0;
        /** @type {Map<number, import("ws").WebSocket>} */
        this.sockets = new Map();
        /** @type {((request: Request) => void)[]} */
        this.waiting = [];
    }

    /** The address of the page, with its token. */
    get address() {
        return `http://127.0.0.1:${this.port}/#${TOKEN}`;
    }

    /** @param {number} [port] any without it */
    async start(port = 0) {
        const server = createServer((request, response) => {
            this.answer(request).then(
                ([status, type, body]) =>
                    response
                        .writeHead(status, {
                            "content-type": type,
                            "content-security-policy": POLICY,
                        })
                        .end(body),
                () => response.writeHead(404).end()
            );
        });
        this.server = server;
        const sockets = new WebSocketServer({ noServer: true });
        server.on("upgrade", (request, socket, head) => {
            if (!request.url?.endsWith(`token=${TOKEN}`)) {
                socket.end("HTTP/1.1 403 Forbidden\r\n\r\n");
                return;
            }
            sockets.handleUpgrade(request, socket, head, (one) => this.welcome(one));
        });
        await new Promise((resolve) => server.listen(port, "127.0.0.1", () => resolve(null)));
        const address = server.address();
        if (address && typeof address === "object") this.port = address.port;
    }

    stop() {
        for (const socket of this.sockets.values()) socket.terminate();
        this.server?.closeAllConnections();
        return new Promise((resolve) => this.server?.close(() => resolve(null)));
    }

    /**
     * @param {import("node:http").IncomingMessage} request
     * @returns {Promise<[number, string, string | Buffer]>}
     */
    async answer(request) {
        const url = new URL(request.url ?? "/", "http://x");
        const path = url.pathname;
        if (path.startsWith("/machines")) {
            const asked = `Bearer ${url.searchParams.get("token")}`;
            const token = request.headers.authorization ?? asked;
            if (token !== `Bearer ${TOKEN}`) return [403, "text/plain", "wrong token"];
            if (path === "/machines") {
                return [200, "application/json", JSON.stringify(this.infos)];
            }
            let body = "";
            for await (const part of request) body += part;
            const file = this.files[`${request.method} ${path}`];
            if (!file) return [404, "text/plain", "none"];
            const made = file(body);
            return typeof made === "string"
                ? [200, "text/plain", made]
                : [200, "application/json", JSON.stringify(made)];
        }
        const file = normalize(join(ROOT, path === "/" ? "panel/index.html" : path));
        const own = path === "/favicon.svg" ? join(ROOT, "panel/favicon.svg") : file;
        if (!own.startsWith(ROOT)) throw new Error(path);
        return [200, TYPES[extname(own)] ?? "text/plain", await readFile(own)];
    }

    /** @param {import("ws").WebSocket} socket */
    welcome(socket) {
        const client = ++this.clients;
        this.sockets.set(client, socket);
        socket.on("close", () => this.sockets.delete(client));
        socket.on("message", (data) => this.heard(client, JSON.parse(String(data))));
        const welcome = { kind: "welcome", protocol: 1, version: "0", client };
        const timing = { lease_ms: 250, renew_ms: 80 };
        const { offers } = this;
        const machines = this.infos.map((info) => ({ ...info, offers }));
        socket.send(JSON.stringify({ ...welcome, ...timing, machines }));
        const alive = setInterval(() => socket.send(JSON.stringify({ kind: "alive" })), 1000);
        socket.on("close", () => clearInterval(alive));
        for (const { machine } of this.infos) this.change({}, machine);
    }

    /**
     * @param {number} client
     * @param {Request} request
     */
    heard(client, request) {
        this.requests.push(request);
        const index = (request.machine ?? 1) - 1;
        if (request.do === "take") {
            const { operator } = this.states[index];
            const isTaken = this.sockets.has(operator) && operator !== client;
            if (isTaken && !request.force) {
                this.reply(client, request, new Error("another client is in control"));
            } else {
                this.change({ operator: client }, index + 1);
                this.reply(client, request, null);
            }
        } else {
            if (request.do === "give") this.change({ operator: null }, index + 1);
            this.reply(client, request, this.verbs[request.do]?.(request, client) ?? null);
        }
        for (const waiting of this.waiting) waiting(request);
    }

    /**
     * @param {number} client
     * @param {Request} request
     * @param {any} data
     */
    reply(client, request, data) {
        const { id = null } = request;
        const isRefused = data instanceof Error;
        if (id === null && !isRefused) return;
        const answer = isRefused ? { ok: false, error: data.message } : { ok: true, data };
        this.sockets.get(client)?.send(JSON.stringify({ kind: "answer", id, ...answer }));
    }

    /**
     * Changes the state of a machine, and tells all pages.
     *
     * @param {Record<string, any>} changes
     * @param {number} [machine]
     */
    change(changes, machine = 1) {
        Object.assign(this.states[machine - 1], changes);
        const state = { ...this.states[machine - 1], clients: this.sockets.size };
        this.send({ kind: "state", machine, number: ++this.number, ...state });
    }

    /**
     * Lines of the console.
     *
     * @param {"host" | "controller" | "server"} from
     * @param {...string} texts
     */
    print(from, ...texts) {
        const lines = texts.map((text) => ({ number: ++this.number, at_ms: 1, from, text }));
        this.send({ kind: "console", machine: 1, missed: 0, lines });
    }

    /** @param {object} frame */
    send(frame) {
        for (const socket of this.sockets.values()) socket.send(JSON.stringify(frame));
    }

    /**
     * Waits for a request of a verb that has not been waited for, and removes it.
     *
     * @param {string} verb
     * @returns {Promise<Request>}
     */
    next(verb) {
        const at = this.requests.findIndex((request) => request.do === verb);
        if (at >= 0) return Promise.resolve(this.requests.splice(at, 1)[0]);
        return new Promise((resolve, reject) => {
            const stuck = setTimeout(() => reject(new Error(`no request ${verb}`)), PATIENCE);
            /** @param {Request} request */
            const waiting = (request) => {
                if (request.do !== verb) return;
                clearTimeout(stuck);
                this.waiting.splice(this.waiting.indexOf(waiting), 1);
                this.requests.splice(this.requests.indexOf(request), 1);
                resolve(request);
            };
            this.waiting.push(waiting);
        });
    }

    /** How often a verb was asked for. @param {string} verb */
    count(verb) {
        return this.requests.filter((request) => request.do === verb).length;
    }
}
