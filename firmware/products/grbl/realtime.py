"""Real-time bytes while the firmware moves, in wall-clock time: report, hold, resume, reset."""

from __future__ import annotations

import re
import tempfile
import time
from pathlib import Path

from husillo_firmware import registers
from husillo_firmware.boards import Board
from husillo_firmware.emulated import same
from husillo_firmware.waiting import require

from products.grbl.link import Edges, Grbl

STEPS_PER_MM = 250
MOVING_S = 0.5
PULSE_US = 255


def place(report: str) -> list[float]:
    """The machine position of a report."""
    found = re.search(r"MPos:([-\d.,]+)", report)
    assert found, report
    return [float(number) for number in found[1].split(",")]


def check(board: Board) -> None:
    """Holds and resumes a move, resets during another one, and counts every step."""
    with tempfile.TemporaryDirectory() as path:
        log = Path(path) / "log"
        trace = (*registers.ACCESSES, "-D", str(log))
        with Grbl("grbl", board, *trace, in_wall_time=True) as grbl:
            grbl.start()
            # Long pulses, so that the reset comes in the middle of one on most runs.
            grbl.ask(f"$0={PULSE_US}")
            grbl.ask("$120=100")
            grbl.say("G1 X8 F240\n")
            grbl.reports("Run")
            time.sleep(MOVING_S)
            grbl.say("!")
            held = place(grbl.reports("Hold:0"))
            require(0 < held[0] < 8, f"{board}: held at {held}")
            time.sleep(MOVING_S)
            same(f"{board}: moved in the hold", place(grbl.status())[0], held[0])
            grbl.say("~")
            same(f"{board}: end after a hold", place(grbl.reports("Idle"))[0], 8)
            grbl.say("G1 Y30 F600\n")
            time.sleep(MOVING_S)
            grbl.reports("Run")
            grbl.say("\x18")
            while grbl.next() != "ALARM:3":
                pass
            while not grbl.next().startswith("Grbl"):
                pass
            stopped = grbl.reports("Alarm")
            require("error" in grbl.ask("G0 X0")[-1], f"{board}: moves without $X")
            grbl.ask("$X")
            same(f"{board}: unlocked", place(grbl.reports("Idle"))[1], place(stopped)[1])
            # The monitor answers when everything before it has been logged.
            grbl.monitor("info status")
        net = Edges.of(registers.read_file(board, log)).net
    for axis, (steps, mm) in enumerate(zip(net, place(stopped), strict=True)):
        same(f"{board}: steps of axis {axis} after a reset", steps, round(mm * STEPS_PER_MM))
    print(f"{board}: held at {held[0]} mm, reset at {place(stopped)[1]} mm, no step lost")
