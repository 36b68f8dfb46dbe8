"""Limits that arithmetic sets to a benchmark table's cells: inequalities that fail, laid beside the cell they concern."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from study.cases.printed import Cell
from study.problem import Floats
from study.reproduction import forensics
from study.reproduction.forensics import Finding, Summary
from study.reproduction.rules import digits, half_unit
from study.testfunctions import Benchmark

MONOTONE = {"sphere", "schwefel-222", "schwefel-221", "step", "step-without-floor", "quartic"}
"""Functions whose largest value in a symmetric box lies in its upper corner."""

STAIRS = 1e-9
"""Steps of a function that are wider are its own and no rounding."""


@dataclass(frozen=True)
class Statistics:
    """Cells of one function and one algorithm; None where a table has no such row."""

    mean: Cell
    std: Cell
    best: Cell | None = None
    worst: Cell | None = None


@cache
def grain(function: Benchmark) -> float:
    """Smallest value above a least value of 0 that double precision shows; 0 where there is none above 1e-200.

    What is gathered is an upper estimate, so the checks allow for a tenth of it.
    """
    if function.minimiser is None or function.minimum != 0.0:
        return 0.0
    values = _near(function.minimiser, function)
    least = 0.1 * float(values[values > 0].min())
    return least if least > 1e-200 else 0.0


@cache
def rounding(function: Benchmark) -> float:
    """Smallest difference above a function's least value in double precision, where arithmetic makes it: 0 elsewhere.

    Ackley's function is a difference of terms of about 20, so that near 0 it takes multiples of 3.6e-15 alone, and which
    of them depends on the last digit of the processor's exponential function: what is closer is the same. A staircase
    has steps of its own, wider than `STAIRS`.
    """
    if function.minimiser is None:
        return 0.0
    steps = np.diff(np.unique(_near(function.minimiser, function)))[:1]
    return float(steps[(steps > 1e-200) & (steps < STAIRS)].sum())


def _near(minimiser: Floats, function: Benchmark) -> Floats:
    """Values of a function ever nearer to its minimiser, with all coordinates moved and with one alone, down to the next doubles."""
    n = function.n_dimensions
    scales = 10.0 ** -np.arange(0.0, 300.0, 0.25)[:, None]
    shapes = [
        *np.random.default_rng(0).standard_normal((4, n)),
        *(side * np.eye(n)[k] for k in {0, n // 2, n - 1} for side in (-1, 1)),
    ]
    near = np.concatenate([minimiser + scales * shape for shape in shapes])
    alone = np.eye(n, dtype=bool)
    ulps = [np.where(alone, np.nextafter(minimiser, way), minimiser) for way in (-np.inf, np.inf)]
    return function.formula(np.concatenate([near, *ulps]))


def largest(function: Benchmark) -> float | None:
    """Largest value inside the box, where it is known to lie in the upper corner."""
    if function.name not in MONOTONE:
        return None
    return float(function.formula(function.upper[None])[0]) + function.noise


def examine(cells: Statistics, runs: int, function: Benchmark) -> dict[str, Finding]:
    """Find what cannot be: the cell's role (`mean`, `std`, `best`, `worst`) and the inequality that fails.

    Parameters
    ----------
    cells : Statistics
    runs : int
        Number of runs behind them.
    function : Benchmark
        In its stated reading.
    """
    summary = _summary(cells, runs)
    gathered: dict[str, Finding] = {}
    checks: list[tuple[str, Finding | None]] = [
        ("mean", forensics.mean_outside_extremes(summary)),
        ("mean", forensics.mean_too_near_extreme(summary)),
        ("std", forensics.std_beyond_extremes(summary)),
        ("std", None if function.minimum is None else _std_bound(cells, runs, function.minimum, "f*")),
    ]
    if cells.best is not None and cells.best.value is not None:
        best = cells.best.value - half_unit(cells.best.printed)
        checks.append(("std", _std_bound(cells, runs, best, "best")))
    if function.minimum is not None:
        checks += _against_least(cells, summary, function, function.minimum)
    top = largest(function)
    if top is not None:
        checks.append(("mean", forensics.above_largest(summary, top)))
    for role, finding in checks:
        if finding is not None:
            gathered.setdefault(role, finding)
    return gathered


def _against_least(
    cells: Statistics, summary: Summary, function: Benchmark, least: float
) -> list[tuple[str, Finding | None]]:
    step = grain(function)
    checks = [("mean", forensics.below_optimum(summary, least))]
    if step:
        checks.append(("mean", forensics.finer_than_doubles(summary, least, step)))
        if cells.best is not None and cells.best.value is not None:
            checks.append(("best", _finer(cells.best.value - least, step)))
    return checks


def _std_bound(cells: Statistics, runs: int, least: float, name: str) -> Finding | None:
    """Check the deviation against the mean's distance from a least value; each is rounded by its own digits."""
    mean, std = cells.mean, cells.std
    if mean.value is None or std.value is None:
        return None
    own = digits(mean.printed)
    lowest = Summary(runs, mean.value, max(std.value - half_unit(std.printed), 0.0), digits=own)
    if forensics.std_too_large(lowest, least) is None:
        return None
    finding = forensics.std_too_large(Summary(runs, mean.value, std.value, digits=own), least)
    return finding and Finding(finding.check, finding.inequality.replace("f*", name))


def _finer(above: float, step: float) -> Finding | None:
    """Check a single value, not a mean: it is the least value or at least one grain above it."""
    if above <= 0.0 or above >= step:
        return None
    return Finding("granularity", f"value - f* = {above:g} is 0 or >= the function's smallest step {step:.4g} fails")


def outside_extremes(cell: Cell, cells: Mapping[str, Cell]) -> Finding | None:
    """Check that a single run's printed value lies between the printed minimum and maximum."""
    value, low, high = cell.value, cells["min"].value, cells["max"].value
    if value is None or low is None or high is None:
        return None
    slack = half_unit(cell.printed) * (1 + 1e-9)
    if value > high + slack + half_unit(cells["max"].printed):
        return Finding("value outside", f"value {value:g} <= maximum {high:g} fails")
    if value < low - slack - half_unit(cells["min"].printed):
        return Finding("value outside", f"minimum {low:g} <= value {value:g} fails")
    return None


def _summary(cells: Statistics, runs: int) -> Summary:
    printed = [cell for cell in (cells.mean, cells.std, cells.best, cells.worst) if cell is not None and cell.value]
    return Summary(
        n=runs,
        mean=cells.mean.value or 0.0,
        std=cells.std.value,
        minimum=None if cells.best is None else cells.best.value,
        maximum=None if cells.worst is None else cells.worst.value,
        digits=min((digits(cell.printed) for cell in printed), default=3),
    )
