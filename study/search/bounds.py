"""Bounds rules: clip, stop, reflect or ignore candidates that have left the box."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from study.choices import Choice
from study.problem import Floats
from study.search.state import Box

Moved = tuple[Floats, Floats]


@lru_cache(maxsize=8)
def population_bounds(box: Box, shape: tuple[int, ...]) -> tuple[Floats, Floats]:
    """Lower and upper bounds repeated for a population of that shape.

    Broadcasting one row over a narrow population takes longer than the arithmetic, and every generation needs it.
    """
    return np.broadcast_to(box.lower, shape).copy(), np.broadcast_to(box.upper, shape).copy()


def clipped(box: Box, positions: Floats) -> Floats:
    """Clip positions to the box, as `numpy.clip` does, in a third of its time for fifty candidates."""
    lower, upper = population_bounds(box, positions.shape)
    return np.minimum(np.maximum(positions, lower), upper)


def clip(box: Box, positions: Floats, velocities: Floats) -> Moved:
    """Clip positions and keep velocities; this can trap coordinates on a bound."""
    return clipped(box, positions), velocities


def stop(box: Box, positions: Floats, velocities: Floats) -> Moved:
    """Clip positions and zero the velocities that left the box."""
    outside = (positions < box.lower) | (positions > box.upper)
    return clipped(box, positions), np.where(outside, 0.0, velocities)


def reflect(box: Box, positions: Floats, velocities: Floats) -> Moved:
    """Reflect positions at the bound and reverse their velocities."""
    outside = (positions < box.lower) | (positions > box.upper)
    period = 2 * box.width
    folded = np.mod(positions - box.lower, period)
    return box.lower + np.minimum(folded, period - folded), np.where(outside, -velocities, velocities)


def free(box: Box, positions: Floats, velocities: Floats) -> Moved:
    """Leave positions outside the box."""
    return positions, velocities


class BoundsRule(Choice):
    """Bounds rule of a search; every search names its rule, and the rule is recorded."""

    CLIP = "clip"
    STOP = "stop"
    REFLECT = "reflect"
    FREE = "free"


_RULES: dict[str, Callable[[Box, Floats, Floats], Moved]] = {
    BoundsRule.CLIP: clip,
    BoundsRule.STOP: stop,
    BoundsRule.REFLECT: reflect,
    BoundsRule.FREE: free,
}


def bounded(rule: BoundsRule, box: Box, positions: Floats, velocities: Floats) -> Moved:
    """Apply a bounds rule to positions and velocities.

    Parameters
    ----------
    rule : BoundsRule
    box : Box
    positions : array of shape (n_candidates, n_dimensions)
    velocities : array of the same shape
        Per generation.

    Raises
    ------
    StudyError
        If there is no such rule.
    """
    return _RULES[BoundsRule(rule)](box, positions, velocities)


def bounded_positions(rule: BoundsRule, box: Box, positions: Floats) -> Floats:
    """Apply a bounds rule to candidates without velocities."""
    return bounded(rule, box, positions, positions)[0]
