"""Measures flash and stack of small programs, and flash and static RAM of each crate: Cortex-M0.

The flash of a small program does not include that of an empty one. All programs are built at
`opt-level = "s"`. The depth of the stack is observed under QEMU, and its bound is read from the
code. For each crate, all public functions that the panic proof names are linked together.
"""

from __future__ import annotations

import argparse
import subprocess
from collections.abc import Iterator
from pathlib import Path

from husillo_firmware import golden
from husillo_firmware.boards import MICROBIT
from husillo_firmware.build import FIRMWARE, cargo, target_folder
from husillo_firmware.elf import Elf
from husillo_firmware.golden import Lines
from husillo_firmware.stack import Depths
from husillo_firmware.waiting import fail

SIZES = FIRMWARE / "proofs/sizes"
# The crates. The panic proof has a function with the name of each crate.
CRATES = (
    *("gcode", "excellon", "interp", "planner", "stepper", "backlash", "encoder", "pid"),
    *("probe", "transports", "store", "machine", "controllers"),
)
# Functions whose stack is bounded, each with a pattern of its symbol.
BOUNDS = (
    ("Block::read", "5Block4take"),
    ("Modal::apply", "Modal.*5apply17"),
    ("Commands::next", "Commands.*Iterator.*4next"),
)
LEVEL = "s"


def of_programs(features: str) -> Iterator[tuple[str, float]]:
    """Flash, stack and bounds of the small programs, with these features of the parser."""
    folder = target_folder() / f"size-{features}"
    chosen = () if features == "basic" else ("--features", features)
    cargo(
        *("build", "-q", "--release", "--target", MICROBIT.target),
        *("--target-dir", str(folder), *chosen),
        folder=SIZES,
        CARGO_PROFILE_RELEASE_OPT_LEVEL=LEVEL,
    )
    built = folder / MICROBIT.target / "release"
    empty = Elf(built / "size-empty").flash()
    for program in ("words", "commands"):
        yield f"flash {program}", Elf(built / f"size-{program}").flash() - empty
    for line in run(built / "stack").splitlines():
        name, _, value = line.rpartition(" ")
        yield name, float(value)
    depths = Depths(built / "stack")
    for name, pattern in BOUNDS:
        yield f"bound {name}", depths.bound(pattern)


def run(program: Path) -> str:
    """Runs a program in QEMU. Returns its output."""
    done = subprocess.run(["./qemu-run", program], cwd=FIRMWARE, stdout=subprocess.PIPE, text=True)
    if done.returncode:
        fail(f"{done.stdout}{program}: status {done.returncode}")
    return done.stdout


def of_crates() -> Iterator[tuple[str, float]]:
    """Flash and static RAM of each crate."""
    folder = target_folder() / "size-crates"
    folder.mkdir(parents=True, exist_ok=True)
    # Without a new time, Cargo would not link the program again.
    (FIRMWARE / "proofs/panics/src/main.rs").touch()
    cargo(
        *("rustc", "-q", "--release", "-p", "panics", "--target", MICROBIT.target),
        *("--target-dir", str(folder), "--", "-C", f"linker={SIZES / 'link-each'}"),
        EACH=" ".join(CRATES),
        EACH_FOLDER=str(folder),
        CARGO_PROFILE_RELEASE_OPT_LEVEL=LEVEL,
    )
    for crate in CRATES:
        elf = Elf(folder / crate)
        yield f"crate flash {crate}", elf.flash()
        yield f"crate static {crate}", elf.written()


def main(arguments: list[str]) -> int:
    """Prints the figures and compares them with the golden ones."""
    parser = argparse.ArgumentParser(prog="firmware/check sizes", description=__doc__)
    parser.add_argument("--write", action="store_true", help="renew golden.txt")
    options = parser.parse_args(arguments)
    figures = {
        f"{features} {name}": value
        for features in ("basic", "extended")
        for name, value in of_programs(features)
    }
    figures |= dict(of_crates())
    print(Lines.text(figures), end="")
    return golden.settle(SIZES / "golden.txt", Lines, figures, options.write)
