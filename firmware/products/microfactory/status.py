"""The status that the microfactory reports on request."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from husillo_firmware.emulated import Row
from husillo_firmware.registers import Happened, Made

from products.microfactory.pins import CLOCKS, MOTORS

ASK = 0x35
LENGTH = 21
MOVING, HOMED = 1, 2
BACKLASH = (200, 0, 200, 0)
# Positions of axes and spindle at power-on, counted from home. Home is 200 steps off the switches.
BEGIN = (220, 180, 700, 0)


class Status(NamedTuple):
    """A report: the steps made before it, its reason, flags and positions."""

    steps: int
    report: int
    flags: int
    positions: tuple[int, ...]


def positions(rows: Iterable[Row]) -> Iterator[tuple[int, ...]]:
    """Positions of loads and spindle: before the first step of the host's rows, and after each."""
    ahead, loads = list(BACKLASH), list(BEGIN)
    yield tuple(loads)
    for row in rows:
        for axis, motor in enumerate(MOTORS):
            at = ahead[axis] + row[motor]
            ahead[axis] = min(max(at, 0), BACKLASH[axis])
            loads[axis] += row[motor] if motor == "dc" else at - ahead[axis]
        if any(row[motor] for motor in MOTORS):
            yield tuple(loads)


def check(content: bytes) -> int:
    """The CRC-16 of X.25."""
    value = 0xFFFF
    for byte in content:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0x8408 if value & 1 else 0)
    return value ^ 0xFFFF


def statuses(happened: Iterable[Happened]) -> Iterator[Status]:
    """All reports among the bytes that were sent."""
    said: list[tuple[int, int]] = []
    steps = 0
    for one in happened:
        if isinstance(one, int):
            said.append((one, steps))
        elif isinstance(one, Made):
            steps += bool(one.levels & CLOCKS)
    for index in range(len(said) - LENGTH + 1):
        byte, steps = said[index]
        content = bytes(byte for byte, _ in said[index + 1 : index + LENGTH])
        if byte == ASK and check(content[:18]) == int.from_bytes(content[18:], "little"):
            yield Status(steps, content[0], content[1], struct.unpack("<4i", content[2:18]))
