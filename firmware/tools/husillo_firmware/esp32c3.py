"""A simulated ESP32-C3, because Debian's QEMU does not have this chip.

It has the parts that `board/src/esp32c3.rs` uses: the loading by the boot ROM, its functions for
the flash, pins, system timer, PWM, interrupts, and the serial port on USB.
"""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass, field

from unicorn import riscv_const as rv
from unicorn.unicorn import Uc
from unicorn.unicorn_const import UC_ARCH_RISCV, UC_HOOK_CODE, UC_MODE_RISCV32

from husillo_firmware.simulated import Chip

CORE_MHZ, TIMER_MHZ = 160, 16
# Addresses and sizes: instruction bus and data bus of the RAM, boot ROM, peripherals.
CODE, DATA, RAM_BYTES = 0x4038_0000, 0x3FC8_0000, 0x6_0000
ROM, ROM_BYTES = 0x4000_0000, 0x6_0000
PERIPHERALS, PERIPHERAL_BYTES = 0x6000_0000, 0xD_1000
ROM_DATA = 0x3FCD_FFF0
RETURN = 0x8082
NUMBER_OF_TIMER, NUMBER_OF_USB = 37, 26
TIMER, USB, MATRIX = 0x6002_3000, 0x6004_3000, 0x600C_2000
# The host looks for a packet after this time.
POLL_US = 100
INTERRUPTS_ON, WERE_ON, MACHINE_MODE = 1 << 3, 1 << 7, 0b11 << 11


@dataclass
class Esp32c3(Chip):
    """The chip."""

    core_mhz = CORE_MHZ
    sleep = bytes.fromhex("73005010")

    packet: bytearray = field(default_factory=bytearray)
    # When the packet was complete, until the host takes it.
    completed: int | None = None
    copied: int = 0
    alarm: int = 0
    # Where each part of the program is loaded, and its length.
    parts: list[tuple[int, int]] = field(default_factory=list)

    def processor(self) -> Uc:
        cpu = Uc(UC_ARCH_RISCV, UC_MODE_RISCV32)
        cpu.mem_map(CODE, RAM_BYTES)
        cpu.mem_map(DATA, RAM_BYTES)
        cpu.mem_map(ROM, ROM_BYTES)
        cpu.mem_write(ROM, struct.pack("<H", RETURN) * (ROM_BYTES // 2))
        cpu.mmio_map(PERIPHERALS, PERIPHERAL_BYTES, self.read, None, self.write, None)
        cpu.hook_add(UC_HOOK_CODE, self.call, begin=ROM, end=ROM + ROM_BYTES)
        # The data of the boot ROM on the flash.
        cpu.mem_write(ROM_DATA, struct.pack("<I", ROM_DATA + 4))
        return cpu

    def start(self) -> None:
        _, parts, _, _, self.at = struct.unpack_from("<4BI", self.flash)
        place = 24
        for _ in range(parts):
            address, length = struct.unpack_from("<II", self.flash, place)
            self.cpu.mem_write(address, bytes(self.flash[place + 8 : place + 8 + length]))
            self.parts.append((address, length))
            place += 8 + length

    @property
    def ticks(self) -> int:
        """The counter of the system timer."""
        return self.clocks * TIMER_MHZ // CORE_MHZ

    def read(self, _: Uc, offset: int, __: int, ___: object) -> int:
        """A register of a peripheral."""
        address = PERIPHERALS + offset
        # An access takes some clocks, so that no loop waits forever.
        self.clocks += 4
        match address:
            case 0x6000_403C:
                return ~self.closed & 0x3F_FFFF
            case 0x6002_3004:
                return 1 << 29
            case 0x6002_3040:
                return self.copied >> 32
            case 0x6002_3044:
                return self.copied & 0xFFFF_FFFF
            case 0x6002_3068:
                return int(self.rings())
            case 0x6002_3070:
                return int(self.rings()) & self.registers.get(TIMER + 0x64, 0)
            case 0x6004_3000:
                return self.to_chip.pop(0) if self.to_chip else 0
            case 0x6004_3004:
                self.poll()
                return int(self.completed is None) << 1 | int(bool(self.to_chip)) << 2
            case 0x6004_3008:
                self.poll()
        return self.registers.get(address, 0)

    def write(self, _: Uc, offset: int, __: int, value: int, ___: object) -> None:
        """Writes a register of a peripheral."""
        address = PERIPHERALS + offset
        match address:
            case 0x6000_4008:
                self.drive(self.levels | value)
            case 0x6000_400C:
                self.drive(self.levels & ~value)
            case 0x6002_3004:
                self.copied = self.ticks
            case 0x6002_3050:
                low, high = (self.registers.get(TIMER + at, 0) for at in (0x20, 0x1C))
                self.alarm = high << 32 | low
            case 0x6004_3000:
                assert self.completed is None, "a byte is written into a complete packet"
                self.packet.append(value & 0xFF)
                assert len(self.packet) <= 64, "the packet is too long"
            case 0x6004_3004 if value & 1:
                self.completed = self.clocks
            case 0x6004_3014:
                self.registers[USB + 8] = self.registers.get(USB + 8, 0) & ~value
        self.registers[address] = value

    def rings(self) -> bool:
        """Whether the time of the timer's alarm has come."""
        return self.compares() and self.ticks >= self.alarm

    def compares(self) -> bool:
        """Whether the timer compares its counter with the alarm."""
        return bool(self.registers.get(TIMER, 0) >> 24 & 1)

    def poll(self) -> None:
        if self.completed is None or not self.is_open:
            return
        if self.clocks - self.completed > POLL_US * CORE_MHZ:
            self.to_host += self.packet
            self.packet.clear()
            self.completed = None
            self.registers[USB + 8] = self.registers.get(USB + 8, 0) | 1 << 3

    def pending(self) -> int | None:
        sources = []
        if self.rings() and self.registers.get(TIMER + 0x64, 0) & 1:
            sources.append(NUMBER_OF_TIMER)
        if self.to_chip and self.registers.get(USB + 0x10, 0) >> 2 & 1:
            sources.append(NUMBER_OF_USB)
        for source in sources:
            number = self.registers.get(MATRIX + 4 * source, 0)
            priority = self.registers.get(MATRIX + 0x114 + 4 * number, 0)
            threshold = self.registers.get(MATRIX + 0x194, 0)
            enabled = self.registers.get(MATRIX + 0x104, 0) >> number & 1
            if number and enabled and priority and priority >= threshold:
                return number
        return None

    def call(self, cpu: Uc, address: int, *_: object) -> None:
        """A function of the boot ROM."""
        first, second, third = (cpu.reg_read(rv.UC_RISCV_REG_A0 + n) for n in range(3))
        match address:
            case 0x4000_0128:
                self.flash[first * 4096 : (first + 1) * 4096] = b"\xff" * 4096
            case 0x4000_012C:
                for place, byte in enumerate(cpu.mem_read(second, third), first):
                    self.flash[place] &= byte
            case 0x4000_0130:
                cpu.mem_write(second, bytes(self.flash[first : first + third]))
            case 0x4000_0134 | 0x4000_0140 | 0x4000_0588:
                pass
            case _:
                raise AssertionError(f"the boot ROM is called at {address:#x}")
        cpu.reg_write(rv.UC_RISCV_REG_A0, 0)

    def permits(self) -> bool:
        return bool(self.cpu.reg_read(rv.UC_RISCV_REG_MSTATUS) & INTERRUPTS_ON)

    def enter(self, number: int) -> None:
        cpu = self.cpu
        status = cpu.reg_read(rv.UC_RISCV_REG_MSTATUS)
        cpu.reg_write(rv.UC_RISCV_REG_MEPC, self.at)
        cpu.reg_write(rv.UC_RISCV_REG_MCAUSE, 1 << 31 | number)
        cpu.reg_write(rv.UC_RISCV_REG_MSTATUS, status & ~INTERRUPTS_ON | WERE_ON | MACHINE_MODE)
        # The table has 256-byte alignment, and the mode is fixed.
        self.at = (cpu.reg_read(rv.UC_RISCV_REG_MTVEC) & ~0xFF) + 4 * number

    def leaves(self) -> bool:
        # The last instruction of the handler has done all.
        return not self.cpu.reg_read(rv.UC_RISCV_REG_MSTATUS) & MACHINE_MODE

    def events(self) -> list[int]:
        times = []
        if self.compares() and self.ticks < self.alarm:
            times.append(self.alarm * CORE_MHZ // TIMER_MHZ)
        if self.completed is not None and self.is_open:
            times.append(self.completed + POLL_US * CORE_MHZ + 1)
        return times

    def counter(self) -> int:
        return int(self.cpu.reg_read(rv.UC_RISCV_REG_PC))

    def never_used(self, begin: int, end: int) -> int:
        """The bytes between static data and stack that are still zero: the longest run of them."""
        ram = bytes(self.cpu.mem_read(begin, end - begin))
        return max(len(zeros) for zeros in re.findall(rb"\0+", ram))
