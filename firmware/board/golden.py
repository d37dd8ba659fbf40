"""What a firmware makes of commands, beside what the host's emulated machine makes of the same ones: event by event."""
import csv
import os
import subprocess
import sys

import registers

# A foreground gives one event after the other, as it has to look at the switches: one that follows within this time of another may come this late.
FOREGROUND_US = 300


class Emulated:
    """A machine that the host emulates, quicker than in real time."""

    def __init__(self, husillo, machine, folder, speed, *options):
        self.link, self.steps = (os.path.join(folder, f"{machine}.{kind}") for kind in ("link", "csv"))
        arguments = ["--link", self.link, "--steps", self.steps, "--speed", str(speed), *options]
        self.process = subprocess.Popen([husillo, "emulate", machine, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.process.stdout.readline()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.communicate()

    def rows(self):
        """All that it has made, when it was ended."""
        with open(self.steps) as file:
            return [{name: int(value) for name, value in row.items()} for row in csv.DictReader(file)]


def compare(board, happened, rows, pins, outputs, slow=0):
    """Compares pins written when a wait was over, and outputs switched, with rows: how many of these have happened.

    `pins` gives levels and outputs of a row; `outputs` are those before the first one. Waits count from the event before or, where an output that is `slow` was
    switched on, from then; how long a machine stood before nobody knows.
    """
    clocks_per_us = registers.BOARDS[board].CLOCKS_PER_US
    happened, due, t_us = iter(happened), None, None

    def expect(what, found, expected):
        if found != expected:
            sys.exit(f"{board}: row {number + 1}, behind event {row['event']}: {what} {found} instead of {expected}")

    for number, row in enumerate(rows):
        before, (levels, outputs) = outputs, pins(row)
        is_switch = not row["wait_ticks"] and not any(row[name] for name in row if name.startswith("d"))
        if is_switch and outputs == before:
            continue
        one = next(happened, None)
        if one is None:
            return number
        expect("outputs", one.outputs, outputs)
        expect("only outputs:", isinstance(one, registers.Switched), is_switch)
        if is_switch:
            if outputs & ~before & slow:
                due, t_us = next(happened).due, row["t_us"]
            continue
        expect("levels", one.levels, levels)
        if t_us is not None and row["t_us"] - t_us == row["wait_ticks"]:
            wait_us = (one.due - due) % 2**32 / clocks_per_us
            if not row["wait_ticks"] <= wait_us < FOREGROUND_US:
                expect("wait", wait_us, row["wait_ticks"])
        due, t_us = one.due, row["t_us"]
    if next(happened, None):
        sys.exit(f"{board}: more than {len(rows)} rows of events")
    return len(rows)
