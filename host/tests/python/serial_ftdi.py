"""The USB port object of pylabrobot, on a serial port."""

from __future__ import annotations

import os

import serial  # type: ignore[import-untyped]


class SerialFtdi:
    """Has the methods of `pylabrobot.io.ftdi.FTDI` that the centrifuge uses. The port is that of
    the variable SERIAL_PORT."""

    def __init__(self, human_readable_device_name: str, device_id: str | None = None) -> None:
        self.name = human_readable_device_name
        self.device_id = device_id or "serial port"

    async def setup(self) -> None:
        # A reading returns what is there, as that of the USB port.
        self.port = serial.Serial(os.environ["SERIAL_PORT"], timeout=0)

    async def stop(self) -> None:
        self.port.close()

    async def set_baudrate(self, baudrate: int) -> None:
        self.port.baudrate = baudrate

    async def set_line_property(self, bits: int, stopbits: int, parity: int) -> None:
        assert parity == 0
        self.port.bytesize = bits
        self.port.stopbits = stopbits

    async def set_flowctrl(self, flowctrl: int) -> None:
        assert flowctrl == 0

    async def set_latency_timer(self, latency: int) -> None:
        """A serial port has none."""

    async def set_rts(self, level: bool) -> None:
        """A pseudo-terminal has no such line."""

    async def set_dtr(self, level: bool) -> None:
        """A pseudo-terminal has no such line."""

    async def get_serial(self) -> str:
        return self.device_id

    async def write(self, data: bytes) -> int:
        return int(self.port.write(data))

    async def read(self, num_bytes: int = 1) -> bytes:
        return bytes(self.port.read(num_bytes))
