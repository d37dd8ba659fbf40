"""run.py BOARD HUSILLO PROGRAM [--steps]: cuts a program with the firmware in QEMU by the host, and compares it with the host's own files of it.

Of each event the wait, the motors' phases and the spindle at the pins, and of the line every byte: echoes, steps, answers. With `--steps` only the steps
that are told: programs of any length. Prints steps, by how much their lateness varies, flash, static RAM and the deepest stack.
"""
import csv
import math
import os
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "../../board"))
import registers  # noqa: E402
from bench import Bench, figures, send  # noqa: E402

board, husillo, program = sys.argv[1:4]
is_traced = "--steps" not in sys.argv
DONE = 0x8F


def made_by_the_host(folder):
    """The strings, and of each its step events: rows of `husillo steps`, with the levels of the drivers."""
    compiled = subprocess.run([husillo, "compile", program, "-m", "micromill"], capture_output=True, text=True, check=True)
    strings = compiled.stdout.splitlines()
    path, before, parts = os.path.join(folder, "part.mm"), 0, []
    for count in range(1, len(strings) + 1):
        with open(path, "w") as file:
            file.write("\n".join(strings[:count]) + "\n")
        steps = subprocess.run([husillo, "steps", path, "--levels", "-o", "-"], capture_output=True, text=True, check=True)
        rows = [{name: int(value) for name, value in row.items()} for row in csv.DictReader(steps.stdout.splitlines())]
        parts.append(rows[before:])
        before = len(rows)
    return strings, parts


def report(path):
    """What the simulator says of a program."""
    return subprocess.run([husillo, "run", path, "-m", "micromill", "--format", "json"], capture_output=True, text=True, check=True).stdout


def compare(happened, strings, parts):
    """Compares what happened after homing with the host's files; how late each step was whose line was under way, in microseconds."""

    def differs(what, found, expected):
        if found != expected:
            sys.exit(f"{board}: {what}: {found} instead of {expected}")

    homed = happened.index(DONE) + 1
    at = [0, 0, 0]
    for byte in happened[:homed]:
        if isinstance(byte, int) and 0x80 <= byte <= 0x85:
            at[byte >> 1 & 3] += 1 if byte & 1 else -1
    # PH of both phases of a motor that has gone so many steps, as the host's file has it from the first step on.
    cycle, sums = {}, [0, 0, 0]
    for row in (row for rows in parts for row in rows):
        for axis, letter in enumerate("xyz"):
            sums[axis] += row["d" + letter]
            levels = row["l" + letter]
            phases = levels & 1 | levels >> 2 & 2
            differs("the host's levels", cycle.setdefault(sums[axis] % 4, phases), phases)

    said = bytes(byte for byte in happened[homed:] if isinstance(byte, int))
    made = [step for step in happened[homed:] if not isinstance(step, int)]
    differs("events", len(made), sum(map(len, parts)))
    expected, spindle, number, last, late = b"", 0, 0, None, []
    clocks_per_us = registers.BOARDS[board].CLOCKS_PER_US
    for string, rows in zip(strings, parts):
        expected += string.encode()
        spindle = {"M03": 1, "M04": 2, "M05": 0, "M30": 0}.get(string[:3], spindle)
        for place, row in enumerate(rows):
            step, number = made[number], number + 1
            for axis, letter in enumerate("xyz"):
                delta = row["d" + letter]
                at[axis] += delta
                if delta:
                    expected += bytes([0x80 | axis << 1 | (delta > 0)])
            where = f"{string} event {place + 1}"
            differs(f"{where}: phases", step.levels, sum(cycle[steps % 4] << 2 * axis for axis, steps in enumerate(at)))
            differs(f"{where}: spindle", step.outputs, spindle)
            assert step.due is not None, f"{where} was not waited for"
            if place:
                differs(f"{where}: wait", (step.due - last) % 2**32 / clocks_per_us, row["wait_ticks"])
                if step.at is not None:
                    late.append((step.at - step.due) % 2**32 / clocks_per_us)
            elif last is not None and (step.due - last) % 2**32 < row["wait_ticks"] * clocks_per_us:
                sys.exit(f"{where}: before its wait is over")
            last = step.due
        expected += bytes([DONE])
    differs("what was said", said.hex(), expected.hex())
    # No step is told before it is made.
    ahead = 0
    for one in happened[homed:]:
        if isinstance(one, int):
            ahead -= 0x80 <= one <= 0x85
        else:
            ahead += 3
        assert ahead >= 0, "a step is told before it is made"
    return late


with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    arguments = [*registers.ARGUMENTS, "-D", log] if is_traced else []
    with Bench("micromill", board, *arguments) as bench:
        bench.booted()
        told = send(husillo, program, "micromill", f"tcp:127.0.0.1:{bench.port}")
        ram = bench.ram()
    # The steps told are those of the strings on the simulator: what it says of them has to be what it says of the program.
    path = os.path.join(folder, "strings.mm")
    subprocess.run([husillo, "compile", program, "-m", "micromill", "-o", path], capture_output=True, check=True)
    if report(path) != report(program):
        sys.exit(f"{board}: {report(path)} instead of {report(program)}")
    late = []
    if is_traced:
        late = compare(registers.read(board, open(log, errors="replace")), *made_by_the_host(folder))

print(board, "steps", *told)
if late:
    # In virtual time, 64 ns an instruction, from the wait's end until the time is read behind the pins. Of 1000 steps the latest is left out: on a busy
    # computer QEMU's clock now and then jumps too far where the chip sleeps. `held_longest` of count.py has what the firmware itself can do.
    assert len(late) > 0.8 * int(told[0]), len(late)
    late.sort()
    print(board, "jitter_us", math.ceil(late[len(late) * 999 // 1000] - late[0]))
figures("micromill", bench, ram)
