"""Reads a firmware's events from QEMU's trace of every access to the board's registers."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from husillo_firmware.boards import Board

# Options for QEMU, to be used with `-D FILE`. ACCESSES traces the pins and their waits. ARGUMENTS
# also traces when the pins were written.
ACCESSES = ("-trace", "memory_region_ops_write", "-trace", "memory_region_ops_read")
ARGUMENTS = (*ACCESSES, "-d", "int")

# If the end of a wait has passed when it begins, the wait ends within this time. The microbit's
# timer detects only an end in the future, so setting it may need a second try.
AT_ONCE_US = 4

ACCESS = re.compile(r"memory_region_ops_(write|read) .* addr 0x([0-9a-f]+) value 0x([0-9a-f]+) ")


class Registers:
    """The registers of a board, and the meaning of writes to them."""

    # Clocks of the timer per microsecond.
    CLOCKS_PER_US: int
    # The addresses of sent bytes, of received bytes, and of the time.
    SENT: int
    HEARD: int
    NOW: int

    def now(self, value: int) -> int:
        """The time, from the value read at `NOW`."""
        return value

    def write(self, address: int, value: int) -> tuple[str, int] | None:
        """What this write sets (motors, outputs or the end of a wait), and its value."""
        raise NotImplementedError


class Microbit(Registers):
    """TIMER0 counts microseconds. OUTCLR, then OUTSET write all pins of a kind."""

    CLOCKS_PER_US = 1
    SENT, HEARD = 0x4000_251C, 0x4000_2518
    NOW = 0x4000_8544

    def __init__(self) -> None:
        self.low = 0

    def write(self, address: int, value: int) -> tuple[str, int] | None:
        if address == 0x4000_8540:
            return "due", value
        if address == 0x5000_050C:
            self.low = value
        if address == 0x5000_0508:
            if self.low | value == 0xF << 20:
                return "outputs", value >> 20
            return "motors", value >> 1 & 0x3F | value >> 5 & 0xC0
        return None


class Mps2(Registers):
    """TIMER1 counts down at 25 MHz. TIMER0 gets the time from the last reading of TIMER1."""

    CLOCKS_PER_US = 25
    SENT = HEARD = 0x4000_4000
    NOW = 0x4000_1004

    def __init__(self) -> None:
        self.at = 0
        self.low = 0

    def now(self, value: int) -> int:
        self.at = ~value & 0xFFFF_FFFF
        return self.at

    def write(self, address: int, value: int) -> tuple[str, int] | None:
        if address == 0x4000_0004 and value not in (0, 0xFFFF_FFFF):
            return "due", self.at + value
        if address == 0x4001_07FC:
            return "motors", value
        # With the feature `wide`, the motors' pins are written in two parts.
        if address == 0x4001_2004:
            self.low = value
        if address == 0x4001_3004:
            return "motors", self.low | value << 16
        if address == 0x4001_083C:
            return "outputs", value >> 8
        return None


class Virt(Registers):
    """mtime runs at 10 MHz and is compared with mtimecmp. The pins are those of the UART."""

    CLOCKS_PER_US = 10
    SENT = HEARD = 0x1000_0000
    NOW = 0x0200_BFF8

    def write(self, address: int, value: int) -> tuple[str, int] | None:
        # The value 0 is written only at power-on.
        if address == 0x0200_4000 and value:
            return "due", value
        if address == 0x1000_0007:
            return "motors", value
        if address == 0x1000_0004:
            return "outputs", value
        return None


class NucleoF446(Registers):
    """SysTick counts at 168 MHz. There is no counter of time, so `NOW` is never read.

    The motors are at ports A, B and C, which are written in this order. The other outputs are at
    the same ports.
    """

    CLOCKS_PER_US = 168
    SENT = HEARD = 0x4000_4404
    NOW = 0
    SET_RESET = (0x4002_0018, 0x4002_0418, 0x4002_0818)
    MOTORS = ((0, 10), (1, 3), (1, 5), (1, 4), (1, 10), (0, 8), (2, 1), (2, 11))
    OUTPUTS = ((0, 9), (2, 10), (0, 5), (1, 0))

    def __init__(self) -> None:
        self.ports = [0, 0, 0]

    def levels(self, pins: tuple[tuple[int, int], ...]) -> int:
        """The levels of these pins, bit 0 for the first one."""
        return sum((self.ports[port] >> pin & 1) << n for n, (port, pin) in enumerate(pins))

    def write(self, address: int, value: int) -> tuple[str, int] | None:
        if address not in self.SET_RESET:
            return None
        port, changed = self.SET_RESET.index(address), value | value >> 16
        self.ports[port] = self.ports[port] & ~(value >> 16) | value & 0xFFFF
        # Port C is the last one, and has pins of both.
        for kind, pins in (("motors", self.MOTORS), ("outputs", self.OUTPUTS)):
            of_last = [pin for of, pin in pins if of == 2]
            if port == 2 and all(changed >> pin & 1 for pin in of_last):
                return kind, self.levels(pins)
        return None


BOARDS: dict[str, type[Registers]] = {
    "microbit": Microbit,
    "mps2-an386": Mps2,
    "virt": Virt,
    "nucleo-f446": NucleoF446,
}


def clocks_per_us(board: Board) -> int:
    """Clocks per microsecond of the board's timer."""
    return BOARDS[board.name].CLOCKS_PER_US


def heard_at(board: Board) -> int:
    """The address at which a received byte is read."""
    return BOARDS[board.name].HEARD


@dataclass(eq=False)
class Made:
    """A write to the motors' pins."""

    levels: int
    outputs: int
    # When the write was due, in clocks of the board, 32 bits. `None`: there was no wait.
    due: int | None
    # The last reading of the time before that wait began.
    asked: int | None
    # The first reading of the time after the write. `None`: the interrupt did not read the time, or
    # this is unknown (on `virt`, QEMU does not log the end of an interrupt).
    at: int | None = None

    def is_late(self, board: Board) -> bool:
        """Whether its time had passed when its wait began, so that it was made at once."""
        if self.due is None or self.asked is None:
            return False
        since = (self.due - self.asked) % 2**32
        return since <= AT_ONCE_US * clocks_per_us(board)

    def earlier(self, clocks: int) -> Made:
        """The same write, requested and due earlier by this many clocks."""
        due, asked = (None if at is None else at - clocks for at in (self.due, self.asked))
        return replace(self, due=due, asked=asked)


@dataclass(eq=False)
class Switched:
    """A change of the other outputs."""

    outputs: int


# A number stands for a byte that was sent.
Happened = Made | Switched | int


def made(happened: Iterable[Happened]) -> list[Made]:
    """The writes to the motors' pins."""
    return [one for one in happened if isinstance(one, Made)]


def said(happened: Iterable[Happened]) -> bytes:
    """The bytes that were sent."""
    return bytes(one for one in happened if isinstance(one, int))


def read_file(board: Board, path: Path, with_outputs: bool = False) -> list[Happened]:
    """Reads a log up to its present end; see `read`."""
    with path.open(errors="replace") as lines:
        return read(board, lines, with_outputs)


def since_heard(board: Board, path: Path) -> list[Happened]:
    """Reads a log from the last byte on that the firmware has received.

    What happens after that byte does not depend on how quickly the host works.
    """
    lines = path.read_text(errors="replace").splitlines()
    address = f" addr {heard_at(board):#x} "
    heard = [
        number
        for number, line in enumerate(lines)
        if "memory_region_ops_read" in line and address in line
    ]
    return read(board, lines[heard[-1] if heard else 0 :])


def read(board: Board, lines: Iterable[str], with_outputs: bool = False) -> list[Happened]:
    """Reads the writes to the motors' pins and the bytes sent from the lines of a log, in order.

    With `with_outputs` it includes changes of the other outputs.
    """
    registers = BOARDS[board.name]()
    happened: list[Happened] = []
    outputs = 0
    now: int | None = None
    due: int | None = None
    asked: int | None = None
    last: Made | None = None
    for line in lines:
        found = ACCESS.search(line)
        if not found:
            if "successful exception return" in line:
                last = None
            continue
        address, value = int(found[2], 16), int(found[3], 16)
        if found[1] == "read":
            if address == registers.NOW:
                now = registers.now(value)
                if last:
                    last.at, last = now, None
            continue
        if address == registers.SENT:
            happened.append(value)
        written = registers.write(address, value)
        if not written:
            continue
        kind, value = written
        if kind == "due":
            due, asked = value & 0xFFFF_FFFF, now
        elif kind == "outputs":
            if with_outputs and value != outputs:
                happened.append(Switched(value))
            outputs = value
        else:
            one = Made(value, outputs, due, asked)
            due, last = None, None if board.name == "virt" else one
            happened.append(one)
    return happened
