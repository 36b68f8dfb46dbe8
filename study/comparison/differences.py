"""Which differences are real: paired tests on every case, and the omnibus test over cases."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from study.comparison import statistics
from study.comparison.contestants import Contestant, Reference
from study.comparison.statistics import Friedman, Interval
from study.problem import Floats

EQUAL = 1e-6
"""Durations closer than this share of the reference count as equal: it is the judge's tolerance."""

CONTROLS = ("pso", "random-search")
"""The yardstick of the papers, and the floor that every search must beat."""


@dataclass(frozen=True)
class Pairing:
    """A planner against a control on one case, on paired seeds.

    Attributes
    ----------
    case, level, planner, control : str
    a12 : float
        Probability that a run of the planner is shorter.
    difference : Interval, optional
        Median of planner minus control, as a share of the reference; None where a run is infeasible.
    signed_rank, rank_sum : float
        p-values, each adjusted by Holm for the planners of the case.
    """

    case: str
    level: str
    planner: str
    control: str
    a12: float
    difference: Interval | None
    signed_rank: float
    rank_sum: float


def pairings(found: Sequence[Contestant], references: Mapping[str, Reference]) -> list[Pairing]:
    """Compare every contestant with every control, case by case."""
    pairs: list[Pairing] = []
    for case in references:
        own = {one.planner: one for one in found if one.case == case}
        runs = max((len(one.durations) for one in own.values()), default=0)
        for control in CONTROLS:
            if control in own:
                pairs += _against(own, own[control], runs, references[case].value)
    return pairs


def _against(own: Mapping[str, Contestant], control: Contestant, runs: int, reference: float) -> list[Pairing]:
    others = [one for one in own.values() if one.planner != control.planner]
    base = levelled(control.paired(runs), reference)
    samples = [levelled(one.paired(runs), reference) for one in others]
    signed = statistics.holm([statistics.signed_rank(sample, base) for sample in samples])
    sums = statistics.holm([statistics.rank_sum(sample, base) for sample in samples])
    return [
        Pairing(
            one.case,
            one.level,
            one.planner,
            control.planner,
            statistics.a12(sample, base),
            difference(sample, base),
            float(p),
            float(q),
        )
        for one, sample, p, q in zip(others, samples, signed, sums, strict=True)
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
    """Friedman's test over cases with what follows from it.

    Attributes
    ----------
    level : str
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

    level: str
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
    found: Sequence[Contestant], references: Mapping[str, Reference], level: str, control: str = CONTROLS[0]
) -> Omnibus | None:
    """Rank the planners' medians over cases; None with fewer than two cases or three planners.

    Parameters
    ----------
    found : sequence of Contestant
    references : mapping of str to Reference
        Cases without one are left out.
    level : str
    control : str

    Raises
    ------
    StudyError
        If the library of Nemenyi's test is not installed.
    """
    medians: dict[str, dict[str, float]] = {}
    for one in (one for one in found if one.case in references):
        medians.setdefault(one.case, {})[one.planner] = float(
            levelled(np.array(one.median), references[one.case].value)
        )
    planners = [
        name for name in dict.fromkeys(one.planner for one in found) if all(name in row for row in medians.values())
    ]
    if len(medians) < 2 or len(planners) < 3 or control not in planners:
        return None
    table = np.array([[row[name] for name in planners] for row in medians.values()])
    ranks = statistics.friedman(table).mean_ranks
    order = np.argsort(ranks, kind="stable")
    planners, table = [planners[i] for i in order], table[:, order]
    result = statistics.friedman(table)
    n_cases, n_planners = table.shape
    difference = statistics.critical_difference(n_planners, n_cases)
    return Omnibus(
        level,
        tuple(planners),
        tuple(medians),
        result,
        difference,
        statistics.cliques(result.mean_ranks, difference),
        control,
        statistics.against_control(result, planners.index(control)),
        statistics.nemenyi(table),
        statistics.smallest_omnibus_p(n_cases, n_planners),
        statistics.smallest_pair_p(n_cases),
    )
