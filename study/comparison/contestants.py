"""The planners' runs as contestants: equal budgets, paired seeds, and the best known of every case."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from study.analysis.formatting import DASH, percent, seconds, wall
from study.analysis.tables import Column, Grid, grid
from study.cases.library import Case
from study.comparison.effort import Effort
from study.comparison.tables import PlannerColumn
from study.planners.other_searches import MinimiserPlanner
from study.planning import Formulation, Freedom
from study.problem import Floats
from study.registry import planner_named, planner_names, unavailable_planners
from study.runs.lineup import Spec, make_cells
from study.runs.selections import CONTESTANTS, REPEATED, YARDSTICKS
from study.store.results import Cell, Result


class Level(StrEnum):
    """Formulation that runs share, or what else they have in common."""

    SCALED = "scaled"
    PENALTY = "penalty"
    OWN = "own"
    SOLVER = "solver"
    FREE = "free path"


LEVELS = {
    Level.SCALED: "every candidate stretched until it is exactly feasible, all joints together",
    Level.PENALTY: "the papers' form: total time plus a penalty where a limit is broken, all joints together",
}
"""Levels of equal budgets."""

SAME = 1e-9
"""Relative difference from which two durations name different records."""

Runs = Mapping[Cell, Result]


@dataclass(frozen=True, eq=False)
class Contestant:
    """All runs of one planner on one case at one level, in the order of the seeds.

    Attributes
    ----------
    case, planner : str
    level : Level
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
    level: Level
    durations: Floats
    totals: Floats
    histories: tuple[Floats, ...]
    spent: Floats
    wall: Floats

    @property
    def median(self) -> float:
        """Median duration, s; infinity if half of the runs or more are infeasible."""
        return float(np.quantile(self.durations, 0.5, method="higher"))

    @property
    def total(self) -> float:
        """Median total, feasible or not, s: the papers do not judge the motion that their joints make together."""
        return float(np.median(self.totals))

    @property
    def seconds(self) -> float:
        """Median wall time of a run, s."""
        return float(np.median(self.wall))

    @property
    def feasible(self) -> int:
        """Number of runs that passed the judge."""
        return int(np.isfinite(self.durations).sum())

    @property
    def passed(self) -> str:
        """Number of runs that passed the judge, of all."""
        return f"{self.feasible}/{len(self.durations)}"

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
        Planner that found it.
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


def level_cells(cases: Sequence[Case], level: Level, effort: Effort) -> list[Cell]:
    """Cells of all budgeted contestants of a level: equal budgets, the same seeds for all."""
    names = installed((*YARDSTICKS, *CONTESTANTS))
    specs = [Spec(name, "scaled" if needs_scaling(name) else level, "shared") for name in names]
    return make_cells(cases, specs, effort.budget)


def needs_scaling(name: str) -> bool:
    """Tell whether a planner always takes the scaled formulation, and so stands in the tables of both levels."""
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
    return [run for cell in cells for run in (_again(cell, effort.seeds) if cell.planner in REPEATED else [cell])]


def _again(cell: Cell, times: int) -> list[Cell]:
    return [replace(cell, settings=replace(cell.settings, seed=seed)) for seed in range(times)]


def contestants(runs: Runs, cells: Sequence[Cell], level: Level) -> list[Contestant]:
    """Group the runs of cells by case and planner, in the order of the cells."""
    groups: dict[tuple[str, str], list[Result]] = {}
    for cell in cells:
        if cell in runs:
            groups.setdefault((cell.case, cell.planner), []).append(runs[cell])
    return [_contestant(case, planner, level, results) for (case, planner), results in groups.items()]


def _contestant(case: str, planner: str, level: Level, results: list[Result]) -> Contestant:
    return Contestant(
        case,
        planner,
        level,
        durations=np.array([result.duration if result.feasible else np.inf for result in results]),
        totals=np.array([result.duration for result in results]),
        histories=tuple(result.history for result in results),
        spent=np.array([result.evaluations for result in results], dtype=float),
        wall=np.array([result.wall_time for result in results]),
    )


def references(cases: Sequence[Case], runs: Runs) -> dict[str, Reference]:
    """Find the best known of every case: the same curve family, all joints together, feasible by the judge.

    Scaled and penalty runs share it, since they look for the same motions; per-joint runs do not, and take no part.
    """
    known: dict[str, Reference] = {}
    for case in cases:
        eligible = [
            result
            for cell, result in runs.items()
            if cell.case == case.name
            and cell.settings.curve == case.curve
            and cell.settings.synchronisation == "shared"
            and planner_named(cell.planner).freedom is Freedom.CURVE
            and result.feasible
        ]
        if eligible:
            shortest = min(result.duration for result in eligible)
            level = [result for result in eligible if result.duration <= shortest * (1 + SAME)]
            best = min(level, key=lambda result: (planner_named(result.cell.planner).stochastic, result.cell.planner))
            known[case.name] = Reference(case.name, shortest, best.cell.planner, case.curve)
    return known


Run = tuple[Contestant, int]
"""A contestant and a seed."""

RUN_COLUMNS: tuple[Column[Run], ...] = (
    Column("level", "", lambda run: run[0].level),
    Column("case", "", lambda run: run[0].case),
    PlannerColumn("planner", "", lambda run: run[0].planner),
    Column("seed", "", lambda run: run[1]),
    Column("duration_s", "", lambda run: run[0].durations[run[1]]),
    Column("feasible", "", lambda run: np.isfinite(run[0].durations[run[1]])),
    Column("evaluations", "", lambda run: int(run[0].spent[run[1]])),
    Column("wall_s", "", lambda run: run[0].wall[run[1]]),
)

REFERENCE_COLUMNS: tuple[Column[Reference], ...] = (
    Column("", "Case", lambda reference: reference.case),
    Column("", "Best known", lambda reference: reference.value, seconds),
    PlannerColumn("", "Found by", lambda reference: reference.label),
    Column("", "Curve family", lambda reference: reference.curve),
    Column("", "Formulation level", lambda reference: "all joints together"),
)


def runs_of(contestants: Sequence[Contestant]) -> list[Run]:
    """Every run; the seed is its place."""
    return [(contestant, seed) for contestant in contestants for seed in range(len(contestant.durations))]


def reference_grid(references: Mapping[str, Reference], flags: Mapping[str, str]) -> Grid:
    """Durations that the targets of every case are shares above."""
    return grid(
        "The best known of every case: the shortest motion on the paper's curve family, all joints together, that the judge "
        "found feasible. Targets and gaps of both formulations are shares above it.",
        REFERENCE_COLUMNS,
        references.values(),
        flags,
        names=5,
    )


def solver_grid(solvers: Sequence[Contestant], references: Mapping[str, Reference]) -> Grid:
    """Duration and wall time of the solvers."""

    def behind(solver: Contestant) -> str:
        known = references.get(solver.case)
        return percent(solver.median / known.value - 1) if known and np.isfinite(solver.median) else DASH

    columns: tuple[Column[Contestant], ...] = (
        Column("", "Case", lambda solver: solver.case),
        Column("", "Solver", lambda solver: solver.planner),
        Column(
            "",
            "Duration",
            lambda solver: solver.median,
            lambda t: seconds(t) if np.isfinite(t) else "no feasible motion",
        ),
        Column("", "Against the best known", behind),
        Column("", "Wall", lambda solver: solver.seconds, wall),
    )
    return grid(
        "Solvers by wall time and duration. TOPP-RA and Ruckig move on other paths than the paper's curve, so they may be "
        "below the best known on it.",
        columns,
        solvers,
        {},
        names=2,
    )
