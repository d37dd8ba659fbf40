"""count.py BOARD: prints how many instructions the firmware takes for what it does, counted in QEMU's log of every instruction."""
import os
import sys
import tempfile
import time

from link import STEPS, Mill
from bench import Elf, elf
from log import Count

board = sys.argv[1]
program = Elf(elf("micromill", board))


def say(name, value):
    print(board, "count", name, f"{value:.0f}")


with tempfile.TemporaryDirectory() as folder:
    log = os.path.join(folder, "log")
    flags = "log exec,nochain,int"

    # From the reset to the first sleep, "ready" in the transmitter: what nothing else wakes.
    with Mill(board, "-S", "-singlestep", "-D", log) as mill:
        mill.monitor(flags)
        mill.monitor("c")
        while not (said := mill.receive(1)):
            pass
        assert said == b"\x88", said
        time.sleep(0.5)
        mill.monitor("log none")
        say("start", Count(board, program, log, to_sleep=True).foreground)
    os.truncate(log, 0)

    with Mill(board, "-singlestep", "-D", log) as mill:
        def count(string):
            mill.monitor(flags)
            said = mill.ask(string)
            time.sleep(0.2)
            mill.monitor("log none")
            counted = Count(board, program, log)
            os.truncate(log, 0)
            return counted, said

        mill.home()
        mill.ask(b"G01X00005Y00005F0100;")
        string = b"G01X00005Y00005F0100;"
        # How often it wakes in between depends on when the host sends: the least of some.
        nowhere = min((count(string)[0] for _ in range(4)), key=lambda counted: counted.foreground)
        say("byte_interrupt", max(nowhere.byte))
        # Without a step: the bytes, the line read, checked and planned.
        say("line", nowhere.foreground)

        held, worst = nowhere.held, 0
        for name, before, string in (
            ("slope_event", None, b"G01X00150Y00080F0100;"),
            ("slope_event_untold", b"R000;", b"G01X00295Y00155F0100;"),
            # Forwards with both axes, as before: nothing is taken up.
            ("arc_event_untold", None, b"G02X00445Y00305I00445J00155F0100;"),
            # 7 steps after 1457.
            ("take_up_event_untold", None, b"G01X00444F0100;"),
            # A circle of 3 mm, and four times lash.
            ("circle_event_untold", None, b"G02X00444Y00305I00444J00705F0100;"),
        ):
            if before:
                mill.ask(before)
            counted, said = count(string)
            events = len(counted.step)
            assert events > 500, (string, said)
            say(name, counted.foreground / events)
            held, worst = max(held, counted.held), max(worst, max(counted.step))
            if name == "slope_event":
                say("step_interrupt", sum(counted.step) / events)
        say("step_interrupt_longest", worst)
        say("held_longest", held)
