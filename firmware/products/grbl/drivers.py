"""The firmware with TMC2209 drivers: three simulated chips take its registers from a UART."""

from __future__ import annotations

import math
import socket
from dataclasses import dataclass, field

from husillo_firmware.boards import NUCLEO_F446, Board
from husillo_firmware.qemu import free_port
from husillo_firmware.waiting import require, until

from products.grbl.link import ANSWER_S, QUIET_S, Grbl

FEATURES = "tmc2209"
SYNC = 0x05
WRITES = 0x80
DATAGRAM = 8
# Registers of the data sheet, chapter 5.
GCONF, IHOLD_IRUN, TCOOLTHRS, SGTHRS, CHOPCONF = 0x00, 0x10, 0x14, 0x40, 0x6C
SENSE_OHMS = 0.11
# UARTs of QEMU's machine between that of the link and that of the drivers.
BETWEEN = {NUCLEO_F446.name: 2}


def checksum(data: bytes) -> int:
    """The CRC of a datagram: x^8 + x^2 + x + 1, the lowest bit of each byte first (chapter 4.2)."""
    rest = 0
    for byte in data:
        for bit in range(8):
            carry = rest >> 7 ^ byte >> bit & 1
            rest = rest << 1 & 0xFF ^ (7 if carry else 0)
    return rest


@dataclass
class Chip:
    """What the firmware has written to a chip."""

    registers: dict[int, int] = field(default_factory=dict)

    def bits(self, register: int, first: int, count: int) -> int:
        """A field of a register."""
        return self.registers.get(register, 0) >> first & (1 << count) - 1

    def milliamperes(self) -> float:
        """The RMS current of the coils while the motor turns (chapter 9)."""
        volts = 0.180 if self.bits(CHOPCONF, 17, 1) else 0.325
        scale = self.bits(IHOLD_IRUN, 8, 5) + 1
        return scale / 32 * volts / (SENSE_OHMS + 0.02) / math.sqrt(2) * 1000

    def microsteps(self) -> int:
        return 256 >> self.bits(CHOPCONF, 24, 4)


class Chips:
    """Three chips at one line, which opens when the firmware listens."""

    def __init__(self, port: int) -> None:
        self.line = socket.create_connection(("127.0.0.1", port))
        self.line.settimeout(QUIET_S)
        self.chips = [Chip(), Chip(), Chip()]
        self.heard = b""

    def listen(self) -> bool:
        """Takes the datagrams that have come. Returns whether some have."""
        try:
            self.heard += self.line.recv(65536)
        except TimeoutError:
            return False
        while len(self.heard) >= DATAGRAM:
            datagram, self.heard = self.heard[:DATAGRAM], self.heard[DATAGRAM:]
            sync, address, register, *_, found = datagram
            require(sync == SYNC and register & WRITES != 0, f"no datagram: {datagram.hex()}")
            require(found == checksum(datagram[:-1]), f"wrong CRC: {datagram.hex()}")
            value = int.from_bytes(datagram[3:7], "big")
            self.chips[address].registers[register & ~WRITES] = value
        return True


def check(board: Board) -> None:
    """Changes the settings of the drivers, and compares the registers."""
    # The example of the data sheet's CRC: a reading of IOIN of chip 0.
    require(checksum(bytes((0x05, 0x00, 0x06))) == 0x6F, "the CRC itself")
    port = free_port()
    others = ["-serial", "null"] * BETWEEN.get(board.name, 0)
    line = f"tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on"
    with Grbl("grbl", board, *others, "-serial", line, features=FEATURES) as grbl:
        grbl.start()
        chips = Chips(port)
        settings = [(140, 800), (141, 1200), (142, 250), (150, 16), (151, 100), (152, 256)]
        settings += [(200, 100), (339, 1), (450, 3)]
        for number, value in settings:
            answer = grbl.ask(f"${number}={value}")
            require(answer == ["ok"], f"{board}: ${number}={value}: {answer}")
        require(grbl.ask("$140=3000") != ["ok"], f"{board}: a current beyond the range")
        require(grbl.ask("$140") == ["$140=800", "ok"], f"{board}: $140 is not kept")
        until(lambda: not chips.listen(), ANSWER_S, f"{board}: the drivers' line is not quiet")
        for chip, (_, milliamperes), (_, microsteps) in zip(
            chips.chips, settings[:3], settings[3:6], strict=True
        ):
            require(chip.bits(GCONF, 6, 2) == 0b11, f"{board}: UART and microsteps are off")
            # A step of the scale is below 60 mA, and is not exceeded.
            difference = milliamperes - chip.milliamperes()
            require(0 <= difference < 60, f"{board}: {chip.milliamperes()} mA, not {milliamperes}")
            # 100 is no power of two, so it is 64.
            power = 1 << microsteps.bit_length() - 1
            require(chip.microsteps() == power, f"{board}: {chip.microsteps()} microsteps")
        spread = [chip.bits(GCONF, 2, 1) for chip in chips.chips]
        require(spread == [0, 0, 1], f"{board}: SpreadCycle of {spread}")
        stall = [(chip.registers[SGTHRS], chip.registers[TCOOLTHRS]) for chip in chips.chips]
        require(stall == [(100, 0xFFFFF), (0, 0), (0, 0)], f"{board}: StallGuard {stall}")
        print(f"{board}: the registers of three TMC2209 are those of the settings")
