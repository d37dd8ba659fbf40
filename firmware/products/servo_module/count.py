"""Counts the instructions of a servo interrupt while the host moves the motor back and forth."""

from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path

from husillo_firmware import host
from husillo_firmware.boards import Board
from husillo_firmware.instructions import BEGIN, END, Count
from husillo_firmware.qemu import ANSWER_S, Firmware
from husillo_firmware.waiting import require, until

GOALS = ("goto", "7000", "goto", "-7000") * 3
# The number of logged parts of the motion, the length of the log of each, and the time between
# them.
PARTS = 12
LOG_BYTES = 16_000_000
BETWEEN_S = 0.4


def ticks(board: Board) -> Iterator[tuple[str, int]]:
    """Yields how many interrupts were logged, their median and the longest."""
    found: list[int] = []
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        with Firmware("servo_module", board, "-singlestep", "-D", str(log)) as firmware:
            firmware.booted()
            measures = host.command("measure", "-m", "cmm", "--port", firmware.tcp, *GOALS)
            with subprocess.Popen(measures, stdout=subprocess.DEVNULL) as measuring:
                for _ in range(PARTS):
                    firmware.monitor(BEGIN)
                    until(lambda: log.stat().st_size > LOG_BYTES, ANSWER_S, f"{board}: no log")
                    firmware.monitor(END)
                    # The last interrupt of a part may be cut off.
                    found += Count(firmware, log).step[:-1]
                    os.truncate(log, 0)
                    runs_on(measuring)
                measuring.kill()
    found.sort()
    require(len(found) > 500, f"{board}: {len(found)} interrupts")
    yield "count ticks", len(found)
    yield "count tick_median", found[len(found) // 2]
    yield "count tick_longest", found[-1]


def runs_on(process: subprocess.Popen[bytes]) -> None:
    """Lets the process run until the next part, or until it ends."""
    try:
        process.wait(BETWEEN_S)
    except subprocess.TimeoutExpired:
        return
