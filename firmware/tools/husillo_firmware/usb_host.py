"""The USB controller of an RP2040 or RP2350, and a host that opens the serial port of the device.

The host checks the number of each packet, DATA0 or DATA1. A step of one of its generators is a
moment at which it waits.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, field

MEMORY_BYTES = 4096
# Registers, from their beginning.
ADDRESS, CONTROL, STATUS, DONE, STALL, ENABLE, INTERRUPTS = 0, 0x4C, 0x50, 0x58, 0x68, 0x90, 0x98
IS_ATTACHED = 1 << 16
WAS_RESET, HAS_SETUP = 1 << 19, 1 << 17
# Bits of the register of a buffer.
AVAILABLE, FULL, LENGTH = 1 << 10, 1 << 15, 0x3FF
IN, OUT = 0, 1
# The packets of endpoint 0 in the descriptor of the device, and those of the data.
PACKET_BYTES_OF_0, PACKET_BYTES = 8, 64
OWN_ADDRESS = 7
# A request without data has this answer.
OBEYED = b"obeyed"


@dataclass
class Usb:
    """The controller with its host."""

    to_chip: bytearray
    to_host: bytearray
    is_open: bool = True
    memory: bytearray = field(default_factory=lambda: bytearray(MEMORY_BYTES))
    registers: dict[int, int] = field(default_factory=dict)
    configuration: bytes = b""

    def __post_init__(self) -> None:
        self.host = self.enumerates()

    def read(self, offset: int) -> int:
        """A register."""
        if offset != INTERRUPTS:
            return self.registers.get(offset, 0)
        status = self.registers.get(STATUS, 0)
        raw = int(bool(self.registers.get(DONE, 0))) << 4
        raw |= int(bool(status & WAS_RESET)) << 12
        raw |= int(bool(status & HAS_SETUP)) << 16
        return raw & self.registers.get(ENABLE, 0)

    def write(self, offset: int, value: int) -> None:
        """Writes a register."""
        if offset in (STATUS, DONE):
            value = self.registers.get(offset, 0) & ~value
        self.registers[offset] = value

    def add(self, offset: int, bits: int) -> None:
        """Sets bits of a register."""
        self.registers[offset] = self.registers.get(offset, 0) | bits

    def word(self, place: int) -> int:
        """A word of the memory."""
        return int.from_bytes(self.memory[place : place + 4], "little")

    def set_word(self, place: int, value: int) -> None:
        """Writes a word of the memory."""
        self.memory[place : place + 4] = value.to_bytes(4, "little")

    def buffer(self, endpoint: int, side: int) -> int:
        """Where the buffer of an endpoint is."""
        if endpoint == 0:
            return 0x100
        register = self.word(8 * endpoint + 4 * side)
        assert register >> 31, f"endpoint {endpoint} is not enabled"
        return register & 0xFFC0

    def takes(self, endpoint: int, toggle: int) -> bytes | None:
        """Takes a packet, if there is one."""
        place = 0x80 + 8 * endpoint
        state = self.word(place)
        if not state & AVAILABLE:
            return None
        assert state & FULL and state >> 13 & 1 == toggle, f"IN {endpoint}: {state:#x}"
        begin = self.buffer(endpoint, IN)
        self.set_word(place, state & ~(AVAILABLE | FULL))
        self.add(DONE, 1 << 2 * endpoint)
        return bytes(self.memory[begin : begin + (state & LENGTH)])

    def gives(self, endpoint: int, toggle: int, data: bytes) -> bool:
        """Gives a packet, if there is room for it."""
        place = 0x84 + 8 * endpoint
        state = self.word(place)
        if not state & AVAILABLE:
            return False
        assert state >> 13 & 1 == toggle, f"OUT {endpoint}: {state:#x}"
        begin = self.buffer(endpoint, OUT)
        self.memory[begin : begin + len(data)] = data
        self.set_word(place, state & ~(AVAILABLE | LENGTH) | FULL | len(data))
        self.add(DONE, 2 << 2 * endpoint)
        return True

    def taken(self, toggle: int) -> Iterator[bytes | None]:
        """Takes a packet of endpoint 0: waits with `None`, and ends with the packet."""
        while (packet := self.takes(0, toggle)) is None:
            assert not self.registers.get(STALL, 0), "a request is refused"
            yield None
        yield packet

    def request(self, head: tuple[int, int, int, int], data: int | bytes) -> Iterator[bytes]:
        """A control transfer. Yields nothing while it waits, and at last what it has read."""
        kind = head[0]
        length = data if isinstance(data, int) else len(data)
        self.memory[:8] = struct.pack("<BBHHH", *head, length)
        self.registers[STALL] = 0
        self.add(STATUS, HAS_SETUP)
        while self.registers[STATUS] & HAS_SETUP:
            yield b""
        if not kind & 0x80:
            while data and isinstance(data, bytes) and not self.gives(0, 1, data):
                yield b""
            for packet in self.taken(1):
                assert not packet, "the end of a request is not empty"
                yield b""
            yield OBEYED
            return
        toggle, received, is_whole = 1, b"", False
        while not is_whole and len(received) < length:
            for packet in self.taken(toggle):
                if packet is None:
                    yield b""
                else:
                    received += packet
                    is_whole = len(packet) < PACKET_BYTES_OF_0
            toggle ^= 1
        while not self.gives(0, 1, b""):
            yield b""
        yield received

    def enumerates(self) -> Iterator[None]:
        """The host: finds the device, opens its port, and then moves bytes."""
        while not self.registers.get(CONTROL, 0) & IS_ATTACHED:
            yield
        self.add(STATUS, WAS_RESET)
        while self.registers[STATUS] & WAS_RESET:
            yield
        answers = []
        rate = struct.pack("<IBBB", 115_200, 0, 0, 8)
        requests: list[tuple[tuple[int, int, int, int], int | bytes]] = [
            ((0x80, 6, 0x0100, 0), 64),
            ((0x00, 5, OWN_ADDRESS, 0), 0),
            ((0x80, 6, 0x0100, 0), 18),
            ((0x80, 6, 0x0200, 0), 255),
            ((0x80, 6, 0x0300, 0), 255),
            ((0x80, 6, 0x0302, 0x409), 255),
            ((0x00, 9, 1, 0), 0),
            ((0x21, 0x20, 0, 0), rate),
        ]
        for head, data in requests:
            for answer in self.request(head, data):
                if answer:
                    answers.append(answer)
                yield
        assert answers[2][7] == PACKET_BYTES_OF_0, "other packets of endpoint 0"
        assert self.registers[ADDRESS] == OWN_ADDRESS, "the device does not have its address"
        self.configuration = answers[3]
        into, out = self.data_endpoints()
        taken = given = 0
        was_open = False
        while True:
            if self.is_open != was_open:
                was_open = self.is_open
                for _ in self.request((0x21, 0x22, int(was_open), 0), 0):
                    yield
            if was_open and (packet := self.takes(into, taken)) is not None:
                self.to_host += packet
                taken ^= 1
            if self.to_chip and self.gives(out, given, bytes(self.to_chip[:PACKET_BYTES])):
                del self.to_chip[:PACKET_BYTES]
                given ^= 1
            yield

    def data_endpoints(self) -> tuple[int, int]:
        """The endpoints of the data, to the host and from it."""
        place, into, out = 0, 0, 0
        while place < len(self.configuration):
            length, kind, address, attributes = self.configuration[place : place + 4]
            if kind == 5 and attributes == 2:
                if address & 0x80:
                    into = address & 0xF
                else:
                    out = address
            place += length
        assert into and out, "no endpoints for data"
        return into, out
