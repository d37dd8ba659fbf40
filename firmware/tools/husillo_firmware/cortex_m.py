"""The processor of a simulated chip: a Cortex-M with its exceptions."""

from __future__ import annotations

import struct
from abc import abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

from unicorn import arm_const as arm
from unicorn.unicorn import Uc
from unicorn.unicorn_const import UC_ARCH_ARM, UC_MODE_MCLASS, UC_MODE_THUMB

from husillo_firmware.simulated import Chip

RAM = 0x2000_0000
VECTORS = 0xE000_ED08
# Where a handler returns to, without the bit of Thumb.
RETURN = 0xFFFF_FFF8


@dataclass
class CortexM(Chip):
    """A chip with such a processor."""

    sleep = b"\x30\xbf"
    mode = 1
    end = RETURN
    model: ClassVar[int]
    # Where the flash begins, and the vectors of the program.
    program: ClassVar[int]
    vectors: ClassVar[int]
    ram_bytes: ClassVar[int]
    # The parts of the address space with registers, and their lengths.
    parts: ClassVar[tuple[tuple[int, int], ...]]

    def processor(self) -> Uc:
        cpu = Uc(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS)
        cpu.ctl_set_cpu_model(self.model)
        for begin, length in ((self.program, self.flash_bytes), (RAM, self.ram_bytes)):
            cpu.mem_map(begin, length)
        cpu.mem_write(self.program, bytes(self.flash))
        for begin, length in self.parts:
            cpu.mmio_map(begin, length, self.reader(begin), None, self.writer(begin), None)
        return cpu

    def start(self) -> None:
        stack, entry = struct.unpack_from("<II", self.flash, self.vectors - self.program)
        self.cpu.reg_write(arm.UC_ARM_REG_SP, stack)
        self.at = entry & ~1

    @abstractmethod
    def read(self, address: int, size: int) -> int:
        """A register."""

    @abstractmethod
    def write(self, address: int, size: int, value: int) -> None:
        """Writes a register."""

    def reader(self, base: int) -> Callable[[Uc, int, int, object], int]:
        """Reads a part of the address space."""
        return lambda _, offset, size, __: self.read(self.place(base + offset), size)

    def writer(self, base: int) -> Callable[[Uc, int, int, int, object], None]:
        """Writes a part of the address space."""
        return lambda _, offset, size, value, __: self.change(base + offset, size, value)

    def place(self, address: int) -> int:
        """Which register has this address."""
        return address

    def change(self, address: int, size: int, value: int) -> None:
        """Writes to an address."""
        self.write(address, size, value)

    def permits(self) -> bool:
        return not self.cpu.reg_read(arm.UC_ARM_REG_PRIMASK) & 1

    def enter(self, number: int) -> None:
        cpu = self.cpu
        saved = [cpu.reg_read(arm.UC_ARM_REG_R0 + n) for n in range(4)]
        saved += [cpu.reg_read(arm.UC_ARM_REG_R12), cpu.reg_read(arm.UC_ARM_REG_LR), self.at]
        stack = cpu.reg_read(arm.UC_ARM_REG_SP)
        frame = (stack - 32) & ~7
        # Bit 9 tells that the frame was aligned.
        flags = cpu.reg_read(arm.UC_ARM_REG_XPSR) & ~(1 << 9) | int(frame != stack - 32) << 9
        cpu.mem_write(frame, struct.pack("<8I", *saved, flags))
        cpu.reg_write(arm.UC_ARM_REG_SP, frame)
        cpu.reg_write(arm.UC_ARM_REG_LR, RETURN | 1)
        table = self.registers.get(VECTORS, self.vectors)
        (handler,) = struct.unpack("<I", cpu.mem_read(table + 64 + 4 * number, 4))
        assert handler & 1, f"interrupt {number} has no handler"
        self.at = handler & ~1

    def leaves(self) -> bool:
        if self.at != RETURN:
            return False
        cpu = self.cpu
        frame = cpu.reg_read(arm.UC_ARM_REG_SP)
        values = struct.unpack("<8I", cpu.mem_read(frame, 32))
        for number in range(4):
            cpu.reg_write(arm.UC_ARM_REG_R0 + number, values[number])
        cpu.reg_write(arm.UC_ARM_REG_R12, values[4])
        cpu.reg_write(arm.UC_ARM_REG_LR, values[5])
        cpu.reg_write(arm.UC_ARM_REG_SP, frame + 32 + 4 * (values[7] >> 9 & 1))
        cpu.reg_write(arm.UC_ARM_REG_XPSR, values[7])
        self.at = values[6]
        return True

    def counter(self) -> int:
        return int(self.cpu.reg_read(arm.UC_ARM_REG_PC)) & ~1
