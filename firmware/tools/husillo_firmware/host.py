"""The host program, as checks use it."""

from __future__ import annotations

import os
import re
import subprocess
from functools import cache
from pathlib import Path

from husillo_firmware.build import FIRMWARE, cargo, target_folder
from husillo_firmware.waiting import fail

# No command of a check takes longer than this.
LONGEST_S = 600
STEPS_AS_SIMULATED = r"Steps +([\d,]+), each as in the simulator"
# Virtual time may run ahead of the host, so a lease in wall-clock time does not fit.
IN_VIRTUAL_TIME = ("--lease", "0")


@cache
def program() -> Path:
    """The path of the host program: that of the variable HUSILLO, or of a new build."""
    if given := os.environ.get("HUSILLO"):
        return Path(given).resolve()
    root = FIRMWARE.parent
    cargo("build", "-q", "-p", "husillo-host", folder=root)
    return target_folder(root) / "debug/husillo"


def command(*arguments: str | Path) -> list[str]:
    """A command line of the host program."""
    return [str(program()), *map(str, arguments)]


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Runs the host program to its end."""
    return subprocess.run(command(*arguments), capture_output=True, text=True, timeout=LONGEST_S)


def says(*arguments: str | Path) -> str:
    """Runs the host program. Returns its standard output; ends the check if it fails."""
    done = run(*arguments)
    if done.returncode:
        fail(f"husillo {' '.join(map(str, arguments))}\n{done.stdout}{done.stderr}")
    return done.stdout


def send(
    file: str | Path,
    machine: str,
    port: str,
    *arguments: str,
    answer: str = STEPS_AS_SIMULATED,
) -> list[str]:
    """Has the host send a file to a machine in virtual time.

    Returns all matches of the pattern's group in its output.
    """
    to = ("-m", machine, "--port", port)
    said = says("send", file, *to, *IN_VIRTUAL_TIME, *arguments)
    found: list[str] = re.findall(answer, said)
    if not found:
        fail(said)
    return found
