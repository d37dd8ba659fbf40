"""Sets the cycles that a board measures beside the instructions counted under QEMU.

SOURCE is the port of a board that runs the firmware `cycles`, a saved output of it, or only the
name of a board: then the table has the cycles that are expected.
"""

from __future__ import annotations

import argparse
import os
import select
import socket
import sys
import termios
import time
import tty
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from husillo_firmware.build import FIRMWARE, compiler
from husillo_firmware.golden import Columns, Figures
from husillo_firmware.waiting import fail

GOLDEN = FIRMWARE / "proofs/counts/golden.txt"
# What was measured on metal: `BOARD.txt`, with the compiler in the first line.
METAL = FIRMWARE / "proofs/cycles/metal"
FIRST, LAST = "husillo cycles 1", "end"
# The whole table takes a few seconds at 72 MHz.
SILENCE_S = 30
# Each kernel is measured this many times. The least value counts.
TABLES = 3


@dataclass(frozen=True)
class Chip:
    """A processor: its column of the golden counts, and what is expected of it."""

    column: str
    # Cycles per instruction, with the wait states of the flash behind its cache.
    expected: float
    mhz: float


# The boards of `husillo_firmware.image`. No count is made for a Cortex-M33: it executes nearly the
# instructions of a Cortex-M4F.
CHIPS = {
    "pico": Chip("thumbv6m", 1.5, 125),
    "pico2": Chip("thumbv7em", 1.3, 150),
    "nucleo_f401": Chip("thumbv7em", 1.3, 84),
    "nucleo_f446": Chip("thumbv7em", 1.3, 168),
    "black_pill": Chip("thumbv7em", 1.3, 84),
}


@dataclass(frozen=True)
class Table:
    """One output of the firmware."""

    counter: str
    mhz: float
    # Cycles per event. `inf`: the counter wrapped.
    cycles: Figures


def parse(lines: Iterable[str]) -> Iterator[Table]:
    """The whole tables of an output. What is before, between and after them is ignored."""
    rows: list[list[str]] | None = None
    for line in (line.strip() for line in lines):
        if line == FIRST:
            rows = []
        elif line == LAST and rows is not None:
            (_, counter), (_, mhz), *kernels = rows
            cycles = {name: float("inf" if value == "over" else value) for name, value in kernels}
            yield Table(counter, float(mhz), cycles)
            rows = None
        elif rows is not None and len(line.split()) == 2:
            rows.append(line.split())


def least(tables: list[Table]) -> Table:
    """The least value of each kernel."""
    first = tables[0]
    cycles = {name: min(table.cycles[name] for table in tables) for name in first.cycles}
    return Table(first.counter, first.mhz, cycles)


@contextmanager
def opened(source: str) -> Iterator[int]:
    """The file descriptor of a port, a serial one at 115,200 bit/s or `tcp:HOST:PORT`."""
    if source.startswith("tcp:"):
        host, _, port = source.removeprefix("tcp:").rpartition(":")
        with socket.create_connection((host, int(port))) as connection:
            yield connection.fileno()
        return
    line = os.open(source, os.O_RDWR | os.O_NOCTTY)
    try:
        tty.setraw(line)
        attributes = termios.tcgetattr(line)
        attributes[4] = attributes[5] = termios.B115200
        termios.tcsetattr(line, termios.TCSANOW, attributes)
        yield line
    finally:
        os.close(line)


def ask(line: int, source: str) -> str:
    """Asks for a table, and returns the output up to its end. Each byte asks for one."""
    os.write(line, b"?")
    heard = b""
    while LAST.encode() not in heard.split():
        begun = time.monotonic()
        if not select.select([line], [], [], SILENCE_S)[0]:
            fail(f"{source}: silent for {SILENCE_S} s after {len(heard)} bytes")
        more = os.read(line, 4096)
        if not more:
            fail(f"{source}: closed after {len(heard)} bytes, {time.monotonic() - begun:.0f} s")
        heard += more
    return heard.decode(errors="replace")


def measured(source: str) -> str:
    """The output of a board at a port: some tables."""
    with opened(source) as line:
        return "".join(ask(line, source) for _ in range(TABLES))


def instructions(column: str) -> Figures:
    """The golden counts of a processor, by kernel."""
    _, _, text = GOLDEN.read_text().partition("\n")
    names = ((name.split(), value) for name, value in Columns.figures(text).items())
    return {kernel: value for (kernel, target), value in names if target == column}


def rows(chip: Chip, table: Table | None) -> Iterator[str]:
    """The lines of the table that is printed."""
    yield f"{'kernel':<28}{'instructions':>12}{'expected':>10}{'cycles':>10}{'ratio':>7}{'us':>9}"
    mhz = table.mhz if table else chip.mhz
    for kernel, count in instructions(chip.column).items():
        expected = count * chip.expected
        found = table.cycles.get(kernel) if table else None
        cells = ("-", "-") if found is None else (f"{found:.2f}", f"{found / count:.2f}")
        us = (expected if found is None else found) / mhz if mhz else 0
        yield f"{kernel:<28}{count:>12.2f}{expected:>10.1f}{cells[0]:>10}{cells[1]:>7}{us:>9.2f}"


def summary(chip: Chip, table: Table) -> str:
    """The ratio of all kernels together, beside the expected one."""
    counts = instructions(chip.column)
    ratios = sorted(
        table.cycles[kernel] / count for kernel, count in counts.items() if kernel in table.cycles
    )
    if not ratios:
        return "none of these kernels has a count"
    middle, low, high = ratios[len(ratios) // 2], ratios[0], ratios[-1]
    return (
        f"cycles per instruction: median {middle:.2f}, {low:.2f} to {high:.2f}; "
        f"expected {chip.expected}"
    )


def main(arguments: list[str]) -> int:
    """Prints the table. Returns the status."""
    options = argparse.ArgumentParser(prog="firmware/cycles", description=__doc__)
    options.add_argument("source", metavar="SOURCE", help=f"port, file, or {', '.join(CHIPS)}")
    options.add_argument("--board", choices=CHIPS, help="the board at the port or of the file")
    options.add_argument("--save", action="store_true", help="keep the output as BOARD.txt")
    chosen = options.parse_args(arguments)
    board = chosen.board or chosen.source
    if board not in CHIPS:
        options.error(f"name the board: --board {'|'.join(CHIPS)}")
    saved = METAL / f"{board}.txt"
    output = ""
    if chosen.source != board:
        path = Path(chosen.source)
        output = path.read_text() if path.is_file() else measured(chosen.source)
    elif saved.exists():
        output = saved.read_text()
    print(f"{board}, {compiler()}")
    tables = list(parse(output.splitlines()))
    if output and not tables:
        fail(f"{chosen.source}: no whole table, from `{FIRST}` to `{LAST}`")
    table = least(tables) if tables else None
    if table:
        print(f"measured by {table.counter} at {table.mhz:.2f} MHz, the least of {len(tables)}")
    print(*rows(CHIPS[board], table), sep="\n")
    if table:
        print(summary(CHIPS[board], table))
        if table.counter == "nothing":
            fail("this chip has no counter of cycles")
    if chosen.save and table:
        METAL.mkdir(exist_ok=True)
        saved.write_text(f"{compiler()}\n{output}")
        print(f"{saved} written", file=sys.stderr)
    return 0
