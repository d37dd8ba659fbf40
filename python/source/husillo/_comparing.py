"""Comparisons of methods of interpolation."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _native
from ._findings import ProgramError, raised
from ._programs import options, text_of

if TYPE_CHECKING:
    from ._programs import OfMachine, Program


@dataclass(frozen=True)
class Line:
    """A line from zero to an end, steps of each axis."""

    end: tuple[int, ...]

    def _move(self) -> dict[str, Any]:
        return {"line": self.end}


@dataclass(frozen=True)
class Circle:
    """A full circle; its radius in steps."""

    radius: int
    clockwise: bool = False

    def _move(self) -> dict[str, Any]:
        return {"circle": {"radius": self.radius, "clockwise": self.clockwise}}


@dataclass(frozen=True)
class Arc:
    """An arc, in steps."""

    start: tuple[int, int]
    end: tuple[int, int]
    centre: tuple[int, int]
    clockwise: bool = False

    def _move(self) -> dict[str, Any]:
        arc = {"from": self.start, "to": self.end, "centre": self.centre}
        return {"arc": {**arc, "clockwise": self.clockwise}}


@dataclass(frozen=True)
class Method:
    """A method of interpolation with its figures. Errors are in steps."""

    method: str
    shape: str
    moves: int
    iterations: int
    max_error_steps: float
    rms_error_steps: float
    additions: float
    instructions: Mapping[str, float | None]
    """Per step event, by processor: ``cortex_m0``, ``cortex_m4f``, ``riscv``."""
    points: Mapping[str, float]
    """By criterion, and ``total``."""
    values: Mapping[str, Any]
    """All figures, by the keys of the JSON of ``husillo compare``."""


@dataclass(frozen=True)
class Comparison:
    """Methods of interpolation, the best one first."""

    title: str
    methods: tuple[Method, ...]
    notes: tuple[str, ...]


def compare(
    what: Line | Circle | Arc | Program,
    machine: OfMachine = "free",
    *,
    weights: tuple[float, float, float, float] = (3, 3, 3, 1),
    only: str | None = None,
    name: str | None = None,
    dialect: str | None = None,
    zero: str | None = None,
    files: Mapping[str, str] | None = None,
) -> Comparison:
    """Compares the methods of interpolation for one move, or for the feed moves of a program.

    :param what: a move in steps, or a program
    :param machine: the machine of a program
    :param weights: of error, speed, instructions and additions
    :param only: only methods with this in their name
    :raises MachineError: there is no such machine, or its file has mistakes
    :raises ProgramError: the program has errors, or an option is wrong
    """
    wanted: dict[str, Any] = {"weights": ",".join(str(weight) for weight in weights)}
    if only is not None:
        wanted["only"] = only
    text = b""
    if isinstance(what, (Line, Circle, Arc)):
        wanted["one"] = what._move()
    else:
        more = {"dialect": dialect, "zero": zero, "files": files}
        wanted["program"] = json.loads(options(what, machine, name, more))
        text = text_of(what)
    with raised(ProgramError):
        made = json.loads(_native.compare(json.dumps(wanted), text))
    methods = tuple(_method(values) for values in made["methods"])
    return Comparison(made["title"], methods, tuple(made["notes"]))


def _method(values: dict[str, Any]) -> Method:
    return Method(
        method=values["method"],
        shape=values["shape"],
        moves=values["moves"],
        iterations=values["iterations"],
        max_error_steps=values["max_error_blu"],
        rms_error_steps=values["rms_error_blu"],
        additions=values["additions"],
        instructions=values["instructions"],
        points=values["points"],
        values=values,
    )
