"""Reads 32-bit ELF programs without the tools of a target."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

# Kinds of sections, and flags of sections.
PROGRAM, SYMBOLS, ZEROS = 1, 2, 8
WRITTEN, LOADED = 1, 2


@dataclass(frozen=True)
class Section:
    """A section. `link` is the number of the section that has its names."""

    name: str
    kind: int
    flags: int
    address: int
    offset: int
    length: int
    link: int

    def has(self, address: int) -> bool:
        """Whether the address is in this section."""
        return self.address <= address < self.address + self.length


@dataclass(frozen=True)
class Symbol:
    """A symbol. `is_function` is true for a function that the program defines."""

    name: str
    value: int
    length: int
    is_function: bool


class Elf:
    """Sections and symbols of a program."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.data = path.read_bytes()
        # Where the program begins.
        self.entry: int
        (self.entry,) = struct.unpack_from("<I", self.data, 0x18)
        (offset,) = struct.unpack_from("<I", self.data, 0x20)
        size, count, names = struct.unpack_from("<HHH", self.data, 0x2E)
        raw = [struct.unpack_from("<10I", self.data, offset + n * size) for n in range(count)]
        self.sections = [Section(self.text(raw[names][4] + one[0]), *one[1:7]) for one in raw]
        self.programs = [one for one in self.sections if one.kind == PROGRAM and one.flags & LOADED]

    def text(self, place: int) -> str:
        """The name at an offset of the file."""
        return self.data[place : self.data.index(b"\0", place)].decode()

    def flash(self) -> int:
        """The bytes that are loaded."""
        return self.sum(lambda one: one.kind != ZEROS)

    def loaded(self) -> Iterator[tuple[int, bytes]]:
        """The parts that are loaded, each with its address in flash."""
        (offset,) = struct.unpack_from("<I", self.data, 0x1C)
        size, count = struct.unpack_from("<HH", self.data, 0x2A)
        for number in range(count):
            kind, place, _, address, length = struct.unpack_from(
                "<5I", self.data, offset + number * size
            )
            if kind == PROGRAM and length:
                yield address, self.data[place : place + length]

    def written(self) -> int:
        """The bytes of memory that can be written."""
        return self.sum(lambda one: bool(one.flags & WRITTEN))

    def sum(self, counts: Callable[[Section], bool]) -> int:
        """Total length of the loaded sections for which `counts` is true."""
        return sum(one.length for one in self.sections if one.flags & LOADED and counts(one))

    def static(self, start: int) -> int:
        """The bytes from the start of RAM to the end of the static data."""
        names = (".data", ".bss", ".uninit")
        return max(one.address + one.length for one in self.sections if one.name in names) - start

    def halfword(self, address: int) -> int:
        """Two bytes of code; 0 where there is no code."""
        return self.number(address, "<H")

    def number(self, address: int, form: str) -> int:
        """A number in the program, in a `struct` format; 0 where there is no code."""
        for one in self.programs:
            if one.has(address):
                place = one.offset + address - one.address
                return int(struct.unpack_from(form, self.data, place)[0])
        return 0

    def symbols(self) -> Iterator[Symbol]:
        """All symbols."""
        for section in self.sections:
            if section.kind != SYMBOLS:
                continue
            names = self.sections[section.link].offset
            for place in range(section.offset, section.offset + section.length, 16):
                name, value, length, info, _, defined = struct.unpack_from(
                    "<IIIBBH", self.data, place
                )
                is_function = info & 15 == 2 and defined != 0
                yield Symbol(self.text(names + name), value, length, is_function)
