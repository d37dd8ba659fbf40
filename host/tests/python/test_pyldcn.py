"""pyldcn, a client for Logosol's modules on the same line, with emulated servo modules."""

from __future__ import annotations

import struct
import time
import unittest

from emulated import Emulated, in_a_session
from pyldcn import pyldcn  # type: ignore[import-not-found]

# Kp, Kd, Ki, IL, OL, CL, EL, SR, DB: those of machines/cmm.toml.
GAINS = struct.pack("<HHHHBBHBB", 2000, 16000, 50, 8000, 255, 0, 400, 1, 0)
SERVO, IO = 0, 2
LONGEST_S = 30


class Addresses(unittest.TestCase):
    """The network as the client finds it."""

    def test_modules_of_both_kinds_are_found(self) -> None:
        def session(emulated: Emulated) -> None:
            client = pyldcn(emulated.port)
            if client.LdcnInit() != 3:
                raise OSError(f"found {client.devices}")
            found = [(d["addr"], d["modtype"], d["modver"]) for d in client.devices]
            self.assertEqual(found, [(1, SERVO, 4), (2, IO, 2), (3, SERVO, 10)])
            client.LdcnShutdown()
            self.assertEqual(client.devices, [])

        in_a_session(session, "cmm", "--modules", "servo:4,io:2,servo:10")


class Moves(unittest.TestCase):
    """A servo that the client commands and reads."""

    def test_an_axis_reaches_its_goals(self) -> None:
        def session(emulated: Emulated) -> None:
            client = pyldcn(emulated.port)
            if client.LdcnInit() != 2:
                raise OSError(f"found {client.devices}")
            # Gains, amplifier and servo, and the sticky position error.
            self.assertEqual(client.LdcnSendCmd(2, 0xE6, GAINS, nread=2)[0], 0x19)
            self.assertEqual(client.LdcnSendCmd(2, 0x17, b"\x05", nread=2)[0], 0x19)
            self.assertEqual(client.LdcnSendCmd(2, 0x0B, nread=2)[0], 0x09)
            for goal in (700, -300):
                # A trapezoid of one count a period, started now.
                load = struct.pack("<BiII", 0x97, goal, 65536, 200)
                self.assertEqual(client.LdcnSendCmd(2, 0xD4, load, nread=2)[0], 0x08)
                # The motor settles a little later than the profile ends.
                end = time.monotonic() + LONGEST_S
                while (read := status_and_position(client, 2)) not in near(goal):
                    self.assertLess(time.monotonic(), end, f"{read}, and the goal is {goal}")
            # The other one has not moved, and its servo is off.
            self.assertEqual(status_and_position(client, 1), (0x19, 0))

        in_a_session(session, "cmm", "--modules", "servo:4,servo:4")


def near(goal: int) -> list[tuple[int, int]]:
    """Status and position of an axis that stands at its goal, within a count."""
    return [(0x09, goal + off) for off in (-1, 0, 1)]


def status_and_position(client: pyldcn, address: int) -> tuple[int, int]:
    """Reads the status and the position of a module."""
    status, position, _ = struct.unpack("<BiB", client.LdcnSendCmd(address, 0x13, b"\x01", nread=6))
    return status, position


if __name__ == "__main__":
    unittest.main()
