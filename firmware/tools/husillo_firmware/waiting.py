"""Waits for conditions, always with a time limit."""

from __future__ import annotations

import os
import select
import subprocess
import time
from collections.abc import Callable
from typing import IO, NoReturn

# Time between two checks of a condition.
LOOK_S = 0.01


def fail(what: str) -> NoReturn:
    """Ends the check as failed."""
    raise SystemExit(what)


def require(is_true: bool, what: object) -> None:
    """Ends the check if a condition is false."""
    if not is_true:
        fail(str(what))


def until(is_so: Callable[[], bool], seconds: float, what: str) -> None:
    """Waits until a condition is true. Fails with `what` if that takes too long."""
    end = time.monotonic() + seconds
    while not is_so():
        if time.monotonic() > end:
            fail(f"{what} within {seconds} s")
        time.sleep(LOOK_S)


def settled(count: Callable[[], int], quiet_s: float, seconds: float, what: str) -> int:
    """The count once it stays the same for `quiet_s`. Fails with `what` if it goes on."""
    counts = [-1]

    def is_quiet() -> bool:
        time.sleep(quiet_s)
        counts.append(count())
        return counts[-1] == counts[-2]

    until(is_quiet, seconds, what)
    return counts[-1]


class Lines:
    """Reads the output lines of a process."""

    def __init__(self, process: subprocess.Popen[bytes]) -> None:
        self.process = process
        self.pipe = pipe_of(process.stdout)
        self.begun = b""

    def next(self, seconds: float) -> str:
        """The next line, without its end. Fails if none comes within that time."""
        end = time.monotonic() + seconds
        while b"\n" not in self.begun:
            left = end - time.monotonic()
            if left < 0 or not select.select([self.pipe], [], [], left)[0]:
                fail(f"{self.process.args!r} says nothing within {seconds} s")
            more = os.read(self.pipe.fileno(), 65536)
            if not more:
                fail(f"{self.process.args!r} has ended")
            self.begun += more
        line, _, self.begun = self.begun.partition(b"\n")
        return line.decode(errors="replace").strip()


def pipe_of(pipe: IO[bytes] | None) -> IO[bytes]:
    """The pipe of a process that was started with one."""
    assert pipe is not None, "the process was started with a pipe"
    return pipe
