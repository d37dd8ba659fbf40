"""With the feature `coils` a step is one change of the levels of a motor, and no step is lost.

Each motor has four wires, which follow the eight states of half steps.
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


def check(board: Board, lines: list[str], expected: Edges) -> None:
    """Runs a program, and compares its steps with those of the emulator."""
    with tempfile.TemporaryDirectory() as path:
        log = Path(path) / "log"
        with Grbl("grbl", board, *registers.ACCESSES, "-D", str(log), features="coils") as grbl:
            grbl.start()
            for line in lines:
                require(grbl.ask(line) == ["ok"], f"{board}: {line}")
            grbl.ask("$SLP")

            def is_off() -> bool:
                # The monitor answers when everything before it has been written.
                grbl.monitor("info status")
                return made(registers.read_file(board, log))[-1].levels == OFF

            until(is_off, ANSWER_S, f"{board}: the current is on in sleep")
        found = steps(registers.read_file(board, log))
    require(found == expected, f"{board}: coils: {found} instead of {expected}")
    print(f"{board}: coils: {sum(found.pulses)} steps as in the emulator")
