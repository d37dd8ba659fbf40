"""Full, half and quarter steps, PBL3717A and A3988: all inputs of the drivers are at pins.

The firmware is built once, and started with each setting of its jumpers. Then every step, its wait
and the 18 levels must be those of the host for a machine with the same steps and drivers. The host
sends the strings once more, with the file of that machine.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

from husillo_firmware import host, registers
from husillo_firmware.boards import MPS2, Board
from husillo_firmware.build import FIRMWARE

from products.micromill.link import DONE, Micromill
from products.micromill.program import Wiring, compare, lines_of

MACHINE = FIRMWARE.parent / "machines/micromill.toml"
# A slope, an arc and a reversal of X. Each axis makes more than a cycle of its levels.
STRINGS = [
    "G01X00020.00Y00009.00F1000;",
    "G02X00024.00Y00009.00I00022.00J00009.00F1000;",
    "G01Z00005.00F1000;",
    "G00X00023.00Y00012.00;",
]
# PH, I0 and I1 of both phases.
LINES_PER_MOTOR = 6
FULL_STEPS_PER_CYCLE = 4


# The word of RAM that stands for the jumpers: `SIMULATED_JUMPERS` in the board's file.
JUMPERS = 0x2100_0000
HALF, QUARTER, A3988 = 1, 2, 4


@dataclass
class Steps:
    """A step mode with a driver."""

    jumpers: int
    mode: str
    # Steps per full step.
    parts: int
    driver: str = "pbl3717a"

    def machine(self) -> str:
        """The machine file of a mill with these steps. Its speeds in mm/min are the same."""
        text = MACHINE.read_text()
        for old, new in (
            ('"0.14 um"', f'"{0.14 / self.parts:.3f} um"'),
            ('"170 Hz"', f'"{170 * self.parts} Hz"'),
            ('"390 Hz"', f'"{390 * self.parts} Hz"'),
            ('"400 steps"', f'"{400 * self.parts} steps"'),
            ('mode = "full"', f'mode = "{self.mode}"'),
            ('driver = "pbl3717a"', f'driver = "{self.driver}"'),
        ):
            assert old in text, old
            text = text.replace(old, new)
        return text

    def loader(self) -> tuple[str, str]:
        """Options of QEMU that close these jumpers."""
        return "-device", f"loader,addr={JUMPERS:#x},data={self.jumpers},data-len=4"

    def __str__(self) -> str:
        return f"jumpers {self.jumpers:03b}, {self.mode} steps, {self.driver}"


ALL = (
    Steps(0, "full", 1),
    Steps(HALF, "half", 2),
    Steps(QUARTER, "quarter", 4),
    Steps(QUARTER | HALF, "quarter", 4),
    Steps(A3988, "full", 1, "a3988"),
    Steps(A3988 | HALF, "half", 2, "a3988"),
    Steps(A3988 | QUARTER, "quarter", 4, "a3988"),
)


def check(board: Board) -> None:
    """Compares all modes. Only the board with 18 pins for motors has them."""
    if board != MPS2:
        return
    for steps in ALL:
        with tempfile.TemporaryDirectory() as folder:
            compare_mode(board, steps, Path(folder))
        print(f"{board}: {steps}: 18 levels as in the simulator")


def compare_mode(board: Board, steps: Steps, folder: Path) -> None:
    """Sends the strings to a firmware with these jumpers, and compares."""
    log, machine = folder / "log", folder / "mill.toml"
    machine.write_text(steps.machine())
    trace = (*registers.ARGUMENTS, "-D", str(log))
    with Micromill(board, *trace, *steps.loader(), features="coils") as mill:
        mill.home()
        for string in STRINGS:
            mill.ask(string.encode(), (DONE,))
    wiring = Wiring(LINES_PER_MOTOR, FULL_STEPS_PER_CYCLE * steps.parts, lambda levels: levels)
    lines = lines_of(STRINGS, folder, "-m", machine)
    compare(board, registers.read_file(board, log), lines, wiring)
    part = folder / "part.mm"
    part.write_text("\n".join(STRINGS) + "\n")
    with Micromill(board, *steps.loader(), features="coils", is_connected=False) as mill:
        mill.booted()
        host.send(part, str(machine), mill.tcp)
