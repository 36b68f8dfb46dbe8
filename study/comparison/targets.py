"""Targets: evaluations and seconds to come so near to the best known, distributions and anytime quartiles."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from study.analysis.formatting import count, listed, percent, wall
from study.analysis.tables import Column, Grid, grid
from study.comparison import runtime
from study.comparison.contestants import Contestant, Level, Reference
from study.comparison.runtime import TARGETS
from study.comparison.tables import PlannerColumn
from study.problem import Floats
from study.runs.selections import YARDSTICKS

GRID_POINTS = 120


@dataclass(frozen=True, eq=False)
class Performance:
    """A contestant against its case's reference; arrays of targets have shape (n_targets,).

    Attributes
    ----------
    contestant : Contestant
    gap : float
        Median duration above the reference, relative.
    best_gap : float
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
    hits: Floats
    reached: Floats
    evaluations: Floats
    seconds: Floats


def performances(contestants: Iterable[Contestant], references: Mapping[str, Reference]) -> list[Performance]:
    """Measure contestants whose case has a reference; by case, then by median gap."""
    known = [contestant for contestant in contestants if contestant.case in references]
    measured = [performance(contestant, references[contestant.case].value) for contestant in known]
    order = {name: i for i, name in enumerate(references)}
    return sorted(measured, key=lambda p: (order[p.contestant.case], p.gap, p.best_gap, p.contestant.planner))


def performance(contestant: Contestant, reference: float) -> Performance:
    """Measure a contestant against a reference duration, s."""
    hits = runtime.hits(contestant.histories, reference)
    per_evaluation = contestant.wall / np.maximum(contestant.spent, 1.0)
    columns = range(hits.shape[1])
    return Performance(
        contestant,
        gap=contestant.median / reference - 1.0,
        best_gap=float(contestant.durations.min()) / reference - 1.0,
        hits=hits,
        reached=np.isfinite(hits).mean(axis=0),
        evaluations=np.array([runtime.average_runtime(hits[:, k], contestant.spent) for k in columns]),
        seconds=np.array([runtime.average_runtime(hits[:, k] * per_evaluation, contestant.wall) for k in columns]),
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
    for each in measured:
        per_segment = each.hits / segments[each.contestant.case]
        runs = max(len(other.hits) for other in measured if other.contestant.case == each.contestant.case)
        repeated = np.resize(per_segment, (runs, per_segment.shape[1]))  # a deterministic run counts like the others
        costs.setdefault(each.contestant.planner, []).append(repeated.ravel())
    last = max((float(each.contestant.spent.max()) / segments[each.contestant.case] for each in measured), default=1.0)
    cost = np.geomspace(1.0, max(last, 2.0), GRID_POINTS)
    shares = [Distribution(name, cost, runtime.ecdf(np.concatenate(parts), cost)) for name, parts in costs.items()]
    return sorted(shares, key=lambda line: (-line.shares[-1], -line.shares.mean(), line.planner))


@dataclass(frozen=True, eq=False)
class Anytime:
    """Quartiles over runs of the best objective so far, shape (3, n_points), s."""

    planner: str
    evaluations: Floats
    values: Floats


def anytime(contestants: Sequence[Contestant]) -> list[Anytime]:
    """Anytime curves of the contestants of a case."""
    last = max(float(contestant.spent.max()) for contestant in contestants)
    points = np.unique(np.geomspace(1.0, max(last, 2.0), GRID_POINTS).round())
    return [Anytime(c.planner, points, runtime.quartiles(c.histories, points)) for c in contestants if c.histories]


TargetRow = tuple[Performance, int]
"""A performance and the number of a target."""


def target_name(target: float) -> str:
    """Name a target as a column does."""
    return f"{100 * target:g} %"


TARGET_COLUMNS: tuple[Column[TargetRow], ...] = (
    Column("level", "", lambda row: row[0].contestant.level),
    Column("case", "", lambda row: row[0].contestant.case),
    PlannerColumn("planner", "", lambda row: row[0].contestant.planner),
    Column("median_gap", "", lambda row: row[0].gap),
    Column("best_gap", "", lambda row: row[0].best_gap),
    Column("runs", "", lambda row: len(row[0].contestant.durations)),
    Column("feasible_runs", "", lambda row: row[0].contestant.feasible),
    Column("median_wall_s", "", lambda row: row[0].contestant.seconds),
    Column("target", "", lambda row: target_name(TARGETS[row[1]])),
    Column("reached", "", lambda row: row[0].reached[row[1]]),
    Column("average_evaluations", "", lambda row: row[0].evaluations[row[1]]),
    Column("average_seconds", "", lambda row: row[0].seconds[row[1]]),
)
"""Columns of the files, a row for every target; on the page a target is a column."""


def target_rows(measured: Sequence[Performance]) -> list[TargetRow]:
    """Every performance and target."""
    return [(each, number) for each in measured for number in range(len(TARGETS))]


def _to(number: int, head: str, field: str, text: Callable[[float], str]) -> Column[Performance]:
    said = f"{head}to {target_name(TARGETS[number])}"
    return Column("", said, lambda row: getattr(row, field)[number], lambda n: text(n) if np.isfinite(n) else "never")


PAGE_COLUMNS: tuple[Column[Performance], ...] = (
    PlannerColumn("", "Planner", lambda row: row.contestant.planner),
    Column("", "Feasible", lambda row: row.contestant.passed),
    Column("", "Median gap", lambda row: row.gap, percent),
    *(_to(number, "", "evaluations", count) for number in range(len(TARGETS))),
    *(_to(number, "time ", "seconds", wall) for number in range(len(TARGETS))),
    Column("", "Wall", lambda row: row.contestant.seconds, wall),
)


def target_grid(case: str, measured: Sequence[Performance], flags: Mapping[str, str]) -> Grid:
    """Average running time to every target on a case."""
    own = [each for each in measured if each.contestant.case == case]
    caption = f"{case}: average evaluations to every target with restarts, then seconds; best median first."
    return grid(caption, PAGE_COLUMNS, own, flags)


def targets_reached(level: Level, measured: Sequence[Performance]) -> str:
    """Say which share of all runs and targets the best search and the trivial opponents reached."""
    shares: dict[str, list[float]] = {}
    for each in measured:
        shares.setdefault(each.contestant.planner, []).append(float(each.reached.mean()))
    means = {name: float(np.mean(values)) for name, values in shares.items()}
    best = max((name for name in means if name not in YARDSTICKS), key=lambda name: means[name], default=None)
    trivial = listed([f"{name} {percent(means[name], signed=False)}" for name in YARDSTICKS if name in means])
    if best is None:
        return f"With the {level} formulation no search was run."
    return (
        f"With the {level} formulation {best} reached {percent(means[best], signed=False)} of all cases, runs and targets, "
        f"the most of the searches; the trivial opponents: {trivial}."
    )
