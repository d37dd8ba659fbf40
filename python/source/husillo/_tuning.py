"""A servo axis on a simulated stand."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._findings import Error, raised

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Trace:
    """The position of the axis in one experiment."""

    title: str
    target: int | None
    """Goal, counts."""
    time_us: NDArray[np.int64]
    position: NDArray[np.int64]
    """Counts of the encoder."""


@dataclass(frozen=True)
class Tuned:
    """The result of an experiment."""

    gains_toml: str | None
    """The gains that were found, as a line of a machine file."""
    traces: tuple[Trace, ...]
    values: Mapping[str, Any]
    """The outcome, by the keys of the JSON of ``husillo tune``: ``step`` has rise, overshoot and
    settling."""


def tune(
    method: str = "step",
    *,
    p: int | None = None,
    i: int | None = None,
    d: int | None = None,
    integral_limit: int | None = None,
    size: int = 100,
) -> Tuned:
    """An experiment with the simulated axis of the measuring machine.

    :param method: ``step`` with the given gains; ``ultimate``, ``relay`` or ``stepwise`` find gains
    :param p: proportional gain; those that are not given are those of the machine
    :param i: integral gain
    :param d: derivative gain
    :param size: length of the step, counts
    :raises Error: a gain or the length is out of range, or there is no such method
    """
    wanted = {"method": method, "size": size}
    gains = {"p": p, "i": i, "d": d, "integral_limit": integral_limit}
    wanted.update({key: value for key, value in gains.items() if value is not None})
    with raised(Error):
        made = json.loads(_native.tune(json.dumps(wanted)))
    outcome = made["outcome"]
    traces = tuple(_trace(trace) for trace in made["traces"])
    return Tuned(gains_toml=outcome.get("toml"), traces=traces, values=outcome)


def _trace(trace: dict[str, Any]) -> Trace:
    points = np.array(trace["points"], np.int64).reshape(-1, 2)
    return Trace(trace["title"], trace["target"], points[:, 0], points[:, 1])
