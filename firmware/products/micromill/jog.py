"""Moves the firmware by hand with `husillo jog`, in wall-clock time.

Several axes step together, and the rate changes on request. The number of steps must be that which
the host reports. When the host is killed, the jog must end automatically.
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from itertools import pairwise
from pathlib import Path

from husillo_firmware import host, registers
from husillo_firmware.boards import Board
from husillo_firmware.registers import Happened, Made, clocks_per_us
from husillo_firmware.waiting import require, until

from products.micromill.link import ANSWER_S, DONE, STOPPED, TAKEN, WRONG, Micromill

ACTIONS = (
    *("x+y-z+", "0.5s", "faster", "0.5s", "slower", "0.5s"),
    *("run", "z", "-250", "0.5s", "x", "30"),
)
# At 170 steps per second, and at 180.
WAITS_US = [5883, 5556, 5883]
# At 250 steps per second, as requested.
RUN_US = 4000
# A lease that is longer than a busy computer delays the host.
PATIENCE = ("--lease", "9000")
# The host is killed after BEGUN steps. The jog makes at most MOST steps after its last byte, in the
# lease of 250 ms at 170 per second; all of it would be 5100.
BEGUN, MOST = 200, 50
# The jog ends half a second after the host's last byte. A busy computer may need this long.
END_S = 20
AFTER = 34


class Jogged:
    """A micro mill that is jogged, and its log."""

    def __init__(self, mill: Micromill, log: Path) -> None:
        self.mill, self.log, self.board = mill, log, mill.board

    def command(self, *actions: str) -> list[str]:
        """The arguments of the host for a jog."""
        return ["jog", "-m", "micromill", "--port", self.mill.tcp, *actions]

    def happened(self) -> list[Happened]:
        """Everything that has happened until now."""
        # The monitor answers when everything before it has been written.
        self.mill.monitor("info status")
        return registers.read_file(self.board, self.log)

    def steps(self) -> list[Made]:
        """All steps until now, without the levels written at power-on."""
        return registers.made(self.happened())[1:]

    def jog(self) -> int:
        """Jogs at several rates and compares. Returns the total steps of three axes."""
        said = host.says(*self.command(*PATIENCE, *ACTIONS))
        steps = self.steps()
        waits = [
            round((after.due - before.due) % 2**32 / clocks_per_us(self.board))
            for before, after in pairwise(steps)
            if before.due is not None and after.due is not None
        ]
        counts = [int(count.replace(",", "")) for count in re.findall(r"s, ([\d,]+) steps?", said)]
        jogged, run = counts[0] // 3, counts[1]
        is_all = counts[0] % 3 == 0 and counts[2] == 30 and len(steps) == jogged + run + 30
        require(is_all and len(waits) == len(steps) - 1, (counts, len(steps), len(waits)))
        # Every event changes the phase of each axis.
        for before, after in pairwise(steps[:jogged]):
            changed = before.levels ^ after.levels
            require(all(changed >> place & 3 for place in (0, 2, 4)), "an axis did not step")
        # A wait is longer if the queue runs empty because this computer is delayed. On a busy
        # computer, most waits may be longer.
        right = [wait for wait in waits[: jogged - 1] if wait in WAITS_US]
        paces = [wait for n, wait in enumerate(right) if not n or wait != right[n - 1]]
        require(paces == WAITS_US and len(right) > 0.3 * jogged, waits[:jogged])
        of_run = waits[jogged : jogged + run - 1]
        require(of_run.count(RUN_US) > 0.3 * run, of_run)
        return counts[0]

    def kill(self) -> None:
        """Kills the host while it jogs."""
        before = len(self.steps())
        jogs = host.command(*self.command("x+", "30s"))
        with subprocess.Popen(jogs, stdout=subprocess.DEVNULL) as jogging:
            until(
                lambda: len(self.steps()) > before + BEGUN,
                ANSWER_S,
                f"{self.board}: it does not jog",
            )
            jogging.kill()
        until(
            lambda: self.happened()[-1] == STOPPED,
            END_S,
            f"{self.board}: it does not stop without a host",
        )
        stopped = len(self.steps())
        alone = len(registers.made(registers.since_heard(self.board, self.log)))
        require(alone <= MOST, f"{self.board}: {alone} steps after the last byte of the host")
        # The mill makes exactly the requested steps.
        self.mill.connect()
        # The killed host may have left the start of a string.
        self.mill.ask(b"A;", (TAKEN, WRONG))
        self.mill.ask(b"L0000;", (TAKEN,))
        self.mill.ask(b"PX+%04d;" % AFTER, (DONE,))
        after = len(self.steps())
        require(after == stopped + AFTER, f"{self.board}: it moves on without a host")


def check(board: Board) -> None:
    """Jogs it, then kills the host."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        trace = (*registers.ARGUMENTS, "-D", str(log))
        # The host opens the link.
        with Micromill(board, *trace, in_wall_time=True, is_connected=False) as mill:
            mill.booted()
            jogged = Jogged(mill, log)
            steps = jogged.jog()
            jogged.kill()
    print(f"{board}: jogged {steps} steps of three axes; without a host it stopped")
