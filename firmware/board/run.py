"""run.py FIRMWARE BOARD HUSILLO PROGRAM: starts the firmware in QEMU, sends a program to it, and prints steps, flash, static RAM and the deepest stack."""
import os
import re
import subprocess
import sys
import tempfile
import time

from bench import Bench, Elf, elf

firmware, board, husillo, program = sys.argv[1:5]
START = 0x8010_0000 if board == "virt" else 0x2000_0000
RAM = 16384

with Bench(firmware, board) as bench:
    for _ in range(5):
        time.sleep(1)
        sent = subprocess.run(
            [husillo, "send", program, "-m", firmware, "--port", f"tcp:127.0.0.1:{bench.port}"],
            capture_output=True, text=True, timeout=200)
        # Not listening yet, or just booting.
        if not re.search("refused|was reset|stop:", sent.stderr):
            break
    if sent.returncode:
        sys.exit(sent.stdout + sent.stderr)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "ram")
        # As the processor sees it: the microbit's RAM is on no other bus.
        bench.monitor(f'memsave {START:#x} {RAM} "{path}"')
        ram = open(path, "rb").read()

steps, = re.findall(r"Steps +(\d+), each as in the simulator", sent.stdout)
program = Elf(elf(firmware, board))
static = program.static(START)
# RAM is zero when QEMU starts: the stack came down to the lowest byte above the statics that is not.
deepest = next((place for place in range(static, RAM) if ram[place]), RAM)
for name, value in (("steps", steps), ("flash", program.flash()), ("static", static), ("stack", RAM - deepest)):
    print(board, name, value)
