"""An emergency stop during homing.

The events before it must equal those of the host's emulated machine. After it, at most the step in
progress may be made, and the current must be switched off.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from husillo_firmware import host, registers
from husillo_firmware.boards import Board
from husillo_firmware.emulated import Emulated, compare
from husillo_firmware.qemu import Firmware
from husillo_firmware.registers import Happened, Made, Switched
from husillo_firmware.waiting import fail, require, until

from products.microfactory import pins
from products.microfactory.status import ASK, LENGTH

HOME, EMERGENCY, REJECTED = b"H!?"
# Steps that may already be in progress at the stop.
AHEAD = 1
# The stop is sent after more than this number of steps.
BEGUN = 3
# On a busy computer, homing may end before the stop is sent. Then the check is repeated.
TRIES = 5
ANSWER_S = 60


class Line(Firmware):
    """The microfactory in QEMU, and its answers."""

    def ask(self, byte: int, length: int = 1) -> bytes:
        """Sends a byte. Returns the answer."""
        self.line.sendall(bytes([byte]))
        said = b""
        while len(said) < length:
            more = self.receive(ANSWER_S)
            if not more:
                fail(f"{self.board}: no answer to {byte:#x}")
            said += more
        return said


def stopped(board: Board, log: Path) -> list[Happened]:
    """Starts homing and stops it. Returns everything that happened."""

    def happened() -> list[Happened]:
        return registers.read_file(board, log, with_outputs=True)

    line = Line("microfactory", board, *registers.ACCESSES, "-D", str(log))
    with line:
        line.connect()
        line.booted()
        require(line.ask(HOME) == bytes([HOME]), f"{board}: it does not home")
        until(lambda: len(pins.events(board, happened())) > BEGUN, ANSWER_S, f"{board}: no step")
        require(line.ask(EMERGENCY) == bytes([EMERGENCY]), f"{board}: no emergency stop")
        report, flags = line.ask(ASK, LENGTH)[1:3]
        if (report, flags) != (EMERGENCY, 0):
            fail(f"{board}: report {report:#x}, flags {flags} after an emergency stop")
        if line.ask(HOME) != bytes([REJECTED]):
            fail(f"{board}: it homes after an emergency stop")
        # These bytes take as long on the line as several steps of the motors.
        line.ask(ASK, LENGTH)
        line.ask(ASK, LENGTH)
        # The current is switched off after the step that is still waiting for its time.
        still = f"{board}: the current is on after an emergency stop"
        until(lambda: is_off(pins.events(board, happened())[-1]), ANSWER_S, still)
    return happened()


def is_off(one: Made | Switched) -> bool:
    """Whether this event switches the current off."""
    return isinstance(one, Switched) and not one.outputs & pins.ENABLE


def check(board: Board) -> None:
    """Stops the firmware during homing and checks its pins."""
    with tempfile.TemporaryDirectory() as path:
        folder = Path(path)
        with Emulated("microfactory", folder, 200) as emulated:
            to = ("-m", "microfactory", "--port", emulated.link)
            host.says("jog", *to, *host.IN_VIRTUAL_TIME, "home")
        rows = emulated.rows()
        for _ in range(TRIES):
            happened = stopped(board, folder / "log")
            made = pins.events(board, happened)
            if len(made) < len(rows):
                break
        else:
            fail(f"{board}: every emergency stop came after homing")
    *made, end = made
    compare(board, made, rows, pins.Pins(), pins.NOT_RESET, pins.ENABLE)
    if not is_off(end):
        fail(f"{board}: the current is on after an emergency stop")
    late = pins.events(board, happened[happened.index(EMERGENCY) :])
    if len(late) > AHEAD + 1:
        fail(f"{board}: {len(late) - 1} steps after an emergency stop")
    print(f"{board}: stopped permanently after {len(made)} of {len(rows)} events")
