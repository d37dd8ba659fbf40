"""What the microfactory tells of itself when it is asked."""
import struct

from pins import CLOCKS, MOTORS

ASK = 0x35
MOVING, HOMED = 1, 2
LASH = (200, 0, 200, 0)
# From home, 200 steps off the switches, to where axes and spindle stand at first.
BEGIN = (220, 180, 700, 0)


def places(rows):
    """Where loads and spindle are before the first step of the host's rows and after each."""
    ahead, loads = list(LASH), list(BEGIN)
    yield tuple(loads)
    for row in rows:
        for axis, motor in enumerate(MOTORS):
            at = ahead[axis] + row[motor]
            ahead[axis] = min(max(at, 0), LASH[axis])
            loads[axis] += row[motor] if motor == "dc" else at - ahead[axis]
        if any(row[motor] for motor in MOTORS):
            yield tuple(loads)


def check(content):
    """CRC-16 of X.25."""
    value = 0xFFFF
    for byte in content:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0x8408 if value & 1 else 0)
    return value ^ 0xFFFF


def statuses(happened):
    """What was told: how many steps had been made, report, flags, place."""
    said, steps = [], 0
    for one in happened:
        if isinstance(one, int):
            said.append((one, steps))
        else:
            steps += bool(getattr(one, "levels", 0) & CLOCKS)
    for index in range(len(said) - 20):
        byte, steps = said[index]
        content = bytes(byte for byte, _ in said[index + 1:index + 21])
        if byte == ASK and check(content[:18]) == int.from_bytes(content[18:], "little"):
            yield steps, content[0], content[1], struct.unpack("<4i", content[2:18])
