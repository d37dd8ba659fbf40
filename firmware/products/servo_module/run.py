"""run.py BOARD HUSILLO: starts the firmware in QEMU, measures with it, compares with the simulator, prints flash, static RAM and the deepest stack."""
import json
import os
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../board"))
from bench import Bench, figures  # noqa: E402

board, husillo = sys.argv[1:3]
# Home on the index, trapezoids, the probe both ways, a jog, the state at the end.
ACTIONS = "home x goto 1200 goto -777 goto 3 touch + touch - --repeat 3 goto 0 zero goto 250 jog -x 0.2s slow status".split()


def measure(*where):
    return subprocess.run(
        [husillo, "measure", "-m", "cmm", *ACTIONS, *where, "--format", "json"],
        capture_output=True, text=True, timeout=300)


simulated = measure("--contact", "1:1500", "--contact", "1:..-1500")
with Bench("servo_module", board) as bench:
    for _ in range(10):
        time.sleep(1)
        measured = measure("--port", f"tcp:127.0.0.1:{bench.port}")
        if "refused" not in measured.stderr:
            break
    if simulated.returncode or measured.returncode:
        sys.exit(simulated.stderr + measured.stdout + measured.stderr)
    ram = bench.ram()

# A motor rests within a count of its goal, here and there; where contacts are is latched, to the count. A jog is as long as the host's clock says.
TOLERANCES = {"trigger": 0, "corrected": 0, "pre_travel": 0, "spread": 0, "touches": 0, "position": 2}
rows = [json.loads(run.stdout) for run in (simulated, measured)]
assert len(rows[0]) == len(rows[1]) == 11, rows
for expected, found in zip(*rows):
    is_jog = expected["action"].startswith(("jog", "status"))
    for key, tolerance in TOLERANCES.items():
        if isinstance(expected.get(key), (int, float)) and not (is_jog and key == "position"):
            assert abs(expected[key] - found[key]) <= tolerance, f"{board}: {found} instead of {expected}"

print(board, "results", len(rows[1]))
figures("servo_module", bench, ram)
