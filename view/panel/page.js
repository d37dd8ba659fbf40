/**
 * Puts the parts of the panel together.
 */

import { element } from "husillo/viewer/element.js";
import { Console } from "husillo/panel/console.js";
import { DrillStatus } from "husillo/panel/drill.js";
import { DrillBoard } from "husillo/panel/drill_board.js";
import { DrillHand } from "husillo/panel/drill_hand.js";
import { FactoryStatus } from "husillo/panel/factory.js";
import { FactoryHand } from "husillo/panel/factory_hand.js";
import { Gamepads } from "husillo/panel/gamepad.js";
import { Header } from "husillo/panel/header.js";
import { HeightMap } from "husillo/panel/height_map.js";
import { Jog } from "husillo/panel/jog.js";
import { Joystick } from "husillo/panel/joystick.js";
import { Keys } from "husillo/panel/keys.js";
import { Contact, RawBytes, Scales } from "husillo/panel/measuring.js";
import { Backlash, Confirmation, MillSpeeds } from "husillo/panel/mill.js";
import { MillJog } from "husillo/panel/mill_jog.js";
import { MillPlot } from "husillo/panel/mill_plot.js";
import { Macros } from "husillo/panel/macros.js";
import { Notices } from "husillo/panel/notices.js";
import { Positions } from "husillo/panel/positions.js";
import { Program } from "husillo/panel/program.js";
import { RoutinePanel } from "husillo/panel/routine.js";
import { Settings } from "husillo/panel/settings.js";
import { Outputs, Speeds } from "husillo/panel/speeds.js";
import { Stop } from "husillo/panel/stop.js";
import { tabs } from "husillo/panel/tabs.js";
import { ToolChange } from "husillo/panel/tool_change.js";
import { Units } from "husillo/panel/units.js";
import { Wizard } from "husillo/panel/wizard.js";

/** @typedef {import("husillo/panel/desk.js").Desk} Desk */

/**
 * @param {HTMLElement} place
 * @param {Desk} desk
 * @param {import("husillo/panel/words.js").Words} words
 */
export function fillPage(place, desk, words) {
    const units = new Units();
    const jog = new Jog(desk, words, units);
    const millJog = new MillJog(desk, words);
    const drillHand = new DrillHand(desk, words, units, () => program.run.ask());
    const factoryHand = new FactoryHand(desk, words, () => program.run.ask());
    const joystick = new Joystick(desk, words);
    const jogs = [jog, millJog, drillHand, factoryHand, joystick];
    const shownJog = () => jogs.find((one) => one.isShown) ?? jog;
    const wizard = new Wizard(desk, words);
    const heights = new HeightMap(desk, words, wizard);
    const stop = new Stop(desk, words, () => {
        for (const one of jogs) one.hold.end("stop");
        wizard.stop();
        heights.stop();
    });
    const header = new Header(desk, words, stop.root);
    const notices = new Notices(desk, words);
    const positions = new Positions(desk, words, units);
    const speeds = new Speeds(desk, words, units);
    const outputs = new Outputs(desk, words);
    const lines = new Console(desk, words);
    const program = new Program(desk, words);
    const drillStatus = new DrillStatus(desk, words, units, {
        open: () => program.file.click(),
        edit: () => program.openEditor(),
        start: () => program.run.ask(),
        manual: () => drillHand.switchMode(),
    });
    const more = tabs(words.more, [
        { id: "probing", name: words.probingTab, content: wizard.root },
        { id: "heights", name: words.heightMap, content: heights.root },
        { id: "settings", name: words.settings, content: new Settings(desk, words).root },
        { id: "macros", name: words.macros, content: new Macros(desk, words).root },
    ]);
    const toolChange = new ToolChange(desk, words, wizard, () => {
        more.choose("probing");
        wizard.choose("tool");
        more.root.scrollIntoView({ block: "start" });
        wizard.begin.focus({ preventScroll: true });
    });
    desk.listen(() => {
        program.root.hidden = !desk.offers.has("program");
        more.offer(desk.offers);
        positions.root.hidden = ["microfactory", "measuring"].includes(desk.family);
        speeds.root.hidden = outputs.root.hidden = desk.family !== "grbl";
    });
    const keys = new Keys(desk, words, {
        get jog() {
            return shownJog();
        },
        positions,
        pace: (by) => {
            if (millJog.isShown) millJog.pace(by > 0);
            else speeds.overrides[0].change(by * 10);
        },
        start: () => {
            if (desk.offers.has("program")) program.run.ask();
        },
        pause: () => program.run.pauseOrResume(),
    });
    const pad = new Gamepads(words, shownJog, () => stop.stop());
    keys.root.append(pad.root);
    place.classList.add("panel");
    place.replaceChildren(
        header.root,
        notices.root,
        element(
            "main",
            { id: "machine" },
            element(
                "div",
                { class: "column left" },
                new MillPlot(desk, words).root,
                drillStatus.root,
                new DrillBoard(desk, words, program).root,
                toolChange.root,
                program.root,
                new RoutinePanel(desk, words).root,
                new Confirmation(desk, words).root,
                new RawBytes(desk, words).root,
                lines.root,
                more.root
            ),
            element(
                "div",
                { class: "column right" },
                new FactoryStatus(desk, words, units).root,
                positions.root,
                new Scales(desk, words).root,
                jog.root,
                millJog.root,
                drillHand.root,
                factoryHand.root,
                joystick.root,
                new Contact(desk, words).root,
                speeds.root,
                new MillSpeeds(desk, words, units).root,
                new Backlash(desk, words).root,
                outputs.root,
                keys.root
            )
        ),
        notices.live
    );
}
