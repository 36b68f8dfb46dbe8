"""Uniformity of the papers' chaotic maps at the papers' own sizes, over many random starts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np

from study.problem import Floats
from study.reproduction import rules
from study.reproduction.sampling import compared
from study.reproduction.verdicts import Basis, Ruling
from study.search.chaos import MAPS, uniformity

STARTS = 1000
"""Random starts of every map behind a figure."""

NUMBERS = 1000
"""Numbers drawn from each start, as in the PUMA560 and the sparrow paper; the woodworking paper shows 100."""


@cache
def chaos_numbers(name: str) -> Floats:
    """Sequences of a map from many starts, or of the uniform generator under the name `uniform`, (NUMBERS, STARTS)."""
    rng = np.random.default_rng(11)
    if name == "uniform":
        return rng.random((NUMBERS, STARTS))
    with np.errstate(over="ignore", invalid="ignore"):  # an orbit that has left [0, 1], as Singer's may, diverges
        return MAPS[name].sequences(rng.random(STARTS), NUMBERS, rng)


@cache
def chi_squares(name: str, numbers: int = NUMBERS) -> tuple[float, ...]:
    """Chi-square figures of a map's first numbers from many starts; infinite for an orbit that leaves [0, 1]."""
    drawn = chaos_numbers(name)[:numbers].T
    return tuple(uniformity(x) if ((x >= 0) & (x <= 1)).all() else math.inf for x in drawn)


def gaps(name: str, numbers: int) -> tuple[Floats, Floats]:
    """Least and greatest gap between neighbours among a map's first numbers, times their count, each of shape (STARTS,)."""
    apart = np.diff(np.sort(chaos_numbers(name)[:numbers], axis=0), axis=0) * numbers
    return apart.min(axis=0), apart.max(axis=0)


def more_uniform(name: str, others: Sequence[str], sizes: Sequence[int] = (NUMBERS,), decisive: int = 1) -> Ruling:
    """Rule on the statement that a map is more uniform than others: smaller chi-square by the rank-sum test.

    Parameters
    ----------
    name : str
    others : sequence of str
    sizes : sequence of int
        Numbers drawn, in turn.
    decisive : int
        How many of the sizes, from the first on, decide; the others are shown.
    """
    parts, failed = [], []
    for rank, size in enumerate(sizes):
        own = chi_squares(name, size)
        figures = {other: chi_squares(other, size) for other in others}
        against = ", ".join(f"{other} {np.median(values):.1f}" for other, values in figures.items())
        parts.append(f"{size} numbers: {np.median(own):.1f} against {against}")
        if rank < decisive:
            failed += [f"{other} at {size}" for other, values in figures.items() if not compared(own, values).smaller]
    why = f"not more uniform than {', '.join(failed)}" if failed else "smaller by the rank-sum test"
    told = f"{why}; chi-square over ten bins (5 % limit 16.9), medians over {STARTS} starts"
    return rules.holds(not failed, "; ".join(parts), told, Basis.FORMULA)


def more_even(name: str, numbers: int) -> Ruling:
    """Rule on the statement that a map's numbers neither cluster nor leave holes, unlike random ones."""
    (least, greatest), (random_least, random_greatest) = gaps(name, numbers), gaps("uniform", numbers)
    apart = compared(random_least.tolist(), least.tolist()).smaller
    filled = compared(greatest.tolist(), random_greatest.tolist()).smaller
    text = (
        f"least gap {np.median(least):.2g} against {np.median(random_least):.2g}, "
        f"greatest {np.median(greatest):.2g} against {np.median(random_greatest):.2g}"
    )
    why = f"gaps of {numbers} numbers times {numbers}, medians over {STARTS} starts, random numbers second"
    return rules.holds(apart and filled, text, why, Basis.FORMULA)


def denser(name: str, low: float, high: float, numbers: int) -> Ruling:
    """Rule on the statement that a map is denser in an interval than elsewhere."""
    drawn = chaos_numbers(name)[:numbers]
    share = float(np.median(((drawn > low) & (drawn < high)).mean(axis=0)))
    text = f"{100 * share:.0f} % of {numbers} numbers lie in {100 * (high - low):.0f} % of the interval"
    return rules.holds(share > high - low, text, f"median over {STARTS} starts", Basis.FORMULA)


def lyapunov(r: float, steps: int = 2000) -> float:
    """Lyapunov exponent of the sine-tent-cosine map at a control parameter; positive in chaos."""
    x = np.random.default_rng(5).random(50)
    total = np.zeros_like(x)
    for step in range(steps):
        half = np.where(x < 0.5, 1.0, -1.0)
        angle = np.pi * (r * np.sin(np.pi * x) + 2 * (1 - r) * np.where(x < 0.5, x, 1 - x) - 0.5)
        slope = np.abs(np.sin(angle) * np.pi * (r * np.pi * np.cos(np.pi * x) + 2 * (1 - r) * half))
        total += np.log(np.maximum(slope, 1e-300)) * (step >= steps // 10)
        x = np.clip(np.cos(angle), 0.0, 1.0)
    return float(np.median(total)) / (steps - steps // 10)
