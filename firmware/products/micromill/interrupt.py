"""A host that ends while the firmware moves: the motors must stop, in wall-clock time.

Ctrl-C or SIGTERM comes during a jog, during steps or during a program. The host stops the motors
and reports it. A host that is killed cannot: the lease of the firmware ends the motion.
"""

from __future__ import annotations

import os
import signal
import subprocess
import tempfile
from pathlib import Path

from husillo_firmware import host, registers
from husillo_firmware.boards import Board
from husillo_firmware.waiting import require, settled, until

from products.micromill.link import ANSWER_S, DONE, TAKEN, WRONG, Micromill

# 5 mm forward and back at 10 mm/min takes a minute.
PROGRAM = "G21 G90\nG1 X5 F10\nG1 X0\nM30\n"
# Steps before the request.
BEGUN = 50
# The most steps after the last byte of the host: those of the lease of 250 ms at 250 per second,
# and those that were given before.
MOST = 70
# Longer than a busy computer delays the host, which ends its motion itself.
PATIENCE = ("--lease", "9000")
END_S = 20
# A motion makes a step in this time.
QUIET_S = 0.5
# The host's exit status.
INTERRUPTED = 130
# The number of steps that are requested after the stop.
AFTER = 34


class Interrupted:
    """A micro mill that a host moves until the host is asked to end, and its log."""

    def __init__(self, mill: Micromill, log: Path) -> None:
        self.mill, self.log, self.board = mill, log, mill.board

    def steps(self) -> int:
        """Steps since the log was emptied."""
        # The monitor answers when everything before it has been written.
        self.mill.monitor("info status")
        return len(registers.made(registers.read_file(self.board, self.log)))

    def ended(self) -> int:
        """Steps since the log was emptied, when no more are made."""
        what = f"{self.board}: it moves on without a host"
        return settled(self.steps, QUIET_S, ANSWER_S, what)

    def interrupt(self, words: list[str | Path], request: signal.Signals) -> int:
        """Starts a host and asks it to end. Returns the steps after its last byte."""
        os.truncate(self.log, 0)
        place = f"{self.board}: {' '.join(map(str, words))}"
        lease = () if request == signal.SIGKILL else PATIENCE
        moves = host.command(*words, "-m", "micromill", "--port", self.mill.tcp, *lease)
        with subprocess.Popen(
            moves, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        ) as moving:
            try:
                until(lambda: self.steps() >= BEGUN, ANSWER_S, f"{place}: it does not move")
                moving.send_signal(request)
                said = moving.communicate(timeout=END_S)[1]
            finally:
                moving.kill()
        if request == signal.SIGKILL:
            all_steps = self.ended()
        else:
            all_steps = self.steps()
            status = f"status {moving.returncode}, {said}"
            require(moving.returncode == INTERRUPTED, f"{place}: {status}")
            require("the controller has stopped" in said, f"{place}: {said}")
        after = len(registers.made(registers.since_heard(self.board, self.log)))
        require(after <= MOST, f"{place}: {after} steps after the last byte of the host")
        # The mill makes exactly the requested steps.
        self.mill.connect()
        # A host that was killed may have left the beginning of a string.
        self.mill.ask(b"A;", (TAKEN, WRONG))
        self.mill.ask(b"L0000;", (TAKEN,))
        self.mill.ask(b"PX+%04d;" % AFTER, (DONE,))
        self.mill.line.close()
        require(self.steps() == all_steps + AFTER, f"{place}: it moves on without a host; {said}")
        return after


def check(board: Board) -> None:
    """Moves the mill with each command, and ends the host each time."""
    with tempfile.TemporaryDirectory() as path:
        log, program = Path(path) / "log", Path(path) / "long.nc"
        program.write_text(PROGRAM)
        turns: list[tuple[list[str | Path], signal.Signals]] = [
            (["jog", "x+", "30s"], signal.SIGINT),
            (["jog", "x", "5000"], signal.SIGTERM),
            (["jog", "run", "z", "-250", "30s"], signal.SIGINT),
            (["send", program], signal.SIGTERM),
            (["send", program, "--stream"], signal.SIGINT),
            (["jog", "x", "5000"], signal.SIGKILL),
            (["jog", "run", "z", "-250", "30s"], signal.SIGKILL),
            (["send", program], signal.SIGKILL),
            (["send", program, "--stream"], signal.SIGKILL),
        ]
        trace = (*registers.ARGUMENTS, "-D", str(log))
        # The host opens the link.
        with Micromill(board, *trace, in_wall_time=True, is_connected=False) as mill:
            mill.booted()
            interrupted = Interrupted(mill, log)
            most = max(interrupted.interrupt(words, request) for words, request in turns)
    print(f"{board}: without its host it stops within {most} steps")
