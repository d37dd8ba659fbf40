"""Senders of Grbl against `husillo emulate grbl`: grbl-streamer and pygrbl-streamer."""

from __future__ import annotations

import threading
import time
import unittest
from pathlib import Path

import serial  # type: ignore[import-untyped]
from emulated import Emulated, spiral
from grbl_streamer import GrblStreamer as Streamer  # type: ignore[import-not-found]
from pygrbl_streamer import GrblStreamer as PyStreamer  # type: ignore[import-not-found]

LINES = 2000
# Several seconds of motion in one of real time.
SPEED = "8"


def prepared(port: str) -> None:
    """Sets rates and ramps of a usual mill."""
    with serial.Serial(port, 115200, timeout=5) as line:
        line.write(b"\x18")
        time.sleep(0.5)
        line.reset_input_buffer()
        for number in (110, 111, 112, 120, 121, 122):
            value = 3000 if number < 120 else 300
            line.write(f"${number}={value}\n".encode())
            assert line.readline() == b"ok\r\n"


def position(port: str) -> bytes:
    """The status report at rest."""
    with serial.Serial(port, 115200, timeout=5) as line:
        line.reset_input_buffer()
        line.write(b"?")
        return bytes(line.readline())


class Senders(unittest.TestCase):
    """Each streams a program to its end, without an error."""

    def test_grbl_streamer(self) -> None:
        """Streams by counting characters, holds, resumes and polls reports."""
        with Emulated("grbl", "--speed", SPEED) as emulated:
            prepared(emulated.port)
            events: list[tuple[str, tuple[object, ...]]] = []
            done = threading.Event()

            def called(event: str, *data: object) -> None:
                events.append((event, data))
                if event == "on_job_completed":
                    done.set()

            grbl = Streamer(called)
            grbl.cnect(emulated.port, 115200)
            time.sleep(1)
            grbl.poll_start()
            grbl.incremental_streaming = False
            grbl.write(spiral(LINES))
            grbl.job_run()
            time.sleep(1)
            grbl.hold()
            time.sleep(0.5)
            grbl.resume()
            self.assertTrue(done.wait(240), [name for name, _ in events[-20:]])
            time.sleep(1)
            grbl.poll_stop()
            grbl.disconnect()
            names = [name for name, _ in events]
            self.assertNotIn("on_error", names)
            self.assertNotIn("on_alarm", names)
            self.assertIn("on_job_completed", names)
            self.assertIn("on_stateupdate", names)
            self.assertIn(b"MPos:3.000,4.000,0.000", position(emulated.port))

    def test_pygrbl_streamer(self) -> None:
        """Streams a file by counting characters and waits for Idle."""
        with Emulated("grbl", "--speed", SPEED) as emulated:
            prepared(emulated.port)
            file = Path(emulated.folder.name) / "spiral.nc"
            file.write_text(spiral(LINES))
            errors: list[str] = []
            grbl = PyStreamer(emulated.port, 115200)
            grbl.error_callback = errors.append
            grbl.connect()
            self.assertTrue(grbl.send_file(str(file)))
            grbl.disconnect()
            self.assertEqual(errors, [])
            self.assertIn(b"MPos:3.000,4.000,0.000", position(emulated.port))


if __name__ == "__main__":
    unittest.main()
