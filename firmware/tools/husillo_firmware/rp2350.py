"""A simulated Raspberry Pi Pico 2, because QEMU does not have its chip, an RP2350.

It has the parts that `board/src/pico2.rs` uses: clocks that are ready at once, pins, timer, the
function of the boot ROM for the flash, interrupts, and the USB with a host.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import ClassVar

from unicorn import arm_const as arm
from unicorn.unicorn import Uc
from unicorn.unicorn_const import UC_HOOK_CODE

from husillo_firmware.cortex_m import CortexM
from husillo_firmware.simulated import LONGEST_SLEEP_US
from husillo_firmware.usb_host import INTERRUPTS, MEMORY_BYTES, Usb

# The host makes its next transaction after this time.
POLL_US = 20
FLASH = 0x1000_0000
RAM_BYTES = 512 << 10
ROM_BYTES, LOOKUP, FLASH_OP = 0x1000, 0x100, 0x200
# The parts of the address space with registers, and their lengths.
REGISTERS = (
    (0x4000_0000, 0x20_0000),
    (0x5010_0000, 0x2_0000),
    (0xD000_0000, 0x1000),
    (0xE000_0000, 0x10_0000),
)
USB_MEMORY, USB = 0x5010_0000, 0x5011_0000
TIMER_RAW, TIMER_ENABLE = 0x400B_003C, 0x400B_0040
NVIC_ENABLE = 0xE000_E100
TIMER_INTERRUPT = 0


@dataclass
class Rp2350(CortexM):
    """The chip."""

    core_mhz = 150
    model = arm.UC_CPU_ARM_CORTEX_M33
    usb_interrupt: ClassVar[int] = 14
    program = FLASH
    vectors = FLASH
    ram_bytes = RAM_BYTES
    parts: ClassVar[tuple[tuple[int, int], ...]] = REGISTERS

    alarm_us: int | None = None
    polled: int = 0

    def processor(self) -> Uc:
        cpu = super().processor()
        cpu.mem_map(0, ROM_BYTES)
        # Every function of the boot ROM returns at once.
        cpu.mem_write(0, b"\x70\x47" * (ROM_BYTES // 2))
        cpu.mem_write(0x16, struct.pack("<H", LOOKUP | 1))
        cpu.hook_add(UC_HOOK_CODE, self.call, begin=0, end=ROM_BYTES)
        return cpu

    def start(self) -> None:
        super().start()
        self.usb = Usb(self.to_chip, self.to_host)

    def read(self, address: int, size: int) -> int:
        """A register."""
        # An access takes some clocks, so that no loop waits forever.
        self.clocks += 2
        if 0 <= (place := address - USB_MEMORY) < MEMORY_BYTES:
            return int.from_bytes(self.usb.memory[place : place + size], "little")
        if address >> 16 == USB >> 16:
            return self.usb.read(address - USB)
        kept = self.registers.get(address, 0)
        match address:
            case 0x4001_0038:
                return 1 << (self.registers.get(0x4001_0030, 0) & 3)
            case 0x4001_0044:
                return 1 << (self.registers.get(0x4001_003C, 0) & 1)
            case 0x4002_0008:
                return ~self.registers.get(0x4002_0000, 0xFFFF_FFFF) & 0xFFFF_FFFF
            case 0x4004_8004 | 0x4005_0000 | 0x4005_8000:
                return kept | 1 << 31
            case 0x400B_0020:
                return int(self.alarm_us is not None)
            case 0x400B_0028:
                return int(self.us)
            case 0xD000_0004:
                return ~self.closed & 0xFFFF_FFFF
        return kept

    def write(self, address: int, size: int, value: int) -> None:
        """Writes a register."""
        if 0 <= (place := address - USB_MEMORY) < MEMORY_BYTES:
            self.usb.memory[place : place + size] = value.to_bytes(size, "little")
            return
        if address >> 16 == USB >> 16:
            self.usb.write(address - USB, value)
            return
        match address:
            case 0x400B_0010:
                self.alarm_us = value
            case 0x400B_0020 if value & 1:
                self.alarm_us = None
            case 0x400B_003C:
                value = self.registers.get(address, 0) & ~value
            case 0xD000_0018:
                self.drive(self.levels | value)
            case 0xD000_0020:
                self.drive(self.levels & ~value)
            case 0xE000_E100:
                value |= self.registers.get(address, 0)
        self.registers[address] = value

    def poll(self) -> None:
        if self.clocks - self.polled > POLL_US * self.core_mhz:
            self.polled = self.clocks
            self.usb.is_open = self.is_open
            next(self.usb.host)

    def pending(self) -> int | None:
        # The alarm comes at one moment only. One that is set later comes after 2^32 us.
        if self.alarm_us is not None and 0 <= self.us - self.alarm_us < LONGEST_SLEEP_US:
            self.alarm_us = None
            self.registers[TIMER_RAW] = self.registers.get(TIMER_RAW, 0) | 1
        enabled = self.registers.get(NVIC_ENABLE, 0)
        timer = self.registers.get(TIMER_RAW, 0) & self.registers.get(TIMER_ENABLE, 0)
        if timer & 1 and enabled >> TIMER_INTERRUPT & 1:
            return TIMER_INTERRUPT
        if self.usb.read(INTERRUPTS) and enabled >> self.usb_interrupt & 1:
            return self.usb_interrupt
        return None

    def call(self, cpu: Uc, address: int, *_: object) -> None:
        """A function of the boot ROM."""
        first, second, third, fourth = (cpu.reg_read(arm.UC_ARM_REG_R0 + n) for n in range(4))
        if address == LOOKUP:
            assert (first, second) == (int.from_bytes(b"FO", "little"), 4), "unknown function"
            cpu.reg_write(arm.UC_ARM_REG_R0, FLASH_OP | 1)
            return
        assert address == FLASH_OP, f"the boot ROM is called at {address:#x}"
        if first >> 16 == 0:
            self.flash[second : second + third] = b"\xff" * third
        else:
            for place, byte in enumerate(cpu.mem_read(fourth, third), second):
                self.flash[place] &= byte
        cpu.mem_write(FLASH + second, bytes(self.flash[second : second + third]))
        cpu.reg_write(arm.UC_ARM_REG_R0, 0)

    def events(self) -> list[int]:
        times = [self.polled + POLL_US * self.core_mhz + 1]
        if self.alarm_us is not None and self.alarm_us > self.us:
            times.append(self.alarm_us * self.core_mhz)
        return times
