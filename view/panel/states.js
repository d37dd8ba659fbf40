/**
 * States in words, and what is safe to do in them.
 */

import { toolText } from "husillo/panel/tool_change.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */
/** @typedef {import("husillo/panel/desk.js").State} State */
/** @typedef {import("husillo/panel/words.js").Words} Words */
/** @typedef {"good" | "busy" | "wait" | "bad"} Kind */

/**
 * The state of the shown machine.
 *
 * @param {Desk} desk
 * @param {Words} words
 * @returns {{text: string, kind: Kind}}
 */
export function stateText({ link, state }, words) {
    if (link.status === "opening") return { text: words.connecting, kind: "wait" };
    if (link.status !== "up") return { text: words.linkLost, kind: "bad" };
    if (state === undefined || state.link === "opening") {
        return { text: words.connecting, kind: "wait" };
    }
    if (state.link === "lost" || state.state === null) {
        return { text: words.controllerLost, kind: "bad" };
    }
    if (state.stopping) return { text: words.stateStopping, kind: "bad" };
    switch (state.state) {
        case "Idle":
            if (state.program?.change) return { text: words.stateTool, kind: "wait" };
            return state.program?.phase === "waiting"
                ? { text: words.stateWaiting, kind: "wait" }
                : { text: words.stateIdle, kind: "good" };
        case "Run":
            return { text: words.stateRun, kind: "busy" };
        case "Jog":
            return { text: words.stateJog, kind: "busy" };
        case "Home":
            return { text: words.stateHome, kind: "busy" };
        case "Probe":
            return { text: words.stateProbe, kind: "busy" };
        case "Hold":
            return {
                text: state.detail === 1 ? words.stateBraking : words.stateHold,
                kind: "wait",
            };
        case "Door":
            return { text: words.stateDoor, kind: "wait" };
        case "Check":
            return { text: words.stateCheck, kind: "wait" };
        case "Tool":
            return { text: words.stateTool, kind: "wait" };
        case "Sleep":
            return { text: words.stateSleep, kind: "wait" };
        case "Alarm":
            return { text: alarmText(state, words), kind: "bad" };
        default:
            return { text: state.state, kind: "wait" };
    }
}

/**
 * @param {State} state
 * @param {Words} words
 */
function alarmText({ alarm, factory }, words) {
    if (factory?.is_latched) return words.factory.latched;
    return alarm && alarm.number > 0
        ? `${words.stateAlarm} ${alarm.number}`
        : words.stateLocked;
}

/**
 * What happened and what is safe to do, as notices.
 *
 * @typedef {object} Notice
 * @property {string} id
 * @property {Kind} kind
 * @property {string} text
 * @property {string} [advice]
 *
 * @param {Desk} desk
 * @param {Words} words
 * @returns {Notice[]}
 */
export function noticesOf(desk, words) {
    const { link, machine, state } = desk;
    if (link.status === "refused") {
        return [{ id: "token", kind: "bad", text: words.tokenWrong, advice: words.tokenAdvice }];
    }
    if (link.status === "lost") {
        return [{ id: "link", kind: "bad", text: words.linkLostLong, advice: words.linkAdvice }];
    }
    if (link.status === "up" && !machine) {
        return [{ id: "none", kind: "wait", text: words.noMachine }];
    }
    /** @type {Notice[]} */
    const notices = [];
    if (state?.emergency_waits) {
        const { waits: text, waitsAdvice: advice } = words.factory;
        notices.push({ id: "waits", kind: "bad", text, advice });
    }
    if (state?.link === "lost") {
        notices.push({
            id: "controller",
            kind: "bad",
            text: `${words.controllerLostLong} ${state.why ?? ""}`.trim(),
            advice: words.controllerAdvice,
        });
    } else if (state) notices.push(...ofState(state, words));
    if (desk.refusal) {
        notices.push({ id: "refusal", kind: "wait", text: `${words.refused}: ${desk.refusal}` });
    }
    return notices;
}

/**
 * @param {State} state
 * @param {Words} words
 * @returns {Notice[]}
 */
function ofState(state, words) {
    const { alarm, why } = state;
    if (state.factory?.is_latched) {
        const { latchedLong: text, latchedAdvice: advice } = words.factory;
        return [{ id: "emergency", kind: "bad", text, advice }];
    }
    const because = why ? ` (${why})` : "";
    switch (state.state) {
        case "Alarm": {
            const text = alarm ? (words.alarms[alarm.number] ?? alarm.text) : words.alarms[0];
            const number = alarm?.number ?? 0;
            const advice = words.alarmAdvice[number] ?? state.advice ?? words.alarmAdvice[0];
            return [{ id: "alarm", kind: "bad", text, advice }];
        }
        case "Hold":
            return [{ id: "hold", kind: "wait", text: words.holdLong + because }];
        case "Door":
            return [{ id: "door", kind: "wait", text: words.doorLong, advice: words.doorAdvice }];
        case "Sleep":
            return [{ id: "sleep", kind: "wait", text: words.sleepLong }];
        case "Check":
            return [{ id: "check", kind: "wait", text: words.checkLong }];
        default:
            return [
                ...ofChange(state, words),
                ...ofUnhomed(state, words),
                ...ofMeasuring(state, words),
                ...(why ? [ofWhy(why)] : []),
            ];
    }
}

/**
 * @param {State} state
 * @param {Words} words
 * @returns {Notice[]}
 */
function ofChange({ program, state }, words) {
    if (program?.change) {
        const text = `${words.change}: ${toolText(program.change, words)}`;
        return [{ id: "tool", kind: "wait", text, advice: words.changeAdvice }];
    }
    // One of a line by hand, or of another sender.
    return state === "Tool" ? [{ id: "tool", kind: "wait", text: words.changeLong }] : [];
}

/** @param {string} why @returns {Notice} */
function ofWhy(why) {
    return { id: "why", kind: "wait", text: why };
}

/**
 * @param {State} state
 * @param {Words} words
 * @returns {Notice[]}
 */
function ofUnhomed({ mill, drill, factory, state }, words) {
    if (state !== "Idle") return [];
    if (mill && !mill.is_homed) {
        const { millUnhomed: text, millUnhomedAdvice: advice } = words;
        return [{ id: "unhomed", kind: "wait", text, advice }];
    }
    if (drill && !drill.is_homed) {
        const { unhomed: text, unhomedAdvice: advice } = words.drill;
        return [{ id: "unhomed", kind: "wait", text, advice }];
    }
    if (factory && !factory.is_homed) {
        const { unhomed: text, unhomedAdvice: advice } = words.factory;
        return [{ id: "unhomed", kind: "wait", text, advice }];
    }
    return [];
}

/**
 * @param {State} state
 * @param {Words} words
 * @returns {Notice[]}
 */
function ofMeasuring({ measuring, state }, words) {
    const isHomed = measuring?.axes.every(({ machine }) => machine !== null) ?? true;
    if (isHomed || state !== "Idle") return [];
    const { unhomed: text, unhomedAdvice: advice } = words;
    return [{ id: "unhomed", kind: "wait", text, advice }];
}
