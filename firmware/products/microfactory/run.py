"""run.py BOARD HUSILLO FIGURE: cuts a figure with the firmware in QEMU by the host program, and compares it with the host's emulated machine.

From homing on, of each event the wait, the motors' pins and their current and RESET, of each status told the place. Prints steps, flash, static RAM and the
deepest stack.
"""
import os
import sys
import tempfile

import pins  # it knows where the others are
import status
import registers
from bench import Bench, figures, send
from golden import Emulated, compare

board, husillo, figure = sys.argv[1:4]

with tempfile.TemporaryDirectory() as folder:
    with Emulated(husillo, "microfactory", folder, 200) as emulated:
        send(husillo, figure, "microfactory", emulated.link, answer="done")
    rows = emulated.rows()
    log = os.path.join(folder, "log")
    with Bench("microfactory", board, *registers.waits(board), "-D", log) as bench:
        bench.booted()
        send(husillo, figure, "microfactory", f"tcp:127.0.0.1:{bench.port}", answer="done")
        ram = bench.ram()
    with open(log, errors="replace") as lines:
        happened = registers.read(board, lines, with_outputs=True)

made = compare(board, pins.events(happened), rows, pins.Pins(), pins.NOT_RESET, pins.ENABLE)
if made < len(rows):
    sys.exit(f"{board}: {made} rows of events instead of {len(rows)}")
told, places = list(status.statuses(happened)), list(status.places(rows))
for steps, _, flags, place in told:
    # It is ahead of the pins by the step that waits for its time, which may have come before its first byte went out.
    if flags & status.HOMED and place not in places[max(steps - 1, 0):steps + 2]:
        sys.exit(f"{board}: told {place} after {steps} steps, and is at {places[steps]}")
if told[-1] != (len(places) - 1, ord("d"), status.HOMED, places[-1]):
    sys.exit(f"{board}: told {told[-1]} at the end, and is at {places[-1]} after {len(places) - 1} steps")

print(board, "steps", len(places) - 1)
figures("microfactory", bench, ram)
