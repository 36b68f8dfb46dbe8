"""Profiles over a suite: shares of runs by factor and by cost; a line that ends below 1 has failures in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from study.suites.measures import NEAR, Field
from study.suites.runs import Run


@dataclass(frozen=True, eq=False)
class Profile:
    """Share of runs whose ratio or cost is at most `x`, a step function."""

    method: str
    x: np.ndarray
    share: np.ndarray


def performance_profiles(field: Field) -> list[Profile]:
    """Share of runs within a factor of the best known of any kind (Dolan and More 2002)."""
    return _profiles(field, lambda run: 1.0 + field.gap(run, own_kind=False))


def data_profiles(field: Field, near: float = NEAR) -> list[Profile]:
    """Share of runs that are near the best known of any kind within a wall time, s (More and Wild 2009)."""
    return _profiles(field, lambda run: run.wall_time if field.gap(run, own_kind=False) <= near else np.inf)


def _profiles(field: Field, cost: Callable[[Run], float]) -> list[Profile]:
    lines = []
    for name, runs in field.by_method.items():
        costs = np.sort([cost(run) for run in runs])
        finite = costs[np.isfinite(costs)]
        lines.append(Profile(name, finite, np.arange(1, len(finite) + 1) / len(costs)))
    return lines
