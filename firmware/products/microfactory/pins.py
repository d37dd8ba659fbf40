"""The microfactory's pins: CLOCK and CW/CCW of four L297, their ENABLE and RESET."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../board"))
import registers  # noqa: E402

MOTORS = ("dx", "dy", "dz", "dc")
CLOCKS, ENABLE, NOT_RESET = 0xF, 0b01, 0b10


class Pins:
    """Levels and outputs of one row of the host's after the other: directions stay."""

    def __init__(self):
        self.ways = 0

    def __call__(self, row):
        clocks = 0
        for axis, motor in enumerate(MOTORS):
            if row[motor]:
                clocks |= 1 << axis
                self.ways = self.ways & ~(1 << axis) | (row[motor] > 0) << axis
        return clocks | self.ways << 4, row["current"] * ENABLE | (not row["reset"]) * NOT_RESET


def events(happened):
    """What was waited for, and the current when it is switched.

    CLOCK rises with a step and falls in an interrupt of its own. Between two events directions are as they will be.
    """
    found, before, outputs = [], None, 0
    for one in happened:
        if isinstance(one, registers.Switched):
            if (one.outputs ^ outputs) & ENABLE:
                found.append(one)
            outputs = one.outputs
        elif not isinstance(one, int):
            if one.due is None:
                assert not one.levels & CLOCKS, "a CLOCK rises unasked"
            elif before and before.levels & CLOCKS:
                assert not one.levels & CLOCKS and one.due != before.due, "a CLOCK is not high for its time"
                assert one.levels >> 4 == before.levels >> 4, "a direction changes with the fall of CLOCK"
            else:
                is_ready = not before or not before.levels & CLOCKS and before.levels >> 4 == one.levels >> 4
                assert is_ready, "a CLOCK has not fallen, or its direction comes with it"
                found.append(one)
            before = one
    return found
