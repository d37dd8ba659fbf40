"""A simulated STM32F446, the chip of a Nucleo.

QEMU's board with this processor has neither pins nor the cycle counter, so it does not show when a
pin changes. This chip has the clocks, which are ready at once, pins, flash, USART2, the cycle
counter, and SysTick, which begins again at its end.
"""

from __future__ import annotations

from dataclasses import dataclass

from unicorn import arm_const as arm

from husillo_firmware.cortex_m import CortexM

FLASH = 0x0800_0000
SECTOR_BYTES = 16 << 10
ERASES = 1 << 16 | 1 << 1
PINS, PINS_END = 0x4002_0000, 0x4002_0C00
HAS_BYTE, IS_FREE = 1 << 5, 0b11 << 6
BYTE_US = 87
TICK_RELOAD = 0xE000_E014
UNPEND = 1 << 25
NVIC_ENABLE = 0xE000_E104
# The vectors of exceptions are before that of interrupt 0.
TICK, USART = -1, 38
# Clocks from an exception to the first instruction of its handler.
ENTRY = 12


@dataclass
class Stm32f446(CortexM):
    """The chip."""

    core_mhz = 168
    at_once = 20
    flash_bytes = 512 << 10
    model = arm.UC_CPU_ARM_CORTEX_M4
    program = FLASH
    vectors = FLASH
    ram_bytes = 128 << 10
    parts = ((0x4000_0000, 0x3_0000), (0xE000_0000, 0x10_0000))

    # The next end of SysTick, while it runs, and whether its exception is pending.
    tick: int | None = None
    is_pending: bool = False
    # When the next byte has arrived.
    arrives: int = 0

    def read(self, address: int, size: int) -> int:
        # An access takes some clocks, so that no loop waits forever.
        self.clocks += 2
        kept = self.registers.get(address, 0)
        match address:
            case 0x4002_3800:
                return kept | (kept & (1 << 16 | 1 << 24)) << 1
            case 0x4002_3808:
                return kept | (kept & 0b11) << 2
            case 0x4000_4400:
                return IS_FREE | HAS_BYTE * self.has_byte()
            case 0x4000_4404:
                self.arrives = self.clocks + BYTE_US * self.core_mhz
                return self.to_chip.pop(0) if self.to_chip else 0
            case 0xE000_1004:
                return self.clocks & 0xFFFF_FFFF
        if PINS <= address < PINS_END and address & 0x3FF == 0x10:
            return ~(self.closed >> 16 * (address - PINS >> 10)) & 0xFFFF
        return kept

    def write(self, address: int, size: int, value: int) -> None:
        """Writes a register."""
        self.registers[address] = value
        if PINS <= address < PINS_END and address & 0x3FF == 0x18:
            port = 16 * (address - PINS >> 10)
            high, low = value & 0xFFFF, value >> 16
            self.drive(self.levels & ~(low << port) | high << port)
        match address:
            case 0x4000_4404:
                self.to_host.append(value & 0xFF)
            case 0xE000_E010:
                self.ticks()
                period = self.registers.get(TICK_RELOAD, 0) + 1
                self.tick = self.clocks + period if value & 1 else None
            case 0xE000_ED04 if value & UNPEND:
                self.is_pending = False
            case 0x4002_3C10 if value & ERASES == ERASES:
                begin = FLASH + SECTOR_BYTES * (value >> 3 & 0xF)
                self.cpu.mem_write(begin, b"\xff" * SECTOR_BYTES)

    def has_byte(self) -> bool:
        """Whether a byte has arrived."""
        return bool(self.to_chip) and self.clocks >= self.arrives

    def ticks(self) -> None:
        """Lets SysTick come to its end, as often as it has by now."""
        period = self.registers.get(TICK_RELOAD, 0) + 1
        while self.tick is not None and self.clocks >= self.tick:
            self.is_pending = True
            self.tick += period

    def poll(self) -> None:
        self.ticks()

    def pending(self) -> int | None:
        if self.is_pending:
            return TICK
        is_enabled = self.registers.get(NVIC_ENABLE, 0) >> USART - 32 & 1
        return USART if is_enabled and self.has_byte() else None

    def enter(self, number: int) -> None:
        if number == TICK:
            self.is_pending = False
        self.clocks += ENTRY
        super().enter(number)

    def events(self) -> list[int]:
        times = [] if self.tick is None else [self.tick]
        return [*times, self.arrives] if self.to_chip else times
