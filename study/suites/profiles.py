"""Profiles over a suite: shares of runs by factor and by cost; a line that ends below 1 has failures in it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from study.comparison.runtime import ecdf
from study.problem import Floats
from study.suites.measures import NEAR, Field
from study.suites.runs import Run

MOST_POINTS = 160
LEAST = 1e-6
"""Least cost that a logarithmic axis shows."""


@dataclass(frozen=True, eq=False)
class Profile:
    """Share of runs whose ratio or cost is at most `x`, a step function."""

    method: str
    x: Floats
    share: Floats


def performance_profiles(field: Field) -> list[Profile]:
    """Share of runs within a factor of the best known of any kind (Dolan and More 2002)."""
    return _profiles(field, lambda run: 1.0 + field.gap(run, own_kind=False))


def data_profiles(field: Field, near: float = NEAR) -> list[Profile]:
    """Share of runs that are near the best known of any kind within a wall time, s (More and Wild 2009)."""
    return _profiles(field, lambda run: run.wall_time if field.gap(run, own_kind=False) <= near else np.inf)


def _profiles(field: Field, cost: Callable[[Run], float]) -> list[Profile]:
    return [step_profile(name, np.array([cost(run) for run in runs])) for name, runs in field.by_method.items()]


def step_profile(name: str, costs: Floats) -> Profile:
    """Share reached within every cost; of many costs a grid of `MOST_POINTS` is taken, which begins and ends where they do.

    Parameters
    ----------
    name : str
    costs : array of any shape
        Infinity where nothing was reached.
    """
    grid = np.unique(np.maximum(costs[np.isfinite(costs)], LEAST))
    if len(grid) > MOST_POINTS:
        grid = np.append(np.geomspace(grid[0], grid[-1], MOST_POINTS)[:-1], grid[-1])
    return Profile(name, grid, ecdf(np.maximum(costs, LEAST), grid))
