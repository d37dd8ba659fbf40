"""The common part of all products' checks: boards, figures, the golden file."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable

from husillo_firmware import boards, golden, stack
from husillo_firmware.boards import MICROBIT, Board
from husillo_firmware.build import FIRMWARE
from husillo_firmware.golden import Figures

Measured = Callable[[Board], Iterable[tuple[str, int]]]


def parser(name: str, what: str) -> argparse.ArgumentParser:
    """Returns a parser of the options that all products' checks have."""
    options = argparse.ArgumentParser(prog=f"firmware/check {name}", description=what)
    options.add_argument("boards", nargs="*", type=boards.named, metavar="BOARD")
    options.add_argument("--write", action="store_true", help="renew golden.txt")
    return options


def measure(name: str, on: Iterable[Board], measured: Measured) -> Figures:
    """Checks a product on boards, and prints its figures as they come. Returns them."""
    figures: Figures = {}
    for board in on:
        rows = list(measured(board))
        if board == MICROBIT:
            rows.append(("bound", stack.worst(name)))
        for row, value in rows:
            figures[f"{board} {row}"] = value
            print(board, row, value, flush=True)
    return figures


def settle(
    name: str,
    options: argparse.Namespace,
    figures: Figures,
    on: Iterable[Board] = boards.ALL,
) -> int:
    """Compares a product's figures with its golden file, or writes it. Returns the status."""
    chosen = {board.name for board in options.boards or on}
    path = FIRMWARE / "products" / name / "golden.txt"
    return golden.settle(
        path, golden.Lines, figures, options.write, lambda row: row.split()[0] in chosen
    )


def check(name: str, what: str, arguments: list[str], measured: Measured) -> int:
    """Runs the whole check of a product that has no further options. Returns the status."""
    options = parser(name, what).parse_args(arguments)
    return settle(name, options, measure(name, options.boards or boards.ALL, measured))
