"""Drill files."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._findings import Finding, ProgramError, listed, raised
from ._programs import text_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._programs import Program


@dataclass(frozen=True)
class Board:
    """The holes of a drill file."""

    holes_mm: NDArray[np.float64]
    """X, Y and diameter of each hole in the order of drilling; no diameter is NaN."""
    errors: int
    warnings: int
    findings: tuple[Finding, ...]
    gcode: str | None
    """The program that drills them, if a depth was given."""
    values: Mapping[str, Any]
    """All that is known, by the keys of the JSON of ``husillo holes``: tools, slots, units and
    their reasons."""


def holes(
    file: Program,
    *,
    depth_mm: float | None = None,
    shortest: bool = False,
    name: str | None = None,
) -> Board:
    """Reads a drill file (Excellon).

    :param file: its text, or a path (``pathlib.Path``)
    :param depth_mm: depth of the holes: the program in G-code is made as well
    :param shortest: puts the holes into an order with short moves
    :raises ProgramError: the depth is out of range, or a depth is given and the file has errors
    """
    if name is None and isinstance(file, Path):
        name = file.name
    wanted = {"name": name, "depth_mm": depth_mm, "shortest": shortest}
    wanted = {key: value for key, value in wanted.items() if value is not None}
    with raised(ProgramError):
        found, gcode = _native.holes(json.dumps(wanted), text_of(file))
    values = json.loads(found)
    rows = np.array(values["holes"], np.float64).reshape(-1, 3)
    return Board(
        holes_mm=rows,
        errors=values["errors"],
        warnings=values["warnings"],
        findings=listed(values["findings"]),
        gcode=gcode or None,
        values=values,
    )
