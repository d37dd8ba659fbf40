"""stop.py BOARD: a byte that stops acts before the next step, even where the processor is so slow that the foreground is steps behind.

QEMU's log tells each access to a register: once the stopping byte was read the motors' pins may not change any more. Interrupts have one priority, so a step
that was due in the same instant is made before that, or not at all. The steps that the link told are those of the pins. A step after the stop waits its time after
the last one that was made, and no longer than that from now on.
"""
import math
import os
import sys
import tempfile
import time

from link import STEPS, STOPPED, TAKEN, Mill
import registers  # noqa: E402

board = sys.argv[1]
CLOCKS_PER_US = registers.BOARDS[board].CLOCKS_PER_US
STOP = f"addr {registers.BOARDS[board].HEARD:#x} value 0x41 "
# Of a counted step: those a second of the machine.
WAIT_US = math.ceil(1e6 / 170)

with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    # A million instructions a second, as slow as QEMU goes.
    with Mill(board, *registers.ARGUMENTS, "-D", log, "-icount", "shift=10,sleep=off") as mill:
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
            before = logged()
            # The foreground has two lines to read before it comes to the stop: an arc that is none, and a feed. On the microbit that takes longer than two
            # steps, so a hold that does nothing is seen there; the mps2-an386 has read them before, and on virt QEMU takes a byte too late.
            mill.line.send(b"G02X9Y9I5J7F99;" + lines[1][:9] + b"F99;A")
            said = b""
            while STOPPED not in said:
                if not (more := mill.receive(10)):
                    sys.exit(f"{board}: silent after a byte that stops")
                said += more
            time.sleep(0.2)
            text = logged()
            tally(said + mill.ask(b";"))
            late = made(text[text.rindex(STOP):])
            if late:
                sys.exit(f"{board}: {len(late)} steps after the byte that stops")
            last = made(before + text)[-1]
            stand = phases(last)
            if stand != [cycle[steps % 4] for steps in told]:
                sys.exit(f"{board}: the motors stand at {stand} after {told} steps")
            tally(mill.ask(b"PX+0001;"))
            step, = made(logged())
            since_us = (step.due - last.due) % 2**32 / CLOCKS_PER_US
            if since_us < WAIT_US:
                sys.exit(f"{board}: the step after a stop comes {since_us} us after the one before, not {WAIT_US}")

    # By the clock on the wall, which does not jump to the end of a wait that was cut short.
    os.truncate(log, 0)
    with Mill(board, *registers.ARGUMENTS, "-D", log, "-icount", "shift=6,sleep=on") as mill:
        mill.booted()
        mill.home()
        mill.ask(b"G01X00005Y00005F0100;")
        mill.ask(b"S1;")
        mill.ask(b"G04P10;", (TAKEN,))
        mill.ask(b"G01X00009Y00005F0100;", (TAKEN,))
        mill.ask(b"A", (STOPPED,))
        mill.ask(b";")
        mill.ask(b"PX+0001;")
        mill.monitor("stop")
        with open(log, errors="replace") as file:
            step = [step for step in registers.read(board, file) if not isinstance(step, int)][-1]
        wait_us = (step.due - step.asked) % 2**32 / CLOCKS_PER_US
        if not WAIT_US <= wait_us <= WAIT_US + 1:
            sys.exit(f"{board}: the step after a wait that was cut short waits {wait_us} us, not {WAIT_US}")
print(board, "stops before the next step")
