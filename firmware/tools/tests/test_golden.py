"""Tests the golden comparison: which figures may change, and by how much."""

from __future__ import annotations

import tempfile
import unittest
from pathlib import Path

from husillo_firmware.build import FIRMWARE, compiler
from husillo_firmware.golden import Columns, Lines, differences, settle


class Differences(unittest.TestCase):
    """Differences between figures and golden figures."""

    def test_two_percent_up_or_down_is_the_limit(self) -> None:
        for now in (980, 1000, 1020):
            self.assertEqual(differences({"flash": 1000}, {"flash": now}), [])
        for now in (979, 1021):
            self.assertEqual(len(differences({"flash": 1000}, {"flash": now})), 1, now)

    def test_steps_are_exact(self) -> None:
        golden = {"microbit steps": 30281.0}
        self.assertEqual(differences(golden, {"microbit steps": 30281}), [])
        said = differences(golden, {"microbit steps": 30282})
        self.assertEqual(said, ["microbit steps: 30282 instead of 30281"])

    def test_zero_stays_zero(self) -> None:
        self.assertEqual(len(differences({"static": 0}, {"static": 1})), 1)

    def test_a_figure_that_is_missing_or_new_is_a_difference(self) -> None:
        said = differences({"old": 1}, {"new": 1})
        self.assertEqual(said, ["old is gone", "new 1 is not in the golden file"])


class Forms(unittest.TestCase):
    """Golden files are read as they were written."""

    def test_lines(self) -> None:
        figures = {"microbit count line": 22555.0, "basic bytes Modal<3>": 328.0}
        text = "microbit count line 22555\nbasic bytes Modal<3> 328\n"
        self.assertEqual(Lines.text(figures), text)
        self.assertEqual(Lines.figures(text), figures)

    def test_columns_with_a_kernel_that_one_target_lacks(self) -> None:
        figures = {"pid thumbv7em": 36.02, "pid thumbv6m": 146.02, "line thumbv6m": 25.0}
        text = Columns.text(figures)
        self.assertEqual(text.splitlines()[2].split(), ["line", "-", "25.00"])
        self.assertEqual(Columns.figures(text), figures)


class Writing(unittest.TestCase):
    """The file is renewed for what was measured."""

    def test_figures_of_boards_that_were_not_measured_stay(self) -> None:
        with tempfile.TemporaryDirectory(dir=FIRMWARE) as folder:
            path = Path(folder) / "golden.txt"
            path.write_text(f"{compiler()}\nvirt flash 10\nnucleo flash 20\n")
            settle(path, Lines, {"virt flash": 11}, True, lambda row: row.startswith("virt"))
            self.assertEqual(path.read_text(), f"{compiler()}\nvirt flash 11\nnucleo flash 20\n")


if __name__ == "__main__":
    unittest.main()
