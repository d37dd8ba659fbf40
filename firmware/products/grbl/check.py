"""Runs recorded dialogues and a program of 200 lines: every step must be that of the emulator.

The answers to the dialogues are compared with those of Grbl 1.1h. The rising edges of the step pins
are counted, and compared with Grbl's and with those of `husillo emulate grbl`. Then settings are
kept over a reset, the machine homes, and `realtime` holds and resets it. `coils` makes the program
once more with the coils of the motors at the pins. `tier` checks the firmware with the protocol of
grblHAL and the height map, `drivers` the settings of motor drivers. The micro:bit has too little
RAM. Its processor, a Cortex-M0, gives the bound of the stack.
"""

from __future__ import annotations

import itertools
import tempfile
from collections.abc import Iterator
from pathlib import Path

from husillo_firmware import build, product, registers, stack
from husillo_firmware.boards import MPS2, NUCLEO_F446, VIRT, Board
from husillo_firmware.emulated import Emulated, Row, same
from husillo_firmware.waiting import require

from products.grbl import coils, dialogue, drivers, realtime, tier
from products.grbl.link import Edges, Grbl

LINES = 200
SPEED = 1000
# Not the time at power-on.
PULSE_US = 37
# Few steps per mm, because QEMU logs every access to a register. Rates and ramps of a small mill.
SETTINGS = [(100, 25), (101, 25), (102, 25), (110, 3000), (111, 3000), (112, 2000)]
SETTINGS += [(120, 500), (121, 500), (122, 500)]
# The Nucleo is checked only if it is named: at times its firmware is silent in QEMU.
BOARDS = (MPS2, VIRT)
# The last line of a program waits until everything has been made.
WAIT = "G4 P0.01"


def program() -> list[str]:
    """Lines and arcs in three axes, with turns, short moves and changes of feed."""
    lines = [f"${number}={value}" for number, value in SETTINGS]
    x = y = z = 0
    for number in range(LINES - len(lines) - 1):
        x, y, z = (x * 37 + 811) % 4001, (y * 53 + 1201) % 3001, (z * 29 + 307) % 801
        end = f"X{x / 1000:.3f} Y{y / 1000:.3f}"
        match number % 4:
            case 0:
                lines.append(f"G1 {end} Z{-z / 1000:.3f} F{600 + 10 * number}")
            case 1:
                lines.append(f"G2 {end} R5")
            case 2:
                lines.append(f"G0 {end}")
            case _:
                lines.append(f"G3 {end} R4")
    return [*lines, WAIT]


class Link:
    """A line to the emulated machine, with the answers of `Grbl`."""

    def __init__(self, path: Path) -> None:
        self.file = path.open("r+b", buffering=0)

    def ask(self, line: str) -> str:
        """Sends a line and waits for its answer."""
        self.file.write(line.encode() + b"\n")
        while True:
            said = self.file.readline().decode().strip()
            if said == "ok" or said.startswith("error:"):
                return said


def emulated(lines: list[str] | None = None) -> Edges:
    """The steps that the emulator makes of the program, or of other lines."""
    with tempfile.TemporaryDirectory() as path:
        with Emulated("grbl", Path(path), SPEED) as machine:
            link = Link(machine.link)
            for line in lines or program():
                same(f"emulator: {line}: ok", link.ask(line) == "ok", True)
        rows: list[Row] = machine.rows()
    steps = [[row[name] for row in rows] for name in ("dx", "dy", "dz")]
    return Edges([sum(map(abs, axis)) for axis in steps], [sum(axis) for axis in steps])


def dialogues(board: Board) -> None:
    """Plays each dialogue with a firmware that was just started."""
    for name in dialogue.NAMES:
        with tempfile.TemporaryDirectory() as path:
            log = Path(path) / "log"
            with Grbl("grbl", board, *registers.ACCESSES, "-D", str(log)) as grbl:
                grbl.start()
                expected = dialogue.play(grbl, name)
                grbl.ask(WAIT)
                grbl.monitor("info status")
            found = Edges.of(registers.read_file(board, log))
        if found != expected:
            raise SystemExit(f"{board}: {name}: {found} instead of {expected}")


def cut(board: Board) -> Iterator[tuple[str, int]]:
    """Makes the program, and homes. Yields the figures."""
    if board != NUCLEO_F446:
        # It has the same processor as the MPS2.
        dialogues(board)
    expected = emulated()
    with tempfile.TemporaryDirectory() as path:
        log = Path(path) / "log"
        with Grbl("grbl", board, *registers.ACCESSES, "-D", str(log)) as grbl:
            grbl.start()
            for line in program():
                require(grbl.ask(line) == ["ok"], f"{board}: {line}")
            grbl.monitor("info status")
            found = Edges.of(registers.read_file(board, log))
            ram = grbl.ram()
    if found != expected:
        raise SystemExit(f"{board}: {found} instead of {expected}")
    if board == MPS2:
        pulses(board)
        coils.check(board, program(), expected)
    home(board)
    realtime.check(board)
    yield "steps", sum(found.pulses)
    yield from grbl.memory(ram).items()
    if board == MPS2:
        yield "bound", bound()
        yield from tier.check(board)
    if board in (MPS2, NUCLEO_F446):
        drivers.check(board)


def home(board: Board) -> None:
    """Homes, probes, and resets: the settings are kept."""
    with Grbl("grbl", board) as grbl:
        grbl.start()
        for line in ("$22=1", "$24=500", "$H", "G10 L20 P1 X0 Y0 Z0", "G54"):
            require(grbl.ask(line)[-1] == "ok", f"{board}: {line}")
        (probed, _) = grbl.ask("G38.2 Z-30 F300")
        require(probed.endswith(":1]"), f"{board}: {probed}")
        grbl.ask("G0 Z0")
        grbl.reset()
        require("$22=1" in grbl.ask("$$"), f"{board}: a setting is lost at a reset")


def pulses(board: Board) -> None:
    """The time of a step pulse is that of `$0`."""
    with tempfile.TemporaryDirectory() as path:
        log = Path(path) / "log"
        with Grbl("grbl", board, *registers.ACCESSES, "-D", str(log)) as grbl:
            grbl.start()
            for line in (f"$0={PULSE_US}", "G1 X0.1 F600", WAIT):
                grbl.ask(line)
            grbl.monitor("info status")
        writes = [one for one in registers.made(registers.read_file(board, log)) if one.due]
    times = {
        (low.due - high.due) // registers.clocks_per_us(board)
        for high, low in itertools.pairwise(writes)
        if high.levels & 1 and not low.levels & 1 and high.due and low.due
    }
    require(times == {PULSE_US}, f"{board}: pulses of {times} us instead of {PULSE_US}")


def bound() -> int:
    """The most stack that the code for a Cortex-M0 can take."""
    build.cargo(
        *("build", "-q", "--release", "-p", "grbl", "--target", "thumbv6m-none-eabi"),
        BOARD="src/mps2.rs",
        CARGO_PROFILE_RELEASE_OPT_LEVEL="s",
    )
    return stack.worst("grbl")


def main(arguments: list[str]) -> int:
    """Checks the firmware on the boards with enough RAM."""
    options = product.parser("grbl", __doc__).parse_args(arguments)
    figures = product.measure("grbl", options.boards or BOARDS, cut)
    return product.settle("grbl", options, figures, BOARDS)
