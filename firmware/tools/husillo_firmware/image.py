"""Builds a product for a board that people own, and writes the file that the board takes.

A Pico whose button BOOTSEL is held while it is connected is a disk. It takes a UF2 file and starts.
A Nucleo is a disk as well, and takes the bytes of its flash. `dfu-util` writes these to a Black
Pill.

Source of the form UF2: <https://github.com/microsoft/uf2>.
"""

from __future__ import annotations

import argparse
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from husillo_firmware.build import FAST, cargo, target_folder
from husillo_firmware.elf import Elf

MAGIC = 0x0A324655, 0x9E5D5157, 0x0AB16F30
HAS_FAMILY = 0x2000
# The bytes of a block; the boot loader takes no other number.
PAGE = 256


@dataclass(frozen=True)
class Board:
    """A board, and what its build needs."""

    target: str
    features: str
    # The number by which the boot loader recognises a UF2 file for its chip. `None`: it takes the
    # bytes of the flash.
    family: int | None = None
    # The optimisation level: for speed where there is room.
    level: str = "s"


M4F = "thumbv7em-none-eabihf"
# By the names of their files in `board/src`.
BOARDS = {
    "pico": Board("thumbv6m-none-eabi", "board/rp2040,board/switches", 0xE48BFF56, "3"),
    "pico2": Board("thumbv8m.main-none-eabihf", "board/switches", 0xE48BFF59, "3"),
    "nucleo_f401": Board(M4F, "board/switches"),
    "nucleo_f446": Board(M4F, "board/switches"),
    "black_pill": Board(M4F, "board/otg,board/switches"),
    "blue_pill": Board("thumbv7m-none-eabi", "board/usbd,board/switches"),
}


def pages(elf: Elf) -> dict[int, bytearray]:
    """The pages of flash that a program fills, by their address."""
    found: dict[int, bytearray] = {}
    for address, data in elf.loaded():
        for place, byte in enumerate(data, address):
            page = found.setdefault(place - place % PAGE, bytearray(b"\xff" * PAGE))
            page[place % PAGE] = byte
    return found


def uf2(filled: dict[int, bytearray], family: int) -> Iterator[bytes]:
    """The file for the boot loader, block by block."""
    for number, (address, page) in enumerate(sorted(filled.items())):
        head = struct.pack(
            "<8I", *MAGIC[:2], HAS_FAMILY, address, PAGE, number, len(filled), family
        )
        yield head + bytes(page).ljust(476, b"\0") + struct.pack("<I", MAGIC[2])


def flash(filled: dict[int, bytearray]) -> Iterator[bytes]:
    """The bytes of the flash from its first page to its last one."""
    for address in range(min(filled), max(filled) + PAGE, PAGE):
        yield bytes(filled.get(address, b"\xff" * PAGE))


def main(arguments: list[str]) -> int:
    """Builds and writes. Returns the status."""
    options = argparse.ArgumentParser(prog="firmware/image", description=__doc__)
    options.add_argument("product")
    options.add_argument("board", nargs="?", choices=BOARDS, default="pico")
    options.add_argument("-o", "--output", type=Path, help="by default PRODUCT.uf2 or PRODUCT.bin")
    options.add_argument("--features", default="", help="of the product, for example coils")
    chosen = options.parse_args(arguments)
    board = BOARDS[chosen.board]
    cargo(
        *("build", "-q", "--release", "-p", chosen.product, "--target", board.target),
        *("--features", f"{board.features},{chosen.features}"),
        BOARD=f"src/{chosen.board}.rs",
        CARGO_PROFILE_RELEASE_OPT_LEVEL="3" if chosen.product in FAST else board.level,
    )
    filled = pages(Elf(target_folder() / board.target / "release" / chosen.product))
    suffix, file = (
        ("bin", flash(filled)) if board.family is None else ("uf2", uf2(filled, board.family))
    )
    output = chosen.output or Path(f"{chosen.product}.{suffix}")
    output.write_bytes(b"".join(file))
    print(f"{output}: {len(filled) * PAGE} bytes of flash")
    return 0
