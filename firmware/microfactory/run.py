"""run.py BOARD HUSILLO FIGURE: cuts a figure with the firmware in QEMU by the host program, and prints steps, flash, static RAM and the deepest stack.

The steps are those of its pins, by QEMU's trace of them: at the end the loads and the spindle have to stand where the host's simulated machine has them.
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

board, husillo, figure = sys.argv[1:4]
LASH = (200, 0, 200, 0)


def send(port):
    send_to(husillo, figure, "microfactory", port, answer="done")


def simulated(folder):
    """Load steps of X, Y, Z and steps of the spindle of the host's simulated machine, as its panel says."""
    link = os.path.join(folder, "cell")
    with subprocess.Popen([husillo, "emulate", "microfactory", "--speed", "200", "--link", link], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as cell:
        try:
            cell.stdout.readline()
            send(link)
            cell.stdin.write("where\n")
            cell.stdin.flush()
            line = next(line for line in cell.stdout if re.search(r"\bx -?\d+", line))
        finally:
            cell.terminate()
    return [int(number) for number in re.findall(r"\b(?:x|y|z|spindle) (-?\d+)", line)], line


def made(steps):
    """Loads from where they were at first, and how many steps there were: motors step where their CLOCK rises."""
    before, ahead, loads, events = 0, list(LASH), [0, 0, 0, 0], 0
    for step in steps:
        risen = step.levels & ~before & 0xF
        before = step.levels
        events += bool(risen)
        for axis in range(4):
            if risen >> axis & 1:
                motor = ahead[axis] + (1 if step.levels >> 4 + axis & 1 else -1)
                ahead[axis] = min(max(motor, 0), LASH[axis])
                loads[axis] += motor - ahead[axis]
    return loads, events


with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    with Bench("microfactory", board, *registers.PINS, "-D", log) as bench:
        bench.booted()
        send(f"tcp:127.0.0.1:{bench.port}")
        ram = bench.ram()
    (loads, events), (expected, line) = made(registers.written(board, log)), simulated(folder)
    # Zero is off the switches by the back-off: 200 load steps.
    loads = [load + above - 200 for load, above in zip(loads, (420, 380, 900))] + loads[3:]
    if loads != expected:
        sys.exit(f"{board}: loads at {loads}, the simulator's at {expected}: {line}")

print(board, "steps", events)
figures("microfactory", bench, ram)
