"""Builds firmwares and the host program with cargo."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from husillo_firmware.boards import Board

# The folder `firmware`.
FIRMWARE = Path(__file__).resolve().parents[2]

# Products whose events are optimised for speed, on boards with enough flash.
LEVELS = {("micromill", "mps2-an386"): "3"}
# Programs that are optimised for speed on every board, as the counted ones are.
FAST = {"cycles"}
# The code of the micro mill's events is generic and is instantiated in the crate `micromill`, so
# this crate has another level.
OWN = {("micromill", "microbit"): 'profile.release.package.micromill.opt-level="s"'}


def target_folder(of: Path = FIRMWARE) -> Path:
    """Cargo's target folder of a workspace."""
    return of / os.environ.get("CARGO_TARGET_DIR", "target")


def cargo(*arguments: str, folder: Path = FIRMWARE, **environment: str) -> None:
    """Runs cargo and shows its messages. Ends the check if it fails."""
    command = ["cargo", *arguments]
    status = subprocess.run(command, cwd=folder, env={**os.environ, **environment}).returncode
    if status:
        raise SystemExit(f"{' '.join(command)}: status {status}")


def elf(program: str, board: Board) -> Path:
    """The path of a firmware."""
    return target_folder() / board.target / "release" / program


def firmware(program: str, board: Board, features: str = "") -> Path:
    """Builds a firmware for a board."""
    key = program, board.name
    level = "3" if program in FAST else LEVELS.get(key, board.level)
    environment = {"CARGO_PROFILE_RELEASE_OPT_LEVEL": level}
    if board.file:
        environment["BOARD"] = board.file
    own = ["--config", OWN[key]] if key in OWN else []
    cargo(
        *("build", "-q", "--release", "-p", program, "--features", features),
        *("--target", board.target, *own, *board.options),
        folder=FIRMWARE,
        **environment,
    )
    return elf(program, board)


def compiler() -> str:
    """The compiler's version. Figures of another version are not compared."""
    said = subprocess.run(["rustc", "-V"], cwd=FIRMWARE, capture_output=True, text=True, check=True)
    return said.stdout.strip()
