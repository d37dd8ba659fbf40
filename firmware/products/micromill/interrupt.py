"""interrupt.py BOARD HUSILLO: a host that is asked to end while the firmware moves stops it first.

Ctrl-C and a request to end, in a jog, in steps, and in a program, in the time of the clock on the wall:
within MOST_STEPS the motors stand, and the host says so.
"""
import os
import signal
import subprocess
import sys
import tempfile
import time

os.environ["SLOW"] = "1"
sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../board"))
import registers  # noqa: E402
from bench import Bench  # noqa: E402

board, husillo = sys.argv[1:3]
# Of 170 a second, from before the request to the last one, with what this computer needs to look.
MOST_STEPS = 100

with tempfile.TemporaryDirectory() as folder:
    log, program = os.path.join(folder, "log"), os.path.join(folder, "long.nc")
    with open(program, "w") as file:
        file.write("G21 G90\nG1 X5 F10\nG1 X0\nM30\n")
    with Bench("micromill", board, *registers.ARGUMENTS, "-D", log) as bench:
        bench.booted()

        def steps():
            bench.monitor("info status")
            with open(log, errors="replace") as file:
                return sum(not isinstance(one, int) for one in registers.read(board, file))

        most = 0
        for words, request in (
            (["jog", "x+", "30s"], signal.SIGINT),
            (["jog", "x", "5000"], signal.SIGTERM),
            (["jog", "run", "z", "-250", "30s"], signal.SIGINT),
            (["send", program], signal.SIGTERM),
            (["send", program, "--stream"], signal.SIGINT),
        ):
            start = steps()
            host = subprocess.Popen(
                [husillo, *words, "-m", "micromill", "--port", f"tcp:127.0.0.1:{bench.port}"],
                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            for _ in range(100):
                time.sleep(0.1)
                if (before := steps()) >= start + 50:
                    break
            assert before >= start + 50, f"{board}: {words} does not move"
            host.send_signal(request)
            told = host.communicate(timeout=20)[1]
            after = steps()
            time.sleep(1)
            assert steps() == after, f"{board}: {words}: it goes on without a host; {told}"
            assert host.returncode == 130, (words, host.returncode, told)
            assert "the controller has stopped" in told, (words, told)
            most = max(most, after - before)
            assert after - before <= MOST_STEPS, f"{board}: {words}: {after - before} steps after the request"
print(f"{board}: a host that is asked to end stops within {most} steps")
