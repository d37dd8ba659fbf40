"""The microfactory's pins: CLOCK and CW/CCW of four L297, their ENABLE and RESET."""

from __future__ import annotations

from collections.abc import Iterable

from husillo_firmware.boards import Board
from husillo_firmware.emulated import Row
from husillo_firmware.registers import Happened, Made, Switched, clocks_per_us
from husillo_firmware.waiting import require

MOTORS = ("dx", "dy", "dz", "dc")
CLOCKS, ENABLE, NOT_RESET = 0xF, 0b01, 0b10
# How long CLOCK is high.
PULSE_US = 10


class Pins:
    """Converts the host's rows, in order, to levels and outputs. Directions persist."""

    def __init__(self) -> None:
        self.directions = 0

    def __call__(self, row: Row) -> tuple[int, int]:
        clocks = 0
        for axis, motor in enumerate(MOTORS):
            if row[motor]:
                clocks |= 1 << axis
                self.directions = self.directions & ~(1 << axis) | (row[motor] > 0) << axis
        outputs = row["current"] * ENABLE | (not row["reset"]) * NOT_RESET
        return clocks | self.directions << 4, outputs


def events(board: Board, happened: Iterable[Happened]) -> list[Made | Switched]:
    """The steps that had a wait, and the changes of the current.

    CLOCK rises with a step and falls in a separate interrupt. If that interrupt is late, all later
    events are late by the same time, so this time is subtracted. Between two events, the directions
    are already those of the next event.
    """
    found: list[Made | Switched] = []
    before: Made | None = None
    outputs = late = 0
    pulse = PULSE_US * clocks_per_us(board)
    for one in happened:
        if isinstance(one, Switched):
            if (one.outputs ^ outputs) & ENABLE:
                found.append(one)
            outputs = one.outputs
        elif isinstance(one, Made):
            if one.due is None:
                require(not one.levels & CLOCKS, "a CLOCK rises without a wait")
            elif before and before.levels & CLOCKS and before.due is not None:
                longer = (one.due - before.due) % 2**32 - pulse
                is_long = longer == 0 or (longer > 0 and one.is_late(board))
                require(is_long and not one.levels & CLOCKS, "a CLOCK is not high for its time")
                late += longer
                is_kept = one.levels >> 4 == before.levels >> 4
                require(is_kept, "a direction changes with the fall of CLOCK")
            else:
                is_ready = not before or before.levels >> 4 == one.levels >> 4
                require(is_ready, "a direction changes together with its CLOCK")
                found.append(one.earlier(late))
            before = one
    return found
