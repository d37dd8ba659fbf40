"""The lamps of the panel, as the shift register at outputs 1 to 3 shows them."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path

from husillo_firmware import registers
from husillo_firmware.boards import Board
from husillo_firmware.qemu import Firmware
from husillo_firmware.registers import Switched
from husillo_firmware.waiting import require, until

DATA, CLOCK, LATCH = 2, 4, 8
# Lamps from bit 0.
X, Y, HOME, DRILL, MANUAL, READY, RECEIVE, FULL = (1 << lamp for lamp in range(8))
# What they show one after another while the drill homes.
HOMING = [HOME | DRILL, HOME | Y, HOME | X]
# Changes of the heartbeat that are waited for, one every 500 ms.
BLINKS = 4
# The longest time until the lamps show what is wanted, on a busy computer.
SHOWN_S = 120


def shown(events: Iterable[object]) -> Iterator[int]:
    """The lamps that the register shows, each time it is latched."""
    before = shift = 0
    for one in events:
        if not isinstance(one, Switched):
            continue
        rises = one.outputs & ~before
        if rises & CLOCK:
            shift = (shift << 1 | int(bool(one.outputs & DATA))) & 0xFF
        if rises & LATCH:
            yield shift
        before = one.outputs


def heartbeat(lamps: list[int]) -> int:
    """How often the lamp for a drill that is ready has changed since the homing."""
    if HOMING[0] not in lamps:
        return 0
    blinks = [lamp & READY for lamp in lamps[lamps.index(HOMING[0]) + len(HOMING) :]]
    return sum(one != other for one, other in pairwise(blinks))


def check(board: Board) -> None:
    """Reads the lamps while the drill homes, is ready, and receives a program."""
    with tempfile.TemporaryDirectory() as path:
        log = Path(path) / "log"
        trace = (*registers.ACCESSES, "-D", str(log))
        with Firmware("drill", board, *trace, features="lights", in_wall_time=True) as firmware:
            firmware.connect()

            def lamps_so_far() -> list[int]:
                # The monitor answers when everything before it has been written.
                firmware.monitor("info status")
                return list(shown(registers.read_file(board, log, with_outputs=True)))

            until(
                lambda: heartbeat(lamps_so_far()) >= BLINKS,
                SHOWN_S,
                f"{board}: the heartbeat does not change {BLINKS} times",
            )
            firmware.line.sendall(b"b")
            until(
                lambda: lamps_so_far()[-1] & ~READY == RECEIVE,
                SHOWN_S,
                f"{board}: no lamp for a program that is received",
            )
            lamps = lamps_so_far()
    start = lamps.index(HOMING[0])
    require(lamps[start : start + 3] == HOMING, f"{board}: {lamps}")
    changes = heartbeat(lamps)
    print(f"{board}: {len(lamps)} times the lamps, the heartbeat changed {changes} times")
