"""The centrifuge of pylabrobot: a servo module, and a module with inputs and outputs."""

from __future__ import annotations

import asyncio
import os
import unittest
from pathlib import Path
from typing import Any

import pylabrobot.centrifuge.vspin_backend as vspin  # type: ignore[import-not-found]
from emulated import Emulated, in_a_session
from serial_ftdi import SerialFtdi

MACHINE = Path(__file__).parent / "centrifuge.toml"
# Where centrifuge.toml has the index mark.
INDEX = 1000
LONGEST_S = 120
# As near as the client itself wants to be.
NEAR = 10


class Centrifuge(unittest.TestCase):
    """The client as it is; only its port is another one."""

    def setUp(self) -> None:
        vspin.FTDI = SerialFtdi

    def session(self, wanted: Any) -> None:
        """Sets the centrifuge up, and has it do what is wanted.

        The client sends Set Address three times after a reset, then once more, and expects that
        the fourth one is the first to be heard. Modules that are deaf for 100 ms hear that one.
        """

        async def run() -> None:
            centrifuge = vspin.VSpinBackend("emulated")
            await centrifuge.setup()
            await wanted(centrifuge)
            await centrifuge.stop()

        def on_the_line(emulated: Emulated) -> None:
            os.environ["SERIAL_PORT"] = emulated.port
            asyncio.run(asyncio.wait_for(run(), LONGEST_S))

        arguments = ["--modules", "servo:4,io:2", "--reset-ms", "100"]
        in_a_session(on_the_line, MACHINE, *arguments)

    def test_it_homes_and_reaches_its_buckets(self) -> None:
        async def wanted(centrifuge: vspin.VSpinBackend) -> None:
            self.assertEqual(await centrifuge.get_home_position(), INDEX)
            self.assertFalse(await centrifuge.get_door_open())
            self.assertTrue(await centrifuge.get_door_locked())
            await centrifuge.set_bucket_1_position_to_current()
            for half, go in enumerate([centrifuge.go_to_bucket1, centrifuge.go_to_bucket2]):
                goal = await centrifuge.get_bucket_1_position() + half * vspin.FULL_ROTATION // 2
                await go()
                # It passes the place within the tolerance of the client, and stands there later.
                await asyncio.sleep(2)
                self.assertLessEqual(abs(await centrifuge.get_position() - goal), NEAR)
                self.assertTrue(await centrifuge.get_door_open())

        self.session(wanted)

    def test_it_spins_and_finds_its_home_again(self) -> None:
        async def wanted(centrifuge: vspin.VSpinBackend) -> None:
            await centrifuge.spin(g=5, duration=1)
            # It counts from where it was reset, on its way to the index mark.
            home = await centrifuge.get_home_position()
            self.assertTrue(0 < home <= vspin.FULL_ROTATION, home)
            await centrifuge.lock_bucket()
            self.assertTrue(await centrifuge.get_bucket_locked())

        self.session(wanted)


if __name__ == "__main__":
    unittest.main()
