"""Who is compared, at which budget, against which reference: the planners' runs seen as contestants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from study.cases.library import Case
from study.comparison.effort import Effort
from study.planners.other_searches import MinimiserPlanner
from study.planning import Formulation, Freedom
from study.problem import Floats
from study.registry import planner_named, planner_names, unavailable_planners
from study.runs.lineup import Spec, make_cells
from study.runs.selections import CONTESTANTS, REPEATED, YARDSTICKS
from study.store.results import Cell, Result

LEVELS = {
    "scaled": "every candidate stretched until it is exactly feasible, all joints together",
    "penalty": "the papers' form: total time plus a penalty where a limit is broken, all joints together",
}
SAME = 1e-9
"""Relative difference from which two durations name different records."""

Runs = Mapping[Cell, Result]


@dataclass(frozen=True, eq=False)
class Contestant:
    """All runs of one planner on one case at one level, in the order of the seeds.

    Attributes
    ----------
    case, planner, level : str
    durations : array of shape (n_runs,), s
        As the judge measured them; infinity where a run is infeasible or gave no motion.
    totals : array of shape (n_runs,), s
        The same, feasible or not; infinity only where there is no motion.
    histories : tuple of arrays of shape (n_records, 2)
        Evaluations so far and best objective so far.
    spent : array of shape (n_runs,)
        Evaluations in all.
    wall : array of shape (n_runs,), s
    """

    case: str
    planner: str
    level: str
    durations: Floats
    totals: Floats
    histories: tuple[Floats, ...]
    spent: Floats
    wall: Floats

    @property
    def median(self) -> float:
        """Median duration, s; infinity if half of the runs or more are infeasible."""
        return float(np.quantile(self.durations, 0.5, method="higher"))

    def paired(self, n_runs: int) -> Floats:
        """Durations for so many paired seeds; the one run of a deterministic planner stands for every seed."""
        return np.resize(self.durations, n_runs) if len(self.durations) == 1 else self.durations


@dataclass(frozen=True)
class Reference:
    """Shortest feasible duration known for a case on its paper's curve, all joints together.

    Attributes
    ----------
    case : str
    value : float, s
    label : str
        Who found it.
    curve : str
    """

    case: str
    value: float
    label: str
    curve: str


def installed(names: Sequence[str]) -> list[str]:
    """Those of the names whose planners are installed and can be loaded."""
    broken = unavailable_planners()
    known = [name for name in planner_names() if name not in broken]
    return [name for name in names if name in known]


def level_cells(cases: Sequence[Case], level: str, effort: Effort) -> list[Cell]:
    """Cells of all budgeted contestants of a level: equal budgets, the same seeds for all."""
    names = installed((*YARDSTICKS, *CONTESTANTS))
    specs = [Spec(name, "scaled" if needs_scaling(name) else level, "shared") for name in names]
    return make_cells(cases, specs, effort.budget)


def needs_scaling(name: str) -> bool:
    """Whether a planner takes the scaled formulation whatever it is asked for, and so stands in the tables of both levels."""
    planner = planner_named(name)
    return isinstance(planner, MinimiserPlanner) and planner.formulation is Formulation.SCALED


def solver_cells(cases: Sequence[Case], effort: Effort) -> list[Cell]:
    """Cells of the planners that are compared on wall time and duration; the fastest are repeated.

    Repeated, because the first call includes library loading.
    """
    specs = [
        Spec(name, "scaled", "shared") if planner_named(name).freedom is Freedom.CURVE else Spec(name)
        for name in installed(effort.solvers)
    ]
    cells = make_cells(cases, specs, effort.budget)
    return [one for cell in cells for one in (_again(cell, effort.seeds) if cell.planner in REPEATED else [cell])]


def _again(cell: Cell, times: int) -> list[Cell]:
    return [replace(cell, settings=replace(cell.settings, seed=seed)) for seed in range(times)]


def contestants(runs: Runs, cells: Sequence[Cell], level: str) -> list[Contestant]:
    """Group the runs of cells by case and planner, in the order of the cells."""
    groups: dict[tuple[str, str], list[Result]] = {}
    for cell in cells:
        if cell in runs:
            groups.setdefault((cell.case, cell.planner), []).append(runs[cell])
    return [_contestant(case, planner, level, results) for (case, planner), results in groups.items()]


def _contestant(case: str, planner: str, level: str, results: list[Result]) -> Contestant:
    return Contestant(
        case,
        planner,
        level,
        durations=np.array([judged(one) for one in results]),
        totals=np.array([one.verdict.duration if one.verdict else np.inf for one in results]),
        histories=tuple(one.history for one in results),
        spent=np.array([one.evaluations for one in results], dtype=float),
        wall=np.array([one.wall_time for one in results]),
    )


def judged(result: Result) -> float:
    """Duration of a run if the judge found it feasible, s; infinity otherwise."""
    return result.verdict.duration if result.verdict is not None and result.verdict.feasible else np.inf


def references(cases: Sequence[Case], runs: Runs) -> dict[str, Reference]:
    """Find the best known of every case: the same curve family, all joints together, feasible by the judge.

    Scaled and penalty runs share it, since they look for the same motions; per-joint runs do not, and take no part.
    """
    found: dict[str, Reference] = {}
    for case in cases:
        eligible = [
            result
            for cell, result in runs.items()
            if cell.case == case.name
            and cell.settings.curve == case.curve
            and cell.settings.synchronisation == "shared"
            and planner_named(cell.planner).freedom is Freedom.CURVE
            and np.isfinite(judged(result))
        ]
        if eligible:
            shortest = min(judged(one) for one in eligible)
            level = [one for one in eligible if judged(one) <= shortest * (1 + SAME)]
            best = min(level, key=lambda one: (planner_named(one.cell.planner).stochastic, one.cell.planner))
            found[case.name] = Reference(case.name, shortest, best.cell.planner, case.curve)
    return found
