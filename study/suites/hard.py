"""The suite of what is hard: each kind with its own trouble, with and without jerk limits."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from study.problem import Floats, JointLimits
from study.suites.drawn import Drawn

Rng = np.random.Generator
Made = tuple[Floats, Floats, tuple[Floats, Floats] | None]
"""Waypoints, factors of the joints' limits, and a range of positions."""

VELOCITY, ACCELERATION, JERK = 2.0, 8.0, 80.0


def _even(waypoints: Floats) -> Made:
    return waypoints, np.ones(waypoints.shape[1]), None


def long_moves(rng: Rng) -> Made:
    """Ways of 20 to 60 rad, most of them at full speed."""
    return _even(np.cumsum(rng.uniform(20, 60, (5, 3)) * rng.choice([-1, 1], (5, 3)), axis=0))


def tiny_steps(rng: Rng) -> Made:
    """Steps of a tenth of a milliradian."""
    return _even(rng.uniform(-1, 1, 6) + np.cumsum(rng.uniform(-1e-4, 1e-4, (12, 6)), axis=0))


def long_and_tiny(rng: Rng) -> Made:
    """Long moves with tiny corrections after each."""
    steps = np.where((np.arange(12) % 2 == 0)[:, None], rng.uniform(-3, 3, (12, 6)), rng.uniform(-1e-3, 1e-3, (12, 6)))
    return _even(np.cumsum(steps, axis=0))


def u_turns(rng: Rng) -> Made:
    """Back to where it came from at every waypoint, all joints at once."""
    away = rng.uniform(-1, 1, (2, 6))
    return _even(np.array([away[k % 2] + 0.01 * k for k in range(12)]))


def one_joint_still(rng: Rng) -> Made:
    """One joint stands still all the time, another one but once."""
    waypoints = rng.uniform(-1.5, 1.5, (8, 6))
    waypoints[:, 2], waypoints[:4, 4], waypoints[4:, 4] = 0.5, -0.3, 0.3
    return _even(waypoints)


def binding_range(rng: Rng) -> Made:
    """Waypoints near the ends of the range, where a free path would swing out."""
    waypoints = 0.98 * rng.choice([-1.0, 1.0], (8, 6))
    waypoints[:, 0] = rng.uniform(-0.98, 0.98, 8)
    return waypoints, np.ones(6), (np.full(6, -1.0), np.full(6, 1.0))


def unlike_limits(rng: Rng) -> Made:
    """Limits of the joints from a hundredth to a hundred times the usual."""
    return rng.uniform(-1.5, 1.5, (8, 6)), np.geomspace(0.01, 100.0, 6), None


def straight_line(rng: Rng) -> Made:
    """Waypoints on a straight line, unevenly spaced."""
    along = np.cumsum(rng.exponential(0.3, 15))
    return _even(along[:, None] * rng.uniform(-1, 1, 6))


def staircase(rng: Rng) -> Made:
    """One joint moves at a time."""
    steps = np.zeros((12, 6))
    steps[np.arange(12), np.arange(12) % 6] = rng.uniform(0.2, 1.0, 12)
    return _even(np.cumsum(steps, axis=0))


def near_duplicates(rng: Rng) -> Made:
    """Every waypoint comes twice, a microradian apart."""
    points = np.repeat(rng.uniform(-1.5, 1.5, (6, 6)), 2, axis=0)
    points[1::2] += 1e-6 * rng.choice([-1, 1], (6, 6))
    return _even(points)


def one_joint_alone(rng: Rng) -> Made:
    """A single joint through turns of every length."""
    return _even((np.geomspace(1e-3, 10.0, 14) * (-1.0) ** np.arange(14))[:, None])


def slow_first(rng: Rng) -> Made:
    """One joint must go far, the others hardly move."""
    waypoints = 0.01 * rng.uniform(-1, 1, (10, 6))
    waypoints[:, 0] = np.linspace(0, 9, 10) + rng.uniform(-0.2, 0.2, 10)
    return _even(waypoints)


KINDS: tuple[Callable[[Rng], Made], ...] = (
    long_moves, tiny_steps, long_and_tiny, u_turns, one_joint_still, binding_range, unlike_limits, straight_line,
    staircase, near_duplicates, one_joint_alone, slow_first,
)  # fmt: skip


def problems(seed: int) -> list[Drawn]:
    """Draw the suite."""
    return [_problem(seed, number, jerk) for number in range(len(KINDS)) for jerk in (False, True)]


def _problem(seed: int, number: int, jerk: bool) -> Drawn:
    kind = KINDS[number]
    waypoints, factors, span = kind(np.random.default_rng([seed, number]))
    name = kind.__name__.replace("_", "-")
    rates = [limit * factors for limit in (VELOCITY, ACCELERATION, JERK)]
    if not jerk:
        rates[2] = np.full(len(factors), np.inf)
    limits = JointLimits(*rates, *(() if span is None else span))
    ours = "ours: made to be hard"
    return Drawn(
        f"{name}{'-jerk' if jerk else ''}",
        f"study/suites/hard.py, {kind.__name__}, seed {seed}",
        str(kind.__doc__).rstrip("."),
        (name, "jerk" if jerk else "no jerk", f"{len(factors)} joints"),
        None,
        ("rad",) * len(factors),
        limits,
        dict.fromkeys(("velocity", "acceleration", "jerk", "position"), ours),
        waypoints,
    )
