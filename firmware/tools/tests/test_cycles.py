"""Tests of the table of cycles: whole and broken outputs, and a board at a serial port."""

from __future__ import annotations

import contextlib
import io
import os
import tempfile
import threading
import unittest
from pathlib import Path

from proofs.cycles import table

OUTPUT = "\r\n".join(
    ["husillo cycles 1", "counter DWT", "mhz 84.00", "line_2_axes 22.10", "arc_dda over", "end", ""]
)


class Parsing(unittest.TestCase):
    def test_a_whole_table(self) -> None:
        (found,) = table.parse(OUTPUT.splitlines())
        self.assertEqual((found.counter, found.mhz), ("DWT", 84.0))
        self.assertEqual(found.cycles, {"line_2_axes": 22.1, "arc_dda": float("inf")})

    def test_a_table_without_its_end_or_its_beginning_is_none(self) -> None:
        lines = OUTPUT.splitlines()
        self.assertEqual(list(table.parse(lines[:-1])), [])
        self.assertEqual(list(table.parse(lines[1:])), [])
        # A reset in between: only the second one is whole.
        self.assertEqual(len(list(table.parse(lines[:-1] + lines))), 1)

    def test_the_least_of_some_tables(self) -> None:
        later = OUTPUT.replace("22.10", "21.90")
        both = list(table.parse((OUTPUT + later).splitlines()))
        self.assertEqual(table.least(both).cycles["line_2_axes"], 21.9)


class Printing(unittest.TestCase):
    def printed(self, *arguments: str) -> str:
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            self.assertEqual(table.main(list(arguments)), 0)
        return said.getvalue()

    def test_the_expectation_of_a_board(self) -> None:
        counts = table.instructions("thumbv6m")
        row = next(
            line.split() for line in self.printed("pico").splitlines() if "line_2_axes" in line
        )
        self.assertEqual(float(row[1]), counts["line_2_axes"])
        self.assertAlmostEqual(float(row[2]), 1.5 * counts["line_2_axes"], places=1)

    def test_a_saved_output(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "output.txt"
            path.write_text(OUTPUT)
            said = self.printed(str(path), "--board", "nucleo_f401")
        count = table.instructions("thumbv7em")["line_2_axes"]
        self.assertIn("measured by DWT at 84.00 MHz", said)
        row = next(line.split() for line in said.splitlines() if line.startswith("line_2_axes"))
        self.assertEqual(row[3:], ["22.10", f"{22.1 / count:.2f}", f"{22.1 / 84:.2f}"])


class Port(unittest.TestCase):
    def test_a_board_at_a_serial_port_prints_a_table_for_each_byte(self) -> None:
        board, port = os.openpty()

        def answer() -> None:
            for _ in range(table.TABLES):
                os.read(board, 1)
                # In pieces, as USB has them.
                for at in range(0, len(OUTPUT), 7):
                    os.write(board, OUTPUT[at : at + 7].encode())

        thread = threading.Thread(target=answer)
        thread.start()
        output = table.measured(os.ttyname(port))
        thread.join()
        os.close(board)
        os.close(port)
        self.assertEqual(len(list(table.parse(output.splitlines()))), table.TABLES)


if __name__ == "__main__":
    unittest.main()
