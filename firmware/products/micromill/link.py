"""The micro mill's link, as far as checks need it: strings sent byte by byte, each waited for."""
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../board"))
from bench import Bench  # noqa: E402

DONE, TAKEN, WRONG, REFUSED, NO_SWITCH, STOPPED = 0x8F, 0x8C, 0x8E, 0x8B, 0x89, 0x8D
STEPS = range(0x80, 0x86)


class Mill(Bench):
    """A micro mill in QEMU, and what it says."""

    def __init__(self, board, *arguments):
        super().__init__("micromill", board, *arguments)
        self.connect()

    def ask(self, string, answers=(DONE, TAKEN, WRONG, REFUSED, NO_SWITCH, STOPPED)):
        """Sends a string and gives all that is said until there is one of the answers."""
        said = b""
        for byte in string:
            self.line.send(bytes([byte]))
            said += self.receive(10)
        while not any(byte in answers for byte in said):
            # Where every instruction is logged it takes its time.
            more = self.receive(60)
            if not more:
                sys.exit(f"{string}: silent after {said[-20:]}")
            said += more
        return said

    def home(self):
        said = self.ask(b"H;", (DONE, NO_SWITCH))
        if said[-1] != DONE:
            sys.exit("homing found no switch")
