"""The part of the micro mill's link that checks need: strings are sent by bytes and echoed."""

from __future__ import annotations

from collections.abc import Iterable

from husillo_firmware.boards import Board
from husillo_firmware.qemu import Firmware
from husillo_firmware.waiting import fail

READY = b"\x88"
DONE, TAKEN, WRONG, REFUSED, NO_SWITCH, STOPPED = 0x8F, 0x8C, 0x8E, 0x8B, 0x89, 0x8D
ANSWERS = (DONE, TAKEN, WRONG, REFUSED, NO_SWITCH, STOPPED)
STEPS = range(0x80, 0x86)
ECHO_S = 10
# Long, because logging every instruction is slow.
ANSWER_S = 60


class Micromill(Firmware):
    """A micro mill in QEMU."""

    def __init__(
        self,
        board: Board,
        *arguments: str,
        features: str = "",
        in_wall_time: bool = False,
        is_connected: bool = True,
    ) -> None:
        super().__init__(
            "micromill", board, *arguments, features=features, in_wall_time=in_wall_time
        )
        if is_connected:
            self.connect()

    def __enter__(self) -> Micromill:
        return self

    def ask(self, string: bytes, answers: Iterable[int] = ANSWERS) -> bytes:
        """Sends a string. Returns all bytes received up to one of the answers."""
        said = b""
        for byte in string:
            self.line.send(bytes([byte]))
            said += self.receive(ECHO_S)
        return said if any(byte in answers for byte in said) else self.hear(answers, said)

    def hear(self, answers: Iterable[int], said: bytes = b"") -> bytes:
        """Returns all bytes received up to one of the answers."""
        while not any(byte in answers for byte in said):
            more = self.receive(ANSWER_S)
            if not more:
                fail(f"{self.board}: silent after {said[-20:]!r}")
            said += more
        return said

    def home(self) -> None:
        """Homes the mill."""
        if self.ask(b"H;", (DONE, NO_SWITCH))[-1] != DONE:
            fail(f"{self.board}: homing found no switch")


def add_steps(said: Iterable[int], to: list[int]) -> None:
    """Adds the reported steps to the counts of the axes."""
    for byte in said:
        if byte in STEPS:
            to[byte >> 1 & 3] += 1 if byte & 1 else -1
