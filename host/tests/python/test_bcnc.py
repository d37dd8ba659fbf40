"""bCNC, in a window on a virtual screen, with `husillo emulate grbl`. Its web pendant drives it."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.parse
import urllib.request
from collections.abc import Callable
from pathlib import Path
from types import TracebackType

from emulated import Emulated, in_a_session, spiral

LINES = 10_000
# Several seconds of motion in one of real time.
SPEED = "8"
# A computer that is busy with other work needs longer than the machine does.
PATIENCE_S = 120.0
Vector = tuple[float, float, float]


def free_port() -> int:
    """A port that nobody uses."""
    with socket.socket() as line:
        line.bind(("127.0.0.1", 0))
        return int(line.getsockname()[1])


class Sender:
    """bCNC with a home folder of its own."""

    def __init__(self, port: str) -> None:
        self.home = tempfile.TemporaryDirectory()
        self.pendant = free_port()
        settings = Path(self.home.name) / ".bCNC"
        settings.write_text(
            "[Connection]\ncontroller = GRBL1\nbaud = 115200\n"
            f"port = {port}\nopenserial = 1\npendant = 1\npendantport = {self.pendant}\n"
            "[bCNC]\ncheckinterval = 100000\n"
        )
        self.process = subprocess.Popen(
            ["xvfb-run", "-a", "-s", "-screen 0 1280x900x24", sys.executable, "-m", "bCNC"],
            env={**os.environ, "HOME": self.home.name},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def __enter__(self) -> Sender:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        os.killpg(self.process.pid, 15)
        self.process.wait()
        self.home.cleanup()

    def _get(self, path: str) -> bytes:
        with urllib.request.urlopen(f"http://127.0.0.1:{self.pendant}{path}", timeout=20) as page:
            return bytes(page.read())

    def state(self) -> dict[str, object]:
        """The state, as the pendant's page shows it."""
        state: dict[str, object] = json.loads(self._get("/state"))
        return state

    def send(self, **what: str) -> None:
        """A `gcode` line, or a `cmd` of bCNC's command line."""
        self._get("/send?" + urllib.parse.urlencode(what))

    def until(self, what: str, holds: Callable[[dict[str, object]], bool]) -> dict[str, object]:
        """Waits for a state."""
        end = time.monotonic() + PATIENCE_S
        state: dict[str, object] = {}
        while time.monotonic() < end:
            try:
                state = self.state()
            except OSError:
                state = {}
            if state and holds(state):
                return state
            time.sleep(0.1)
        raise TimeoutError(f"{what} did not happen: {state}")

    def idle_at(self, wanted: Vector) -> None:
        """Waits until the mill stands at this position of the work."""

        def holds(state: dict[str, object]) -> bool:
            at = [float(str(state[name])) for name in ("wx", "wy", "wz")]
            near = all(abs(a - b) < 0.011 for a, b in zip(at, wanted, strict=True))
            return near and state["state"] == "Idle"

        self.until(f"Idle at {wanted}", holds)

    def until_state(self, name: str) -> None:
        """Waits for the name of a state."""
        self.until(name, lambda state: str(state["state"]).upper().startswith(name.upper()))


def say(step: str, answer: str) -> None:
    """A line of the transcript."""
    print(f"{step:<34} {answer}", flush=True)


def session(emulated: Emulated) -> None:
    """Homes, jogs, probes, resets in motion, and streams 10,000 lines with a hold."""
    with Sender(emulated.port) as sender:
        sender.until_state("Idle")
        say("open", "Idle")
        for number in (110, 111, 112, 120, 121, 122):
            sender.send(gcode=f"${number}={3000 if number < 120 else 300}")
        sender.send(gcode="$22=1")
        sender.send(cmd="HOME")
        # Homed, the mill is 1 mm inside of its switches.
        sender.until("homing", lambda state: state["state"] == "Idle" and state["mx"] == -1.0)
        state = sender.state()
        say("HOME", f"Idle at {state['mx']} {state['my']} {state['mz']}")
        sender.send(cmd="SET0")
        sender.idle_at((0, 0, 0))
        sender.send(gcode="$J=G91 G21 X-25 Y-12.5 F2000")
        sender.idle_at((-25, -12.5, 0))
        say("$J=G91 G21 X-25 Y-12.5 F2000", "Idle at -25 -12.5 0")
        sender.send(gcode="G38.2 Z-40 F200")
        state = sender.until(
            "contact", lambda state: state["state"] == "Idle" and float(str(state["wz"])) < -1
        )
        assert float(str(state["wz"])) > -39, state
        say("G38.2 Z-40 F200", f"Idle at {state['wz']}")
        sender.send(cmd="SET0")
        sender.idle_at((0, 0, 0))
        sender.send(gcode="G0 Z5")
        sender.idle_at((0, 0, 5))

        # The program is the last step, because bCNC resets the controller after a program.
        sender.send(gcode="G1 X-60 F500")
        sender.until_state("Run")
        sender.send(cmd="RESET")
        sender.until_state("Alarm")
        say("G1 X-60 F500, RESET in motion", str(sender.state()["state"]))
        sender.send(cmd="UNLOCK")
        sender.until_state("Idle")
        say("UNLOCK", "Idle")
        sender.send(cmd="SET0")
        sender.idle_at((0, 0, 0))

        program = Path(emulated.folder.name) / "spiral.nc"
        program.write_text(spiral(LINES))
        sender.send(cmd=f"LOAD {program}")
        sender.send(cmd="RUN")
        sender.until_state("Run")
        sender.send(cmd="FEEDHOLD")
        sender.until_state("Hold")
        say("RUN, FEEDHOLD", str(sender.state()["state"]))
        sender.send(cmd="RESUME")
        sender.until_state("Run")
        sender.idle_at((3, 4, 0))
        say("RESUME, to the end", "Idle at 3 4 0")


@unittest.skipUnless(shutil.which("xvfb-run"), "xvfb is not installed")
class InItsWindow(unittest.TestCase):
    """The window of bCNC drives an emulated mill."""

    def test_a_session(self) -> None:
        """bCNC waits for ever for an answer that reaches it in parts more than 100 ms apart."""
        in_a_session(session, "grbl", "--speed", SPEED)
