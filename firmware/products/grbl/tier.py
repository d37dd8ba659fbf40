"""The firmware with the protocol of grblHAL and the height map, on a board with enough memory."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator
from pathlib import Path

from husillo_firmware import registers
from husillo_firmware.boards import Board
from husillo_firmware.emulated import same
from husillo_firmware.waiting import require

from products.grbl import dialogue
from products.grbl.link import Edges, Grbl

FEATURES = "grblhal,height-map"
STEPS_PER_MM = 250
HEIGHT_MM = 0.2


def check(board: Board) -> Iterator[tuple[str, int]]:
    """Plays dialogues of grblHAL, changes a tool, measures a map and follows one. Yields the
    figures."""
    for name, lines in dialogue.HAL.items():
        with Grbl("grbl", board, features=FEATURES) as grbl:
            grbl.start()
            dialogue.play(grbl, name, lines)
    with tempfile.TemporaryDirectory() as path:
        log = Path(path) / "log"
        trace = (*registers.ACCESSES, "-D", str(log))
        with Grbl("grbl", board, *trace, features=FEATURES) as grbl:
            grbl.start()
            change_tool(grbl)
            reset(grbl)
            follow(grbl)
            grbl.monitor("info status")
            ram = grbl.ram()
            figures = grbl.memory(ram)
        net = Edges.of(registers.read_file(board, log)).net
    same(f"{board}: steps of Z on the map", net[2], round(HEIGHT_MM * STEPS_PER_MM))
    measure(board)
    for name, value in figures.items():
        yield f"grblhal {name}", value


def change_tool(grbl: Grbl) -> None:
    """M6 waits for the start button or `~`. A full report has all fields."""
    require(grbl.ask("T1 M6") == ["ok"], f"{grbl.board}: M6")
    grbl.reports("Tool")
    grbl.say("~")
    grbl.reports("Idle")
    grbl.say("\x87")
    # Reports that were requested before come first.
    while "FW:" not in (report := grbl.next()):
        pass
    for field in ("MPos:0.000,0.000,0.000", "WCO:", "Ov:100,100,100", "T:1", "FW:grblHAL"):
        require(field in report, f"{grbl.board}: no {field} in {report}")


def reset(grbl: Grbl) -> None:
    """A reset in motion brakes first, so the position stays valid and there is no alarm."""
    grbl.say("G1 X1 F1\n")
    grbl.reports("Run")
    grbl.say("\x18")
    said = grbl.next()
    while not said.startswith("GrblHAL"):
        require(not said.startswith("ALARM"), f"{grbl.board}: {said} after a reset")
        said = grbl.next()
    grbl.reports("Idle")


def follow(grbl: Grbl) -> None:
    """The corner of a map is higher than its first point, and the tool goes there."""
    for line in (
        *("$110=3000", "$111=3000", "$112=2000", "$120=500", "$121=500", "$122=500"),
        *("G0 X0", "G4 P0", "$ZG=0,0,4,4,2,2", f"$Z3={HEIGHT_MM}", "$Z=1"),
        *("G1 X4 Y4 F600", "G4 P0.01"),
    ):
        require(grbl.ask(line) == ["ok"], f"{grbl.board}: {line}")
    place = grbl.reports("Idle")
    require("MPos:4.000,4.000,0.000" in place, f"{grbl.board}: {place} at the corner")


def measure(board: Board) -> None:
    """The probe finds the level plate of the simulated machine at each point of a grid."""
    with Grbl("grbl", board, features=FEATURES) as grbl:
        grbl.start()
        for line in ("$110=3000", "$111=3000", "$112=2000", "$ZG=0,0,2,2,2,2"):
            require(grbl.ask(line) == ["ok"], f"{board}: {line}")
        said = grbl.ask("$ZP=12,600")
        contacts = [line for line in said if re.match(r"\[PRB:.*,-10\.\d+:1\]$", line)]
        require(len(contacts) == 4 and said[-1] == "ok", f"{board}: {said}")
        rows = [line for line in grbl.ask("$Z") if line.startswith("[HEIGHTS:")]
        level = [f"[HEIGHTS:{row},0.000,0.000]" for row in range(2)]
        require(rows == level, f"{board}: {rows} on a level plate")
