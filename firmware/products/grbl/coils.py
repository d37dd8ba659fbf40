"""With the feature `coils` a step is one change of the levels of a motor, and no step is lost.

Each motor has four wires, which follow the eight states of half steps. The current is off while the
motors are, and stays on if a setting changes. The protocol is that of grblHAL, because Grbl obeys
no line in the time in which the motors are on after power-on.
"""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Iterable
from pathlib import Path

from husillo_firmware import registers
from husillo_firmware.boards import Board
from husillo_firmware.registers import Happened, made
from husillo_firmware.waiting import require, until

from products.grbl.link import ANSWER_S, Edges, Grbl

WIRES = 4
OFF = 0
FEATURES = "coils,grblhal"
# One wire and two wires in turn.
STATES = (0b0001, 0b1001, 0b1000, 0b1100, 0b0100, 0b0110, 0b0010, 0b0011)


def wires(levels: int, axis: int) -> int:
    """The levels of the wires of a motor."""
    return levels >> WIRES * axis & (1 << WIRES) - 1


def steps(happened: Iterable[Happened]) -> Edges:
    """Counts the steps of each motor. A change by more than one state is an error."""
    found = Edges([0] * 3, [0] * 3)
    levels = [one.levels for one in made(happened)]
    for axis in range(3):
        seen = [state for one in levels if (state := wires(one, axis)) != OFF]
        for before, after in itertools.pairwise(map(STATES.index, seen)):
            step = (after - before + 4) % 8 - 4
            require(abs(step) <= 1, f"motor {axis} skips from state {before} to {after}")
            found.pulses[axis] += abs(step)
            found.net[axis] += step
    return found


def last(grbl: Grbl, log: Path) -> int:
    """The present levels of all wires."""
    # The monitor answers when everything before it has been written.
    grbl.monitor("info status")
    return made(registers.read_file(grbl.board, log))[-1].levels


def hold(board: Board) -> None:
    """Motors that never rest keep their current from power-on, also when a setting changes."""
    with tempfile.TemporaryDirectory() as path:
        log = Path(path) / "log"
        # QEMU waits with the first lines, so that the motors move before they would rest.
        trace = *registers.ACCESSES, "-D", str(log), "-S"
        with Grbl("grbl", board, *trace, features=FEATURES) as grbl:
            grbl.connect()
            grbl.say("$1=255\nG91 G1 X1 F600\nG4 P0.1\n")
            grbl.monitor("cont")
            for _ in range(3):
                answer = list(grbl.answered())
                require(answer[-1] == "ok", f"{board}: {answer}")
            for line in ("$10=1", "G4 P0.1"):
                require(grbl.ask(line) == ["ok"], f"{board}: {line}")
            held = last(grbl, log)
    are_held = all(wires(held, axis) != OFF for axis in range(3))
    require(are_held, f"{board}: no current after a setting: {held:b}")


def check(board: Board, lines: list[str], expected: Edges) -> None:
    """Runs a program, and compares its steps with those of the emulator."""
    with tempfile.TemporaryDirectory() as path:
        log = Path(path) / "log"
        with Grbl("grbl", board, *registers.ACCESSES, "-D", str(log), features=FEATURES) as grbl:
            grbl.start()
            for line in lines:
                require(grbl.ask(line) == ["ok"], f"{board}: {line}")
            grbl.ask("$SLP")
            until(lambda: last(grbl, log) == OFF, ANSWER_S, f"{board}: the current is on in sleep")
        found = steps(registers.read_file(board, log))
    require(found == expected, f"{board}: coils: {found} instead of {expected}")
    hold(board)
    print(f"{board}: coils: {sum(found.pulses)} steps as in the emulator")
