"""Tests that every wait ends, either with its condition or with an error."""

from __future__ import annotations

import subprocess
import sys
import unittest

from husillo_firmware.waiting import Lines, until


class Until(unittest.TestCase):
    """Waits for a condition."""

    def test_ends_when_the_condition_is_true(self) -> None:
        looks = iter([False, False, True])
        until(lambda: next(looks), 10, "no third look")
        self.assertIsNone(next(looks, None))

    def test_fails_with_the_name_of_the_condition(self) -> None:
        with self.assertRaisesRegex(SystemExit, "no port within"):
            until(lambda: False, 0.05, "no port")


class OutputLines(unittest.TestCase):
    """Waits for a line of a process."""

    def said(self, code: str) -> Lines:
        process = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return Lines(process)

    def test_lines_come_one_by_one(self) -> None:
        lines = self.said("print('one\\ntwo')")
        self.assertEqual([lines.next(10), lines.next(10)], ["one", "two"])

    def test_silence_and_an_end_are_errors(self) -> None:
        with self.assertRaisesRegex(SystemExit, "says nothing within"):
            self.said("import time; time.sleep(60)").next(0.05)
        with self.assertRaisesRegex(SystemExit, "has ended"):
            self.said("").next(10)


if __name__ == "__main__":
    unittest.main()
