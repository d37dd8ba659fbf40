"""count.py BOARD HUSILLO: prints how many instructions a servo interrupt takes while the host has the motor go to and fro."""
import os
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../board"))
from bench import Bench, Elf, elf  # noqa: E402
from log import Count  # noqa: E402

board, husillo = sys.argv[1:3]
program = Elf(elf("servo_module", board))
GOALS = "goto 7000 goto -7000 goto 7000 goto -7000 goto 7000 goto -7000".split()

with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    with Bench("servo_module", board, "-singlestep", "-D", log) as bench:
        time.sleep(2)
        host = subprocess.Popen(
            [husillo, "measure", "-m", "cmm", "--port", f"tcp:127.0.0.1:{bench.port}", *GOALS],
            stdout=subprocess.DEVNULL)
        # Some of the start-up, and of the ways. The last interrupt of a window may be cut off.
        ticks = []
        for _ in range(12):
            bench.monitor("log exec,nochain,int")
            time.sleep(0.2)
            bench.monitor("log none")
            count = Count(board, program, log)
            os.truncate(log, 0)
            ticks += count.step[:-1]
            time.sleep(0.4)
        host.kill()
        host.wait()
ticks.sort()
assert len(ticks) > 500, len(ticks)
for name, value in (
    ("ticks", len(ticks)),
    ("tick_median", ticks[len(ticks) // 2]),
    ("tick_longest", ticks[-1]),
):
    print(board, "count", name, value)
