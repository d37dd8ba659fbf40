"""Counts the instructions of the firmware's tasks, in QEMU's log of every instruction."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from husillo_firmware.boards import Board
from husillo_firmware.instructions import BEGIN, END, Count
from husillo_firmware.waiting import fail, require

from products.micromill.link import ANSWER_S, READY, Micromill

START = b"G01X00005Y00005F0100;"
# The name, a string to send first, and the string whose events are counted. `untold`: no step is
# reported.
EVENTS = (
    ("slope_event", None, b"G01X00150Y00080F0100;"),
    ("slope_event_untold", b"R000;", b"G01X00295Y00155F0100;"),
    # Both axes move forwards, as before, so there is no take-up.
    ("arc_event_untold", None, b"G02X00445Y00305I00445J00155F0100;"),
    # A take-up of 1457 steps, then 7 steps.
    ("take_up_event_untold", None, b"G01X00444F0100;"),
    # A circle of 3 mm, with four take-ups.
    ("circle_event_untold", None, b"G02X00444Y00305I00444J00705F0100;"),
)


def count(board: Board) -> Iterator[tuple[str, int]]:
    """Yields names and instructions."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "log"
        for name, value in (*start(board, log), *strings(board, log)):
            yield f"count {name}", round(value)


def start(board: Board, log: Path) -> Iterator[tuple[str, float]]:
    """Counts from the reset to the first sleep, with "ready" in the transmitter."""
    with Micromill(board, "-S", "-singlestep", "-D", str(log)) as mill:
        mill.monitor(BEGIN)
        mill.monitor("c")
        said = mill.receive(ANSWER_S)
        require(said == READY, said)
        mill.booted()
        mill.monitor(END)
        yield "start", Count(mill, log, to_sleep=True).foreground
    os.truncate(log, 0)


def strings(board: Board, log: Path) -> Iterator[tuple[str, float]]:
    """Counts the instructions of strings and of their events."""
    with Micromill(board, "-singlestep", "-D", str(log)) as mill:

        def counted(string: bytes) -> Count:
            mill.monitor(BEGIN)
            mill.ask(string)
            # The work of the firmware after its answer also counts for the string.
            mill.booted()
            mill.monitor(END)
            found = Count(mill, log)
            os.truncate(log, 0)
            return found

        mill.home()
        mill.ask(START)
        # The number of wake-ups depends on when the host sends, so the minimum of four is taken.
        nowhere = min((counted(START) for _ in range(4)), key=lambda found: found.foreground)
        yield "byte_interrupt", max(nowhere.byte)
        # The line makes no step: its bytes are received, and it is read, checked and planned.
        yield "line", nowhere.foreground

        held, worst = nowhere.held, 0
        for name, before, string in EVENTS:
            if before:
                mill.ask(before)
            found = counted(string)
            events = len(found.step)
            if events <= 500:
                fail(f"{board}: {events} events of {string!r}")
            yield name, found.foreground / events
            held, worst = max(held, found.held), max(worst, *found.step)
            if name == "slope_event":
                yield "step_interrupt", sum(found.step) / events
        yield "step_interrupt_longest", worst
        yield "held_longest", held
