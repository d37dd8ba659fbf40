"""The host cuts a figure: every event must equal that of the host's emulated machine.

From homing on, the wait, the motors' pins, their current and RESET of each event are compared, and
the position in each status. Then an emergency stop during homing is checked.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

from husillo_firmware import host, product, registers
from husillo_firmware.boards import Board
from husillo_firmware.build import FIRMWARE
from husillo_firmware.emulated import Emulated, compare, same
from husillo_firmware.qemu import Firmware
from husillo_firmware.registers import Happened
from husillo_firmware.waiting import fail

from products.microfactory import pins, status, stop

FIGURE = FIRMWARE.parent / "examples/microfactory/square.nc"
SPEED = 200


def cut(board: Board) -> Iterator[tuple[str, int]]:
    """Cuts with the firmware and with the emulated machine, and compares. Yields the figures."""
    with tempfile.TemporaryDirectory() as path:
        folder = Path(path)
        with Emulated("microfactory", folder, SPEED) as emulated:
            host.send(FIGURE, "microfactory", str(emulated.link), answer="done")
        rows, log = emulated.rows(), folder / "log"
        trace = (*registers.ACCESSES, "-D", str(log))
        with Firmware("microfactory", board, *trace) as firmware:
            firmware.booted()
            host.send(FIGURE, "microfactory", firmware.tcp, answer="done")
            ram = firmware.ram()
        happened = registers.read_file(board, log, with_outputs=True)
    events = pins.events(board, happened)
    made = compare(board, events, rows, pins.Pins(), pins.NOT_RESET, pins.ENABLE)
    same(f"{board}: rows of events", made, len(rows))
    positions = list(status.positions(rows))
    check_reports(board, happened, positions)
    stop.check(board)
    yield "steps", len(positions) - 1
    yield from firmware.memory(ram).items()


def check_reports(board: Board, happened: list[Happened], positions: list[tuple[int, ...]]) -> None:
    """Checks that every reported position is that of the pins."""
    reported = list(status.statuses(happened))
    for steps, _, flags, position in reported:
        # The position includes the step that is still waiting for its time. That step may be made
        # before the first byte of the report is sent.
        if flags & status.HOMED and position not in positions[max(steps - 1, 0) : steps + 2]:
            fail(f"{board}: reports {position} after {steps} steps, and is at {positions[steps]}")
    last = len(positions) - 1
    if reported[-1] != (last, ord("d"), status.HOMED, positions[last]):
        fail(f"{board}: reports {reported[-1]} at the end, and is at {positions[last]}")


def main(arguments: list[str]) -> int:
    """Checks the firmware on all boards."""
    return product.check("microfactory", __doc__, arguments, cut)
