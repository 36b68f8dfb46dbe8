"""Cost to come near the best known of a method's own kind of motion: evaluations and seconds, failures counted.

References
----------
Hansen, Auger, Ros, Mersmann, Tusar, Brockhoff: COCO, Optim. Methods Softw. 36 (2021), Section 5.3. More and Wild,
SIAM J. Optim. 20 (2009).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from study.comparison.runtime import average_runtime
from study.problem import Floats
from study.suites.measures import NEAR, Field
from study.suites.profiles import Profile, step_profile
from study.suites.runs import Run

TARGETS = (0.1, 0.01, 0.001, 0.0001)
"""Shares above the best known whose cost is told."""

MANY_TARGETS = tuple(np.geomspace(1.0, 1e-4, 41).tolist())
"""Shares above the best known that distributions of running time are over."""


def parts(field: Field, run: Run, targets: Sequence[float]) -> Floats:
    """Part of a run after which each target was first reached, shape (n_targets,); infinity where it never was.

    A run without a curve reaches all that it reaches at its end.

    Parameters
    ----------
    field : Field
    run : Run
    targets : sequence of float
        Shares above the best known of the run's own kind of motion.
    """
    known = field.best.get((run.problem, run.kind), np.inf)
    if not run.feasible:
        return np.full(len(targets), np.inf)
    curve = run.curve if len(run.curve_above) and run.cost else np.array([[1.0, run.duration]])
    costs = np.append(curve[:, 0] / (run.cost if len(run.curve_above) and run.cost else 1.0), np.inf)
    return costs[np.searchsorted(-curve[:, 1], -known * (1.0 + np.asarray(targets)))]


@dataclass(frozen=True, eq=False)
class Cost:
    """Cost of a method to come near; arrays have shape (n_targets,) and are infinite where no run did.

    Attributes
    ----------
    method : str
    segments : int
        Of the problems; 0 for problems of all sizes.
    runs : int
    reached : array
        Share of runs.
    evaluations : array
        Expected running time: evaluations of all runs until they reached the target or ended, over the number that
        reached it. For problems of all sizes they are evaluations per segment.
    seconds : array
        The same of wall time, which is spread evenly over a run's evaluations.
    """

    method: str
    segments: int
    runs: int
    reached: Floats
    evaluations: Floats
    seconds: Floats


def costs(field: Field) -> list[Cost]:
    """Cost of every method over all problems."""
    return [_cost(field, runs, 0) for runs in field.by_method.values()]


def costs_by_size(field: Field, runs: Iterable[Run]) -> list[Cost]:
    """Cost of every method among runs, by the number of segments."""
    key: Callable[[Run], tuple[str, int]] = lambda run: (run.method, run.segments)  # noqa: E731
    return [_cost(field, list(group), size) for (_, size), group in groupby(sorted(runs, key=key), key)]


def _cost(field: Field, runs: Sequence[Run], segments: int) -> Cost:
    reached = np.array([parts(field, run, TARGETS) for run in runs])
    evaluations = np.array([run.cost / (1 if segments else run.segments) for run in runs])
    seconds = np.array([run.wall_time for run in runs])
    return Cost(
        runs[0].method,
        segments,
        len(runs),
        np.isfinite(reached).mean(axis=0),
        *(np.array([_expected(column, each) for column in reached.T]) for each in (evaluations, seconds)),
    )


def _expected(reached: Floats, spent: Floats) -> float:
    """Expected cost with restarts; the costs of runs that miss count whole."""
    return average_runtime(
        np.multiply(reached, spent, out=np.full(len(spent), np.inf), where=np.isfinite(reached)), spent
    )


def near_profiles(field: Field, near: float = NEAR) -> list[Profile]:
    """Share of runs of every search that came near the best known of their own kind within so many evaluations, in units of
    `segments + 1`, which is what a gradient by differences costs (More and Wild 2009)."""
    return [
        step_profile(name, np.concatenate([parts(field, r, [near]) * (r.cost / (r.segments + 1)) for r in runs]))
        for name, runs in _searches(field)
    ]


def runtime_distributions(field: Field) -> list[Profile]:
    """Share of all pairs of a run and a target that every search reached within so many evaluations per segment, as COCO draws it."""
    return [
        step_profile(name, np.concatenate([parts(field, r, MANY_TARGETS) * (r.cost / r.segments) for r in runs]))
        for name, runs in _searches(field)
    ]


def _searches(field: Field) -> list[tuple[str, list[Run]]]:
    return [(name, runs) for name, runs in field.by_method.items() if runs[0].evaluations]
