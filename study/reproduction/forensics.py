"""Limits that arithmetic sets to a printed result: each check returns the broken inequality as text, or nothing.

A check assumes nothing about the algorithm. It asks only whether any n numbers could have the printed mean, standard
deviation and extremes once rounding is allowed for, and whether sums follow from their terms.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from study.errors import StudyError


@dataclass(frozen=True)
class Finding:
    """One thing that cannot be.

    Attributes
    ----------
    check : str
        Short name of the check.
    inequality : str
        What would have to hold and does not, with its numbers.
    """

    check: str
    inequality: str


@dataclass(frozen=True)
class Summary:
    """Statistics of n independent runs as a table prints them.

    Attributes
    ----------
    n : int
        Number of runs.
    mean : float
    std : float, optional
        Sample standard deviation (divisor n - 1).
    minimum, maximum : float, optional
    digits : int
        Significant digits printed; half a unit of the last one is allowed for everywhere.

    Raises
    ------
    StudyError
        If there are fewer than two runs or no digits.
    """

    n: int
    mean: float
    std: float | None = None
    minimum: float | None = None
    maximum: float | None = None
    digits: int = 3

    def __post_init__(self) -> None:
        if self.n < 2 or self.digits < 1:
            raise StudyError(f"a summary needs at least 2 runs and 1 digit, got {self.n} runs and {self.digits} digits")

    def high(self, value: float) -> float:
        """Largest number that is printed as this value."""
        return value + self._half_unit(value)

    def low(self, value: float) -> float:
        """Smallest number that is printed as this value."""
        return value - self._half_unit(value)

    def _half_unit(self, value: float) -> float:
        return 0.5 * 10.0 ** (math.floor(math.log10(abs(value))) + 1 - self.digits) if value else 0.0


def std_too_large(summary: Summary, optimum: float) -> Finding | None:
    """Check std <= sqrt(n) (mean - f*): reached when all runs but one end at f*, exceeded by no n numbers >= f*."""
    if summary.std is None:
        return None
    bound = math.sqrt(summary.n) * (summary.high(summary.mean) - optimum)
    if summary.low(summary.std) <= bound:
        return None
    return Finding("std bound", f"std {summary.std:g} <= sqrt({summary.n}) (mean - f*) = {bound:.4g} fails")


def finer_than_doubles(summary: Summary, optimum: float, grain: float) -> Finding | None:
    """Check that a mean above f* is at least one grain above it in one of n runs."""
    above = summary.high(summary.mean) - optimum
    least = grain / summary.n
    if above <= 0.0 or above >= least:
        return None
    return Finding(
        "granularity",
        f"mean - f* = {summary.mean - optimum:g} is 0 or >= grain/n = {grain:g}/{summary.n} = {least:.4g} fails",
    )


def below_optimum(summary: Summary, optimum: float) -> Finding | None:
    """Check that neither the minimum nor the mean lies below f*."""
    for name, value in (("minimum", summary.minimum), ("mean", summary.mean)):
        if value is not None and summary.high(value) < optimum:
            return Finding("below optimum", f"{name} {value:g} >= f* = {optimum:g} fails")
    return None


def mean_outside_extremes(summary: Summary) -> Finding | None:
    """Check minimum <= mean <= maximum."""
    if summary.minimum is not None and summary.high(summary.mean) < summary.low(summary.minimum):
        return Finding("mean outside", f"minimum {summary.minimum:g} <= mean {summary.mean:g} fails")
    if summary.maximum is not None and summary.low(summary.mean) > summary.high(summary.maximum):
        return Finding("mean outside", f"mean {summary.mean:g} <= maximum {summary.maximum:g} fails")
    return None


def mean_too_near_extreme(summary: Summary) -> Finding | None:
    """Check that the one run at the far extreme pulls the mean at least (maximum - minimum) / n away from the near one."""
    if summary.minimum is None or summary.maximum is None or mean_outside_extremes(summary):
        return None
    pull = (summary.low(summary.maximum) - summary.high(summary.minimum)) / summary.n
    least, most = summary.low(summary.minimum) + pull, summary.high(summary.maximum) - pull
    if summary.high(summary.mean) < least:
        text = f"mean {summary.mean:g} >= minimum + (maximum - minimum)/{summary.n} = {least:.6g} fails"
    elif summary.low(summary.mean) > most:
        text = f"mean {summary.mean:g} <= maximum - (maximum - minimum)/{summary.n} = {most:.6g} fails"
    else:
        return None
    return Finding("mean too near an extreme", text)


def std_beyond_extremes(summary: Summary) -> Finding | None:
    """Check std^2 <= (maximum - mean)(mean - minimum) n/(n - 1), the Bhatia-Davis bound."""
    if summary.std is None or summary.minimum is None or summary.maximum is None or mean_outside_extremes(summary):
        return None
    n = summary.n
    up = summary.high(summary.maximum) - summary.low(summary.mean)
    down = summary.high(summary.mean) - summary.low(summary.minimum)
    bound = math.sqrt(max(up, 0.0) * max(down, 0.0) * n / (n - 1))
    if summary.low(summary.std) <= bound:
        return None
    formula = "sqrt((maximum - mean)(mean - minimum) n/(n - 1))"
    return Finding("std beyond extremes", f"std {summary.std:g} <= {formula} = {bound:.4g} fails")


def above_largest(summary: Summary, largest: float) -> Finding | None:
    """Check that neither the mean nor the maximum exceeds the largest value in the box."""
    for name, value in (("maximum", summary.maximum), ("mean", summary.mean)):
        if value is not None and summary.low(value) > largest:
            return Finding("above largest", f"{name} {value:g} <= largest value in the box = {largest:g} fails")
    return None


def wrong_sum(terms: Sequence[float], printed: float, decimals: int) -> Finding | None:
    """Check that a printed total is the sum of its printed terms.

    Parameters
    ----------
    terms : sequence of float
    printed : float
    decimals : int
        Decimals of all of them; each may be off by half a unit of the last.
    """
    total = math.fsum(terms)
    slack = 0.5 * 10.0**-decimals * (len(terms) + 1)
    if abs(total - printed) <= slack * (1.0 + 1e-9):
        return None
    return Finding(
        "sum",
        f"|{' + '.join(f'{term:g}' for term in terms)} - {printed:g}| = {abs(total - printed):.4g} <= {slack:g} fails",
    )
