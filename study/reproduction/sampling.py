"""Statistics of as many runs as a paper made, drawn from ours, and tests between two samples with their power."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from study.choices import Choice
from study.problem import Floats
from study.reproduction.verdicts import Outcome, Ruling

DRAWS = 2000
SIGNIFICANT = 0.05

ENOUGH = 10
"""Runs on either side below which a test that finds nothing says nothing."""


class Statistic(Choice):
    """Number that a paper makes of several runs."""

    ONE = "one"
    MEAN = "mean"
    STD = "std"
    BEST = "best"
    WORST = "worst"

    def of(self, values: Sequence[float] | Floats) -> float:
        """Value of the statistic; the median stands for one run."""
        return float(self.over(np.asarray(values, dtype=float)[None])[0])

    def over(self, samples: Floats) -> Floats:
        """Values of the statistic over samples, shape (n_samples, n_runs) -> (n_samples,)."""
        with np.errstate(over="ignore", under="ignore"):
            if self is Statistic.STD:
                return samples.std(axis=1, ddof=1) if samples.shape[1] > 1 else np.zeros(len(samples))
            if self in (Statistic.BEST, Statistic.WORST):
                return samples.min(axis=1) if self is Statistic.BEST else samples.max(axis=1)
            return np.median(samples, axis=1) if self is Statistic.ONE else samples.mean(axis=1)


def resampled(values: Sequence[float], statistic: Statistic, runs: int) -> Floats:
    """Draw samples of so many runs from ours, with replacement, and take the statistic of each.

    Parameters
    ----------
    values : sequence of float
    statistic : Statistic
        `ONE` returns our runs as they are.
    runs : int

    Returns
    -------
    array of shape (n_samples,)
    """
    own = np.asarray(values, dtype=float)
    if statistic is Statistic.ONE:
        return own
    return statistic.over(np.random.default_rng(0).choice(own, (DRAWS, runs)))


@dataclass(frozen=True)
class Comparison:
    """Rank-sum test of one sample against another.

    Attributes
    ----------
    smaller : bool
        Whether the first is significantly smaller.
    p : float
        Two-sided.
    told : bool
        Whether a difference was gathered or ten runs on each side gathered none.
    """

    smaller: bool
    p: float
    told: bool


def rank_sum(first: Sequence[float], second: Sequence[float]) -> float:
    """Two-sided p-value of the rank-sum test between two samples; 1 where all values are equal."""
    if len(set(first) | set(second)) == 1:
        return 1.0
    return float(stats.mannwhitneyu(first, second, alternative="two-sided").pvalue)


def compared(first: Sequence[float], second: Sequence[float]) -> Comparison:
    """Test whether the first sample is smaller than the second."""
    p = rank_sum(first, second)
    smaller = bool(
        p < SIGNIFICANT and np.mean(stats.rankdata([*first, *second])[: len(first)]) < _middle(first, second)
    )
    return Comparison(smaller, p, p < SIGNIFICANT or min(len(first), len(second)) >= ENOUGH)


def smaller(first: Sequence[float], second: Sequence[float]) -> tuple[bool, float]:
    """Whether the first sample is significantly smaller than the second, and the p-value."""
    test = compared(first, second)
    return test.smaller, test.p


def in_every(tests: Mapping[str, Comparison], why: str = "") -> Ruling:
    """Rule on a statement that holds if the first sample is smaller in every comparison.

    Parameters
    ----------
    tests : mapping of a comparison's name to the test
    why : str
    """
    lost = {name: test for name, test in tests.items() if not test.smaller}
    text = f"{len(tests) - len(lost)} of {len(tests)} comparisons"
    named = ", ".join(f"{name} (p = {test.p:.2g})" for name, test in lost.items())
    reason = "; ".join(filter(None, (f"not by the rank-sum test: {named}" if lost else "by the rank-sum test", why)))
    if lost and not any(test.told for test in lost.values()):
        few = f"fewer than {ENOUGH} runs on a side, too few to tell; {reason}"
        return Ruling(Outcome.UNDECIDED, text, few)
    return Ruling(Outcome.NOT_CONFIRMED if lost else Outcome.REPRODUCED, text, reason, not lost)


def converse(ruling: Ruling, about: str) -> Ruling:
    """Rule on the statement that another one does not hold."""
    why = f"{about}: {ruling.why}"
    if ruling.outcome is Outcome.UNDECIDED:
        return replace(ruling, why=why)
    outcome = Outcome.NOT_CONFIRMED if ruling.agrees else Outcome.REPRODUCED
    return replace(ruling, outcome=outcome, why=why, agrees=not ruling.agrees)


def _middle(first: Sequence[float], second: Sequence[float]) -> float:
    """Mean rank of a sample that does not differ from the other."""
    return (len(first) + len(second) + 1) / 2
