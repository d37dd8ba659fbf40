"""Drills three holes with two tools: every event must equal that of the host's emulated drill.

From homing on, the wait, the motors' phases and the spindle of each event are compared. This is
done with our controller, and on one board also with the original one. `interrupt` ends the host
while the drill moves, and `lights` reads the lamps.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from husillo_firmware import host, product, registers
from husillo_firmware.boards import ALL, MICROBIT, MPS2, Board
from husillo_firmware.build import FIRMWARE
from husillo_firmware.emulated import Emulated, Row, compare, same
from husillo_firmware.qemu import Firmware
from husillo_firmware.registers import Made, Switched

from products.drill import interrupt, lights

FILE = FIRMWARE / "products/drill/small.drl"
SPEED = 1000


def pins(row: Row) -> tuple[int, int]:
    """The first two wires of each motor, and the spindle."""
    levels = (row[name] & 3 for name in ("lx", "ly", "lz"))
    return sum(two << 2 * axis for axis, two in enumerate(levels)), row["spindle"]


def drilled(port: str) -> int:
    """Drills the board. Returns the number of holes."""
    return int(host.send(FILE, "drill", port, "--yes", answer=r"(\d+) holes drilled")[-1])


def drill(board: Board, is_faithful: bool) -> Iterator[tuple[str, int]]:
    """Drills with the firmware and with the emulated drill, and compares. Yields the figures."""
    options, features = (("--faithful",), "faithful") if is_faithful else ((), "")
    with tempfile.TemporaryDirectory() as path:
        folder = Path(path)
        with Emulated("drill", folder, SPEED, *options) as emulated:
            expected = drilled(str(emulated.link))
        rows, log = emulated.rows(), folder / "log"
        trace = (*registers.ACCESSES, "-D", str(log))
        with Firmware("drill", board, *trace, features=features) as firmware:
            firmware.booted()
            count = drilled(firmware.tcp)
            ram = firmware.ram()
        happened = registers.read_file(board, log, with_outputs=True)
    same(f"{board}: holes", count, expected)
    # Only events with a wait. A write without a wait switches the motors on before them.
    events: list[Made | Switched] = [
        one
        for one in happened
        if isinstance(one, Switched) or (isinstance(one, Made) and one.due is not None)
    ]
    same(f"{board}: rows of events", compare(board, events, rows, pins, 0), len(rows))
    yield "holes", count
    yield "steps", rows[-1]["event"]
    yield from firmware.memory(ram).items()


def main(arguments: list[str]) -> int:
    """Checks the firmware on all boards."""
    options = product.parser("drill", __doc__).parse_args(arguments)
    chosen = options.boards or ALL
    figures = product.measure("drill", chosen, lambda board: drill(board, False))
    # In wall time, so on one board unless others are named.
    for board in options.boards or (MICROBIT,):
        interrupt.check(board)
    if MPS2 in chosen:
        lights.check(MPS2)
        of_original = dict(drill(MPS2, True))
        print(MPS2, "as the original:", of_original["steps"], "steps")
    return product.settle("drill", options, figures)
