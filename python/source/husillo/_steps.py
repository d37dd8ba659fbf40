"""The step events of a run as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from enum import IntEnum
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

LINEAR = "XYZ"
"""The axes whose lengths add up to the path."""


class Kind(IntEnum):
    """The kind of an entry."""

    WAIT = 0
    """A wait without a step."""
    FEED = 1
    RAPID = 2
    TAKE_UP = 3
    """The step takes up backlash: the tool stands still."""
    OTHER = 4


class Steps:
    """Entries of a run, one after the other: step events, and waits without a step.

    Arrays have one row for each entry, and cannot be written to. Those of two dimensions have a
    column for each axis.
    """

    axes: str
    """The letters of the axes."""
    ticks_per_second: int
    nm_per_step: NDArray[np.float64]
    """Length of a step of each axis."""
    start_ticks: int
    """Time before the first entry; 0 except in a part of a run."""
    start_event: int
    """Number of step events before the first entry."""
    start_commanded: NDArray[np.int32]
    """Position of the controller before the first entry, steps."""
    start_tool: NDArray[np.int32]
    """Position of the tool before the first entry, steps."""
    wait_ticks: NDArray[np.uint32]
    """Ticks between the entry before and this one."""
    kind: NDArray[np.uint8]
    """A :class:`Kind`."""
    line: NDArray[np.uint32]
    """Line of the move, from 1. It is 0 for waits, for moves in files of subroutines, for those
    that depend on a contact, and after a million moves."""
    delta: NDArray[np.int8]
    """Step of each motor: -1, 0 or 1."""
    commanded: NDArray[np.int32]
    """Position of the controller after the entry, steps in machine coordinates."""
    tool: NDArray[np.int32]
    """Position of the tool, which follows the motors through screws with backlash."""

    def __init__(
        self,
        axes: str,
        ticks_per_second: int,
        nm_per_step: ArrayLike,
        start: tuple[int, int, ArrayLike, ArrayLike],
        columns: Sequence[NDArray[Any]],
    ) -> None:
        self.axes = axes
        self.ticks_per_second = ticks_per_second
        self.nm_per_step = np.asarray(nm_per_step, np.float64)
        self.start_ticks, self.start_event = start[:2]
        self.start_commanded = np.asarray(start[2], np.int32)
        self.start_tool = np.asarray(start[3], np.int32)
        self.wait_ticks, self.kind, self.line = columns[:3]
        self.delta, self.commanded, self.tool = columns[3:]

    def __len__(self) -> int:
        return len(self.wait_ticks)

    def __repr__(self) -> str:
        return f"<husillo.Steps: {len(self)} entries, axes {self.axes}>"

    @cached_property
    def ticks(self) -> NDArray[np.int64]:
        """Timer ticks from the start of the run to each entry."""
        return _fixed(self.start_ticks + np.cumsum(self.wait_ticks, dtype=np.int64))

    @cached_property
    def event(self) -> NDArray[np.int64]:
        """Number of step events up to each entry, as in the list of ``husillo steps``."""
        return _fixed(self.start_event + np.cumsum(self.is_step, dtype=np.int64))

    @property
    def is_step(self) -> NDArray[np.bool_]:
        """Whether the entry is a step event."""
        return np.not_equal(self.kind, Kind.WAIT)

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Seconds from the start of the run to each entry."""
        return self.ticks / self.ticks_per_second

    @property
    def tool_mm(self) -> NDArray[np.float64]:
        """Position of the tool in machine coordinates, mm; of a rotary axis degrees."""
        return self.tool * (self.nm_per_step / 1e6)

    @property
    def commanded_mm(self) -> NDArray[np.float64]:
        """Position of the controller in machine coordinates, mm; of a rotary axis degrees."""
        return self.commanded * (self.nm_per_step / 1e6)

    def at(self, time_s: ArrayLike) -> NDArray[np.float64]:
        """Position of the tool at these times, mm: a row for each time."""
        times = np.asarray(time_s, np.float64)
        # The nearest tick: a time that was made of ticks has these ticks again.
        ticks = np.rint(times * self.ticks_per_second).astype(np.int64)
        index = np.searchsorted(self.ticks, ticks, side="right")
        steps = np.concatenate([self.start_tool[None, :], self.tool])[index]
        return np.asarray(steps * (self.nm_per_step / 1e6), np.float64)

    def speed(self, window_s: float = 0.01) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Mean speed of the tool along its path in windows of equal length: the times of their
        middles in seconds, and mm/s.

        Only X, Y and Z count. A window needs many steps: a step in a window of 10 ms is 100 steps
        per second.

        :raises ValueError: the window is not longer than a tick
        """
        if not window_s * self.ticks_per_second >= 1:
            raise ValueError(f"a window of {window_s} s is not longer than a tick")
        begin = self.start_ticks / self.ticks_per_second
        end = begin if len(self) == 0 else float(self.time_s[-1])
        count = max(1, int(np.ceil((end - begin) / window_s - 1e-9)))
        edges = begin + window_s * np.arange(count + 1)
        linear = [index for index, letter in enumerate(self.axes) if letter in LINEAR]
        # Behind the end the tool stands still: the last window is as long as the others.
        moved = np.diff(self.at(edges)[:, linear], axis=0)
        middles = np.asarray(edges[:-1] + window_s / 2, np.float64)
        return middles, np.asarray(np.linalg.norm(moved, axis=1) / window_s, np.float64)

    def columns(self) -> dict[str, NDArray[Any]]:
        """Columns of one dimension by name, as for ``pandas.DataFrame(steps.columns())``."""
        named: dict[str, NDArray[Any]] = {
            "event": self.event,
            "time_s": self.time_s,
            "wait_ticks": self.wait_ticks,
            "kind": self.kind,
            "line": self.line,
        }
        for index, letter in enumerate(self.axes.lower()):
            named[f"d{letter}"] = self.delta[:, index]
            named[f"{letter}_mm"] = self.tool_mm[:, index]
        return named


def _fixed(array: NDArray[np.int64]) -> NDArray[np.int64]:
    array.flags.writeable = False
    return array


COLUMNS = (np.uint32, np.uint8, np.uint32, np.int8, np.int32, np.int32)
"""The numbers of the columns of a batch. The last three have one for each axis."""


def of_bytes(columns: Sequence[bytes], axes: int) -> list[NDArray[Any]]:
    """The columns of a batch, without a copy."""
    arrays: list[NDArray[Any]] = [
        np.frombuffer(column, COLUMNS[index]) for index, column in enumerate(columns)
    ]
    return arrays[:3] + [array.reshape(-1, axes) for array in arrays[3:]]


def joined(parts: Sequence[Sequence[NDArray[Any]]], axes: int) -> list[NDArray[Any]]:
    """The columns of several batches as one."""
    parts = parts or [of_bytes([b""] * len(COLUMNS), axes)]
    arrays = [np.concatenate([part[index] for part in parts]) for index in range(len(COLUMNS))]
    for array in arrays:
        array.flags.writeable = False
    return arrays
