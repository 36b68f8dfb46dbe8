"""Durations to start a segment-time NLP from: the steps under the limits, then random variations of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from study.curves import Curve
from study.formulation import stretch
from study.problem import Floats, Problem

MARGIN = 1.02
"""An interior-point method starts a little inside its limits."""


def guess(problem: Problem) -> Floats:
    """Durations that every segment would need on its own, shape (n_segments,), s."""
    steps = np.abs(np.diff(problem.waypoints, axis=0))
    needed = steps[:, None, :] * np.array([1.5, 4.0, 16.0])[:, None] / problem.limits.rates
    times = (needed ** (1 / np.arange(1, 4)[:, None])).max(axis=(1, 2))
    longest = times.max()
    return np.maximum(times, 0.1 * longest) if longest > 0 else np.ones(len(times))


def feasible(problem: Problem, curve: Curve, durations: Floats) -> Floats:
    """Stretch durations a little beyond feasibility; even them out first where the curve has no motion for them."""
    for _ in range(20):
        factor = stretch(problem, curve, durations[None])[0]
        if np.isfinite(factor):
            break
        durations = np.sqrt(durations * np.sqrt(durations.mean() * durations))
    shortest = problem.duration_bounds[0] / durations.min()
    return durations * (MARGIN * max(factor, shortest) or 1.0)


def starts(problem: Problem, curve: Curve, count: int, seed: int) -> Iterator[Floats]:
    """Yield feasible durations to start from; the first does not depend on the seed."""
    rng = np.random.default_rng(seed)
    base = guess(problem)
    for k in range(count):
        spread = np.exp(0.5 * rng.normal(size=base.shape)) if k else 1.0
        yield feasible(problem, curve, base * spread)
