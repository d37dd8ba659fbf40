"""run.py BOARD HUSILLO FILE [--faithful]: drills a board with the firmware in QEMU by the host program, and compares it with the host's emulated drill.

With --faithful both are the original controller. From homing on, of each event the wait, the motors' phases and the spindle. Prints holes, steps, flash, static RAM and the deepest stack.
"""
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../board"))
import registers  # noqa: E402
from bench import Bench, figures, send  # noqa: E402
from golden import Emulated, compare  # noqa: E402

board, husillo, file = sys.argv[1:4]
options = sys.argv[4:]
if "--faithful" in options:
    os.environ["FEATURES"] = "faithful"


def pins(row):
    """Of each motor the first two wires, and the spindle."""
    return sum((row[levels] & 3) << 2 * axis for axis, levels in enumerate(("lx", "ly", "lz"))), row["spindle"]


def drilled(port):
    return int(send(husillo, file, "drill", port, "--yes", answer=r"(\d+) holes drilled")[-1])


with tempfile.TemporaryDirectory() as folder:
    with Emulated(husillo, "drill", folder, 1000, *options) as emulated:
        expected = drilled(emulated.link)
    rows = emulated.rows()
    log = os.path.join(folder, "log")
    with Bench("drill", board, *registers.waits(board), "-D", log) as bench:
        bench.booted()
        count = drilled(f"tcp:127.0.0.1:{bench.port}")
        ram = bench.ram()
    with open(log, errors="replace") as lines:
        happened = registers.read(board, lines, with_outputs=True)

if count != expected:
    sys.exit(f"{board}: {count} holes instead of {expected}")
# What was waited for; before that the motors are switched on.
events = [one for one in happened if isinstance(one, registers.Switched) or not isinstance(one, int) and one.due is not None]
made = compare(board, events, rows, pins, 0)
if made < len(rows):
    sys.exit(f"{board}: {made} rows of events instead of {len(rows)}")

print(board, "holes", count)
print(board, "steps", rows[-1]["event"])
figures("drill", bench, ram)
