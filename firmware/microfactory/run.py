"""run.py BOARD HUSILLO FIGURE: cuts a figure with the firmware in QEMU by the host program, and prints steps, flash, static RAM and the deepest stack.

On the microbit the steps are those of its pins, by QEMU's trace of them: at the end the loads and the spindle have to stand where the host's
simulated machine has them.
"""
import os
import re
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../board"))
from bench import Bench, Elf, deepest_stack, elf  # noqa: E402

board, husillo, figure = sys.argv[1:4]
OUTSET, OUTCLR = 0x508, 0x50C
LASH = (200, 0, 200, 0)


def send(port):
    sent = subprocess.run([husillo, "send", figure, "-m", "microfactory", "--port", port], capture_output=True, text=True, timeout=300)
    if sent.returncode or "done" not in sent.stdout:
        sys.exit(sent.stdout + sent.stderr)


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


def traced(path):
    """Loads from where they were at first, and how many steps there were: motors step where their CLOCK rises."""
    pins, ahead, loads, events = 0, list(LASH), [0, 0, 0, 0], 0
    for line in open(path):
        found = re.search(r"nrf51_gpio_write .*?0x([0-9a-f]+) .*?0x([0-9a-f]+)", line)
        if not found:
            continue
        offset, value = (int(number, 16) for number in found.groups())
        before = pins
        if offset == OUTCLR:
            pins &= ~value
        elif offset == OUTSET:
            pins |= value
        levels = pins >> 1 & 0x3F | pins >> 5 & 0xC0
        risen = levels & ~(before >> 1 & 0x3F | before >> 5 & 0xC0) & 0xF
        events += bool(risen)
        for axis in range(4):
            if risen >> axis & 1:
                motor = ahead[axis] + (1 if levels >> 4 + axis & 1 else -1)
                ahead[axis] = min(max(motor, 0), LASH[axis])
                loads[axis] += motor - ahead[axis]
    return loads, events


with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    arguments = ["-trace", "nrf51_gpio_write", "-D", log] if board == "microbit" else []
    with Bench("microfactory", board, *arguments) as bench:
        bench.booted()
        send(f"tcp:127.0.0.1:{bench.port}")
        ram = bench.ram()
    if board == "microbit":
        (loads, events), (expected, line) = traced(log), simulated(folder)
        # Zero is off the switches by the back-off: 200 load steps.
        loads = [load + above - 200 for load, above in zip(loads, (420, 380, 900))] + loads[3:]
        if loads != expected:
            sys.exit(f"{board}: loads at {loads}, the simulator's at {expected}: {line}")
        print(board, "steps", events)

program = Elf(elf("microfactory", board))
print(board, "flash", program.flash())
print(board, "static", program.static(bench.start))
print(board, "stack", deepest_stack(program, bench, ram))
