"""run.py BOARD HUSILLO: starts the firmware in QEMU, measures with it, compares with the simulator, prints flash, static RAM and the deepest stack."""
import json
import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../board"))
from bench import Bench, Elf, elf  # noqa: E402

board, husillo = sys.argv[1:3]
START = 0x8010_0000 if board == "virt" else 0x2000_0000
RAM = 16384
# Home on the index, trapezoids, the probe both ways, a jog, the state at the end.
ACTIONS = "home x goto 1200 goto -777 goto 3 touch + touch - --repeat 3 goto 0 zero goto 250 jog -x 1s slow status".split()


def measure(*where):
    return subprocess.run(
        [husillo, "measure", "-m", "cmm", *ACTIONS, *where, "--format", "json"],
        capture_output=True, text=True, timeout=300)


simulated = measure("--contact", "1:1500", "--contact", "1:..-1500")
with Bench("cmm", board) as bench:
    for _ in range(10):
        time.sleep(1)
        measured = measure("--port", f"tcp:127.0.0.1:{bench.port}")
        if "refused" not in measured.stderr:
            break
    if simulated.returncode or measured.returncode:
        sys.exit(simulated.stderr + measured.stdout + measured.stderr)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "ram")
        # As the processor sees it: the microbit's RAM is on no other bus.
        bench.monitor(f'memsave {START:#x} {RAM} "{path}"')
        ram = open(path, "rb").read()

# A motor rests within a count of its goal, here and there; where contacts are is latched, to the count. A jog is as long as the host's clock says.
TOLERANCES = {"trigger": 0, "corrected": 0, "pre_travel": 0, "spread": 0, "touches": 0, "position": 2}
rows = [json.loads(run.stdout) for run in (simulated, measured)]
assert len(rows[0]) == len(rows[1]) == 11, rows
for expected, found in zip(*rows):
    is_jog = expected["action"].startswith(("jog", "status"))
    for key, tolerance in TOLERANCES.items():
        if isinstance(expected.get(key), (int, float)) and not (is_jog and key == "position"):
            assert abs(expected[key] - found[key]) <= tolerance, f"{board}: {found} instead of {expected}"

program = Elf(elf("cmm", board))
static = program.static(START)
# RAM is zero when QEMU starts: the stack came down to the lowest byte above the statics that is not.
deepest = next((place for place in range(static, RAM) if ram[place]), RAM)
for name, value in (("results", len(rows[1])), ("flash", program.flash()), ("static", static), ("stack", RAM - deepest)):
    print(board, name, value)
