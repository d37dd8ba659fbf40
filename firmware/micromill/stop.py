"""stop.py BOARD: a byte that stops acts before the next step, even where the processor is so slow that the foreground is steps behind.

QEMU's log tells each interrupt: behind that of the stopping byte the motors' pins may not change any more (a step that was due already is let through).
The steps that the link told are those of the pins.
"""
import os
import sys
import tempfile
import time

from link import STEPS, STOPPED, TAKEN, Mill
import registers  # noqa: E402

board = sys.argv[1]
BYTE = {"microbit": "taking pending nonsecure exception 18", "mps2-an386": "taking pending nonsecure exception 16", "virt": "desc=m_external"}[board]
SHIFT = 10 if board == "mps2-an386" else 9

with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    # 2 million instructions a second, or 1: reading and checking two lines takes longer than two steps, which would be made if the interrupt let them.
    with Mill(board, *registers.ARGUMENTS, "-D", log, "-icount", f"shift={SHIFT},sleep=off") as mill:
        mill.booted()
        told = [0, 0, 0]

        def tally(said):
            for byte in said:
                if byte in STEPS:
                    told[byte >> 1 & 3] += 1 if byte & 1 else -1

        def logged():
            """What is in the log, which is empty then."""
            # The monitor answers when all before it was written, and nothing is until it goes on.
            mill.monitor("stop")
            with open(log, errors="replace") as file:
                text = file.read()
            os.truncate(log, 0)
            mill.monitor("cont")
            return text

        def made(text):
            """What was written to the pins."""
            return [step for step in registers.read(board, text.splitlines()) if not isinstance(step, int)]

        def phases(step):
            """PH of X, Y and Z."""
            return [step.levels >> place & 3 for place in (0, 2, 4)]

        # The phases of a motor after 0 to 3 steps.
        cycle = []
        for _ in range(4):
            cycle.append(phases(made(logged())[-1])[0])
            tally(mill.ask(b"PX+0001;"))
        assert len(set(cycle)) == 4, cycle
        tally(mill.ask(b"H;", (0x8F, 0x89)))
        tally(mill.ask(b"G01X00005Y00005F0100;"))
        tally(mill.ask(b"S1;"))
        for turn in range(6):
            lines = [b"G01X%05dY%05dF0100;" % (10 + 60 * turn + 3 * number, 10 + 40 * turn + 5 * number) for number in range(10)]
            for line in lines:
                tally(mill.ask(line, (TAKEN,)))
            before = made(logged())
            # The foreground has two lines to read before it comes to the stop: an arc that is none, and a feed.
            mill.line.send(b"G02X9Y9I5J7F99;" + lines[1][:9] + b"F99;A")
            said = b""
            while STOPPED not in said:
                said += mill.receive(10)
            time.sleep(0.2)
            text = logged()
            tally(said + mill.ask(b";"))
            place = text.rindex(BYTE)
            late = made(text[place:])
            if len(late) > 1:
                sys.exit(f"{board}: {len(late)} steps after the byte that stops")
            stand = phases((before + made(text))[-1])
            if stand != [cycle[steps % 4] for steps in told]:
                sys.exit(f"{board}: the motors stand at {stand} after {told} steps")
print(board, "stops before the next step")
