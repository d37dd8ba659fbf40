"""Compares figures with golden ones, for all checks."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from husillo_firmware.build import FIRMWARE, compiler

# Names and values, in the order in which they are printed.
Figures = dict[str, float]

# How much a figure may change, up or down.
TOLERANCE = 0.02
# The last words in the names of figures that may not change at all.
EXACT = {"steps", "holes", "results"}


def differences(golden: Figures, found: Figures) -> list[str]:
    """Lists the figures that changed more than allowed, and those that are missing or new."""
    said = [f"{name} is gone" for name in golden if name not in found]
    for name, now in found.items():
        if name not in golden:
            said.append(f"{name} {now:g} is not in the golden file")
            continue
        before = golden[name]
        allowed = 0 if name.split()[-1] in EXACT else TOLERANCE * before
        if abs(now - before) > allowed:
            said.append(f"{name}: {now:g} instead of {before:g}")
    return said


class Lines:
    """One figure per line: its name, then its value, a whole number."""

    @staticmethod
    def text(figures: Figures) -> str:
        return "".join(f"{name} {value:.0f}\n" for name, value in figures.items())

    @staticmethod
    def figures(text: str) -> Figures:
        rows = (line.rpartition(" ") for line in text.splitlines())
        return {name: float(value) for name, _, value in rows}


class Columns:
    """A row for each kernel and a column for each target. A name is `KERNEL TARGET`."""

    @staticmethod
    def text(figures: Figures) -> str:
        kernels = list(dict.fromkeys(name.split()[0] for name in figures))
        targets = list(dict.fromkeys(name.split()[1] for name in figures))
        rows = [["kernel", *targets]]
        for kernel in kernels:
            row = (figures.get(f"{kernel} {target}") for target in targets)
            rows.append([kernel, *("-" if value is None else f"{value:.2f}" for value in row)])
        return "".join(
            f"{row[0]:<26}" + "".join(f" {value:>10}" for value in row[1:]) + "\n" for row in rows
        )

    @staticmethod
    def figures(text: str) -> Figures:
        heading, *rows = [line.split() for line in text.splitlines()]
        return {
            f"{row[0]} {target}": float(value)
            for row in rows
            for target, value in zip(heading[1:], row[1:], strict=True)
            if value != "-"
        }


def settle(
    path: Path,
    form: type[Lines] | type[Columns],
    figures: Figures,
    is_written: bool,
    is_meant: Callable[[str], bool] = lambda name: True,
) -> int:
    """Compares figures with a golden file, or writes the file. Returns the status of the check.

    Only those figures of the file for which `is_meant` is true are compared or replaced. Figures of
    another compiler are not compared, and not kept.
    """
    version, where = compiler(), path.relative_to(FIRMWARE)
    first, _, text = path.read_text().partition("\n") if path.exists() else ("", "", "")
    if is_written:
        others = form.figures(text).items() if first == version else ()
        kept = {name: value for name, value in others if not is_meant(name)}
        path.write_text(f"{version}\n{form.text(figures | kept)}")
        print(f"{where} written")
        return 0
    if first != version:
        print(f"not compared: {where} has the figures of {first}")
        return 0
    golden = {name: value for name, value in form.figures(text).items() if is_meant(name)}
    said = differences(golden, figures)
    for one in said:
        print(one)
    print("use --write to accept these figures" if said else f"within 2 % of {where}")
    return 1 if said else 0
