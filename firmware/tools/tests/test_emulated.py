"""Tests the comparison of a firmware's events with those of the host. Waits must be exact."""

from __future__ import annotations

import unittest

from husillo_firmware.boards import ALL, Board
from husillo_firmware.emulated import FOREGROUND_US, Row, compare
from husillo_firmware.registers import Made, clocks_per_us

from products.microfactory import pins

WAITS_US = (2500, 54, 2446)
# The 32-bit clock wraps within the second wait.
BEGIN_US = 2**32 - 2520
# The time from the request of a wait to its end, if the foreground is in time.
AHEAD_US = 40


def rows() -> list[Row]:
    """A step of one axis after each wait, as in the host's file. The first is not compared."""
    found: list[Row] = []
    t_us = 1_000_000
    for wait_us in WAITS_US:
        t_us += wait_us
        found.append({"event": len(found), "t_us": t_us, "wait_ticks": wait_us, "dx": 1})
    return found


def levels(row: Row) -> tuple[int, int]:
    """Levels and outputs of a row."""
    return row["dx"], 0


def made(board: Board, waits_us: list[tuple[int, int]]) -> list[Made]:
    """Steps made of pairs: the wait, and how long before its end the wait was requested."""
    clocks = clocks_per_us(board)
    at = BEGIN_US * clocks
    found: list[Made] = []
    for wait_us, left_us in waits_us:
        at += wait_us * clocks
        found.append(Made(1, 0, at % 2**32, (at - left_us * clocks) % 2**32))
    return found


def pulses(board: Board, high_us: int, left_us: int) -> list[Made]:
    """Two steps with a CLOCK of this length. Without delays, 2446 us pass from rise to rise."""
    clocks = clocks_per_us(board)
    times = ((0, AHEAD_US), (high_us, left_us), (2446 - pins.PULSE_US, AHEAD_US))
    at = 0
    found: list[Made] = []
    for level, (wait_us, left) in zip((1, 0, 1), times, strict=True):
        at += wait_us * clocks
        found.append(Made(level, 0, at, (at - left * clocks) % 2**32))
    return found


class Waits(unittest.TestCase):
    """Compares waits of a firmware with those of the host."""

    def compared(self, board: Board, *waits_us: tuple[int, int]) -> int:
        return compare(board, made(board, [(2500, AHEAD_US), *waits_us]), rows(), levels, 0)

    def test_equal_waits_are_right(self) -> None:
        for board in ALL:
            self.assertEqual(self.compared(board, (54, AHEAD_US), (2446, AHEAD_US)), 3)

    def test_a_microsecond_more_or_less_is_wrong(self) -> None:
        for board in ALL:
            for wait_us in (2445, 2447):
                with self.assertRaisesRegex(SystemExit, f"row 3.* wait: {wait_us}.* of 2446"):
                    self.compared(board, (54, AHEAD_US), (wait_us, AHEAD_US))
            for wait_us in (53, 55):
                with self.assertRaisesRegex(SystemExit, "row 2"):
                    self.compared(board, (wait_us, AHEAD_US), (2446, AHEAD_US))

    def test_a_wait_that_has_passed_ends_at_once(self) -> None:
        for board in ALL:
            self.assertEqual(self.compared(board, (90, 2), (2446, AHEAD_US)), 3)

    def test_no_wait_is_late_by_more_than_the_foreground_takes(self) -> None:
        for board in ALL:
            with self.assertRaisesRegex(SystemExit, "row 2"):
                self.compared(board, (FOREGROUND_US, 2), (2446, AHEAD_US))


class Pulses(unittest.TestCase):
    """Checks CLOCK of the microfactory."""

    def since_us(self, board: Board, high_us: int, left_us: int) -> float:
        """The time from one rise of CLOCK to the next."""
        first, second = pins.events(board, pulses(board, high_us, left_us))
        assert isinstance(first, Made) and isinstance(second, Made)
        assert first.due is not None and second.due is not None
        return (second.due - first.due) / clocks_per_us(board)

    def test_a_late_fall_delays_the_next_rise(self) -> None:
        for board in ALL:
            self.assertEqual(self.since_us(board, pins.PULSE_US, 6), 2446)
            self.assertEqual(self.since_us(board, pins.PULSE_US + 2, 2), 2446)

    def test_a_pulse_of_another_length_without_a_delay_is_wrong(self) -> None:
        for board in ALL:
            for high_us, left_us in ((9, 6), (9, 1), (11, 6)):
                with self.assertRaisesRegex(SystemExit, "not high for its time"):
                    self.since_us(board, high_us, left_us)


if __name__ == "__main__":
    unittest.main()
