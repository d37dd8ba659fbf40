"""run.py BOARD HUSILLO FILE: drills a board with the firmware in QEMU by the host program, and prints holes, flash, static RAM and the deepest stack.

On the microbit the holes are those of its pins, by QEMU's trace of them: each has to be where the host's simulated drill has it, as deep, with the
spindle on.
"""
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../board"))
from bench import Bench, Elf, deepest_stack, elf  # noqa: E402

board, husillo, file = sys.argv[1:4]
# Where the firmware's simulated machine and the host's stand at first, and the board below the upper sensor of Z.
BEGIN = (500, 250, 60)
BOARD_STEPS = 3210
OUTSET, OUTCLR = 0x508, 0x50C


def send(port):
    sent = subprocess.run([husillo, "send", file, "-m", "drill", "--yes", "--port", port], capture_output=True, text=True, timeout=300)
    if sent.returncode:
        sys.exit(sent.stdout + sent.stderr)
    return int(re.findall(r"(\d+) holes drilled", sent.stdout)[-1])


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


def traced(path):
    """Holes of the pins: the phases of each motor go round in the order 3, 1, 0, 2, and 3."""
    order = {3: 0, 1: 1, 0: 2, 2: 3}
    place, phases, pins, spindle, hole, holes = list(BEGIN), [0, 0, 0], 0, False, None, []
    for line in open(path):
        found = re.search(r"nrf51_gpio_write .*?0x([0-9a-f]+) .*?0x([0-9a-f]+)", line)
        if not found:
            continue
        offset, value = (int(number, 16) for number in found.groups())
        if offset == OUTCLR:
            pins &= ~value
            continue
        if offset != OUTSET:
            continue
        pins |= value
        spindle = bool(pins >> 20 & 1)
        for axis in range(3):
            phase = order[pins >> (1 + 2 * axis) & 3]
            way = (phase - phases[axis] + 1) % 4 - 1
            assert way != 2, f"axis {axis} jumps"
            phases[axis] = phase
            place[axis] += way
        if place[2] > BOARD_STEPS:
            assert spindle, "drilled with a spindle that stood"
            hole = (*place[:2], max(place[2], hole[2] if hole else 0))
            at = place[:2]
        elif hole:
            holes.append(hole)
            hole = None
    return holes


with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    arguments = ["-trace", "nrf51_gpio_write", "-D", log] if board == "microbit" else []
    with Bench("drill", board, *arguments) as bench:
        bench.booted()
        count = send(f"tcp:127.0.0.1:{bench.port}")
        ram = bench.ram()
    if board == "microbit":
        holes, expected = traced(log), simulated(folder)
        if holes != expected or len(holes) != count:
            sys.exit(f"{board}: holes {holes} instead of {expected}")

program = Elf(elf("drill", board))
print(board, "holes", count)
print(board, "flash", program.flash())
print(board, "static", program.static(bench.start))
print(board, "stack", deepest_stack(program, bench, ram))
