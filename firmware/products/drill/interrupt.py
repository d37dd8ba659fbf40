"""A host that is killed while the firmware moves: the drill stops by its lease, in wall time."""

from __future__ import annotations

import os
import subprocess
import tempfile
from itertools import pairwise
from pathlib import Path

from husillo_firmware import host, registers
from husillo_firmware.boards import Board
from husillo_firmware.qemu import ANSWER_S, Firmware
from husillo_firmware.waiting import require, settled, until

# The most steps of the table after the last byte of the host: those of the lease of 250 ms at 247
# per second, and those that were given before.
MOST = 70
# The longest homing at power-on, on a busy computer.
HOMED_S = 120
# A motion makes a step in this time.
QUIET_S = 0.5
# A hole at X 10, from where the jog before has ended.
PROGRAM = "%\nG21\nG90\nX10 Y0\n%\n"


class Interrupted:
    """A drill whose host is killed, and its log."""

    def __init__(self, firmware: Firmware, log: Path) -> None:
        self.firmware, self.log, self.board = firmware, log, firmware.board

    def steps(self) -> int:
        """Steps since the log was emptied."""
        # The monitor answers when everything before it has been written.
        self.firmware.monitor("info status")
        events = registers.made(registers.read_file(self.board, self.log))
        return sum(one.levels != other.levels for one, other in pairwise(events))

    def ended(self) -> int:
        """Steps since the log was emptied, when no more are made."""
        what = f"{self.board}: it moves on without a host"
        return settled(self.steps, QUIET_S, ANSWER_S, what)

    def is_homed(self) -> None:
        """Waits until the homing at power-on has ended: the drill then sends its letter."""

        def has_said() -> bool:
            self.firmware.monitor("info status")
            return b"B" in registers.said(registers.read_file(self.board, self.log))

        until(has_said, HOMED_S, f"{self.board}: it does not home")

    def kill(self, words: list[str | Path], begun: int) -> int:
        """Starts a host and kills it after some steps.

        Returns how many were made after its last byte.
        """
        os.truncate(self.log, 0)
        place = f"{self.board}: {' '.join(map(str, words))}"
        command = host.command(*words, "-m", "drill", "--port", self.firmware.tcp)
        with subprocess.Popen(command, stdout=subprocess.DEVNULL) as moving:
            try:
                until(lambda: self.steps() >= begun, ANSWER_S, f"{place}: it does not move")
            finally:
                moving.kill()
        self.ended()
        events = registers.made(registers.since_heard(self.board, self.log))
        return sum(one.levels != other.levels for one, other in pairwise(events))

    def says(self, *wanted: str) -> None:
        """Asks the drill where it is."""
        place = host.says("jog", "where", "-m", "drill", "--port", self.firmware.tcp)
        for words in wanted:
            require(words in place, f"{self.board}: {place}")


def check(board: Board) -> None:
    """Kills the host while the drill homes, in a jog, and in a hole."""
    with tempfile.TemporaryDirectory() as path:
        log, program = Path(path) / "log", Path(path) / "hole.nc"
        program.write_text(PROGRAM)
        trace = (*registers.ARGUMENTS, "-D", str(log))
        with Firmware("drill", board, *trace, in_wall_time=True) as firmware:
            drill = Interrupted(firmware, log)
            drill.is_homed()
            # The axes stand at their switches: they move off them first.
            homing = drill.kill(["jog", "home"], 100)
            drill.says("not homed", "spindle  off")
            # Z is home, Y and X return, then X jogs.
            jog = drill.kill(["jog", "x", "5000"], 3300)
            drill.says("at rest, homed", "spindle  off", "y        0 steps")
            hole = drill.kill(["send", program, "--no-home"], 600)
            drill.says("at rest, homed", "x        1070 steps", "z        up", "spindle  off")
            drill.says("; 0 drillings done")
    for motion, after in (("homing", homing), ("a jog", jog)):
        require(after <= MOST, f"{board}: {after} steps in {motion} without its host")
    print(f"{board}: without its host it stops within {max(homing, jog)} steps, {hole} in a hole")
