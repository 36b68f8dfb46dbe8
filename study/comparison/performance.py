"""How fast every contestant comes how near: targets, seconds, expected running time, distribution, quartiles."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from study.comparison import runtime
from study.comparison.contestants import Contestant, Reference
from study.problem import Floats

GRID_POINTS = 120


@dataclass(frozen=True, eq=False)
class Performance:
    """One contestant against its case's reference; arrays of targets have shape (n_targets,).

    Attributes
    ----------
    contestant : Contestant
    gap : float
        Median duration above the reference, relative.
    best_gap : float
    feasible : int
        Runs that passed the judge.
    hits : array of shape (n_runs, n_targets)
        Evaluations to every target; infinity where it was missed.
    reached : array
        Share of runs that reached each target.
    evaluations : array
        Average running time with restarts, evaluations.
    seconds : array
        The same in seconds: wall time is spread evenly over a run's evaluations.
    """

    contestant: Contestant
    gap: float
    best_gap: float
    feasible: int
    hits: Floats
    reached: Floats
    evaluations: Floats
    seconds: Floats


def performances(found: Iterable[Contestant], references: Mapping[str, Reference]) -> list[Performance]:
    """Measure contestants whose case has a reference; by case, then by median gap."""
    measured = [performance(one, references[one.case].value) for one in found if one.case in references]
    order = {name: i for i, name in enumerate(references)}
    return sorted(measured, key=lambda p: (order[p.contestant.case], p.gap, p.best_gap, p.contestant.planner))


def performance(one: Contestant, reference: float) -> Performance:
    """Measure one contestant against a reference duration, s."""
    hits = runtime.hits(one.histories, reference)
    per_evaluation = one.wall / np.maximum(one.spent, 1.0)
    columns = range(hits.shape[1])
    return Performance(
        one,
        gap=one.median / reference - 1.0,
        best_gap=float(one.durations.min()) / reference - 1.0,
        feasible=int(np.isfinite(one.durations).sum()),
        hits=hits,
        reached=np.isfinite(hits).mean(axis=0),
        evaluations=np.array([runtime.average_runtime(hits[:, k], one.spent) for k in columns]),
        seconds=np.array([runtime.average_runtime(hits[:, k] * per_evaluation, one.wall) for k in columns]),
    )


@dataclass(frozen=True, eq=False)
class Distribution:
    """Share of (case, run, target) triples that a planner reached within so many evaluations per segment."""

    planner: str
    costs: Floats
    shares: Floats


def distributions(measured: Sequence[Performance], segments: Mapping[str, int]) -> list[Distribution]:
    """Empirical distributions of running time over all cases and targets, the highest end first.

    Parameters
    ----------
    measured : sequence of Performance
    segments : mapping of str to int
        Dimensions of every case; evaluations are divided by them, so that cases can be put together.
    """
    costs: dict[str, list[Floats]] = {}
    for one in measured:
        per_segment = one.hits / segments[one.contestant.case]
        runs = max(len(other.hits) for other in measured if other.contestant.case == one.contestant.case)
        repeated = np.resize(per_segment, (runs, per_segment.shape[1]))  # a deterministic run counts like the others
        costs.setdefault(one.contestant.planner, []).append(repeated.ravel())
    last = max((float(one.contestant.spent.max()) / segments[one.contestant.case] for one in measured), default=1.0)
    grid = np.geomspace(1.0, max(last, 2.0), GRID_POINTS)
    found = [Distribution(name, grid, runtime.ecdf(np.concatenate(parts), grid)) for name, parts in costs.items()]
    return sorted(found, key=lambda one: (-one.shares[-1], -one.shares.mean(), one.planner))


@dataclass(frozen=True, eq=False)
class Anytime:
    """Quartiles over runs of the best objective so far, shape (3, n_points), s."""

    planner: str
    evaluations: Floats
    values: Floats


def anytime(found: Sequence[Contestant]) -> list[Anytime]:
    """Anytime curves of the contestants of one case."""
    last = max(float(one.spent.max()) for one in found)
    grid = np.unique(np.geomspace(1.0, max(last, 2.0), GRID_POINTS).round())
    return [Anytime(one.planner, grid, runtime.quartiles(one.histories, grid)) for one in found if one.histories]
