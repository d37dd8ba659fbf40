"""The lamps of the panel, as the shift register at outputs 1 to 3 shows them."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterable, Iterator
from itertools import pairwise
from pathlib import Path

from husillo_firmware import registers
from husillo_firmware.boards import Board
from husillo_firmware.qemu import Firmware
from husillo_firmware.registers import Switched
from husillo_firmware.waiting import require

DATA, CLOCK, LATCH = 2, 4, 8
# Lamps from bit 0.
X, Y, HOME, DRILL, MANUAL, READY, RECEIVE, FULL = (1 << lamp for lamp in range(8))
HOMED_S = 8


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


def check(board: Board) -> None:
    """Reads the lamps while the drill homes, is ready, and receives a program."""
    with tempfile.TemporaryDirectory() as path:
        log = Path(path) / "log"
        trace = (*registers.ACCESSES, "-D", str(log))
        with Firmware("drill", board, *trace, features="lights", in_wall_time=True) as firmware:
            firmware.connect()
            time.sleep(HOMED_S)
            firmware.line.sendall(b"b")
            time.sleep(1)
            firmware.monitor("info status")
            happened = registers.read_file(board, log, with_outputs=True)
    lamps = list(shown(happened))
    homing = [HOME | DRILL, HOME | Y, HOME | X]
    start = lamps.index(homing[0])
    require(lamps[start : start + 3] == homing, f"{board}: {lamps}")
    blinks = [lamp & READY for lamp in lamps[start + 3 :]]
    changes = sum(one != other for one, other in pairwise(blinks))
    require(changes >= 4, f"{board}: the heartbeat changes {changes} times: {lamps}")
    require(lamps[-1] & ~READY == RECEIVE, f"{board}: {lamps}")
    print(f"{board}: {len(lamps)} times the lamps, the heartbeat changed {changes} times")
