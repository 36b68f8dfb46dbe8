"""Durations to start a segment-time NLP from: the steps under the limits, then random variations of them."""

from __future__ import annotations

import numpy as np

from study.curves import Curve
from study.formulation import Scaled, stretch
from study.problem import Floats, Problem

MARGIN = 1.02
"""An interior-point method starts a little inside its limits."""

SAMPLE = {"few segments": 2000, "many": 200}
"""Number of random starts: the 3-5-3 curve's three segments have optima of very different proportions."""
APART = 0.3
"""Starts differ by at least this in the logarithm of some segment's share."""


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


def starts(problem: Problem, curve: Curve, count: int, seed: int) -> list[Floats]:
    """Choose feasible durations to start from, shape (n_segments,) each.

    The first is the guess and does not depend on the seed. The others are the best of a random sample around it after
    stretching, each apart from those chosen before: optima of different kinds lie in different proportions of
    durations.
    """
    rng = np.random.default_rng(seed)
    base = guess(problem)
    chosen = [feasible(problem, curve, base)]
    if count == 1:
        return chosen
    size = SAMPLE["few segments" if len(base) <= 3 else "many"]
    spread = rng.uniform(0.1, 1.5, size=(size, 1)) * rng.normal(size=(size, len(base)))
    sample = base * np.exp(spread)
    totals = Scaled(problem, curve)(sample)
    logs = np.log(sample / sample.sum(axis=1, keepdims=True))
    for k in np.argsort(totals, kind="stable"):
        if len(chosen) >= count or not np.isfinite(totals[k]):
            break
        if all(np.abs(logs[k] - np.log(other / other.sum())).max() > APART for other in chosen):
            chosen.append(feasible(problem, curve, sample[k]))
    return chosen
