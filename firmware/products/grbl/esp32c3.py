"""Runs the firmware for an ESP32-C3 in a simulation of this chip, from the file that is flashed.

Its answers are those of Grbl, its steps those of the emulator, as on the boards of QEMU. Settings
outlive a loss of power. Every pin of the board does what its table says.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

from husillo_firmware import image
from husillo_firmware.boards import Board
from husillo_firmware.emulated import same
from husillo_firmware.esp32c3 import CODE, DATA, RAM_BYTES, Chip, erased
from husillo_firmware.waiting import require

from products.grbl import dialogue
from products.grbl.link import Edges, Grbl

BOARD = Board("esp32c3", "riscv32imc-unknown-none-elf", (), DATA, RAM_BYTES, "s")
BOOT_US = 100_000
# The longest time until the firmware has read the inputs, or obeyed a byte.
NOTICED_US = 20_000
# The pins of `board/src/esp32c3.rs`.
MOTORS = 0, 1, 3, 4, 21, 8
MOTORS_OFF = 2
INPUTS = {7: "X", 10: "Y", 20: "Z", 6: "P", 9: "H"}
DUTY, SIGNAL_OF_PWM, PWM_OUTPUT = 0x6001_9008, 0x6000_4568, 45 | 1 << 9
# The boot ROM uses the RAM from here on while it loads. Static data and stack of the firmware are
# there afterwards.
OF_BOOT_ROM = 0x3FCC_AE00
# Where the stack begins, which grows down to the static data, and how much room it must leave.
STACK_END, LEAST_STACK = 0x3FCD_E700, 8192
# The longest time of a pulse that is too long or too short, with the slices of the simulation.
PULSE_US, TOLERANCE_US = 37, 3
# More changes of a setting than fit into a sector of the flash.
CHANGES = 40


class Simulated(Grbl):
    """A Grbl controller in the simulated chip."""

    def __init__(self, flash: bytearray) -> None:
        self.board = BOARD
        self.chip = Chip(flash)
        self.chip.run(BOOT_US)
        require(self.receive(1).endswith(b"for help]\r\n"), f"{BOARD}: no banner")

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
            sum((edge.levels >> pin & 1) << bit for bit, pin in enumerate(MOTORS))
            for edge in self.chip.edges
        )


def flashed() -> bytearray:
    """A flash with the firmware."""
    with tempfile.TemporaryDirectory() as path:
        file = Path(path) / "grbl.bin"
        image.main(["grbl", "esp32c3", "-o", str(file)])
        data = file.read_bytes()
    flash = erased()
    flash[: len(data)] = data
    return flash


def loads(flash: bytearray) -> None:
    """The boot ROM can load the image: no part overlaps another one or its own data."""
    # Both buses reach the same RAM.
    begins = [(at - (CODE if at >= CODE else DATA), length) for at, length in Chip(flash).parts]
    end = 0
    for begin, length in sorted(begins):
        require(begin >= end, f"{BOARD}: parts overlap")
        end = begin + length
    require(DATA + end <= OF_BOOT_ROM, f"{BOARD}: too large for the boot ROM")


def cuts(flash: bytearray, lines: list[str], expected: Edges) -> int:
    """Makes a program. Returns its steps."""
    with Simulated(flash[:]) as grbl:
        for line in lines:
            require(grbl.ask(line) == ["ok"], f"{BOARD}: {line}")
        found, left = grbl.edges(), grbl.chip.never_used(OF_BOOT_ROM, STACK_END)
    require(left > LEAST_STACK, f"{BOARD}: {left} bytes of RAM are left")
    print(f"{BOARD}: {left} bytes of RAM were never used")
    require(found == expected, f"{BOARD}: {found} instead of {expected}")
    return sum(found.pulses)


def dialogues(flash: bytearray) -> None:
    """Plays recorded dialogues of Grbl."""
    for name in dialogue.NAMES:
        with Simulated(flash[:]) as grbl:
            expected = dialogue.play(grbl, name)
            grbl.ask("G4 P0.01")
            require(grbl.edges() == expected, f"{BOARD}: {name}: {grbl.edges()}")


def keeps(flash: bytearray) -> None:
    """A setting outlives the loss of power, also after the sectors of the flash were erased."""
    flash = flash[:]
    program = flash[: len(flash) // 2]
    with Simulated(flash) as grbl:
        for number in range(CHANGES):
            require(grbl.ask(f"$100={number + 1}") == ["ok"], f"{BOARD}: setting {number}")
        grbl.settle()
    with Simulated(flash) as grbl:
        require(f"$100={CHANGES}.000" in grbl.ask("$$"), f"{BOARD}: a setting is lost")
    require(program == flash[: len(program)], f"{BOARD}: the program in the flash has changed")


def pins(flash: bytearray) -> None:
    """Inputs, outputs, and the time of a pulse."""
    with Simulated(flash[:]) as grbl:
        chip = grbl.chip
        for pin, name in INPUTS.items():
            chip.closed = 1 << pin
            said = grbl.status()
            require(f"|Pn:{name}" in said, f"{BOARD}: GPIO{pin} is not {name}: {said}")
            chip.closed = 0
            grbl.reset()
        for line, duty in (("M3 S1000", 256), ("S500", 128), ("M5", 0)):
            grbl.ask(line)
            grbl.settle()
            same(f"{BOARD}: duty after {line}", chip.registers[DUTY] >> 4, duty)
        same(f"{BOARD}: signal of the PWM", chip.registers[SIGNAL_OF_PWM], PWM_OUTPUT)
        grbl.ask("G4 P0.1")
        require(chip.levels >> MOTORS_OFF & 1 == 1, f"{BOARD}: the motors stay on")
        grbl.ask(f"$0={PULSE_US}")
        begin = len(chip.edges)
        grbl.ask("G91 G1 X0.1 F600")
        grbl.ask("G4 P0.01")
        require(chip.levels >> MOTORS_OFF & 1 == 0, f"{BOARD}: the motors stay off")
        rises = [edge.us for edge in chip.edges[begin:] if edge.levels & 1]
        falls = [edge.us for edge in chip.edges[begin:] if not edge.levels & 1][-len(rises) :]
        times = [fall - rise for rise, fall in zip(rises, falls, strict=True)]
        require(
            len(times) == 25 and all(abs(us - PULSE_US) < TOLERANCE_US for us in times),
            f"{BOARD}: pulses of {times} us",
        )


def stops(flash: bytearray) -> None:
    """A hold, a resume and a reset in motion lose no step."""
    with Simulated(flash[:]) as grbl:
        grbl.say("G1 X8 F240\n")
        grbl.reports("Run")
        grbl.chip.run(500_000)
        grbl.say("!")
        grbl.reports("Hold:0")
        held = grbl.edges().net[0]
        grbl.chip.run(500_000)
        require(0 < held < 2000 and grbl.edges().net[0] == held, f"{BOARD}: moves in a hold")
        grbl.say("~")
        grbl.reports("Idle")
        same(f"{BOARD}: steps after a hold", grbl.edges().net[0], 2000)
        grbl.say("G1 X0\n")
        grbl.reports("Run")
        grbl.chip.run(500_000)
        grbl.reset()
        place = grbl.edges().net[0]
        require(0 < place < 2000, f"{BOARD}: reset at step {place}")
        require(f"MPos:{place / 250:.3f}," in grbl.reports("Alarm"), f"{BOARD}: a step is lost")


def is_deaf(flash: bytearray) -> None:
    """Without a program that reads the port, a motion goes on, and the line works afterwards."""
    with Simulated(flash[:]) as grbl:
        grbl.chip.is_open = False
        grbl.say("G91 G1 X4 F1000\n" + "?\n" * 40)
        grbl.chip.run(4e6)
        same(f"{BOARD}: steps without a reader", grbl.edges().net[0], 1000)
        grbl.chip.is_open = True
        grbl.receive(1)
        grbl.begun = b""
        grbl.ask("")
        require("MPos:4.000," in grbl.status(), f"{BOARD}: no report")


def main(arguments: list[str]) -> int:
    """Checks the firmware. Returns the status."""
    argparse.ArgumentParser(prog="firmware/check esp32c3", description=__doc__).parse_args(
        arguments
    )
    from products.grbl.check import emulated, program

    flash = flashed()
    loads(flash)
    dialogues(flash)
    keeps(flash)
    pins(flash)
    stops(flash)
    is_deaf(flash)
    steps = cuts(flash, program(), emulated())
    print(f"{BOARD}: {steps} steps as in the emulator, simulated")
    return 0
