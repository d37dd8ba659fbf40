"""Programs and their check."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native
from ._findings import Finding, ProgramError, listed, raised
from ._machines import Machine

if TYPE_CHECKING:
    from typing import TypeAlias

    Program: TypeAlias = str | bytes | os.PathLike[str]
    """The text of a program, or the path of its file as an object of ``pathlib``."""
    OfMachine: TypeAlias = Machine | str | os.PathLike[str]
    """A machine, the name of a built-in one, or the path of a machine file."""


def text_of(program: Program) -> bytes:
    """The bytes of a program."""
    if isinstance(program, bytes):
        return program
    if isinstance(program, str):
        return program.encode("utf-8", "surrogateescape")
    return Path(program).read_bytes()


def options(
    program: Program,
    machine: OfMachine,
    name: str | None,
    more: Mapping[str, Any],
) -> str:
    """The options of a call in JSON. Those that are ``None`` are left out."""
    if name is None and isinstance(program, os.PathLike):
        name = Path(program).name
    all_of_them = {"name": name, **Machine.of(machine)._options(), **more}
    return json.dumps({key: value for key, value in all_of_them.items() if value is not None})


@dataclass(frozen=True)
class Checked:
    """The result of a check."""

    file: str
    errors: int
    """All errors: ``findings`` has the first ones, up to the limit."""
    warnings: int
    findings: tuple[Finding, ...]
    notes: tuple[str, ...]
    """What was done without being asked for, such as a move to the middle of the table."""
    feed_nm: int = 0
    """Length of all feed moves."""
    rapid_nm: int = 0
    """Length of all rapids."""
    reversals: tuple[int, ...] = ()
    """Reversals of each axis."""

    @property
    def may_run(self) -> bool:
        """Whether there is no error."""
        return self.errors == 0


def check(
    program: Program,
    machine: OfMachine = "free",
    *,
    name: str | None = None,
    dialect: str | None = None,
    zero: str | None = None,
    limit: int | None = None,
    files: Mapping[str, str] | None = None,
) -> Checked:
    """Checks a program, or a drill file by its name. Nothing runs.

    :param program: its text, or a path (``pathlib.Path``)
    :param machine: the machine that it is for
    :param name: name in messages; its ending may decide the language
    :param dialect: ``rs274``, ``grbl``, ``lathe``, ``lathe-a``, ``iso``, ``printer``, ``micromill``
        or ``drill``
    :param zero: position of work zero: ``X20Y15``, ``fit``, ``centre`` or ``corner``
    :param limit: most findings; 1000 without it
    :param files: texts of files of subroutines, by name
    :raises MachineError: there is no such machine, or its file has mistakes
    :raises ProgramError: an option is wrong, or the file is no text. What is wrong in the
        program is in ``findings``
    """
    more = {"dialect": dialect, "zero": zero, "limit": limit, "files": files}
    wanted = options(program, machine, name, more)
    with raised(ProgramError):
        checked = json.loads(_native.check(wanted, text_of(program)))
    return Checked(
        file=checked["file"],
        errors=checked["errors"],
        warnings=checked["warnings"],
        findings=listed(checked["findings"]),
        notes=tuple(checked["notes"]),
        feed_nm=int(checked.get("feed_nm", 0)),
        rapid_nm=int(checked.get("rapid_nm", 0)),
        reversals=tuple(checked.get("reversals", ())),
    )
