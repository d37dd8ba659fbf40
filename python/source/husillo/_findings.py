"""Findings, and the exceptions that have them."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from . import _native


@dataclass(frozen=True)
class Fix:
    """A change that removes a finding: ``text`` replaces the columns from ``column`` to before
    ``end`` of a line, in characters from 1."""

    line: int
    column: int
    end: int
    text: str


@dataclass(frozen=True)
class Finding:
    """An error or a warning. ``husillo explain CODE`` explains its code."""

    code: str
    """Such as ``E0301``."""
    severity: str
    """``error`` or ``warning``."""
    message: str
    """What is wrong."""
    file: str | None
    """``None`` for a finding about the whole program; the same for line, column and end."""
    line: int | None
    """From 1."""
    column: int | None
    """First column in characters, from 1."""
    end: int | None
    """Column behind the last character."""
    label: str | None
    """Text for the marked columns."""
    notes: tuple[str, ...]
    """Explanations."""
    help: str | None
    """Advice."""
    fixes: tuple[Fix, ...]
    """Changes that remove it."""

    @property
    def is_error(self) -> bool:
        """Whether the program cannot run."""
        return self.severity == "error"

    def __str__(self) -> str:
        place = "" if self.line is None else f"{self.file}:{self.line}:{self.column}: "
        return f"{place}{self.severity}[{self.code}]: {self.message}"


class Error(Exception):
    """Why there is no result."""

    def __init__(self, why: str, findings: tuple[Finding, ...] = ()) -> None:
        first = next((of for of in findings if of.is_error), None)
        super().__init__(why if first is None else f"{why}\n{first}")
        self.findings = findings
        """What is wrong in the program or in the machine file; none if it is something else."""
        self.code = None if first is None else first.code
        """The code of the first error."""
        self.line = None if first is None else first.line
        """Its line, from 1."""
        self.column = None if first is None else first.column
        """Its first column, from 1."""


class MachineError(Error):
    """There is no such machine, or its file has mistakes."""


class ProgramError(Error):
    """The program has errors, or an option does not suit it or its machine."""


def listed(findings: list[dict[str, Any]]) -> tuple[Finding, ...]:
    """Findings as they are in JSON."""
    return tuple(
        Finding(
            **{
                **finding,
                "notes": tuple(finding["notes"]),
                "fixes": tuple(Fix(**fix) for fix in finding["fixes"]),
            }
        )
        for finding in findings
    )


@contextmanager
def raised(kind: type[Error]) -> Iterator[None]:
    """Raises this exception for a call that has no answer."""
    try:
        yield
    except _native.Failed as failed:
        why, findings = failed.args
        raise kind(why, listed(json.loads(findings))) from None
