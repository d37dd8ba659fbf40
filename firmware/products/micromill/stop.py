"""A stopping byte must act before the next step, even if the foreground is several steps late.

QEMU's log contains each access to a register. After the stopping byte has been read, the motors'
pins must not change. Interrupts have one priority, so a step that is due at the same instant is
made before the byte is read, or not at all. The steps reported over the link must be those of the
pins. The next step after a stop waits at least its time from the last step made, and at most its
time from its request.
"""

from __future__ import annotations

import math
import os
import tempfile
from pathlib import Path

from husillo_firmware import registers
from husillo_firmware.boards import Board
from husillo_firmware.registers import Made, clocks_per_us
from husillo_firmware.waiting import fail, require

from products.micromill.link import DONE, NO_SWITCH, STOPPED, TAKEN, Micromill, add_steps

# The wait of a counted step: 170 steps per second.
WAIT_US = math.ceil(1e6 / 170)
STEP = b"PX+0001;"
# Clears the rest of a string after a stop.
CLEAR = b";"
TURNS = 6


class Stopped:
    """A micro mill that is stopped repeatedly, and its log."""

    def __init__(self, mill: Micromill, log: Path) -> None:
        self.mill, self.log, self.board = mill, log, mill.board
        self.steps = [0, 0, 0]
        self.cycle: list[int] = []

    def ask(self, string: bytes, *answers: int) -> None:
        """Sends a string and counts the reported steps."""
        add_steps(self.mill.ask(string, answers) if answers else self.mill.ask(string), self.steps)

    def logged(self) -> str:
        """Returns the text of the log, and empties it."""
        # The monitor answers when everything before has been written. Nothing more is written until
        # `cont`.
        self.mill.monitor("stop")
        text = self.log.read_text(errors="replace")
        os.truncate(self.log, 0)
        self.mill.monitor("cont")
        return text

    def made(self, text: str) -> list[Made]:
        """The writes to the pins."""
        return registers.made(registers.read(self.board, text.splitlines()))

    def prepare(self) -> None:
        """Notes the phases of a motor after 0 to 3 steps, then homes the mill."""
        for _ in range(4):
            self.cycle.append(phases(self.made(self.logged())[-1])[0])
            self.ask(STEP)
        require(len(set(self.cycle)) == 4, self.cycle)
        self.ask(b"H;", DONE, NO_SWITCH)
        self.ask(b"G01X00005Y00005F0100;")
        self.ask(b"S1;")

    def stop(self, turn: int) -> None:
        """Stops the mill during ten lines and checks its pins."""
        lines = [
            b"G01X%05dY%05dF0100;" % (10 + 60 * turn + 3 * number, 10 + 40 * turn + 5 * number)
            for number in range(10)
        ]
        for line in lines:
            self.ask(line, TAKEN)
        before = self.logged()
        # The foreground has to read two lines before the stop: an invalid arc, and a feed. On the
        # microbit this takes longer than two steps, so a hold without effect would be detected
        # there. The mps2-an386 reads the lines in time, and on virt QEMU delivers a byte too late.
        self.mill.line.send(b"G02X9Y9I5J7F99;" + lines[1][:9] + b"F99;A")
        add_steps(self.mill.hear((STOPPED,)), self.steps)
        # A step that was due would be made before the answer to this string.
        self.ask(CLEAR)
        text = self.logged()
        stop = f"addr {registers.heard_at(self.board):#x} value 0x41 "
        if late := self.made(text[text.rindex(stop) :]):
            fail(f"{self.board}: {len(late)} steps after the byte that stops")
        last = self.made(before + text)[-1]
        if phases(last) != [self.cycle[count % 4] for count in self.steps]:
            fail(f"{self.board}: the motors are at phases {phases(last)} after {self.steps} steps")
        self.ask(STEP)
        after = self.made(self.logged())
        require(len(after) == 1, f"{self.board}: {len(after)} steps after a stop, not 1")
        since_us = between_us(self.board, last.due, after[0].due)
        if since_us < WAIT_US:
            fail(f"{self.board}: {since_us} us from a stop to the next step, not {WAIT_US}")


def phases(step: Made) -> list[int]:
    """PH of both phases of X, Y and Z."""
    return [step.levels >> place & 3 for place in (0, 2, 4)]


def between_us(board: Board, begin: int | None, end: int | None) -> float:
    """The time from one clock value to another, in microseconds."""
    if begin is None or end is None:
        fail(f"{board}: a step had no wait")
    return (end - begin) % 2**32 / clocks_per_us(board)


def cut_short(board: Board, log: Path) -> None:
    """Cuts a wait short, in wall-clock time: virtual time would jump to its end."""
    trace = (*registers.ARGUMENTS, "-D", str(log))
    with Micromill(board, *trace, in_wall_time=True) as mill:
        mill.booted()
        mill.home()
        mill.ask(b"G01X00005Y00005F0100;")
        mill.ask(b"S1;")
        mill.ask(b"G04P10;", (TAKEN,))
        mill.ask(b"G01X00009Y00005F0100;", (TAKEN,))
        mill.ask(b"A", (STOPPED,))
        mill.ask(CLEAR)
        mill.ask(STEP)
        mill.monitor("stop")
        step = registers.made(registers.read_file(board, log))[-1]
    wait_us = between_us(board, step.asked, step.due)
    if not WAIT_US <= wait_us <= WAIT_US + 1:
        fail(f"{board}: {wait_us} us from a wait that was cut short to a step, not {WAIT_US}")


def check(board: Board) -> None:
    """Stops the mill repeatedly, then cuts a wait short."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        # A million instructions per second, the slowest that QEMU runs.
        slowly = ("-D", str(log), "-icount", "shift=10,sleep=off")
        with Micromill(board, *registers.ARGUMENTS, *slowly) as mill:
            mill.booted()
            stopped = Stopped(mill, log)
            stopped.prepare()
            for turn in range(TURNS):
                stopped.stop(turn)
        os.truncate(log, 0)
        cut_short(board, log)
    print(f"{board}: stops before the next step")
