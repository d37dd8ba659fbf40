"""The part of Grbl's link that checks need: lines and answers, and pins as steps."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Self

from husillo_firmware.qemu import Firmware
from husillo_firmware.registers import Happened, made
from husillo_firmware.waiting import fail, until

# A line that waits for the end of a motion, with every access of the pins logged.
ANSWER_S = 120
QUIET_S = 0.5
STEPS = 0b111


class Grbl(Firmware):
    """A Grbl controller in QEMU."""

    begun = b""

    def __enter__(self) -> Self:
        return self

    def start(self) -> None:
        """Opens the line. What was said at power-on is dropped; how much has come is unknown."""
        self.booted()
        self.connect()
        self.say("\n")
        while self.receive(QUIET_S):
            pass

    def reset(self) -> None:
        """Resets the controller and reads up to its banner."""
        self.say("\x18")
        while not self.next().startswith("Grbl"):
            pass

    def next(self) -> str:
        """The next line of the controller, without its end."""
        while b"\n" not in self.begun:
            more = self.receive(ANSWER_S)
            if not more:
                fail(f"{self.board}: silent after {self.begun!r}")
            self.begun += more
        line, _, self.begun = self.begun.partition(b"\n")
        return line.decode().strip()

    def say(self, text: str) -> None:
        """Sends bytes."""
        self.line.sendall(text.encode("latin-1"))

    def ask(self, line: str) -> list[str]:
        """Sends a line. Returns all lines up to its answer."""
        self.say(line + "\n")
        return list(self.answered())

    def answered(self) -> Iterator[str]:
        """The lines up to the next answer."""
        while True:
            said = self.next()
            yield said
            if said == "ok" or said.startswith("error:"):
                return

    def status(self) -> str:
        """The next status report."""
        self.say("?")
        while not (said := self.next()).startswith("<"):
            pass
        return said

    def reports(self, state: str) -> str:
        """Waits for a report with this state."""
        last = ""

        def is_so() -> bool:
            nonlocal last
            last = self.status()
            return last.startswith(f"<{state}")

        until(is_so, ANSWER_S, f"{self.board}: no {state}")
        return last


@dataclass
class Edges:
    """Rising edges of the step pins, and the sum of the steps with their directions."""

    pulses: list[int]
    net: list[int]

    @staticmethod
    def of(happened: Iterable[Happened]) -> Edges:
        """Counts the edges at the pins."""
        return Edges.among(one.levels for one in made(happened))

    @staticmethod
    def among(levels: Iterable[int]) -> Edges:
        """Counts the edges in successive levels of the motors' pins."""
        edges, before = Edges([0] * 3, [0] * 3), 0
        for after in levels:
            rising = after & ~before & STEPS
            for axis in range(3):
                if rising >> axis & 1:
                    edges.pulses[axis] += 1
                    edges.net[axis] += -1 if after >> 3 + axis & 1 else 1
            before = after
        return edges
