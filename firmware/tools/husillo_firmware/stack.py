"""Bounds the stack depth of a program for a Cortex-M0, from its code.

The bound of a function is the most stack that it and its callees can take. It is the sum of the
registers that each function pushes and the space that it reserves, along the deepest chain of
calls. Every chain counts, even if no input leads to it. There is no bound for a function that calls
through a pointer or calls itself. Then the check fails.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass, field
from pathlib import Path

from husillo_firmware.boards import MICROBIT
from husillo_firmware.build import elf
from husillo_firmware.elf import Elf
from husillo_firmware.waiting import fail

# The 8 words that the chip pushes at an interrupt, and the two words of the reset.
FRAMES = 40


@dataclass
class Function:
    """The stack that a function takes without its callees, and its calls and jumps."""

    room: int = 0
    calls: set[int] = field(default_factory=set)
    jumps: set[int] = field(default_factory=set)
    calls_a_pointer: bool = False


class Depths:
    """Bounds of the functions of a program."""

    def __init__(self, path: Path) -> None:
        self.path, self.elf = path, Elf(path)
        # The name and the length of the function at an address.
        self.functions: dict[int, tuple[str, int]] = {}
        # Addresses at which code begins (False) or data begins (True).
        self.marks: dict[int, bool] = {}
        for symbol in self.elf.symbols():
            if symbol.is_function:
                self.functions.setdefault(symbol.value & ~1, (symbol.name, symbol.length))
            elif re.match(r"\$[td](\.|$)", symbol.name):
                self.marks[symbol.value] = symbol.name[1] == "d"
        # `None` while the depth is being computed.
        self.depths: dict[int, int | None] = {}
        sys.setrecursionlimit(10000)

    def bound(self, pattern: str) -> int:
        """The bound of the only function whose symbol matches this pattern."""
        found = [at for at, (name, _) in self.functions.items() if re.search(pattern, name)]
        if len(found) != 1:
            fail(f"{self.path}: {len(found)} functions match {pattern}")
        depth = self.depth(found[0])
        assert depth is not None, "no function is looked for here"
        return depth

    def depth(self, begin: int) -> int | None:
        """The bound of the function at an address; `None` while it is being computed."""
        if begin not in self.depths:
            self.depths[begin] = None
            function = self.scan(begin)
            below = [self.depth(to) for to in function.calls]
            instead = [self.depth(to) for to in function.jumps]
            if function.calls_a_pointer or None in below + instead:
                fail(f"{self.path}: no bound for {self.functions[begin][0]}")
            deepest = max((depth for depth in below if depth is not None), default=0)
            others = [depth for depth in instead if depth is not None]
            self.depths[begin] = max(function.room + deepest, *others, 0)
        return self.depths[begin]

    def scan(self, begin: int) -> Function:
        """Reads the code of a function."""
        end = begin + self.functions[begin][1]
        function, is_data = Function(), False
        # The values loaded into registers.
        loaded: dict[int, int] = {}
        at = begin
        while at < end:
            is_data = self.marks.get(at, is_data)
            code = 0 if is_data else self.elf.halfword(at)
            if code & 0xFE00 == 0xB400:  # push
                function.room += 4 * bin(code & 0x1FF).count("1")
            elif code & 0xFF80 == 0xB080:  # sub sp, #n
                function.room += 4 * (code & 0x7F)
            elif code & 0xF800 == 0x4800:  # ldr r, [pc, #n]
                place = (at + 4 & ~3) + 4 * (code & 0xFF)
                loaded[code >> 8 & 7] = self.elf.number(place, "<i")
            elif code & 0xFF87 == 0x4485:  # add sp, r
                function.room -= min(loaded.get(code >> 3 & 15, 0), 0)
            elif code & 0xFF80 == 0x4780 and code != 0x47F0:  # blx r
                # The address was loaded into the register before, perhaps for several calls.
                to = loaded.get(code >> 3 & 15, 0) & ~1
                if to in self.functions:
                    function.calls.add(to)
                else:
                    function.calls_a_pointer = True
            elif code & 0xF800 == 0xE000:  # b
                function.jumps.add(at + 4 + 2 * ((code & 0x7FF) - (code << 1 & 0x800)))
            elif code & 0xF800 >= 0xF000:
                low = self.elf.halfword(at + 2)
                if code & 0xF800 == 0xF000 and low & 0xD000 == 0xD000:  # bl
                    to = at + 4 + branch(code, low)
                    # If the target is within the function, this is a jump that is too far for `b`.
                    if not begin < to < end:
                        function.calls.add(to)
                at += 2
            at += 2
        function.jumps = {to for to in function.jumps if to in self.functions and to != begin}
        return function


def branch(high: int, low: int) -> int:
    """The distance of a `bl` that consists of these halfwords."""
    sign = high >> 10 & 1
    first, second = 1 - (low >> 13 & 1 ^ sign), 1 - (low >> 11 & 1 ^ sign)
    bits = first << 23 | second << 22 | (high & 0x3FF) << 12 | (low & 0x7FF) << 1
    return bits - (sign << 24)


def worst(firmware: str) -> int:
    """The bound of the stack depth of a firmware, for any input.

    It is the sum of the depths of `main` and of an interrupt, with the frame that the chip pushes.
    """
    depths = Depths(elf(firmware, MICROBIT))
    interrupts = ("on_timer_interrupt", "on_uart_interrupt")
    return depths.bound("cortex_m_rt_main") + max(map(depths.bound, interrupts)) + FRAMES
