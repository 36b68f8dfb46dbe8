"""Effect sizes between methods: on every problem over seeds, and over problems with a test of each pair.

References
----------
Vargha and Delaney, J. Educ. Behav. Stat. 25 (2000). Cliff, Psychol. Bull. 114 (1993). Holm, Scand. J. Stat. 6 (1979).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, groupby

import numpy as np

from study.analysis.tables import Record
from study.comparison.ranking import CONTROLS, levelled
from study.comparison.statistics import LARGE, Interval, a12, holm, rank_sum, signed_rank
from study.problem import Floats
from study.suites.measures import Field, Score

RESAMPLES, LEVEL = 1000, 0.95
SIGNIFICANT = 0.05

MOST = 24
"""Methods that are compared with one another."""

Samples = dict[str, Floats]
"""Durations of a method's runs by problem, in steps of the judge's tolerance; infinity for a run without a feasible motion."""


@dataclass(frozen=True)
class Effect:
    """A method against another over the problems on which both were run.

    Attributes
    ----------
    method, other : str
    problems : int
    a12 : Interval
        Probability that a run of the method is shorter, ties counted as half: mean over problems, and a bootstrap interval
        over problems.
    better, worse : int
        Problems on which it is at least `LARGE` for the method, and for the other.
    p : float
        Of the signed rank test on the medians over problems, adjusted by Holm for all pairs.
    """

    method: str
    other: str
    problems: int
    a12: Interval
    better: int
    worse: int
    p: float

    @property
    def delta(self) -> float:
        """Cliff's delta: probability that a run is shorter less the probability that it is longer."""
        return 2.0 * self.a12.estimate - 1.0

    @property
    def significant(self) -> bool:
        """Whether the adjusted test tells the two apart."""
        return self.p < SIGNIFICANT

    def reversed(self) -> Effect:
        """The same from the other's side."""
        ends = Interval(1.0 - self.a12.estimate, 1.0 - self.a12.upper, 1.0 - self.a12.lower)
        return Effect(self.other, self.method, self.problems, ends, self.worse, self.better, self.p)


def featured(field: Field, ranked: Sequence[Score]) -> list[str]:
    """Methods that pages compare, the nearest first: searches at the largest budget, and planners of no chance."""
    budget = max((run.evaluations for run in field.runs), default=0)
    return [s.method for s in ranked if field.by_method[s.method][0].evaluations in (0, budget)][:MOST]


def control_of(field: Field, methods: Sequence[str]) -> str:
    """Method that the others are measured against: the yardstick of the papers, or else the first; empty without methods."""
    planners = {field.by_method[name][0].planner: name for name in methods}
    return planners.get(CONTROLS[0], methods[0] if methods else "")


def effects(field: Field, methods: Sequence[str], seed: int = 0) -> list[Effect]:
    """Compare all pairs of methods that share a problem.

    Parameters
    ----------
    field : Field
    methods : sequence of str
    seed : int
        Of the bootstrap.
    """
    samples = {name: _samples(field, name) for name in methods}
    pairs = [(a, b) for a, b in combinations(methods, 2) if samples[a].keys() & samples[b].keys()]
    tests = holm([_over_problems(samples[a], samples[b]) for a, b in pairs])
    return [_effect(a, b, samples, float(p), seed) for (a, b), p in zip(pairs, tests, strict=True)]


def against(pairs: Sequence[Effect], control: str) -> list[Effect]:
    """Every other method against a control, the best first."""
    own = [each if each.other == control else each.reversed() for each in pairs if control in (each.method, each.other)]
    return sorted(own, key=lambda each: -each.a12.estimate)


def _samples(field: Field, method: str) -> Samples:
    ordered = sorted(field.by_method[method], key=lambda run: run.problem)
    return {
        problem: levelled(
            np.array([run.duration if run.feasible else np.inf for run in group]),
            field.best_of_any.get(problem, 1.0),
        )
        for problem, group in groupby(ordered, lambda run: run.problem)
    }


def _shared(first: Samples, second: Samples) -> list[str]:
    return sorted(first.keys() & second.keys())


def _over_problems(first: Samples, second: Samples) -> float:
    shared = _shared(first, second)
    return signed_rank(*([np.quantile(s[name], 0.5, method="higher") for name in shared] for s in (first, second)))


def _effect(method: str, other: str, samples: dict[str, Samples], p: float, seed: int) -> Effect:
    first, second = samples[method], samples[other]
    each = np.array([a12(first[name], second[name]) for name in _shared(first, second)])
    rows = np.random.default_rng(seed).integers(len(each), size=(RESAMPLES, len(each)))
    low, high = np.quantile(each[rows].mean(axis=1), [(1 - LEVEL) / 2, (1 + LEVEL) / 2])
    interval = Interval(float(each.mean()), float(low), float(high))
    return Effect(method, other, len(each), interval, int((each >= LARGE).sum()), int((each <= 1.0 - LARGE).sum()), p)


def effects_by_problem(field: Field, methods: Sequence[str], control: str) -> list[Record]:
    """Effect size of every method against a control on every problem over seeds, with the rank sum test's p, adjusted by Holm for
    the methods on the problem: rows of a table."""
    samples = {name: _samples(field, name) for name in methods}
    rows: list[Record] = []
    for problem, base in sorted(samples[control].items()):
        others = [name for name in methods if name != control and problem in samples[name]]
        adjusted = holm([rank_sum(samples[name][problem], base) for name in others])
        for name, p in zip(others, adjusted, strict=True):
            size = a12(samples[name][problem], base)
            row: Record = {"problem": problem, "method": name, "control": control, "a12": size}
            rows.append(row | {"cliffs_delta": 2.0 * size - 1.0, "rank_sum_p_holm": float(p)})
    return rows
