/**
 * The link to the server: one WebSocket that is opened again whenever it closes, and requests of
 * files and programs.
 */

/** After this time without a frame the link is lost, milliseconds. One comes each second. */
const SILENCE = 4000;
/** Waits before a connection is tried again, milliseconds. */
const WAITS = [500, 1000, 2000];

/**
 * @typedef {"opening" | "up" | "lost" | "refused"} Status `refused`: the token is wrong or missing
 *
 * @typedef {object} Frame a frame of the server
 * @property {string} kind
 * @property {number} [machine]
 *
 * @typedef {object} Listener
 * @property {(frame: any) => void} frame
 * @property {(status: Status) => void} status
 */

/** The link. */
export class Link {
    /**
     * @param {string} origin such as `http://127.0.0.1:8017`
     * @param {string} token
     * @param {Listener} listener
     */
    constructor(origin, token, listener) {
        this.origin = origin;
        this.token = token;
        this.listener = listener;
        /** @type {Status} */
        this.status = "opening";
        /** The number of this page; 0 before the server has given one. */
        this.client = 0;
        this.failures = 0;
        this.next = 1;
        /** @type {Map<number, {done: (data: any) => void, failed: (error: Error) => void}>} */
        this.pending = new Map();
        /** @type {WebSocket | undefined} */
        this.socket = undefined;
        this.timer = 0;
        /** When the last frame came, or the socket was opened. */
        this.heardAt = 0;
        setInterval(() => this.watch(), 1000);
        window.addEventListener("online", () => this.retry());
        document.addEventListener("visibilitychange", () => {
            if (!document.hidden) this.retry();
        });
    }

    /** Opens the socket. */
    open() {
        clearTimeout(this.timer);
        const address = `${this.origin.replace(/^http/, "ws")}/socket?token=${this.token}`;
        const socket = new WebSocket(address);
        this.socket = socket;
        this.heardAt = Date.now();
        socket.addEventListener("message", ({ data }) => {
            if (this.socket === socket) this.heard(String(data));
        });
        socket.addEventListener("close", () => {
            if (this.socket === socket) this.closed();
        });
    }

    /** Closes a socket that hangs. The browser would notice much later, or never. */
    watch() {
        const { socket } = this;
        if (!socket || Date.now() - this.heardAt < SILENCE) return;
        this.closed();
        socket.close();
    }

    /** Tries again at once, if the link is lost. */
    retry() {
        if (this.status === "lost" && this.socket === undefined) this.open();
    }

    closed() {
        this.socket = undefined;
        this.client = 0;
        for (const { failed } of this.pending.values()) failed(new Error("the link is lost"));
        this.pending.clear();
        this.become("lost");
        const wait = WAITS[Math.min(this.failures++, WAITS.length - 1)];
        this.timer = window.setTimeout(() => this.open(), wait);
        this.ask().catch(() => {});
    }

    /** Finds out whether the token is the reason. */
    async ask() {
        const { status } = await this.fetch("/machines");
        if (status !== 403 || this.status !== "lost") return;
        clearTimeout(this.timer);
        this.socket?.close();
        this.socket = undefined;
        this.become("refused");
    }

    /** @param {Status} status */
    become(status) {
        if (this.status === status) return;
        this.status = status;
        this.listener.status(status);
    }

    /** @param {string} text */
    heard(text) {
        this.heardAt = Date.now();
        const frame = JSON.parse(text);
        if (frame.kind === "answer") {
            const waiting = this.pending.get(frame.id);
            this.pending.delete(frame.id);
            if (frame.ok) waiting?.done(frame.data);
            else if (waiting) waiting.failed(new Error(frame.error));
            else this.listener.frame({ kind: "refusal", text: frame.error });
            return;
        }
        if (frame.kind === "welcome") {
            this.client = frame.client;
            this.failures = 0;
            // The listener knows the machines before it is told that the link is up.
            this.listener.frame(frame);
            this.become("up");
            return;
        }
        this.listener.frame(frame);
    }

    /**
     * Sends a request without waiting for its answer. Returns false if there is no link.
     *
     * @param {string} verb
     * @param {object} fields
     */
    tell(verb, fields) {
        if (this.socket?.readyState !== WebSocket.OPEN) return false;
        this.socket.send(JSON.stringify({ do: verb, ...fields }));
        return true;
    }

    /**
     * Sends a request, and gives the data of its answer.
     *
     * @param {string} verb
     * @param {object} fields
     * @returns {Promise<any>}
     */
    request(verb, fields) {
        const id = this.next++;
        return new Promise((done, failed) => {
            this.pending.set(id, { done, failed });
            if (this.tell(verb, { ...fields, id })) return;
            this.pending.delete(id);
            failed(new Error("the link is lost"));
        });
    }

    /**
     * Requests a file of a machine.
     *
     * @param {string} path
     * @param {RequestInit} [options]
     */
    fetch(path, options = {}) {
        const headers = {
            Authorization: `Bearer ${this.token}`,
            "X-Husillo-Client": String(this.client),
        };
        return fetch(this.origin + path, { cache: "no-store", ...options, headers });
    }
}
