"""Uniformity of the papers' chaotic maps, over many random starts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache

import numpy as np

from study.problem import Floats
from study.reproduction import rules
from study.reproduction.verdicts import Ruling
from study.search.chaos import MAPS, uniformity

STARTS = 1000
"""Random starts of every map behind a chi-square figure."""

NUMBERS = 1000
"""Numbers drawn from each start, as in the PUMA560 and the sparrow paper."""


@cache
def chaos_numbers(name: str) -> Floats:
    """Sequences of a map from many starts, or of the uniform generator under the name `uniform`, (NUMBERS, STARTS)."""
    rng = np.random.default_rng(11)
    if name == "uniform":
        return rng.random((NUMBERS, STARTS))
    with np.errstate(over="ignore", invalid="ignore"):  # an orbit that has left [0, 1], as Singer's may, diverges
        return MAPS[name].sequences(rng.random(STARTS), NUMBERS, rng)


@cache
def chi_squares(name: str) -> tuple[float, ...]:
    """Chi-square figures of a map from many starts; infinite for an orbit that leaves [0, 1]."""
    return tuple(uniformity(x) if ((x >= 0) & (x <= 1)).all() else math.inf for x in chaos_numbers(name).T)


def more_uniform(name: str, others: Sequence[str]) -> Ruling:
    """Rule on the statement that a map is more uniform than others: smaller chi-square by the rank-sum test."""
    own = chi_squares(name)
    figures = {other: chi_squares(other) for other in others}
    tests = {other: rules.smaller(own, values) for other, values in figures.items()}
    text = f"chi-square {np.median(own):.1f} (5 % limit 16.9) against " + ", ".join(
        f"{other} {np.median(values):.1f}" for other, values in figures.items()
    )
    failed = [other for other, (smaller, _) in tests.items() if not smaller]
    why = f"not more uniform than {', '.join(failed)}" if failed else "smaller by the rank-sum test"
    return rules.holds(not failed, text, why + f"; medians over {STARTS} starts of {NUMBERS} numbers, ten bins")
