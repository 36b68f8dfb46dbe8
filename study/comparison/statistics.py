"""The tests and effect sizes of the comparison, each a pure function of numbers where smaller is better.

References
----------
Demsar, Statistical comparisons of classifiers over multiple data sets, JMLR 7 (2006). Vargha and Delaney, J. Educ.
Behav. Stat. 25 (2000). Holm, Scand. J. Stat. 6 (1979).
"""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import ArrayLike
from scipy import stats

from study.errors import StudyError
from study.problem import Floats

RESAMPLES = 2000
FEW = 13
"""Pairs up to which SciPy's signed rank test goes through all patterns of signs where values tie; that is slow, ours is as exact."""

LARGE = 0.71
"""Probability from which Vargha and Delaney call a difference large (0.64 medium, 0.56 small)."""


def comparable(values: ArrayLike) -> Floats:
    """Put a number worse than all others in the place of infinity, so that ranks and differences exist."""
    array = np.asarray(values, dtype=float)
    finite = array[np.isfinite(array)]
    worst = 2.0 * np.abs(finite).max() + 1.0 if finite.size else 1.0
    return np.where(np.isfinite(array), array, worst)


def _pair(first: ArrayLike, second: ArrayLike) -> tuple[Floats, Floats]:
    a, b = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    together = comparable(np.concatenate([a, b]))
    return together[: len(a)], together[len(a) :]


def a12(first: ArrayLike, second: ArrayLike) -> float:
    """Probability that a run of the first is smaller than a run of the second, ties counted as half.

    Parameters
    ----------
    first, second : arrays of shape (n_first,), (n_second,)
        Smaller is better; infinity stands for a failed run.
    """
    a, b = _pair(first, second)
    smaller = (a[:, None] < b).sum() + 0.5 * (a[:, None] == b).sum()
    return float(smaller / (len(a) * len(b)))


def signed_rank(first: ArrayLike, second: ArrayLike) -> float:
    """Two-sided p of Wilcoxon's signed rank test on paired runs; 1 where all pairs are equal.

    Parameters
    ----------
    first, second : arrays of shape (n_pairs,)

    Raises
    ------
    StudyError
        If the numbers of runs differ.
    """
    a, b = _pair(first, second)
    if len(a) != len(b):
        raise StudyError(f"the signed rank test needs pairs, got {len(a)} and {len(b)} runs; take the rank sum test")
    if (a == b).all():
        return 1.0
    return _exact_signed_rank(a - b) if len(a) <= FEW else float(stats.wilcoxon(a, b).pvalue)


def _exact_signed_rank(differences: Floats) -> float:
    """Exact two-sided p with ties, zeros left out: the number of sign patterns by their sum of ranks, one rank after another."""
    known = differences[differences != 0.0]
    doubled = np.rint(2.0 * stats.rankdata(np.abs(known))).astype(int)  # ties have halves of ranks
    ways = np.ones(1)
    for rank in doubled:
        ways = np.pad(ways, (0, rank)) + np.pad(ways, (rank, 0))
    at = int(doubled[known > 0.0].sum())
    return float(min(1.0, 2.0 * min(ways[: at + 1].sum(), ways[at:].sum()) / ways.sum()))


def rank_sum(first: ArrayLike, second: ArrayLike) -> float:
    """Two-sided p of the rank sum test that the papers use; it ignores the pairing."""
    a, b = _pair(first, second)
    return float(stats.mannwhitneyu(a, b).pvalue)


def holm(p_values: ArrayLike) -> Floats:
    """Adjust p-values for their number by Holm's step-down rule; shape as given."""
    p = np.asarray(p_values, dtype=float)
    order = np.argsort(p, kind="stable")
    stepped = np.maximum.accumulate(p[order] * np.arange(len(p), 0, -1))
    adjusted = np.empty_like(p)
    adjusted[order] = np.minimum(stepped, 1.0)
    return adjusted


@dataclass(frozen=True)
class Interval:
    """An estimate and the ends of its interval."""

    estimate: float
    lower: float
    upper: float

    @property
    def excludes_zero(self) -> bool:
        """True if zero lies outside."""
        return self.lower > 0.0 or self.upper < 0.0


def median_difference(first: ArrayLike, second: ArrayLike, seed: int = 0, level: float = 0.95) -> Interval:
    """Median of the paired differences first - second, with a bootstrap percentile interval.

    Parameters
    ----------
    first, second : arrays of shape (n_pairs,)
        Finite.
    seed : int
        Of the resampling.
    level : float
    """
    differences = np.asarray(first, dtype=float) - np.asarray(second, dtype=float)
    rows = np.random.default_rng(seed).integers(len(differences), size=(RESAMPLES, len(differences)))
    medians = np.median(differences[rows], axis=1)
    lower, upper = np.quantile(medians, [(1 - level) / 2, (1 + level) / 2])
    return Interval(float(np.median(differences)), float(lower), float(upper))


@dataclass(frozen=True, eq=False)
class Friedman:
    """The omnibus test over cases.

    Attributes
    ----------
    statistic : float
        Chi-square, corrected for ties.
    p : float
    mean_ranks : array of shape (n_methods,)
        1 is best.
    n_cases : int
    """

    statistic: float
    p: float
    mean_ranks: Floats
    n_cases: int


def friedman(table: ArrayLike) -> Friedman:
    """Test whether methods rank alike over cases.

    Parameters
    ----------
    table : array of shape (n_cases, n_methods)
        One number per case and method, such as the median over runs; smaller is better.

    Raises
    ------
    StudyError
        If there are fewer than two cases or three methods.
    """
    rows = np.array([comparable(row) for row in np.asarray(table, dtype=float)])
    if rows.ndim != 2 or rows.shape[0] < 2 or rows.shape[1] < 3:
        raise StudyError(f"Friedman's test needs at least 2 cases and 3 methods, got a table of shape {rows.shape}")
    ranks = stats.rankdata(rows, axis=1)
    if np.ptp(ranks) == 0:
        return Friedman(0.0, 1.0, ranks.mean(axis=0), len(rows))
    test = stats.friedmanchisquare(*rows.T)
    return Friedman(float(test.statistic), float(test.pvalue), ranks.mean(axis=0), len(rows))


def smallest_omnibus_p(n_cases: int, n_methods: int) -> float:
    """Smallest p that Friedman's test can give: all cases rank alike, so that chi-square is n_cases (n_methods - 1)."""
    return float(stats.chi2.sf(n_cases * (n_methods - 1), n_methods - 1))


def smallest_pair_p(n_cases: int) -> float:
    """Smallest two-sided p of a signed rank test on so many pairs: all differences of one sign."""
    return min(1.0, 2.0 ** (1 - n_cases))


def critical_difference(n_methods: int, n_cases: int, alpha: float = 0.05) -> float:
    """Difference of mean ranks from which Nemenyi's test tells two methods apart.

    References
    ----------
    Demsar 2006, Section 3.2.2 and Table 5(a), whose q is the studentised range over the root of two.
    """
    return nemenyi_quantile(n_methods, alpha) * math.sqrt(n_methods * (n_methods + 1) / (6.0 * n_cases))


def nemenyi_quantile(n_methods: int, alpha: float = 0.05) -> float:
    """Critical value q of Nemenyi's test (Demsar 2006, Table 5(a))."""
    return float(stats.studentized_range.ppf(1 - alpha, n_methods, np.inf) / math.sqrt(2.0))


def against_control(test: Friedman, control: int) -> Floats:
    """Holm-adjusted p of every method's mean rank against one method's; 1 for the control itself.

    Parameters
    ----------
    test : Friedman
    control : int
        Column of the control.

    References
    ----------
    Demsar 2006, Section 3.2.2: z = (R_i - R_j) / sqrt(k (k + 1) / 6 N).
    """
    k = len(test.mean_ranks)
    z = (test.mean_ranks - test.mean_ranks[control]) / math.sqrt(k * (k + 1) / (6.0 * test.n_cases))
    p = 2.0 * stats.norm.sf(np.abs(z))
    others = np.arange(k) != control
    adjusted = np.ones(k)
    adjusted[others] = holm(p[others])
    return adjusted


def posthocs() -> ModuleType:
    """Import the library of the post hoc tests.

    Raises
    ------
    StudyError
        If scikit-posthocs is not installed.
    """
    try:
        return importlib.import_module("scikit_posthocs")
    except ModuleNotFoundError as error:
        raise StudyError(
            f"the comparison's post hoc test needs the Python package {error.name!r}, which is not installed; "
            "install it with: pip install 'time-optimal-study[compare]'"
        ) from None


def nemenyi(table: ArrayLike) -> Floats:
    """All-pairs p of Nemenyi's test after Friedman's, shape (n_methods, n_methods), by scikit-posthocs.

    Raises
    ------
    StudyError
        If scikit-posthocs is not installed.
    """
    rows = np.array([comparable(row) for row in np.asarray(table, dtype=float)])
    return np.asarray(posthocs().posthoc_nemenyi_friedman(rows), dtype=float)


def cliques(mean_ranks: ArrayLike, difference: float) -> list[tuple[int, ...]]:
    """Largest groups of methods, by rank, that the critical difference cannot tell apart; single ones are left out."""
    ranks = np.asarray(mean_ranks, dtype=float)
    order = np.argsort(ranks, kind="stable")
    groups: list[tuple[int, ...]] = []
    for start in range(len(order)):
        near = order[start:][ranks[order[start:]] - ranks[order[start]] <= difference]
        group = tuple(int(i) for i in near)
        if len(group) > 1 and not any(set(group) <= set(other) for other in groups):
            groups.append(group)
    return groups
