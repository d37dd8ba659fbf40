"""A simulated Raspberry Pi Pico. Its chip, an RP2040, is that of a Pico 2 at other addresses.

`rp2040-hal` starts its clocks and runs its USB. So the simulated USB and its host, with which the
driver of a Pico 2 is checked, also work with a driver that is in wide use.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass, field

from unicorn import arm_const as arm
from unicorn.unicorn import Uc

from husillo_firmware.rp2350 import FLASH, REGISTERS, Rp2350

# Where an RP2350 has the peripherals: clocks, resets, crystal, PLLs, PWM, timer.
BLOCKS = {
    0x4000_8000: 0x4001_0000,
    0x4000_C000: 0x4002_0000,
    0x4002_4000: 0x4004_8000,
    0x4002_8000: 0x4005_0000,
    0x4002_C000: 0x4005_8000,
    0x4005_0000: 0x400A_8000,
    0x4005_4000: 0x400B_0000,
}
# And some registers: raw and enabled interrupts of the timer, setting and clearing pins.
MOVED = {
    0x400B_0034: 0x400B_003C,
    0x400B_0038: 0x400B_0040,
    0xD000_0014: 0xD000_0018,
    0xD000_0018: 0xD000_0020,
}
APB, APB_END = 0x4000_0000, 0x4007_0000
# A register of the APB can be written at three more addresses, which change only bits: the bits of
# the value are inverted, set or cleared.
# The divider of the SIO: operands without and with sign, quotient, remainder, state.
DIVIDER = 0xD000_0060
# The controller of the flash, and that of its cache.
SSI, CACHE = 0x1800_0000, 0x1400_0000
# The boot ROM: tables of functions and data, what finds in them, and the functions.
FUNCTIONS, DATA, LOOKUP, FIRST = 0x40, 0x42, 0x100, 0x200


@dataclass
class Rp2040(Rp2350):
    """The chip."""

    core_mhz = 125
    model = arm.UC_CPU_ARM_CORTEX_M0
    usb_interrupt = 5
    vectors = FLASH + 0x100
    parts = (*REGISTERS, (SSI, 0x1000), (CACHE, 0x1000))

    # The codes of the functions that were asked for; their addresses follow each other.
    codes: list[bytes] = field(default_factory=list)

    def processor(self) -> Uc:
        cpu = super().processor()
        cpu.mem_write(0x14, struct.pack("<HHH", FUNCTIONS, DATA, LOOKUP | 1))
        return cpu

    def place(self, address: int) -> int:
        if APB <= address < APB_END:
            block = address & ~0x3FFF
            address = BLOCKS.get(block, block) + (address & 0xFFF)
        return MOVED.get(address, address)

    def change(self, address: int, size: int, value: int) -> None:
        place = self.place(address)
        if APB <= address < APB_END:
            kept = self.registers.get(place, self.at_reset(place))
            match address >> 12 & 3:
                case 1:
                    value ^= kept
                case 2:
                    value |= kept
                case 3:
                    value = kept & ~value
        if DIVIDER <= place < DIVIDER + 16:
            self.divide(place, value)
        else:
            self.write(place, size, value)

    def at_reset(self, place: int) -> int:
        """What a register has after a reset."""
        return 0x01FF_FFFF if place == 0x4002_0000 else 0

    def divide(self, place: int, value: int) -> None:
        """Writes an operand of the divider, which then has the result."""
        self.registers[place] = value
        is_signed = place >= DIVIDER + 8
        first = DIVIDER + 8 * is_signed
        dividend, divisor = (self.registers.get(first + at, 0) for at in (0, 4))
        self.registers[DIVIDER + 8 * (not is_signed) + (place & 4)] = value
        if is_signed:
            dividend, divisor = (one - (one >> 31 << 32) for one in (dividend, divisor))
        if divisor:
            quotient = abs(dividend) // abs(divisor)
            quotient = -quotient if (dividend < 0) != (divisor < 0) else quotient
            rest = dividend - quotient * divisor
        else:
            quotient, rest = (1 if dividend < 0 else -1), dividend
        self.registers[DIVIDER + 0x10] = quotient & 0xFFFF_FFFF
        self.registers[DIVIDER + 0x14] = rest & 0xFFFF_FFFF

    def read(self, address: int, size: int) -> int:
        match address:
            case 0x1800_0028:
                # Everything has been sent.
                return 0b110
            case 0x1800_0060:
                # The flash has its four data lines on.
                return 2
            case 0xD000_0078:
                return 1
        return super().read(address, size)

    def call(self, cpu: Uc, address: int, *_: object) -> None:
        first, second, third = (cpu.reg_read(arm.UC_ARM_REG_R0 + n) for n in range(3))
        if address == LOOKUP:
            code = struct.pack("<H", second)
            assert first == FUNCTIONS, f"data {code!r} of the boot ROM"
            if code not in self.codes:
                self.codes.append(code)
            cpu.reg_write(arm.UC_ARM_REG_R0, FIRST + 2 * self.codes.index(code) | 1)
            return
        code = self.codes[(address - FIRST) // 2]
        match code:
            case b"RE":
                self.flash[first : first + second] = b"\xff" * second
                cpu.mem_write(FLASH + first, b"\xff" * second)
            case b"RP":
                for place, byte in enumerate(cpu.mem_read(second, third), first):
                    self.flash[place] &= byte
                cpu.mem_write(FLASH + first, bytes(self.flash[first : first + third]))
            case b"MC" | b"C4":
                cpu.mem_write(first, bytes(cpu.mem_read(second, third)))
            case b"MS" | b"S4":
                cpu.mem_write(first, bytes([second & 0xFF]) * third)
            case b"L3":
                cpu.reg_write(arm.UC_ARM_REG_R0, 32 - first.bit_length())
            case b"T3":
                cpu.reg_write(arm.UC_ARM_REG_R0, (first & -first).bit_length() - 1 if first else 32)
            case b"P3":
                cpu.reg_write(arm.UC_ARM_REG_R0, first.bit_count())
            case b"IF" | b"EX" | b"FC" | b"CX":
                pass
            case _:
                raise AssertionError(f"function {code!r} of the boot ROM")
