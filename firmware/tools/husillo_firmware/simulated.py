"""A chip that QEMU does not have: Unicorn executes its instructions, Python has its registers.

A chip of this kind shows that a firmware uses registers as their manual describes them, not that
the real chip does. Each instruction takes one clock.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar

from unicorn.unicorn import Uc, UcError

# The most time that passes at once while the processor sleeps.
LONGEST_SLEEP_US = 1000


@dataclass
class Edge:
    """A change of the pins: when, and their levels after it."""

    us: float
    levels: int


@dataclass
class Chip(ABC):
    """A chip after a reset, with a program at the beginning of its flash."""

    core_mhz: ClassVar[int]
    # An instruction that waits for interrupts.
    sleep: ClassVar[bytes]
    # The most instructions between two looks at the interrupts.
    at_once: ClassVar[int] = 1000
    flash_bytes: ClassVar[int] = 4 << 20
    # Added to an address at which execution begins, and an address at which it ends.
    mode: ClassVar[int] = 0
    end: ClassVar[int] = 0

    flash: bytearray
    # Pins of switches that are closed to ground.
    closed: int = 0
    # The host has opened the port.
    is_open: bool = True
    clocks: int = 0
    levels: int = 0
    edges: list[Edge] = field(default_factory=list)
    to_chip: bytearray = field(default_factory=bytearray)
    to_host: bytearray = field(default_factory=bytearray)
    registers: dict[int, int] = field(default_factory=dict)
    is_asleep: bool = False
    # The handler of an interrupt runs.
    is_handling: bool = False
    # The next instruction.
    at: int = 0

    def __post_init__(self) -> None:
        self.cpu = self.processor()
        self.start()

    @abstractmethod
    def processor(self) -> Uc:
        """The processor with its memory."""

    @abstractmethod
    def start(self) -> None:
        """Loads the program, and sets where it begins."""

    @abstractmethod
    def poll(self) -> None:
        """Lets the host act."""

    @abstractmethod
    def pending(self) -> int | None:
        """The number of the interrupt that is due."""

    @abstractmethod
    def permits(self) -> bool:
        """Whether the processor permits interrupts."""

    @abstractmethod
    def enter(self, number: int) -> None:
        """Begins the handler of an interrupt: sets `at`."""

    @abstractmethod
    def leaves(self) -> bool:
        """Ends the handler, if it has come to its end."""

    @abstractmethod
    def events(self) -> list[int]:
        """When something will happen by itself, in clocks."""

    @abstractmethod
    def counter(self) -> int:
        """The program counter of the processor."""

    @classmethod
    def erased(cls) -> bytearray:
        """An empty flash."""
        return bytearray(b"\xff" * cls.flash_bytes)

    @property
    def us(self) -> float:
        """The time since the reset."""
        return self.clocks / self.core_mhz

    def drive(self, levels: int) -> None:
        """Sets the pins."""
        if levels != self.levels:
            self.levels = levels
            self.edges.append(Edge(self.us, levels))

    def run(self, us: float, until: Callable[[], bool] = lambda: False) -> None:
        """Runs for a time, or until the condition."""
        end = self.clocks + int(us * self.core_mhz)
        while self.clocks < end and not until():
            self.poll()
            number = self.pending()
            if number is None and self.is_asleep:
                self.clocks = min(end, self.next())
                continue
            if number is not None and not self.is_handling:
                if not self.permits():
                    # They may be permitted for one instruction only.
                    self.go(1)
                    continue
                self.is_handling = True
                self.enter(number)
            # Not beyond the next event, so that the time of its interrupt is exact.
            self.go(min(self.at_once, self.next() - self.clocks))

    def next(self) -> int:
        """When something may happen next, in clocks."""
        longest = self.clocks + LONGEST_SLEEP_US * self.core_mhz
        return max(self.clocks + 1, min([longest, *self.events()]))

    def go(self, count: int) -> None:
        """Executes instructions."""
        try:
            self.cpu.emu_start(self.at | self.mode, self.end, count=count)
        except UcError as error:
            if self.counter() != self.end:
                raise AssertionError(f"{error} at {self.counter():#x}") from error
        self.at = self.counter()
        self.clocks += count
        if self.is_handling:
            self.is_handling = not self.leaves()
        # Unicorn stops behind an instruction that waits for an interrupt.
        before = self.at - len(self.sleep)
        try:
            self.is_asleep = self.cpu.mem_read(before, len(self.sleep)) == self.sleep
        except UcError:
            # The next instruction is the first one of a memory.
            self.is_asleep = False
