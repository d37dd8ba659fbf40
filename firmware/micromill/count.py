"""count.py BOARD: prints how many instructions the firmware takes for what it does, counted in QEMU's log of every instruction."""
import collections
import os
import re
import sys
import tempfile
import time

from link import STEPS, Mill
from bench import Elf, elf

board = sys.argv[1]
# The number of the step interrupt as the log has it; the UART's is the other one.
STEP = {"microbit": "24", "mps2-an386": "24", "virt": "7"}[board]
program = Elf(elf("micromill", board))


def is_return(address):
    """mret: the ARM boards log it themselves."""
    return board == "virt" and program.halfword(address) == 0x0073 and program.halfword(address + 2) == 0x3020


def holds(address):
    """Whether interrupts are held back from there on (True), let in (False), or neither."""
    code = program.halfword(address)
    if board == "virt":
        code |= program.halfword(address + 2) << 16
        # csrrci and csrrsi of mstatus, bit 3
        return {0x30047073: True, 0x30046073: False}.get(code & ~0xF80)
    return {0xB672: True, 0xB662: False}.get(code)


def sleeps(address):
    """wfi."""
    code = program.halfword(address)
    return code == 0xBF30 if board != "virt" else code == 0x0073 and program.halfword(address + 2) == 0x1050


class Count:
    """What a log says; up to the first sleep or all of it."""

    def __init__(self, path, to_sleep=False):
        self.foreground = 0
        # Instructions of each step interrupt, and of each other one.
        self.step, self.byte = [], []
        # The longest stretch in which no step interrupt comes.
        self.held = 0
        inside, stretch, is_held = None, 0, False
        first = {}
        for line in open(path, errors="replace"):
            if line.startswith("Trace"):
                at = line.index("[")
                address = int(line[at + 10:at + 18], 16)
                if inside is None:
                    self.foreground += 1
                else:
                    inside[-1] += 1
                if address not in first:
                    first[address] = holds(address), is_return(address)
                held, returns = first[address]
                if inside is not self.step:
                    stretch += 1
                    if inside is None and held is not None:
                        if held and not is_held:
                            stretch = 1
                        elif not held and is_held:
                            self.held = max(self.held, stretch)
                        is_held = held
                if to_sleep and sleeps(address):
                    break
                if returns:
                    inside = self.leave(inside, stretch)
            # It was not executed yet: it comes again.
            elif line.startswith(("Stopped", "cpu_io_recompile")):
                if inside is None:
                    self.foreground -= 1
                else:
                    inside[-1] -= 1
                stretch -= 1
            elif "taking pending" in line or "riscv_cpu_do_interrupt" in line:
                number = re.search(r"exception (\d+)|cause:(\w+)", line)
                inside = self.step if (number[1] or str(int(number[2], 16))) == STEP else self.byte
                inside.append(0)
                stretch = 0
            elif "successful exception return" in line:
                inside = self.leave(inside, stretch)

    def leave(self, inside, stretch):
        if inside is self.byte:
            self.held = max(self.held, stretch)
        return None


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
        say("start", Count(log, to_sleep=True).foreground)
    os.truncate(log, 0)

    with Mill(board, "-singlestep", "-D", log) as mill:
        def count(string):
            mill.monitor(flags)
            said = mill.ask(string)
            time.sleep(0.2)
            mill.monitor("log none")
            counted = Count(log)
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
            ("arc_event", b"R001;", b"G02X00295Y00155I00245J00155F0100;"),
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
