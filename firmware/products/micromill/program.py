"""The host cuts a program: every step, wait, phase and byte must be as in the host's files."""

from __future__ import annotations

import json
import math
import re
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from husillo_firmware import host, registers
from husillo_firmware.boards import Board
from husillo_firmware.emulated import Row, rows_of, same
from husillo_firmware.qemu import Firmware
from husillo_firmware.registers import Happened, Made, clocks_per_us
from husillo_firmware.waiting import fail, require

from products.micromill.link import DONE, STEPS, add_steps

AXES = "xyz"
# The host asks for the state after homing and at the end.
REPORT = re.compile(rb"I;[\x90-\x9f]{73}\x8c")
# Strings that switch the spindle: forwards, backwards, off.
SPINDLE = {"M03": 1, "M04": 2, "M05": 0, "M30": 0}


@dataclass
class Line:
    """A string of the link, and its rows in the host's step file."""

    string: str
    rows: list[Row]


def cut(board: Board, program: Path, is_traced: bool) -> Iterator[tuple[str, int]]:
    """Has the host cut a program with the firmware, and compares. Yields the figures.

    Without the trace, only the reported steps are compared. This works for programs of any length.
    """
    with tempfile.TemporaryDirectory() as path:
        folder = Path(path)
        log = folder / "log"
        trace = (*registers.ARGUMENTS, "-D", str(log)) if is_traced else ()
        with Firmware("micromill", board, *trace) as firmware:
            firmware.booted()
            steps = int(host.send(program, "micromill", firmware.tcp)[0].replace(",", ""))
            ram = firmware.ram()
        # The host has compared the reported steps with those of the strings on the simulator. The
        # simulator's reports of the strings and of the program must be equal.
        strings = folder / "strings.mm"
        host.says("compile", program, "-m", "micromill", "-o", strings)
        if (of_strings := report(strings)) != (of_program := report(program)):
            fail(f"{board}: {of_strings} instead of {of_program}")
        late: list[float] = []
        if is_traced:
            sent = strings.read_text().splitlines()
            late = compare(board, registers.read_file(board, log), lines_of(sent, folder))
    yield "steps", steps
    if late:
        # The lateness is the virtual time from the end of the wait until the time is read after
        # the write to the pins. An instruction takes 64 ns. The latest of 1000 steps is left out:
        # on a busy computer QEMU's clock sometimes jumps too far while the chip sleeps.
        # `held_longest` is the delay that the firmware itself can cause.
        require(len(late) > 0.8 * steps, f"{board}: {len(late)} of {steps} steps have a time")
        late.sort()
        yield "jitter_us", math.ceil(late[len(late) * 999 // 1000] - late[0])
    yield from firmware.memory(ram).items()


@dataclass
class Wiring:
    """The lines of a motor."""

    # Lines per motor.
    lines: int
    # Steps of a cycle of its levels.
    cycle: int
    # The levels of these lines, from the host's levels of the motor's driver.
    of: Callable[[int], int]


def lines_of(strings: Sequence[str], folder: Path, *options: str | Path) -> list[Line]:
    """The strings of a program, each with its rows. The options are those of `husillo steps`."""
    path, before, lines = folder / "part.mm", 0, []
    for count, string in enumerate(strings, 1):
        path.write_text("\n".join(strings[:count]) + "\n")
        rows = rows_of(host.says("steps", path, "--levels", "-o", "-", *options).splitlines())
        lines.append(Line(string, rows[before:]))
        before = len(rows)
    return lines


def report(path: Path) -> dict[str, Any]:
    """The simulator's report of a program, without what depends on its file."""
    said = host.says("run", path, "-m", "micromill", "--format", "json")
    values: dict[str, Any] = json.loads(said)
    for name in ("file", "findings"):
        del values[name]
    return values


def phases(levels: int) -> int:
    """PH of both phases of a motor, from the host's levels of its driver."""
    return levels & 1 | levels >> 2 & 2


# In full steps only the phases are at pins.
PHASES = Wiring(2, 4, phases)


def cycle_of(lines: Sequence[Line], wiring: Wiring) -> dict[int, int]:
    """The levels of a motor at each step of their cycle, as in the host's files."""
    cycle: dict[int, int] = {}
    sums = [0, 0, 0]
    for row in (row for line in lines for row in line.rows):
        for axis, letter in enumerate(AXES):
            sums[axis] += row["d" + letter]
            found = wiring.of(row["l" + letter])
            same("the host's levels", cycle.setdefault(sums[axis] % wiring.cycle, found), found)
    return cycle


def compare(
    board: Board, happened: list[Happened], lines: Sequence[Line], wiring: Wiring = PHASES
) -> list[float]:
    """Compares what happened after homing with the host's files.

    Returns the lateness in microseconds of every step but the first of each line.
    """
    homed = happened.index(DONE) + 1
    at = [0, 0, 0]
    add_steps(registers.said(happened[:homed]), at)
    cycle = cycle_of(lines, wiring)
    after = happened[homed:]
    made = registers.made(after)
    same(f"{board}: events", len(made), sum(len(line.rows) for line in lines))
    steps = iter(made)
    expected, spindle = b"", 0
    last: int | None = None
    late: list[float] = []
    for line in lines:
        expected += line.string.encode()
        spindle = SPINDLE.get(line.string[:3], spindle)
        for place, row in enumerate(line.rows):
            step, where = next(steps), f"{board}: {line.string} event {place + 1}"
            for axis, letter in enumerate(AXES):
                delta = row["d" + letter]
                at[axis] += delta
                if delta:
                    expected += bytes([STEPS[0] | axis << 1 | (delta > 0)])
            levels = sum(
                cycle[count % wiring.cycle] << wiring.lines * axis for axis, count in enumerate(at)
            )
            same(f"{where}: levels", step.levels, levels)
            same(f"{where}: spindle", step.outputs, spindle)
            last = waited(board, where, step, row["wait_ticks"], last, place == 0)
            if place and step.at is not None:
                late.append((step.at - last) % 2**32 / clocks_per_us(board))
        expected += bytes([DONE])
    if (found := REPORT.sub(b"", registers.said(after))) != expected:
        fail(f"{board}: bytes sent: {found.hex()} instead of {expected.hex()}")
    none_is_ahead(after)
    return late


def waited(
    board: Board, where: str, step: Made, wait_us: int, last: int | None, is_first: bool
) -> int:
    """Compares the wait before a step with the host's. Returns when the step was due.

    The wait of the first step begins when the line has been read, so it may be longer.
    """
    if step.due is None:
        fail(f"{where}: there was no wait")
    if last is not None:
        since = (step.due - last) % 2**32
        if not is_first:
            same(f"{where}: wait", since / clocks_per_us(board), wait_us)
        elif since < wait_us * clocks_per_us(board):
            fail(f"{where}: before its wait is over")
    return step.due


def none_is_ahead(happened: Sequence[Happened]) -> None:
    """Checks that no step is reported before it is made."""
    ahead = 0
    for one in happened:
        if isinstance(one, int):
            ahead -= one in STEPS
        else:
            ahead += len(AXES)
        require(ahead >= 0, "a step is reported before it is made")
