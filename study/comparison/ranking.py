"""Ranking: paired tests on every case, and the omnibus test over cases."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from study.analysis.formatting import DASH, listed, plural
from study.analysis.tables import Column, Grid, grid
from study.comparison import statistics
from study.comparison.contestants import Contestant, Level, Reference, needs_scaling
from study.comparison.statistics import Friedman, Interval
from study.comparison.tables import IntervalColumn, PlannerColumn, interval_text, p_value, probability
from study.problem import Floats
from study.runs.selections import YARDSTICKS

EQUAL = 1e-6
"""Durations closer than this share of the reference count as equal: it is the judge's tolerance."""

CONTROLS = ("pso", "random-search")
"""The yardstick of the papers, and the floor that every search must beat."""


@dataclass(frozen=True)
class Pairing:
    """A planner against a control on one case, on paired seeds.

    Attributes
    ----------
    case, planner, control : str
    level : Level
    a12 : float
        Probability that a run of the planner is shorter.
    difference : Interval, optional
        Median of planner minus control, as a share of the reference; None where a run is infeasible.
    signed_rank, rank_sum : float
        p-values, each adjusted by Holm for the planners of the case.
    """

    case: str
    level: Level
    planner: str
    control: str
    a12: float
    difference: Interval | None
    signed_rank: float
    rank_sum: float


def pairings(contestants: Sequence[Contestant], references: Mapping[str, Reference]) -> list[Pairing]:
    """Compare every contestant with every control, case by case."""
    pairs: list[Pairing] = []
    for case in references:
        own = {contestant.planner: contestant for contestant in contestants if contestant.case == case}
        runs = max((len(contestant.durations) for contestant in own.values()), default=0)
        for control in CONTROLS:
            if control in own:
                pairs += _against(own, own[control], runs, references[case].value)
    return pairs


def _against(own: Mapping[str, Contestant], control: Contestant, runs: int, reference: float) -> list[Pairing]:
    others = [contestant for contestant in own.values() if contestant.planner != control.planner]
    base = levelled(control.paired(runs), reference)
    samples = [levelled(contestant.paired(runs), reference) for contestant in others]
    signed = statistics.holm([statistics.signed_rank(sample, base) for sample in samples])
    sums = statistics.holm([statistics.rank_sum(sample, base) for sample in samples])
    return [
        Pairing(
            other.case,
            other.level,
            other.planner,
            control.planner,
            statistics.a12(sample, base),
            difference(sample, base),
            float(p),
            float(q),
        )
        for other, sample, p, q in zip(others, samples, signed, sums, strict=True)
    ]


def levelled(durations: Floats, reference: float) -> Floats:
    """Durations in whole steps of the judge's tolerance, so that smaller differences vanish and equal ones tie exactly."""
    return np.round(durations / reference / EQUAL)


def difference(first: Floats, second: Floats) -> Interval | None:
    """Median difference of levelled durations, as a share of the reference; None where a run is infeasible."""
    if not (np.isfinite(first).all() and np.isfinite(second).all()):
        return None
    steps = statistics.median_difference(first, second)
    return Interval(steps.estimate * EQUAL, steps.lower * EQUAL, steps.upper * EQUAL)


@dataclass(frozen=True, eq=False)
class Omnibus:
    """Friedman's test over cases and the post hoc tests.

    Attributes
    ----------
    level : Level
    planners : tuple of str
        By mean rank, best first; the arrays below follow it.
    cases : tuple of str
    friedman : Friedman
    difference : float
        Critical difference of Nemenyi's test at 5 %.
    groups : list of tuples of int
        Planners that it cannot tell apart.
    control : str
    against_control : array of shape (n_planners,)
        p against the control, adjusted by Holm.
    nemenyi : array of shape (n_planners, n_planners)
    smallest_p : float
        Smallest p that the test can give with so many cases and planners.
    smallest_pair_p : float
        Smallest p of a signed rank test over so many cases.
    """

    level: Level
    planners: tuple[str, ...]
    cases: tuple[str, ...]
    friedman: Friedman
    difference: float
    groups: list[tuple[int, ...]]
    control: str
    against_control: Floats
    nemenyi: Floats
    smallest_p: float
    smallest_pair_p: float


def omnibus(
    contestants: Sequence[Contestant], references: Mapping[str, Reference], level: Level, control: str = CONTROLS[0]
) -> Omnibus | None:
    """Rank the planners' medians over cases; None with fewer than two cases or three planners.

    Parameters
    ----------
    contestants : sequence of Contestant
    references : mapping of str to Reference
        Cases without a reference are left out.
    level : Level
    control : str

    Raises
    ------
    StudyError
        If the library of Nemenyi's test is not installed.
    """
    medians: dict[str, dict[str, float]] = {}
    for each in (each for each in contestants if each.case in references):
        median = levelled(np.array(each.median), references[each.case].value)
        medians.setdefault(each.case, {})[each.planner] = float(median)
    names = dict.fromkeys(contestant.planner for contestant in contestants)
    planners = [name for name in names if all(name in row for row in medians.values())]
    if len(medians) < 2 or len(planners) < 3 or control not in planners:
        return None
    table = np.array([[row[name] for name in planners] for row in medians.values()])
    order = np.argsort(statistics.friedman(table).mean_ranks, kind="stable")
    return _tested(level, [planners[i] for i in order], tuple(medians), table[:, order], control)


def _tested(level: Level, planners: list[str], cases: tuple[str, ...], table: Floats, control: str) -> Omnibus:
    result = statistics.friedman(table)
    n_cases, n_planners = table.shape
    difference = statistics.critical_difference(n_planners, n_cases)
    return Omnibus(
        level,
        tuple(planners),
        cases,
        result,
        difference,
        statistics.cliques(result.mean_ranks, difference),
        control,
        statistics.against_control(result, planners.index(control)),
        statistics.nemenyi(table),
        statistics.smallest_omnibus_p(n_cases, n_planners),
        statistics.smallest_pair_p(n_cases),
    )


PAIR_COLUMNS: tuple[Column[Pairing], ...] = (
    Column("level", "", lambda pair: pair.level),
    Column("case", "", lambda pair: pair.case),
    PlannerColumn("planner", "Planner", lambda pair: pair.planner),
    Column("control", "", lambda pair: pair.control),
    Column("a12", "A12", lambda pair: pair.a12, probability),
    IntervalColumn("difference", "Median difference (95 %)", lambda pair: pair.difference, interval_text),
    Column("signed_rank_p_holm", "Signed rank p", lambda pair: pair.signed_rank, p_value),
    Column("rank_sum_p_holm", "Rank sum p", lambda pair: pair.rank_sum, p_value),
)


def pairing_grids(pairs: Sequence[Pairing], flags: Mapping[str, str]) -> list[Grid]:
    """Effect sizes and p-values, a table for every case and control."""
    groups: dict[tuple[str, str], list[Pairing]] = {}
    for pair in pairs:
        groups.setdefault((pair.case, pair.control), []).append(pair)
    return [
        grid(
            f"{case}, against {control}, on paired seeds.",
            PAIR_COLUMNS,
            sorted(group, key=lambda pair: -pair.a12),
            flags,
        )
        for (case, control), group in groups.items()
    ]


Place = tuple[Omnibus, int]
"""A test over cases and the place of a planner in it."""


def _against_control(p: Callable[[Place], float]) -> Callable[[Place], str]:
    """Text of a p-value against the control, which has none against itself."""
    return lambda place: DASH if place[0].planners[place[1]] == place[0].control else p_value(float(p(place)))


RANK_COLUMNS: tuple[Column[Place], ...] = (
    Column("level", "", lambda place: place[0].level),
    PlannerColumn("planner", "Planner", lambda place: place[0].planners[place[1]]),
    Column("mean_rank", "Mean rank", lambda place: place[0].friedman.mean_ranks[place[1]], lambda rank: f"{rank:.2f}"),
    Column("control", "", lambda place: place[0].control),
    Column("p_against_control_holm", "", lambda place: place[0].against_control[place[1]]),
    Column("", "p against the control (Holm)", _against_control(lambda place: place[0].against_control[place[1]])),
    Column(
        "",
        "p against the control (Nemenyi)",
        _against_control(lambda place: place[0].nemenyi[place[1], place[0].planners.index(place[0].control)]),
    ),
    Column("friedman_p", "", lambda place: place[0].friedman.p),
    Column("critical_difference", "", lambda place: place[0].difference),
)


def places(tests: Sequence[Omnibus]) -> list[Place]:
    """Every planner of every test."""
    return [(test, place) for test in tests for place in range(len(test.planners))]


def rank_grid(test: Omnibus, flags: Mapping[str, str]) -> Grid:
    """Mean ranks and tests against the control."""
    caption = f"Mean ranks of the medians over {', '.join(test.cases)}; the control is {test.control}."
    return grid(caption, RANK_COLUMNS, places([test]), flags)


def ranking(test: Omnibus) -> str:
    """Say who ranks first, and where the trivial opponents stand."""
    scaled = [name for name in test.planners if test.level != Level.SCALED and needs_scaling(name)]
    note = f" ({listed(scaled)} with the scaled one, which they need)" if scaled else ""
    trivial = [f"{name} {test.planners.index(name) + 1}" for name in YARDSTICKS if name in test.planners]
    return (
        f"With the {test.level} formulation{note} {test.planners[0]} has the best mean rank over "
        f"{plural(len(test.cases), 'case')} ({test.friedman.mean_ranks[0]:.1f} of {len(test.planners)}); "
        f"the places of the trivial opponents among {len(test.planners)}: {', '.join(trivial)}."
    )


def weakness(test: Omnibus) -> str:
    """Say how little so few cases can show."""
    n, k = len(test.cases), len(test.planners)
    return (
        f"The omnibus test is weak with {plural(n, 'case')}. It may say that not all planners are alike (p "
        f"{p_value(test.friedman.p)}; the smallest that it can give with {k} planners is {test.smallest_p:.0e}), but hardly "
        f"which: two planners are told apart only when their mean ranks differ by {test.difference:.1f} of at most {k - 1}, "
        f"and a signed rank test over the cases cannot give a p below {test.smallest_pair_p:.3g}."
    )
