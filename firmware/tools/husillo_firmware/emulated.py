"""Compares a firmware with the host's emulated machine, which receives the same commands."""

from __future__ import annotations

import csv
import subprocess
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from husillo_firmware import host
from husillo_firmware.boards import Board
from husillo_firmware.registers import Made, Switched, clocks_per_us
from husillo_firmware.waiting import Lines, fail, require

# A foreground makes one event after the other, because it has to read the switches. It takes at
# most this long. An event that is due earlier may be late.
FOREGROUND_US = 300
BEGIN_S = 60

# A row of a step file.
Row = dict[str, int]
# The levels and the outputs of a row.
Pins = Callable[[Row], tuple[int, int]]


def rows_of(lines: Iterable[str]) -> list[Row]:
    """The rows of a step file."""
    return [{name: int(value) for name, value in row.items()} for row in csv.DictReader(lines)]


class Emulated:
    """A machine that the host emulates faster than in real time."""

    def __init__(self, machine: str, folder: Path, speed: int, *options: str) -> None:
        self.link, self.steps = folder / f"{machine}.link", folder / f"{machine}.csv"
        files = ("--link", self.link, "--steps", self.steps)
        self.process = subprocess.Popen(
            host.command("emulate", machine, *files, "--speed", str(speed), *options),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )
        Lines(self.process).next(BEGIN_S)

    def __enter__(self) -> Emulated:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.terminate()
        self.process.communicate()

    def rows(self) -> list[Row]:
        """All rows. The machine must have ended."""
        with self.steps.open() as file:
            return rows_of(file)


def compare(
    board: Board,
    happened: Sequence[Made | Switched],
    rows: Sequence[Row],
    pins: Pins,
    outputs: int,
    slow: int = 0,
) -> int:
    """Compares the writes to the pins after a wait, and the switched outputs, with rows.

    Returns the number of rows that have happened. `outputs` are those before the first row. A wait
    counts from the previous event. After an output in `slow` is switched on, it counts from the
    next write to the pins, because it is unknown how long the machine stood still before. A wait
    must be exact, unless its end had passed when it began.
    """
    events = iter(happened)
    due: int | None = None
    t_us: int | None = None
    for number, row in enumerate(rows):
        place = f"{board}: row {number + 1}, after event {row['event']}"
        before, (levels, outputs) = outputs, pins(row)
        moves = any(row[name] for name in row if name.startswith("d"))
        is_switch = not row["wait_ticks"] and not moves
        if is_switch and outputs == before:
            continue
        one = next(events, None)
        if one is None:
            return number
        same(f"{place}: outputs", one.outputs, outputs)
        same(f"{place}: only outputs", isinstance(one, Switched), is_switch)
        if isinstance(one, Switched):
            if outputs & ~before & slow:
                begin = next(events, None)
                require(isinstance(begin, Made), f"{place}: an output that is slow has no wait")
                due, t_us = due_of(begin), row["t_us"]
            continue
        same(f"{place}: levels", one.levels, levels)
        if t_us is not None and due is not None and row["t_us"] - t_us == row["wait_ticks"]:
            wait_us = (due_of(one) - due) % 2**32 / clocks_per_us(board)
            if not (row["wait_ticks"] < wait_us < FOREGROUND_US and one.is_late(board)):
                same(f"{place}: wait", wait_us, row["wait_ticks"])
        due, t_us = due_of(one), row["t_us"]
    require(next(events, None) is None, f"{board}: more than {len(rows)} rows of events")
    return len(rows)


def same(what: str, found: float, expected: float) -> None:
    """Ends the check if the values differ."""
    if found != expected:
        fail(f"{what}: {found} instead of {expected}")


def due_of(one: Made | Switched | None) -> int:
    """When an event was due. Ends the check if it had no wait."""
    due = one.due if isinstance(one, Made) else None
    if due is None:
        fail("pins were written without a wait")
    return due
