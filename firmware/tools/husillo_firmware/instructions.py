"""Counts instructions in QEMU's log of every instruction (-singlestep, log exec,nochain,int)."""

from __future__ import annotations

import re
from pathlib import Path

from husillo_firmware.qemu import Firmware

# The commands of QEMU's monitor that begin and end such a log.
BEGIN, END = "log exec,nochain,int", "log none"

# A foreground that sleeps again after fewer instructions has only checked for work.
IDLE = 32

# The number of the timer's interrupt in the log. The only other interrupt is that of the UART.
TIMER = {"microbit": "24", "mps2-an386": "24", "virt": "7"}

# Instructions that disable interrupts (True) and enable them (False): cpsid and cpsie; csrrci and
# csrrsi of bit 3 of mstatus.
HOLDS = {0xB672: True, 0xB662: False}
HOLDS_RISCV = {0x30047073: True, 0x30046073: False}


class Count:
    """Counts the instructions in a log: all of them, or only those up to the first sleep."""

    def __init__(self, firmware: Firmware, path: Path, to_sleep: bool = False) -> None:
        self.firmware, self.program = firmware, firmware.elf
        self.is_riscv = firmware.board.name == "virt"
        self.foreground = 0
        # Instructions of each timer interrupt, and of each other one.
        self.step: list[int] = []
        self.byte: list[int] = []
        # The longest series of instructions in which the timer interrupt is blocked.
        self.held = 0
        # The list to which the running interrupt belongs. `None`: the foreground runs.
        self.inside: list[int] | None = None
        self.stretch, self.is_held = 0, False
        # Instructions of the foreground since its last sleep.
        self.awake = IDLE
        # For the instruction at an address: whether it holds interrupts, returns, sleeps.
        self.known: dict[int, tuple[bool | None, bool, bool]] = {}
        with path.open(errors="replace") as lines:
            for line in lines:
                if self.sleeps_after(line) and to_sleep:
                    break

    def sleeps_after(self, line: str) -> bool:
        """Counts a line of the log. Returns whether the foreground sleeps after it."""
        if line.startswith("Trace"):
            at = line.index("[")
            return self.executed(int(line[at + 10 : at + 18], 16))
        # The instruction was not executed. It is logged again.
        if line.startswith(("Stopped", "cpu_io_recompile")):
            if self.inside is None:
                self.foreground -= 1
            else:
                self.inside[-1] -= 1
            self.stretch -= 1
        elif "taking pending" in line or "riscv_cpu_do_interrupt" in line:
            number = re.search(r"exception (\d+)|cause:(\w+)", line)
            assert number is not None, line
            is_timer = (number[1] or str(int(number[2], 16))) == TIMER[self.firmware.board.name]
            self.inside = self.step if is_timer else self.byte
            self.inside.append(0)
            self.stretch = 0
        elif "successful exception return" in line:
            self.leave()
        return False

    def executed(self, address: int) -> bool:
        """Counts an instruction. Returns whether the foreground sleeps after it."""
        is_foreground = self.inside is None
        if self.inside is None:
            self.foreground += 1
            self.awake += 1
        else:
            self.inside[-1] += 1
        if address not in self.known:
            sleeps = self.firmware.is_sleep(address)
            self.known[address] = self.holds(address), self.is_return(address), sleeps
        holds, returns, sleeps = self.known[address]
        if self.inside is not self.step:
            self.stretch += 1
            if is_foreground and holds is not None:
                if holds and not self.is_held:
                    self.stretch = 1
                elif not holds and self.is_held:
                    self.held = max(self.held, self.stretch)
                self.is_held = holds
        if is_foreground and sleeps:
            # An interrupt woke the foreground without work, so these instructions do not count.
            if self.awake < IDLE:
                self.foreground -= self.awake
            self.awake = 0
        if returns:
            self.leave()
        return is_foreground and sleeps

    def leave(self) -> None:
        """Ends an interrupt."""
        if self.inside is self.byte:
            self.held = max(self.held, self.stretch)
        self.inside = None

    def word(self, address: int) -> int:
        """Four bytes of code."""
        return self.program.halfword(address) | self.program.halfword(address + 2) << 16

    def is_return(self, address: int) -> bool:
        """Whether this is mret. On ARM boards this is not needed, as QEMU logs the return."""
        return self.is_riscv and self.word(address) == 0x3020_0073

    def holds(self, address: int) -> bool | None:
        """Whether the instruction disables interrupts, enables them, or neither (`None`)."""
        if self.is_riscv:
            return HOLDS_RISCV.get(self.word(address) & ~0xF80)
        return HOLDS.get(self.program.halfword(address))
