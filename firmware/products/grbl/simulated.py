"""Runs the firmware for boards whose chips QEMU does not have, from the files that are flashed.

The chips are simulated. The answers are those of Grbl, the steps those of the emulator, as on the
boards of QEMU. Settings outlive a loss of power. Every pin does what the table of the board says.
"""

from __future__ import annotations

import argparse
import struct
import tempfile
from dataclasses import dataclass
from pathlib import Path

from husillo_firmware import esp32c3, image
from husillo_firmware.boards import Board
from husillo_firmware.emulated import same
from husillo_firmware.esp32c3 import CODE, DATA, Esp32c3
from husillo_firmware.rp2040 import Rp2040
from husillo_firmware.rp2350 import FLASH, Rp2350
from husillo_firmware.simulated import Chip, Edge
from husillo_firmware.stm32f446 import Stm32f446
from husillo_firmware.waiting import require

from products.grbl import dialogue
from products.grbl.check import LINES, WAIT, emulated, program
from products.grbl.link import Edges, Grbl

BOOT_US = 100_000
# The longest time until the firmware has read the inputs, or obeyed a byte.
NOTICED_US = 20_000
PULSE_US, TOLERANCE_US = 37, 3
# The shortest pulse that the motors' drivers are sure to see, and that of Grbl.
LEAST_US, USUAL_US = 8, 10
# Lines of a short program.
SHORT = 50
# More changes of a setting than fit into a sector of the flash.
CHANGES = 40
# The boot ROM of an ESP32-C3 uses the RAM from here on while it loads. Static data and stack of the
# firmware are there afterwards: the stack grows down, and must leave some room.
OF_BOOT_ROM, STACK_END, LEAST_STACK = 0x3FCC_AE00, 0x3FCD_E700, 8192


@dataclass(frozen=True)
class Table:
    """What the table of a board says."""

    board: Board
    chip: type[Chip]
    # Steps and directions.
    motors: tuple[int, ...]
    motors_off: int
    # The inputs with their letters in a report.
    inputs: dict[int, str]
    # The register of the duty, and its values at half and at full speed.
    duty: int
    duties: tuple[int, int]
    # How many lines of the program it makes. A Cortex-M0 is slow in the simulation.
    lines: int = LINES

    def __str__(self) -> str:
        return self.board.name


def pico(target: str, chip: type[Chip], ram: int) -> Table:
    """A Pico or a Pico 2."""
    return Table(
        Board("pico" if chip is Rp2040 else "pico2", target, (), 0x2000_0000, ram, "3"),
        chip,
        (2, 3, 4, 5, 6, 7),
        10,
        {14: "X", 15: "Y", 16: "Z", 17: "P", 18: "H", 19: "S"},
        0x400A_8048,
        (128, 255),
        SHORT if chip is Rp2040 else LINES,
    )


TABLES = {
    "esp32c3": Table(
        Board("esp32c3", "riscv32imc-unknown-none-elf", (), DATA, esp32c3.RAM_BYTES, "3"),
        Esp32c3,
        (0, 1, 3, 4, 21, 8),
        2,
        {7: "X", 10: "Y", 20: "Z", 6: "P", 9: "H"},
        0x6001_9008,
        (128 << 4, 256 << 4),
    ),
    "nucleo_f446": Table(
        Board("nucleo_f446", "thumbv7em-none-eabihf", (), 0x2000_0000, 128 << 10, "s"),
        Stm32f446,
        (10, 19, 21, 20, 26, 8),
        9,
        {39: "X", 22: "Y", 6: "Z", 32: "P", 34: "D", 1: "H", 4: "S"},
        0x4000_0438,
        (128, 255),
    ),
    "pico": pico("thumbv6m-none-eabi", Rp2040, 256 << 10),
    "pico2": pico("thumbv8m.main-none-eabihf", Rp2350, 512 << 10),
}


class Simulated(Grbl):
    """A Grbl controller in a simulated chip."""

    def __init__(self, table: Table, flash: bytearray) -> None:
        self.board, self.table = table.board, table
        self.chip = table.chip(flash)
        self.chip.run(BOOT_US)
        require(self.receive(1).endswith(b"for help]\r\n"), f"{table}: no banner")

    def __exit__(self, *_: object) -> None:
        pass

    def settle(self) -> None:
        """Waits until an answered line has had its effect. The answer may leave before."""
        self.chip.run(NOTICED_US)

    def say(self, text: str) -> None:
        """Sends bytes after a pause, because Grbl answers two questions at once with one report."""
        self.settle()
        self.chip.to_chip += text.encode("latin-1")

    def receive(self, seconds: float) -> bytes:
        """Runs the chip until it sends bytes, at most this long. Returns them."""
        self.chip.run(seconds * 1e6, lambda: bool(self.chip.to_host))
        said = bytes(self.chip.to_host)
        self.chip.to_host.clear()
        return said

    def edges(self) -> Edges:
        """The steps at the pins."""
        return Edges.among(
            sum((edge.levels >> pin & 1) << bit for bit, pin in enumerate(self.table.motors))
            for edge in self.chip.edges
        )


def flashed(table: Table) -> bytearray:
    """A flash with the firmware."""
    with tempfile.TemporaryDirectory() as path:
        file = Path(path) / "image"
        image.main(["grbl", table.board.name, "-o", str(file)])
        data = file.read_bytes()
    flash = table.chip.erased()
    if image.BOARDS[table.board.name].family is None:
        flash[: len(data)] = data
        return flash
    for place in range(0, len(data), 512):
        address, length = struct.unpack_from("<II", data, place + 12)
        begin = address - FLASH
        flash[begin : begin + length] = data[place + 32 : place + 32 + length]
    return flash


def loads(chip: Chip) -> None:
    """The boot ROM of an ESP32-C3 can load the image: no part overlaps another one or its data."""
    assert isinstance(chip, Esp32c3)
    # Both buses reach the same RAM.
    begins = [(at - (CODE if at >= CODE else DATA), length) for at, length in chip.parts]
    end = 0
    for begin, length in sorted(begins):
        require(begin >= end, "esp32c3: parts overlap")
        end = begin + length
    require(DATA + end <= OF_BOOT_ROM, "esp32c3: too large for the boot ROM")


def has_room(chip: Chip) -> None:
    """The stack of an ESP32-C3 has not reached the static data."""
    assert isinstance(chip, Esp32c3)
    left = chip.never_used(OF_BOOT_ROM, STACK_END)
    require(left > LEAST_STACK, f"esp32c3: {left} bytes of RAM are left")
    print(f"esp32c3: {left} bytes of RAM were never used")


def cuts(table: Table, flash: bytearray, lines: list[str], expected: Edges) -> None:
    """Makes a program."""
    with Simulated(table, flash[:]) as grbl:
        for line in lines:
            require(grbl.ask(line) == ["ok"], f"{table}: {line}")
        found = grbl.edges()
        require(found == expected, f"{table}: {found} instead of {expected}")
        if table.chip is Esp32c3:
            has_room(grbl.chip)
    print(f"{table}: {sum(found.pulses)} steps as in the emulator, simulated")


def dialogues(table: Table, flash: bytearray) -> None:
    """Plays recorded dialogues of Grbl."""
    for name in dialogue.NAMES:
        with Simulated(table, flash[:]) as grbl:
            expected = dialogue.play(grbl, name)
            grbl.ask("G4 P0.01")
            require(grbl.edges() == expected, f"{table}: {name}: {grbl.edges()}")


def keeps(table: Table, flash: bytearray) -> None:
    """A setting outlives the loss of power, also after the sectors of the flash were erased."""
    flash = flash[:]
    program = flash[: len(flash) // 4]
    with Simulated(table, flash) as grbl:
        for number in range(CHANGES):
            require(grbl.ask(f"$100={number + 1}") == ["ok"], f"{table}: setting {number}")
        grbl.settle()
    with Simulated(table, flash) as grbl:
        require(f"$100={CHANGES}.000" in grbl.ask("$$"), f"{table}: a setting is lost")
    require(program == flash[: len(program)], f"{table}: the program in the flash has changed")


def pulses(table: Table, edges: list[Edge]) -> list[float]:
    """The times of the pulses of X."""
    step = 1 << table.motors[0]
    rises = [edge.us for edge in edges if edge.levels & step]
    falls = [edge.us for edge in edges if not edge.levels & step][-len(rises) :]
    return [fall - rise for rise, fall in zip(rises, falls, strict=True)]


def late(table: Table, flash: bytearray) -> None:
    """A step that was queued after it was due has a whole pulse."""
    with Simulated(table, flash[:]) as grbl:
        for line in (f"$0={USUAL_US}", "$100=1000", "$110=12000", "$120=2000"):
            require(grbl.ask(line) == ["ok"], f"{table}: {line}")
        begin = len(grbl.chip.edges)
        grbl.ask("G91 G1 X1 F12000")
        grbl.ask("G4 P0.01")
        times = pulses(table, grbl.chip.edges[begin:])
        same(f"{table}: steps that are late", len(times), 1000)
        require(min(times) > LEAST_US, f"{table}: a pulse of {min(times):.2f} us")


def pins(table: Table, flash: bytearray) -> None:
    """Inputs, outputs, and the time of a pulse."""
    with Simulated(table, flash[:]) as grbl:
        chip = grbl.chip
        for pin, name in table.inputs.items():
            chip.closed = 1 << pin
            said = grbl.status()
            require(f"|Pn:{name}" in said, f"{table}: GPIO{pin} is not {name}: {said}")
            chip.closed = 0
            grbl.reset()
        half, full = table.duties
        for line, duty in (("M3 S1000", full), ("S500", half), ("M5", 0)):
            grbl.ask(line)
            grbl.settle()
            same(f"{table}: duty after {line}", chip.registers[table.duty], duty)
        grbl.ask("G4 P0.1")
        require(chip.levels >> table.motors_off & 1 == 1, f"{table}: the motors stay on")
        grbl.ask(f"$0={PULSE_US}")
        begin = len(chip.edges)
        grbl.ask("G91 G1 X0.1 F600")
        grbl.ask("G4 P0.01")
        require(chip.levels >> table.motors_off & 1 == 0, f"{table}: the motors stay off")
        times = pulses(table, chip.edges[begin:])
        are_good = all(abs(us - PULSE_US) < TOLERANCE_US for us in times)
        require(len(times) == 25 and are_good, f"{table}: pulses of {times} us")


def stops(table: Table, flash: bytearray) -> None:
    """A hold, a resume and a reset in motion lose no step."""
    with Simulated(table, flash[:]) as grbl:
        grbl.say("G1 X8 F240\n")
        grbl.reports("Run")
        grbl.chip.run(500_000)
        grbl.say("!")
        grbl.reports("Hold:0")
        held = grbl.edges().net[0]
        grbl.chip.run(500_000)
        require(0 < held < 2000 and grbl.edges().net[0] == held, f"{table}: moves in a hold")
        grbl.say("~")
        grbl.reports("Idle")
        same(f"{table}: steps after a hold", grbl.edges().net[0], 2000)
        grbl.say("G1 X0\n")
        grbl.reports("Run")
        grbl.chip.run(500_000)
        grbl.reset()
        place = grbl.edges().net[0]
        require(0 < place < 2000, f"{table}: reset at step {place}")
        require(f"MPos:{place / 250:.3f}," in grbl.reports("Alarm"), f"{table}: a step is lost")


def is_deaf(table: Table, flash: bytearray) -> None:
    """Without a program that reads the port, a motion goes on, and the line works afterwards."""
    with Simulated(table, flash[:]) as grbl:
        grbl.chip.is_open = False
        grbl.say("G91 G1 X4 F1000\n" + "?\n" * 40)
        grbl.chip.run(4e6)
        same(f"{table}: steps without a reader", grbl.edges().net[0], 1000)
        grbl.chip.is_open = True
        grbl.receive(1)
        grbl.begun = b""
        grbl.ask("")
        require("MPos:4.000," in grbl.status(), f"{table}: no report")


def main(arguments: list[str]) -> int:
    """Checks the firmware. Returns the status."""
    options = argparse.ArgumentParser(prog="firmware/check simulated", description=__doc__)
    options.add_argument("boards", nargs="*", metavar="BOARD", help=", ".join(TABLES))
    for name in options.parse_args(arguments).boards or TABLES:
        table = TABLES[name]
        flash = flashed(table)
        if table.chip is Esp32c3:
            loads(table.chip(flash))
        if table.chip is Stm32f446:
            # The rest is run in QEMU.
            pins(table, flash)
            late(table, flash)
            continue
        for check in (dialogues, keeps, pins, stops, is_deaf):
            check(table, flash)
        lines = [*program()[: table.lines], WAIT]
        cuts(table, flash, lines, emulated(lines))
    return 0
