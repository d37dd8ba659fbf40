"""Builds a product for a Raspberry Pi Pico and writes it as a UF2 file.

A Pico whose button BOOTSEL is held while it is connected is a disk. It takes this file and starts.

Source: <https://github.com/microsoft/uf2>.
"""

from __future__ import annotations

import argparse
import struct
from collections.abc import Iterator
from pathlib import Path

from husillo_firmware.build import cargo, target_folder
from husillo_firmware.elf import Elf

TARGET = "thumbv6m-none-eabi"
MAGIC = 0x0A324655, 0x9E5D5157, 0x0AB16F30
HAS_FAMILY, RP2040 = 0x2000, 0xE48BFF56
# The bytes of a block; the boot loader takes no other number.
PAGE = 256


def pages(elf: Elf) -> dict[int, bytearray]:
    """The pages of flash that a program fills, by their address."""
    found: dict[int, bytearray] = {}
    for address, data in elf.loaded():
        for place, byte in enumerate(data, address):
            page = found.setdefault(place - place % PAGE, bytearray(PAGE))
            page[place % PAGE] = byte
    return found


def blocks(filled: dict[int, bytearray]) -> Iterator[bytes]:
    """The file, block by block."""
    for number, (address, page) in enumerate(sorted(filled.items())):
        head = struct.pack(
            "<8I", *MAGIC[:2], HAS_FAMILY, address, PAGE, number, len(filled), RP2040
        )
        yield head + bytes(page).ljust(476, b"\0") + struct.pack("<I", MAGIC[2])


def main(arguments: list[str]) -> int:
    """Builds and writes. Returns the status."""
    options = argparse.ArgumentParser(prog="firmware/uf2", description=__doc__)
    options.add_argument("product")
    options.add_argument("-o", "--output", type=Path, help="by default PRODUCT.uf2")
    chosen = options.parse_args(arguments)
    cargo(
        *("build", "-q", "--release", "-p", chosen.product, "--target", TARGET),
        *("--features", "board/usb,board/switches"),
        BOARD="src/pico.rs",
    )
    filled = pages(Elf(target_folder() / TARGET / "release" / chosen.product))
    output = chosen.output or Path(f"{chosen.product}.uf2")
    output.write_bytes(b"".join(blocks(filled)))
    print(f"{output}: {len(filled) * PAGE} bytes of flash")
    return 0
