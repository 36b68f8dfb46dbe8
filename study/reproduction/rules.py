"""From a printed number and ours to a verdict: the comparisons, one function for each kind of number."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence

import numpy as np
from scipy import stats

from study.cases.published import parsed
from study.errors import StudyError
from study.reproduction.verdicts import Outcome, Ruling

FACTOR = 10.0
"""Numbers of random runs agree within this factor."""

RELATIVE = 1e-3
"""Other numbers agree within this share."""

ZERO = 1e-162
"""Below this a number is numerically zero: its square is no longer a double."""

COUNT_FACTOR = 1.5
"""Counts of generations agree within this factor."""

SIGNIFICANT = 0.05


def half_unit(printed: str) -> float:
    """Half a unit of the last printed digit: 0.005 for `3.59`, 5e-96 times 0.001 for `7.657 x 10^-96`."""
    text = printed.replace("−", "-").replace(",", "").replace("×", "x")
    found = re.search(r"\d+(?:\.(\d+))?(?:\s*x\s*10\^(-?\d+)|e([+-]?\d+))?", text, re.IGNORECASE)
    if found is None:
        return 0.0
    exponent = int(found[2] or found[3] or 0)
    return 0.5 * 10.0 ** (exponent - len(found[1] or ""))


def digits(printed: str) -> int:
    """Significant digits of a printed number."""
    found = re.search(r"\d[\d,.]*", printed)
    return max(1, len(re.sub(r"\D", "", found[0]).lstrip("0"))) if found else 1


def number(value: float) -> str:
    """Our number as text, with four digits."""
    return f"{value:.4g}"


def close(printed: float, text: str, ours: float) -> bool:
    """Whether a number that is no random result agrees: 1e-3 relative or the print's own rounding."""
    return abs(ours - printed) <= max(RELATIVE * abs(printed), half_unit(text) * (1 + 1e-9))


def same_order(printed: float, ours: float, zero: float = ZERO) -> bool:
    """Whether two non-negative results of random runs agree: within a factor of ten, or both numerically zero."""
    if printed <= zero and ours <= zero:
        return True
    return printed > 0 and ours > 0 and 1 / FACTOR <= ours / printed <= FACTOR


def stochastic(text: str, ours: float, least: float = 0.0, grain: float = 0.0) -> Ruling:
    """Compare a result of random runs, smaller being better.

    Parameters
    ----------
    text : str
        As printed.
    ours : float
    least : float
        The least value possible, from which both are measured; 0 for a standard deviation.
    grain : float
        Smallest step of the function near its least value in double precision: nothing below it is told from zero.
    """
    printed = _value(text)
    slack = half_unit(text) if printed else 0.0  # a printed zero is taken as exact
    zero = max(ZERO, grain, slack if least else 0.0)
    theirs_above, ours_above = max(printed - least, 0.0), max(ours - least, 0.0)
    agrees = same_order(theirs_above, ours_above, zero) or abs(ours - printed) <= slack
    if agrees:
        tiny = max(theirs_above, ours_above) <= zero
        return Ruling(
            Outcome.REPRODUCED, number(ours), "both numerically zero" if tiny else "same order of magnitude", True
        )
    ratio = math.inf if theirs_above <= 0 else ours_above / theirs_above
    better = ours_above < theirs_above
    why = f"ours is {_times(ratio)} the printed {'distance from the least value' if least else 'value'}"
    return Ruling(Outcome.BETTER if better else Outcome.WORSE, number(ours), why, False)


def exact(text: str, ours: float, otherwise: Outcome, why: str = "") -> Ruling:
    """Compare a number that does not depend on chance.

    Parameters
    ----------
    text : str
        As printed.
    ours : float
    otherwise : Outcome
        The verdict if they differ.
    why : str
        The reason if they differ.
    """
    if close(_value(text), text, ours):
        return Ruling(Outcome.REPRODUCED, number6(ours), "", True)
    return Ruling(otherwise, number6(ours), why or f"computed {number6(ours)}", False)


def duration(text: str, ours: float, why: str = "", spread: tuple[float, float] | None = None) -> Ruling:
    """Compare a total time with the median of our feasible motions, in s.

    Parameters
    ----------
    text : str
        As printed.
    ours : float, s
    why : str
    spread : tuple of two floats, s, optional
        Least and greatest total of our seeds: a printed time between them cannot be told from one of them.
    """
    printed = _value(text)
    inside = spread is not None and spread[0] - half_unit(text) <= printed <= spread[1] + half_unit(text)
    if close(printed, text, ours) or inside:
        return Ruling(Outcome.REPRODUCED, f"{ours:.4f} s", why, True)
    share = 100 * (ours / printed - 1)
    outcome = Outcome.BETTER if ours < printed else Outcome.WORSE
    return Ruling(outcome, f"{ours:.4f} s", f"ours is {share:+.2f} %" + (f"; {why}" if why else ""), False)


def count(text: str, ours: float, at_most: bool = False) -> Ruling:
    """Compare a number of generations; with `at_most` fewer agree as well."""
    printed = _value(text)
    low = 0.0 if at_most else printed / COUNT_FACTOR
    agrees = low <= ours <= printed * COUNT_FACTOR
    if agrees:
        return Ruling(Outcome.REPRODUCED, number(ours), "", True)
    outcome = Outcome.BETTER if ours < printed else Outcome.WORSE
    return Ruling(outcome, number(ours), f"ours is {_times(ours / printed)} the printed number", False)


def rank_sum(first: Sequence[float], second: Sequence[float]) -> float:
    """Two-sided p-value of the rank-sum test between two samples; 1 where all values are equal."""
    if len(set(first) | set(second)) == 1:
        return 1.0
    return float(stats.mannwhitneyu(first, second, alternative="two-sided").pvalue)


def smaller(first: Sequence[float], second: Sequence[float]) -> tuple[bool, float]:
    """Whether the first sample is significantly smaller than the second by the rank-sum test, and its p-value."""
    p = rank_sum(first, second)
    return bool(p < SIGNIFICANT and np.median(first) <= np.median(second)), p


def holds(statement: bool, ours: str, why: str = "") -> Ruling:
    """Rule on a statement about an order that our runs confirm or do not."""
    return Ruling(Outcome.REPRODUCED if statement else Outcome.WORSE, ours, why, statement)


def impossible(inequality: str) -> Ruling:
    """Rule that an inequality of arithmetic fails."""
    return Ruling(Outcome.IMPOSSIBLE, why=inequality)


def contradicts(why: str, ours: str = "") -> Ruling:
    """Rule that printed numbers disagree."""
    return Ruling(Outcome.CONTRADICTS, ours, why)


def number6(value: float) -> str:
    """Our number as text, with six digits."""
    return f"{value:.6g}"


def _times(ratio: float) -> str:
    return "above a printed zero, not a multiple of" if math.isinf(ratio) else f"{ratio:.2g} times"


def _value(text: str) -> float:
    """First number in a printed text, units and words left aside."""
    found = re.search(r"-?\d[\d,]*\.?\d*(?:\s*x\s*10\^-?\d+|e[+-]?\d+)?", text.replace("−", "-"))
    value = None if found is None else parsed(found[0].replace(",", ""))
    if value is None:
        raise StudyError(f"reproduction: {text!r} holds no number to compare with")
    return value
