"""The QEMU boards on which firmwares are checked."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Board:
    """A board that QEMU emulates."""

    name: str
    # The target of the compiler.
    target: str
    qemu: tuple[str, ...]
    ram_start: int
    # Bytes of RAM in the memory map of the board's file.
    ram: int
    # The optimisation level. A product may use another one.
    level: str

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
ALL = (MICROBIT, MPS2, VIRT)


def named(name: str) -> Board:
    """The board of that name.

    Raises `ValueError` if there is none, as a type of `argparse` must.
    """
    for board in ALL:
        if board.name == name:
            return board
    raise ValueError(f"no such board: {name}")
