"""QEMU's log of every instruction (-singlestep, log exec,nochain,int), counted."""
import re


# A foreground that sleeps again after fewer instructions has only looked whether there is something to do.
IDLE = 32


class Count:
    """What a log of a program on a board says; up to the first sleep or all of it."""

    # The number of the timer's interrupt as the log has it; the UART's is the other one.
    TIMER = {"microbit": "24", "mps2-an386": "24", "virt": "7"}

    def __init__(self, board, program, path, to_sleep=False):
        self.board, self.program = board, program
        self.foreground = 0
        # Instructions of each interrupt of the timer, and of each other one.
        self.step, self.byte = [], []
        # The longest stretch in which no interrupt of the timer comes.
        self.held = 0
        inside, stretch, is_held = None, 0, False
        # Instructions of the foreground since it slept last.
        awake = IDLE
        first = {}
        for line in open(path, errors="replace"):
            if line.startswith("Trace"):
                at = line.index("[")
                address = int(line[at + 10:at + 18], 16)
                if inside is None:
                    self.foreground += 1
                    awake += 1
                else:
                    inside[-1] += 1
                if address not in first:
                    first[address] = self.holds(address), self.is_return(address), self.sleeps(address)
                held, returns, sleeps = first[address]
                if inside is not self.step:
                    stretch += 1
                    if inside is None and held is not None:
                        if held and not is_held:
                            stretch = 1
                        elif not held and is_held:
                            self.held = max(self.held, stretch)
                        is_held = held
                if inside is None and sleeps:
                    if to_sleep:
                        break
                    # Woken by an interrupt that it need not follow yet: it is idle.
                    if awake < IDLE:
                        self.foreground -= awake
                    awake = 0
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
                inside = self.step if (number[1] or str(int(number[2], 16))) == self.TIMER[self.board] else self.byte
                inside.append(0)
                stretch = 0
            elif "successful exception return" in line:
                inside = self.leave(inside, stretch)

    def leave(self, inside, stretch):
        if inside is self.byte:
            self.held = max(self.held, stretch)
        return None

    def is_return(self, address):
        """mret: the ARM boards log it themselves."""
        halfword = self.program.halfword
        return self.board == "virt" and halfword(address) == 0x0073 and halfword(address + 2) == 0x3020

    def holds(self, address):
        """Whether interrupts are held back from there on (True), let in (False), or neither."""
        code = self.program.halfword(address)
        if self.board == "virt":
            code |= self.program.halfword(address + 2) << 16
            # csrrci and csrrsi of mstatus, bit 3
            return {0x30047073: True, 0x30046073: False}.get(code & ~0xF80)
        return {0xB672: True, 0xB662: False}.get(code)

    def sleeps(self, address):
        """wfi."""
        code = self.program.halfword(address)
        return code == 0xBF30 if self.board != "virt" else code == 0x0073 and self.program.halfword(address + 2) == 0x1050
