"""run.py BOARD HUSILLO FILE: drills a board with the firmware in QEMU by the host program, and prints holes, flash, static RAM and the deepest stack.

The holes are those of its pins, by QEMU's trace of them: each has to be where the host's simulated drill has it, as deep, with the spindle on.
"""
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../board"))
import registers  # noqa: E402
from bench import Bench, figures  # noqa: E402
from bench import send as send_to  # noqa: E402

board, husillo, file = sys.argv[1:4]
# Where the firmware's simulated machine and the host's stand at first, and the board below the upper sensor of Z.
BEGIN = (500, 250, 60)
BOARD_STEPS = 3210


def send(port):
    return int(send_to(husillo, file, "drill", port, "--yes", answer=r"(\d+) holes drilled")[-1])


def simulated(folder):
    """Holes of the host's simulated drill: x, y, depth."""
    link = os.path.join(folder, "drill")
    with subprocess.Popen([husillo, "emulate", "drill", "--speed", "1000", "--link", link], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as drill:
        try:
            drill.stdout.readline()
            send(link)
            drill.stdin.write("holes\n")
            drill.stdin.flush()
            line = next(line for line in drill.stdout if " holes: " in line)
        finally:
            drill.terminate()
    assert "stood" not in line, line
    return [tuple(map(int, hole)) for hole in re.findall(r"(\d+),(\d+) depth (\d+)", line)]


def drilled(steps):
    """Holes of the pins: the phases of each motor go round in the order 3, 1, 0, 2, and 3."""
    order = {3: 0, 1: 1, 0: 2, 2: 3}
    place, phases, hole, holes = list(BEGIN), [0, 0, 0], None, []
    for step in steps:
        for axis in range(3):
            phase = order[step.levels >> 2 * axis & 3]
            way = (phase - phases[axis] + 1) % 4 - 1
            assert way != 2, f"axis {axis} jumps"
            phases[axis] = phase
            place[axis] += way
        if place[2] > BOARD_STEPS:
            assert step.outputs & 1, "drilled with a spindle that stood"
            hole = (*place[:2], max(place[2], hole[2] if hole else 0))
        elif hole:
            holes.append(hole)
            hole = None
    return holes


def traced(folder):
    """Drills with the firmware: how many holes, what is in its RAM then, and what was written to its pins."""
    log = os.path.join(folder, "log")
    with Bench("drill", board, *registers.PINS, "-D", log) as bench:
        bench.booted()
        count = send(f"tcp:127.0.0.1:{bench.port}")
        return count, bench, bench.ram(), registers.written(board, log)


with tempfile.TemporaryDirectory() as folder:
    # On a busy computer a traced QEMU may answer later than the host waits.
    for left in (2, 1, 0):
        try:
            count, bench, ram, steps = traced(folder)
            break
        except SystemExit as told:
            if not left or "no answer" not in str(told):
                raise
            print("again, after no answer", file=sys.stderr)
    holes, expected = drilled(steps), simulated(folder)
    if holes != expected or len(holes) != count:
        sys.exit(f"{board}: holes {holes} instead of {expected}")

print(board, "holes", count)
print(board, "steps", len(steps))
figures("drill", bench, ram)
