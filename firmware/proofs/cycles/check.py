"""Runs the firmware `cycles` in QEMU, and compares its figures with the counted instructions.

QEMU has no cycles: each instruction takes 64 ns of virtual time. So the counter of a board advances
by a fixed number of its ticks per instruction, the same for every kernel.
"""

from __future__ import annotations

import argparse
import statistics

from husillo_firmware import boards
from husillo_firmware.boards import MICROBIT, MPS2, VIRT, Board
from husillo_firmware.qemu import Firmware
from husillo_firmware.waiting import require

from proofs.cycles import table

# The column of the golden counts, the counter of the firmware, and its ticks per instruction:
# SysTick at 25 MHz, at 16 MHz, and nanoseconds.
KINDS: dict[Board, tuple[str, str, float]] = {
    MPS2: ("thumbv7em", "SysTick", 1.6),
    MICROBIT: ("thumbv6m", "SysTick", 1.024),
    VIRT: ("rv32imac", "mcycle", 64),
}
# The groups of kernels. No board of QEMU has the flash for all.
RUNS = (
    (MPS2, "methods"),
    (MPS2, "line"),
    (MICROBIT, "text"),
    (MICROBIT, "events"),
    (VIRT, "methods"),
)
# The program is linked with other code than that of the counts, so a loop may differ a little.
TOLERANCE = 0.1
# The fewest kernels of a group.
FEWEST = {"methods": 70, "text": 9, "events": 10, "line": 7}


def checked(board: Board, group: str) -> str:
    """Checks a group of kernels on a board. Returns what was found."""
    column, counter, ticks = KINDS[board]
    with Firmware("cycles", board, features=group) as run:
        run.booted()
        output = table.measured(run.tcp)
    tables = list(table.parse(output.splitlines()))
    require(len(tables) == table.TABLES, f"{board}: {len(tables)} tables")
    found = table.least(tables)
    require(found.counter == counter, f"{board}: counted by {found.counter}")
    counts = table.instructions(column)
    strange = set(found.cycles) - set(counts)
    require(not strange, f"{board}: not in the golden counts: {strange}")
    require(len(found.cycles) >= FEWEST[group], f"{board}: {len(found.cycles)} kernels")
    ratios = {kernel: value / counts[kernel] / ticks for kernel, value in found.cycles.items()}
    far = [f"{name} {ratio:.3f}" for name, ratio in ratios.items() if abs(ratio - 1) > TOLERANCE]
    require(not far, f"{board}: far from the counted instructions: {', '.join(far)}")
    return (
        f"{board} {group}: {len(ratios)} kernels by {counter}, {min(ratios.values()):.3f} to "
        f"{max(ratios.values()):.3f} of the counted instructions, "
        f"median {statistics.median(ratios.values()):.3f}"
    )


def main(arguments: list[str]) -> int:
    """Checks the boards. Returns the status."""
    parser = argparse.ArgumentParser(prog="firmware/check cycles", description=__doc__)
    parser.add_argument("boards", nargs="*", type=boards.named, metavar="BOARD")
    chosen = parser.parse_args(arguments).boards or KINDS
    for board, group in RUNS:
        if board in chosen:
            print(checked(board, group), flush=True)
    return 0
