"""The boards on which firmwares are checked in QEMU."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Board:
    """A board that QEMU emulates, or most of it."""

    name: str
    # The target of the compiler.
    target: str
    qemu: tuple[str, ...]
    ram_start: int
    # Bytes of RAM in the memory map of the board's file.
    ram: int
    # The optimisation level. A product may use another one.
    level: str
    # The machine of QEMU, if it has another name.
    machine: str = ""
    # The file of the board, if the target does not select it.
    file: str = ""
    # The UART of the machine, in the order of QEMU.
    serial: int = 0
    # Further options of cargo.
    options: tuple[str, ...] = ()

    def __str__(self) -> str:
        return self.name


MICROBIT = Board("microbit", "thumbv6m-none-eabi", ("qemu-system-arm",), 0x2000_0000, 16384, "z")
MPS2 = Board("mps2-an386", "thumbv7em-none-eabihf", ("qemu-system-arm",), 0x2000_0000, 131072, "s")
VIRT = Board(
    "virt",
    "riscv32imac-unknown-none-elf",
    ("qemu-system-riscv32", "-bios", "none"),
    0x8010_0000,
    131072,
    "s",
)
# The boards on which every product is checked.
ALL = (MICROBIT, MPS2, VIRT)
# The machine has the processor and the UART of the Nucleo, but no clocks, pins and cycle counter.
NUCLEO_F446 = Board(
    "nucleo-f446",
    "thumbv7em-none-eabihf",
    ("qemu-system-arm",),
    0x2000_0000,
    131072,
    "s",
    machine="netduinoplus2",
    file="src/nucleo_f446.rs",
    serial=1,
)
# The machine has a chip of the same family, with 8 kB of RAM and without pins and clocks.
BLUE_PILL = Board(
    "blue-pill",
    "thumbv7m-none-eabi",
    ("qemu-system-arm",),
    0x2000_0000,
    8192,
    "s",
    machine="stm32vldiscovery",
    file="src/blue_pill.rs",
    serial=1,
    options=(
        "--config",
        'target.thumbv7m-none-eabi.rustflags=["-Clink-arg=--defsym=_stack_start=0x20002000"]',
    ),
)


def named(name: str) -> Board:
    """The board of that name.

    Raises `ValueError` if there is none, as a type of `argparse` must.
    """
    for board in (*ALL, NUCLEO_F446, BLUE_PILL):
        if board.name == name:
            return board
    raise ValueError(f"no such board: {name}")
