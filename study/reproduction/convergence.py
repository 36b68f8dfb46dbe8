"""Convergence of a run: defined by a share of its descent, at four shares, from exact generations."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from study.problem import Floats
from study.reproduction.jobs import Record

LEVELS: dict[str, float] = {"0.1 %": 1e-3, "1 %": 1e-2, "2 %": 2e-2, "5 %": 5e-2}
"""Shares of the whole descent within which a run's best value must stay."""

LATE = 0.95
"""Share of the budget after which a run that still comes nearer may have been cut short by it."""


def settled_at(curve: Floats, share: float) -> int:
    """Generation, counted from 1, after which the best value stays within a share of its whole descent of the last one.

    Parameters
    ----------
    curve : array of shape (n_generations,)
        Best value so far; infinite where nothing was finite.
    share : float
    """
    finite = np.where(np.isfinite(curve), curve, np.finfo(float).max)
    level = finite[-1] + share * (finite[0] - finite[-1])
    return int(np.argmax(finite <= level)) + 1


def settled(curves: Sequence[Floats], first: Sequence[int] | None = None) -> dict[str, list[int]]:
    """Generations of convergence of several runs, by the name of the share.

    Parameters
    ----------
    curves : sequence of arrays of shape (n_generations,)
    first : sequence of int, optional
        Generations before each curve's first value, such as those without a feasible candidate.
    """
    before = first or [0] * len(curves)
    return {
        name: [start + settled_at(curve, share) for start, curve in zip(before, curves, strict=True)]
        for name, share in LEVELS.items()
    }


def levels(
    record: Record, pick: Callable[[list[int]], float] = lambda counts: float(np.median(counts))
) -> dict[str, float]:
    """Our generations of convergence at every share: the median of our runs, or what `pick` makes of them."""
    return {name: pick(record["settled"][name]) for name in LEVELS}


def slowest(records: Sequence[Record]) -> dict[str, float]:
    """Greatest of several records' medians, share by share."""
    return {name: max(levels(record)[name] for record in records) for name in LEVELS}


def fastest(records: Sequence[Record]) -> dict[str, float]:
    """Least of several records' medians, share by share."""
    return {name: min(levels(record)[name] for record in records) for name in LEVELS}


def late(records: Sequence[Record]) -> list[str]:
    """Shares at which the runs of one of the records mostly come nearer in the last twentieth of their budget."""
    ends = [LATE * record["generations"][-1] for record in records]
    return [
        name
        for name in LEVELS
        if any(np.median(record["settled"][name]) > end for record, end in zip(records, ends, strict=True))
    ]


def arrived_at(curve: Floats) -> int:
    """Generation, counted from 1, in which a run first has its last value."""
    return int(np.argmax(curve <= curve[-1])) + 1
