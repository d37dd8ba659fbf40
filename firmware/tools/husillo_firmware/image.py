"""Builds a product for a board that people own, and writes the file that the board takes.

A Pico whose button BOOTSEL is held while it is connected is a disk. It takes a UF2 file and starts.
A Nucleo is a disk as well, and takes the bytes of its flash. `dfu-util` writes these to a Black
Pill. `esptool` writes an image to the flash of an ESP32-C3, whose boot ROM copies it into RAM.

Source of the form UF2: <https://github.com/microsoft/uf2>, of an image for an ESP32-C3:
<https://docs.espressif.com/projects/esptool/en/latest/esp32c3/advanced-topics/firmware-image-format.html>.
"""

from __future__ import annotations

import argparse
import functools
import operator
import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from husillo_firmware.build import FAST, cargo, target_folder
from husillo_firmware.elf import Elf

MAGIC = 0x0A324655, 0x9E5D5157, 0x0AB16F30
HAS_FAMILY = 0x2000
# The bytes of a block; the boot loader takes no other number.
PAGE = 256
# An image for an ESP32-C3: its mark and that of its checksum; two data lines and 4 MB of flash at
# 40 MHz; no pin for write protection; the number of the chip.
ESP_MAGIC, ESP_SUM = 0xE9, 0xEF
ESP_MODE, ESP_FLASH = 2, 0x20
ESP_NO_PIN = 0xEE
ESP_CHIP = 5
ESP_ANY_REVISION = 0xFFFF
# The checksum is the last byte of a block.
ESP_BLOCK = 16


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
    # The boot ROM takes an image with the parts of the program.
    is_loaded: bool = False


M4F = "thumbv7em-none-eabihf"
# By the names of their files in `board/src`.
BOARDS = {
    "pico": Board("thumbv6m-none-eabi", "board/rp2040,board/switches", 0xE48BFF56, "3"),
    "pico2": Board("thumbv8m.main-none-eabihf", "board/rp2350,board/switches", 0xE48BFF59, "3"),
    "nucleo_f401": Board(M4F, "board/switches"),
    "nucleo_f446": Board(M4F, "board/switches"),
    "black_pill": Board(M4F, "board/otg,board/switches"),
    "blue_pill": Board("thumbv7m-none-eabi", "board/usbd,board/switches"),
    "esp32c3": Board(
        "riscv32imc-unknown-none-elf", "board/esp32c3,board/switches", level="3", is_loaded=True
    ),
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


def esp_image(entry: int, parts: Iterable[tuple[int, bytes]]) -> bytes:
    """The image of a program for the boot ROM of an ESP32-C3: where it begins, and its parts."""
    padded = [(address, data + bytes(-len(data) % 4)) for address, data in parts]
    head = struct.pack("<4BI", ESP_MAGIC, len(padded), ESP_MODE, ESP_FLASH, entry)
    head += struct.pack("<B3xHBHHxxxxB", ESP_NO_PIN, ESP_CHIP, 0, 0, ESP_ANY_REVISION, 0)
    body = b"".join(struct.pack("<II", at, len(data)) + data for at, data in padded)
    check = functools.reduce(operator.xor, (byte for _, data in padded for byte in data), ESP_SUM)
    image = head + body
    return image + bytes(-len(image) % ESP_BLOCK or ESP_BLOCK)[:-1] + bytes([check])


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
    elf = Elf(target_folder() / board.target / "release" / chosen.product)
    suffix, filled = "bin", pages(elf)
    if board.is_loaded:
        file = esp_image(elf.entry, elf.loaded())
    elif board.family is None:
        file = b"".join(flash(filled))
    else:
        suffix, file = "uf2", b"".join(uf2(filled, board.family))
    output = chosen.output or Path(f"{chosen.product}.{suffix}")
    output.write_bytes(file)
    print(f"{output}: {len(filled) * PAGE} bytes of flash")
    return 0
