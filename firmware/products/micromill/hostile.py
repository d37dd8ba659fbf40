"""Sends random bytes, over-long lines, truncated strings and resets to the firmware.

The firmware must never hang. Before homing, the motors must stay above the switches. After homing,
they must stay within the travel. At the end, the firmware must execute a line as usual.
"""

from __future__ import annotations

import random
import time

from husillo_firmware.boards import Board
from husillo_firmware.waiting import fail

from products.micromill.link import (
    DONE,
    NO_SWITCH,
    READY,
    STEPS,
    STOPPED,
    TAKEN,
    Micromill,
    add_steps,
)

BACKLASH = (1457, 1271, 0)
TRAVEL = (71_429, 50_000, None)
FAR = 10**9
# Without `H`, `B` and `R`: this check would not know the limits of a machine that homes again, has
# another backlash or does not report all steps.
BYTES = bytes(byte for byte in range(256) if byte not in b"HBR")
STRINGS = (
    b"JX-; JX+; &X-Y-; &X+Y+Z-; PX-9999; PY+9999; FY-390; FX+390; G00X10000Y07000; G28X0Y0; S1; S0;"
    b" G01X00100Y00050F99; G02X00300Y00000I00150J00000F9999; W; V; L0100; L; Q; G54; A; G04P01;"
    b" M03S1000; M30;"
).split()
MOVES = (b"JX+;", b"&X+Y+;", b"FY+390;", b"JX-;", b"G28X0Y0;")
LAST_STEPS = 71


class Watch:
    """Tracks the positions of the motors by the reported steps."""

    def __init__(self, where: str) -> None:
        self.where, self.steps = where, 0
        self.start(False)

    def start(self, is_homed: bool) -> None:
        """Starts counting at the present position."""
        self.at, self.is_homed = [0, 0, 0], is_homed

    def hear(self, said: bytes) -> None:
        """Counts the steps and checks the position."""
        self.steps += sum(byte in STEPS for byte in said)
        add_steps(said, self.at)
        for axis, (at, backlash, travel) in enumerate(zip(self.at, BACKLASH, TRAVEL, strict=True)):
            # A motor differs from its load by at most the backlash. Before homing the switches
            # close at -400.
            low, high = -401, FAR
            if self.is_homed:
                low, high = (-backlash, travel) if travel else (-FAR, FAR)
            if not low <= at <= high:
                fail(f"{self.where}: axis {axis} at motor step {at}, homed: {self.is_homed}")


class Attack:
    """Hostile bytes for a micro mill; the same seed gives the same bytes."""

    def __init__(self, mill: Micromill, seed: int) -> None:
        self.mill, self.random = mill, random.Random(seed)
        self.where = f"{mill.board}, seed {seed}"
        self.watch = Watch(self.where)
        self.resets = 0

    def some(self) -> bytes:
        """Returns some bytes."""
        kind = self.random.randrange(8)
        if kind < 3:
            return bytes(self.random.choices(BYTES, k=self.random.randrange(1, 64)))
        if kind == 3:
            # Over-long, with a terminator or without.
            line = bytes(self.random.choices(b"0123456789GXY.-", k=self.random.randrange(60, 400)))
            return line + self.random.choice((b"", b";"))
        string = self.random.choice(STRINGS)
        if kind == 4:
            return string[: self.random.randrange(len(string))]
        if kind == 5:
            place = self.random.randrange(len(string))
            return string[:place] + bytes([self.random.choice(BYTES)]) + string[place + 1 :]
        return string

    def calm(self) -> None:
        """Stops everything and clears an incomplete string from the link."""
        for _ in range(50):
            self.mill.line.send(b"A;")
            said = self.mill.receive(2)
            # Limited, because a run continues if its `A` was lost.
            for _ in range(200):
                if not (more := self.mill.receive(0.1)):
                    break
                said += more
            self.watch.hear(said)
            # Bytes are lost if the firmware has no room for them, so the string may be repeated.
            if said:
                answer = self.mill.ask(b"S0;")
                self.watch.hear(answer)
                if answer[-1] == TAKEN:
                    return
        fail(f"{self.where}: no answer")

    def home(self) -> None:
        """Homes it. On a busy host, hostile bytes may still arrive and stop the homing."""
        for _ in range(9):
            self.calm()
            # The bytes may have requested a lease.
            self.watch.hear(self.mill.ask(b"L0000;"))
            said = self.mill.ask(b"H;", (DONE, NO_SWITCH, STOPPED))
            if said[-1] == DONE:
                self.watch.start(True)
                return
            self.watch.hear(said)
        fail(f"{self.where}: homing ended with {said[-1]:#x}")

    def send(self, burst: bytes) -> None:
        """Sends bytes in parts. Waits for the echoes of each part, unless bytes were lost.

        Otherwise QEMU would keep all bytes for which a UART has no room.
        """
        for place in range(0, len(burst), 256):
            part = burst[place : place + 256]
            self.mill.line.send(part)
            echoes, end = 0, time.monotonic() + 1
            while echoes < len(part) and time.monotonic() < end:
                if not (said := self.mill.receive(0.02)):
                    break
                self.watch.hear(said)
                echoes += sum(byte not in STEPS for byte in said)

    def move(self) -> None:
        """Moves something for a while. In virtual time this is long, and every step is reported."""
        self.mill.line.send(b"A;" + self.random.choice(MOVES))
        end = time.monotonic() + 0.02
        while time.monotonic() < end:
            self.watch.hear(self.mill.receive(0.002))
        self.mill.line.send(b"A;")

    def reset(self) -> None:
        """Resets the firmware in any state."""
        self.mill.monitor("system_reset")
        self.resets += 1
        said = self.mill.hear(READY)
        # Bytes that were sent before the reset may already have moved it.
        self.watch.start(False)
        self.watch.hear(said.rpartition(READY)[2])
        if self.random.randrange(2):
            self.home()

    def run(self, wanted: int) -> int:
        """Sends at least this many hostile bytes. Returns how many."""
        self.watch.hear(self.mill.receive(1))
        sent = 0
        self.home()
        while sent < wanted:
            burst = b"".join(self.some() for _ in range(self.random.randrange(1, 20)))
            self.send(burst)
            sent += len(burst)
            if self.random.randrange(4) == 0:
                self.move()
            if self.random.randrange(40) == 0:
                self.reset()
        self.home()
        said = self.mill.ask(b"PX+%04d;" % LAST_STEPS)
        self.watch.hear(said)
        if said[-1] != DONE or self.watch.at != [LAST_STEPS, 0, 0]:
            fail(f"{self.where}: the last steps ended with {said[-1]:#x} at {self.watch.at}")
        return sent


def check(board: Board, wanted: int, seed: int = 1) -> None:
    """Sends hostile bytes."""
    with Micromill(board) as mill:
        attack, begin = Attack(mill, seed), time.monotonic()
        sent = attack.run(wanted)
    steps, seconds = attack.watch.steps, time.monotonic() - begin
    print(f"{board}: {sent} hostile bytes, {steps} steps, {attack.resets} resets, {seconds:.0f} s")
