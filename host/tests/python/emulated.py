"""`husillo emulate` in the background, for clients of other authors."""

from __future__ import annotations

import math
import os
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path
from types import TracebackType

# Clients give a module 50 to 200 ms to answer. A computer that is busy with other work may let an
# emulated module miss that, so a session is tried several times.
SESSIONS = 5


def spiral(count: int) -> str:
    """A program of short lines: a spiral of this many, which ends at X3 Y4."""
    lines = ["G21 G90", "G1 F2400 X0 Y0"]
    for number in range(count):
        angle = number / 20
        radius = number / count * 8
        lines.append(f"G1 X{radius * math.cos(angle):.3f} Y{radius * math.sin(angle):.3f}")
    lines += ["G0 X3 Y4", "M2"]
    return "\n".join(lines) + "\n"


class Emulated:
    """A network behind a pseudo-terminal. The program is that of the variable HUSILLO."""

    def __init__(self, machine: str | Path, *arguments: str) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.port = str(Path(self.folder.name) / "line")
        self.process = subprocess.Popen(
            [os.environ["HUSILLO"], "emulate", str(machine), "--link", self.port, *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def __enter__(self) -> Emulated:
        """Waits until the port is there."""
        assert self.process.stdout is not None
        self.heading = self.process.stdout.readline()
        assert self.heading, "the emulation has not started"
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.process.terminate()
        self.process.communicate()
        self.folder.cleanup()


def in_a_session(session: Callable[[Emulated], None], machine: str | Path, *arguments: str) -> None:
    """Runs a session with an emulation of its own. Tries again where a reply came too late."""
    for attempt in range(1, SESSIONS + 1):
        try:
            with Emulated(machine, *arguments) as emulated:
                return session(emulated)
        except (OSError, TimeoutError) as error:
            print(f"session {attempt}: {error}")
            if attempt == SESSIONS:
                raise
