"""Machines."""

from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _native
from ._findings import MachineError, raised


@dataclass(frozen=True)
class Axis:
    """An axis of a machine."""

    letter: str
    step_nm: float
    """Length of a step."""
    travel_nm: tuple[int, int] | None
    """Its limits in machine coordinates; ``None`` if it has none or they are not known."""


class Machine:
    """A machine: a built-in one by its name, or one from the path of its file (TOML).

    A name is that of a built-in machine if there is one; otherwise it is a path.

    :raises MachineError: there is no such machine or file, or the file has mistakes
    """

    name: str
    """Short name."""
    title: str
    """One line for people."""
    ticks_per_second: int
    """Of the timer that counts the waits between steps."""
    axes: tuple[Axis, ...]
    text: str
    """The text of its file."""

    def __init__(self, name: str | os.PathLike[str]) -> None:
        path = os.fspath(name)
        if isinstance(name, str) and path in _names():
            self._read({"machine": path})
            return
        try:
            text = Path(path).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            names = ", ".join(sorted(_names()))
            why = f"{path}: no machine of this name ({names}), and the file cannot be read: {error}"
            raise MachineError(why) from error
        self._read({"machine_text": text, "machine_file": path})

    @classmethod
    def from_text(cls, text: str, file: str = "machine.toml") -> Machine:
        """A machine from the text of its file. ``file`` is its name in messages.

        :raises MachineError: the text has mistakes
        """
        machine = cls.__new__(cls)
        machine._read({"machine_text": text, "machine_file": file})
        return machine

    @classmethod
    def of(cls, machine: Machine | str | os.PathLike[str]) -> Machine:
        """The machine itself, or that of a name or a path."""
        return machine if isinstance(machine, Machine) else cls(machine)

    def _read(self, options: dict[str, str]) -> None:
        with raised(MachineError):
            described = json.loads(_native.machine(json.dumps(options)))
        self.name = described["name"]
        self.title = described["title"]
        self.ticks_per_second = described["ticks_per_second"]
        self.axes = tuple(_axis(axis) for axis in described["axes"])
        self.text = described["text"]
        self._file = options.get("machine_file", f"machines/{self.name}.toml")

    @property
    def letters(self) -> str:
        """The letters of its axes, such as ``XYZ``."""
        return "".join(axis.letter for axis in self.axes)

    def _options(self) -> dict[str, str]:
        return {"machine_text": self.text, "machine_file": self._file}

    def __repr__(self) -> str:
        return f"<husillo.Machine {self.name}: {self.title}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Machine) and self.text == other.text

    def __hash__(self) -> int:
        return hash(self.text)


def _axis(axis: dict[str, Any]) -> Axis:
    travel = axis["travel_nm"]
    return Axis(axis["letter"], axis["step_nm"], None if travel is None else tuple(travel))


def _names() -> list[str]:
    return [machine["name"] for machine in json.loads(_native.machines())["machines"]]


def machines() -> list[Machine]:
    """The built-in machines."""
    return [Machine(name) for name in _names()]
