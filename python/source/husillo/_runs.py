"""Simulated runs."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._findings import Error, Finding, ProgramError, listed, raised
from ._programs import options, text_of
from ._steps import Steps, joined, of_bytes

if TYPE_CHECKING:
    from typing import Self

    from numpy.typing import NDArray

    from ._programs import OfMachine, Program

BATCH = 65536
"""Entries of a batch of :func:`simulate`: Ctrl-C ends a run between two of them."""


@dataclass(frozen=True)
class Touch:
    """What a probe has found."""

    is_touched: bool
    position_nm: tuple[int, ...]
    """In the work frame of the move; its end if there was no contact."""
    machine_nm: tuple[int, ...]
    """The same in machine coordinates."""


@dataclass(frozen=True)
class Results:
    """The figures of a run. Positions are those of the tool, from work zero."""

    file: str
    machine: str
    axes: str
    """The letters of the axes."""
    events: int
    """Step events, those of take-ups of backlash included."""
    duration_s: float
    ticks: int
    ticks_per_second: int
    nm_per_step: tuple[float, ...]
    zero_nm: tuple[int, ...]
    """Position of work zero in machine coordinates at the end."""
    end_nm: tuple[int, ...]
    min_nm: tuple[int, ...]
    max_nm: tuple[int, ...]
    max_deviation_nm: float
    """Largest distance of the tool from the programmed path in a feed move."""
    rms_deviation_nm: float
    """Root of the mean square of that distance."""
    reversals: tuple[int, ...]
    """Take-ups of backlash."""
    lost_steps: int
    """Steps that the motors did not follow, all axes."""
    losses: tuple[str, ...]
    """A sentence about each axis that lost steps."""
    encoders: tuple[str, ...]
    """What the encoders reported."""
    probes: tuple[Touch, ...]
    feed_nm: int
    rapid_nm: int
    warnings: int
    findings: tuple[Finding, ...]
    """The warnings of the check."""
    notes: tuple[str, ...]
    """What was done without being asked for, such as a move to the middle of the table."""


@dataclass(frozen=True)
class Run(Results):
    """A simulated run: its figures and all its steps."""

    steps: Steps


def _results(text: str) -> dict[str, Any]:
    """The values of the fields of :class:`Results`."""
    values = json.loads(text)
    lists = ("losses", "encoders", "probes")
    of = {field.name: values.get(field.name) for field in fields(Results)}
    of.update({name: tuple(values.get(name, ())) for name in lists})
    of = {name: tuple(value) if isinstance(value, list) else value for name, value in of.items()}
    of["findings"] = listed(values["findings"])
    of["probes"] = tuple(
        Touch(touch["is_touched"], tuple(touch["position_nm"]), tuple(touch["machine_nm"]))
        for touch in of["probes"]
    )
    return of


class Stream:
    """A run that is computed while its steps are read, part by part: see :func:`stream`.

    It is an iterator of :class:`Steps` and a context manager.
    """

    axes: str
    """The letters of the axes."""
    ticks_per_second: int
    nm_per_step: tuple[float, ...]

    def __init__(self, native: _native.Stream) -> None:
        self._native = native
        units = json.loads(native.units)
        self.axes = units["axes"]
        self.ticks_per_second = units["ticks_per_second"]
        self.nm_per_step = tuple(units["nm_per_step"])
        self._ticks = 0
        self._event = 0
        self._commanded: NDArray[np.int32] = np.array(units["start"], np.int32)
        self._tool = self._commanded

    def __iter__(self) -> Self:
        return self

    def __next__(self) -> Steps:
        columns = self._next()
        if columns is None:
            raise StopIteration
        start = (self._ticks, self._event, self._commanded, self._tool)
        steps = self._steps(start, columns)
        self._ticks = int(steps.ticks[-1])
        self._event = int(steps.event[-1])
        self._commanded = steps.commanded[-1]
        self._tool = steps.tool[-1]
        return steps

    def _next(self) -> list[NDArray[Any]] | None:
        with raised(ProgramError):
            columns = self._native.next()
        return None if columns is None else of_bytes(columns, len(self.axes))

    def _steps(self, start: tuple[Any, Any, Any, Any], columns: list[NDArray[Any]]) -> Steps:
        return Steps(self.axes, self.ticks_per_second, self.nm_per_step, start, columns)

    def _whole(self) -> Run:
        parts = list(iter(self._next, None))
        start = (0, 0, self._commanded, self._tool)
        steps = self._steps(start, joined(parts, len(self.axes)))
        return Run(**self._answer(), steps=steps)

    def _answer(self) -> dict[str, Any]:
        answer = self._native.answer()
        if answer is None:
            raise Error("the run has not ended: read all its steps first")
        return _results(answer)

    @property
    def results(self) -> Results:
        """The figures of the run, after its last part.

        :raises Error: the run has not ended
        """
        return Results(**self._answer())

    def close(self) -> None:
        """Ends the run. Nothing more can be read."""
        self._native.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


def stream(
    program: Program,
    machine: OfMachine = "free",
    *,
    size: int = BATCH,
    name: str | None = None,
    dialect: str | None = None,
    zero: str | None = None,
    limit: int | None = None,
    files: Mapping[str, str] | None = None,
    compensation: bool = True,
    worn: bool = False,
) -> Stream:
    """Checks a program and begins to simulate it. Its steps are read in parts.

    The memory does not grow with the number of steps: up to four parts are held. The run waits for
    its reader. The parameters are those of :func:`simulate`.

    :param size: entries of a part; the last one has fewer
    :raises MachineError: there is no such machine, or its file has mistakes
    :raises ProgramError: the program has errors, or an option is wrong
    :raises ValueError: the size is below 1
    """
    if size < 1:
        raise ValueError(f"a part of {size} entries")
    more = {
        "dialect": dialect,
        "zero": zero,
        "limit": limit,
        "files": files,
        "compensation": compensation,
        "worn": worn,
    }
    wanted = options(program, machine, name, more)
    with raised(ProgramError):
        return Stream(_native.Stream(wanted, text_of(program), size))


def simulate(
    program: Program,
    machine: OfMachine = "free",
    *,
    name: str | None = None,
    dialect: str | None = None,
    zero: str | None = None,
    limit: int | None = None,
    files: Mapping[str, str] | None = None,
    compensation: bool = True,
    worn: bool = False,
) -> Run:
    """Checks and simulates a program. All its steps are in memory afterwards: 36 bytes each on a
    machine of three axes. :func:`stream` is for programs with too many of them.

    :param program: its text, or a path (``pathlib.Path``)
    :param machine: the machine that it runs on
    :param name: name in messages; its ending may decide the language
    :param dialect: as for :func:`check`
    :param zero: position of work zero: ``X20Y15``, ``fit``, ``centre`` or ``corner``
    :param limit: most findings; 1000 without it
    :param files: texts of files of subroutines, by name
    :param compensation: the controller compensates backlash
    :param worn: the screws have the backlash of ``[simulated_backlash]`` of the machine file
    :raises MachineError: there is no such machine, or its file has mistakes
    :raises ProgramError: the program has errors, an option is wrong, or a probe finds nothing
    """
    with stream(
        program,
        machine,
        name=name,
        dialect=dialect,
        zero=zero,
        limit=limit,
        files=files,
        compensation=compensation,
        worn=worn,
    ) as whole:
        return whole._whole()
