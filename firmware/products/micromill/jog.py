"""jog.py BOARD HUSILLO: moves the firmware by hand with `husillo jog`, in the time of the clock on the wall.

Several axes step together, faster and slower when told, and as many steps as the host says; a host that is killed leaves a jog that ends by itself.
"""
import os
import re
import subprocess
import sys
import tempfile
import time

os.environ["SLOW"] = "1"
sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../board"))
import registers  # noqa: E402
from bench import Bench  # noqa: E402

board, husillo = sys.argv[1:3]
STOPPED = 0x8D
# At 170 steps a second, and at 180.
WAITS_US = [5883, 5556, 5883]

with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    with Bench("micromill", board, *registers.ARGUMENTS, "-D", log) as bench:
        bench.booted()

        def jog(*actions):
            return [husillo, "jog", "-m", "micromill", "--port", f"tcp:127.0.0.1:{bench.port}", *actions]

        def happened():
            bench.monitor("info status")
            with open(log, errors="replace") as file:
                return registers.read(board, file)

        told = subprocess.run(jog(*"x+y-z+ 0.5s faster 0.5s slower 0.5s run z -250 0.5s x 30".split()), capture_output=True, text=True, timeout=60)
        if told.returncode:
            sys.exit(told.stdout + told.stderr)
        # The first was written when it was switched on, with none waited for.
        steps = [step for step in happened() if not isinstance(step, int)][1:]
        clocks_per_us = registers.BOARDS[board].CLOCKS_PER_US
        waits = [round((after.due - before.due) % 2**32 / clocks_per_us) for before, after in zip(steps, steps[1:])]
        counts = [int(count) for count in re.findall(r"s, (\d+) steps", told.stdout)]
        jogged = counts[0] // 3
        assert counts[0] % 3 == 0 and counts[2] == 30 and len(steps) == jogged + counts[1] + 30, (counts, len(steps))
        # Each axis has another phase after every event.
        for before, after in zip(steps[:jogged], steps[1:jogged]):
            assert all((before.levels ^ after.levels) >> place & 3 for place in (0, 2, 4)), "an axis stood"
        # Waits may be longer: the steps run dry where this computer is held up, on a busy one most of them.
        right = [wait for wait in waits[:jogged - 1] if wait in WAITS_US]
        paces = [wait for place, wait in enumerate(right) if not place or wait != right[place - 1]]
        assert paces == WAITS_US and len(right) > 0.3 * jogged, waits[:jogged]
        assert waits[jogged:jogged + counts[1] - 1].count(4000) > 0.3 * counts[1], waits[jogged:]

        # The host is gone without a word.
        host = subprocess.Popen(jog("x+", "30s"), stdout=subprocess.DEVNULL)
        time.sleep(1.5)
        host.kill()
        host.wait()
        # Half a second after its last word, however long that takes here.
        for _ in range(20):
            time.sleep(0.5)
            ended = happened()
            if ended[-1] == STOPPED:
                break
        time.sleep(0.5)
        again = happened()
        assert len(again) == len(ended) and ended[-1] == STOPPED, f"{board}: it goes on without a host"
        alone = sum(not isinstance(step, int) for step in ended) - 1 - len(steps)
        # The whole jog would be 5100 steps.
        assert 50 < alone < 2000, alone
print(f"{board}: jogged {counts[0]} steps of three axes; without a host it stopped")
