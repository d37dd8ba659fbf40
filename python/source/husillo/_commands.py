"""The commands of a program."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _native
from ._findings import Finding, ProgramError, listed, raised
from ._programs import options, text_of

if TYPE_CHECKING:
    from ._programs import OfMachine, Program


@dataclass(frozen=True)
class Command:
    """A command: a move, or another action of the machine."""

    line: int
    """From 1."""
    kind: str
    """``rapid``, ``linear``, ``arc``, ``dwell``, ``spindle``, ... as in the JSON of
    ``husillo commands``."""
    to_nm: tuple[int, ...] | None
    """The end of a move in machine coordinates; ``None`` if nothing moves."""
    feed_nm_per_min: int | None
    """The feed along the path; ``None`` for a rapid, and for a feed per turn of the spindle."""
    values: Mapping[str, Any]
    """All that the command has, by the keys of its JSON."""


@dataclass(frozen=True)
class Commands:
    """The commands of a program, in their order."""

    commands: tuple[Command, ...]
    errors: int
    """With errors, the commands are those before the first line that cannot be read."""
    warnings: int
    findings: tuple[Finding, ...]

    def __iter__(self) -> Iterator[Command]:
        return iter(self.commands)

    def __len__(self) -> int:
        return len(self.commands)

    def __getitem__(self, index: int) -> Command:
        return self.commands[index]


def commands(
    program: Program,
    machine: OfMachine = "free",
    *,
    name: str | None = None,
    dialect: str | None = None,
    zero: str | None = None,
    limit: int | None = None,
    files: Mapping[str, str] | None = None,
) -> Commands:
    """The commands of a program, in exact nanometres. The parameters are those of :func:`check`.

    :raises MachineError: there is no such machine, or its file has mistakes
    :raises ProgramError: an option is wrong, or the file is no text
    """
    more = {"dialect": dialect, "zero": zero, "limit": limit, "files": files}
    wanted = options(program, machine, name, more)
    with raised(ProgramError):
        found, lines = _native.commands(wanted, text_of(program))
    about = json.loads(found)
    # One object a line: as a list they are read at once.
    objects = json.loads("[" + lines.rstrip("\n").replace("\n", ",") + "]")
    return Commands(
        commands=tuple(_command(values) for values in objects),
        errors=about["errors"],
        warnings=about["warnings"],
        findings=listed(about["findings"]),
    )


def _command(values: dict[str, Any]) -> Command:
    values.pop("schema")
    to_nm = values.get("to_nm")
    return Command(
        line=values["line"],
        kind=values["kind"],
        to_nm=None if to_nm is None else tuple(to_nm),
        feed_nm_per_min=values.get("feed_nm_per_min"),
        values=values,
    )
