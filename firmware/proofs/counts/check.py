"""Counts the instructions per event of each kernel on three processors, under QEMU."""

from __future__ import annotations

import argparse
import subprocess

from husillo_firmware import golden
from husillo_firmware.boards import MICROBIT, MPS2, VIRT, Board
from husillo_firmware.build import FIRMWARE, cargo, compiler
from husillo_firmware.golden import Columns, Figures
from husillo_firmware.waiting import fail

GOLDEN = FIRMWARE / "proofs/counts/golden.txt"
# The columns, from left to right: the board and the heading.
COLUMNS = ((MPS2, "thumbv7em"), (MICROBIT, "thumbv6m"), (VIRT, "rv32imac"))
PROGRAMS = ("counts", "counts-text", "counts-events", "counts-line")


def counted(package: str, program: str, board: Board) -> Figures:
    """Runs a counting program. Returns the instructions of each kernel."""
    command = ["cargo", "run", "-q", "--release", "-p", package, "--bin", program]
    run = subprocess.run(
        [*command, "--target", board.target], cwd=FIRMWARE, stdout=subprocess.PIPE, text=True
    )
    if run.returncode:
        fail(f"{run.stdout}{program} on {board}: status {run.returncode}")
    rows = (line.split() for line in run.stdout.splitlines())
    return {name: float(value) for name, value in rows}


def table(package: str, programs: tuple[str, ...]) -> Figures:
    """Counts on all processors. Each figure is named `KERNEL COLUMN`."""
    figures: Figures = {}
    for board, heading in COLUMNS:
        cargo("build", "-q", "--release", "-p", package, "--target", board.target)
        for program in programs:
            found = counted(package, program, board)
            figures |= {f"{kernel} {heading}": value for kernel, value in found.items()}
    return figures


def main(arguments: list[str]) -> int:
    """Prints the table and compares it with the golden one."""
    parser = argparse.ArgumentParser(prog="firmware/check counts", description=__doc__)
    parser.add_argument("--write", action="store_true", help="renew golden.txt")
    parser.add_argument(
        "--peers",
        action="store_true",
        help="count controllers and decoders, of other crates and ours; compare nothing",
    )
    options = parser.parse_args(arguments)
    figures = (
        table("peers-control", ("peers-control",)) if options.peers else table("counts", PROGRAMS)
    )
    print(f"{compiler()}\n{Columns.text(figures)}", end="")
    return 0 if options.peers else golden.settle(GOLDEN, Columns, figures, options.write)
