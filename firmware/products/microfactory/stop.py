"""stop.py BOARD HUSILLO: while it homes, an emergency stop comes: what was made until then is as in the host's emulated machine, and nothing follows."""
import os
import subprocess
import sys
import tempfile
import time

import pins  # it knows where the others are
import registers
from bench import Bench
from golden import Emulated, compare
from status import ASK

board, husillo = sys.argv[1:3]
HOME, EMERGENCY, REJECTED = b"H!?"
# Steps that may have been decided on.
AHEAD = 1


class Line(Bench):
    """The microfactory in QEMU, and its answers."""

    def ask(self, byte, length=1):
        self.line.sendall(bytes([byte]))
        said = b""
        while len(said) < length:
            more = self.receive(10)
            if not more:
                sys.exit(f"{board}: no answer to {byte:#x}")
            said += more
        return said


def stopped(log):
    """What has happened."""
    with Line("microfactory", board, *registers.waits(board), "-D", log) as bench:
        bench.connect()
        bench.booted()
        assert bench.ask(HOME) == bytes([HOME])
        time.sleep(0.02)
        assert bench.ask(EMERGENCY) == bytes([EMERGENCY])
        report, flags = bench.ask(ASK, 21)[1:3]
        if (report, flags) != (EMERGENCY, 0):
            sys.exit(f"{board}: report {report:#x}, flags {flags} after an emergency stop")
        if bench.ask(HOME) != bytes([REJECTED]):
            sys.exit(f"{board}: it homes after an emergency stop")
        time.sleep(0.1)
    with open(log, errors="replace") as lines:
        return registers.read(board, lines, with_outputs=True)


with tempfile.TemporaryDirectory() as folder:
    with Emulated(husillo, "microfactory", folder, 200) as emulated:
        subprocess.run([husillo, "jog", "-m", "microfactory", "--port", emulated.link, "home"], capture_output=True, check=True)
    rows = emulated.rows()
    # A computer that is busy may let it home to the end.
    for _ in range(5):
        happened = stopped(os.path.join(folder, "log"))
        made = pins.events(happened)
        if len(made) < len(rows):
            break
    else:
        sys.exit(f"{board}: no emergency stop came while it homed")

*made, end = made
compare(board, made, rows, pins.Pins(), pins.NOT_RESET, pins.ENABLE)
if not isinstance(end, registers.Switched) or end.outputs & pins.ENABLE:
    sys.exit(f"{board}: there is current after an emergency stop")
late = pins.events(happened[happened.index(EMERGENCY):])
if len(late) > AHEAD + 1:
    sys.exit(f"{board}: {len(late) - 1} steps after an emergency stop")
print(board, "stops for good after", len(made), "of", len(rows))
