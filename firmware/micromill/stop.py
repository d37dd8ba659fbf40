"""stop.py BOARD: a byte that stops acts before the next step, even where the processor is so slow that the foreground is steps behind.

QEMU's log tells each interrupt: behind that of the stopping byte there may be no step any more (one that was due already is let through). The
steps that the link told are those of the motors' pins, where the board has any.
"""
import os
import sys
import tempfile
import time

from link import STEPS, STOPPED, TAKEN, Mill

board = sys.argv[1]
STEP = {"microbit": "taking pending nonsecure exception 24", "mps2-an386": "taking pending nonsecure exception 24", "virt": "desc=m_timer"}[board]
BYTE = {"microbit": "taking pending nonsecure exception 18", "mps2-an386": "taking pending nonsecure exception 16", "virt": "desc=m_external"}[board]

with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    # 2 million instructions a second: reading and checking two lines takes longer than two steps.
    with Mill(board, "-D", log, "-icount", "shift=9,sleep=off") as mill:
        told = [0, 0, 0]

        def tally(said):
            for byte in said:
                if byte in STEPS:
                    told[byte >> 1 & 3] += 1 if byte & 1 else -1

        def pins():
            """PH of X, Y and Z."""
            levels = mill.word(0x5000_0504) >> 1 if board == "microbit" else 0
            return [levels >> place & 3 for place in (0, 2, 4)]

        # The phases of a motor after 0 to 3 steps; zeros where the board simulated has no pins.
        cycle = []
        for _ in range(4):
            cycle.append(pins()[0])
            tally(mill.ask(b"PX+0001;"))
        assert len(set(cycle)) == (4 if board == "microbit" else 1), cycle
        tally(mill.ask(b"H;", (0x8F, 0x89)))
        tally(mill.ask(b"G01X00005Y00005F0100;"))
        tally(mill.ask(b"S1;"))
        for turn in range(6):
            lines = [b"G01X%05dY%05dF0100;" % (10 + 60 * turn + 3 * number, 10 + 40 * turn + 5 * number) for number in range(10)]
            for line in lines:
                tally(mill.ask(line, (TAKEN,)))
            mill.monitor("log int")
            # The foreground has two lines to read before it comes to the stop.
            mill.line.send(lines[0][:9] + b"F99;" + lines[1][:9] + b"F99;A")
            said = b""
            while STOPPED not in said:
                said += mill.receive(10)
            time.sleep(0.2)
            mill.monitor("log none")
            tally(said + mill.ask(b";"))
            text = open(log).read()
            os.truncate(log, 0)
            late = text[text.rindex(BYTE):].count(STEP)
            if late > 1:
                sys.exit(f"{board}: {late} steps after the byte that stops")
            if pins() != [cycle[steps % 4] for steps in told]:
                sys.exit(f"{board}: the motors stand at {pins()} after {told} steps")
print(board, "stops before the next step")
