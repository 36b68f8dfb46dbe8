"""justblend as its users take it where every point counts: straight lines with a stop at each waypoint.

The extra `justblend`. Its blends cut corners, so that the motion passes beside the waypoints; where all are to be
passed, only STRICT_CORNERS is left.
"""

from __future__ import annotations

import importlib
from typing import Any, ClassVar

import numpy as np

from baselines.base import along
from baselines.peers.base import Peer, needs, through_phases
from study.planning import RATE_LIMITS
from study.problem import Demand, Floats, Problem
from study.trajectory import Trajectory

needs("justblend")

CLOSE = 1e-9
"""Relative difference of a line's duration, here and in the package, that is rounding."""


class JustBlend(Peer):
    """Planner `justblend-stop`: S-curves, without jerk limits trapezoids of velocity, along straight lines."""

    about = "justblend's S-curves along straight lines, with a stop at each waypoint"
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS

    def solve(self, problem: Problem, time_limit: float) -> Any:
        """Generate the package's trajectory."""
        package: Any = importlib.import_module("justblend")
        velocity, acceleration, jerk = problem.limits.rates
        steps = not np.isfinite(jerk).all()
        kind = package.TrapezoidalTrajectoryGenerator if steps else package.SCurveTrajectoryGenerator
        generator = kind(problem.n_joints)
        generator.set_limits(package.Limits(velocity, acceleration, None if steps else jerk))
        generator.set_options(package.GenerationOptions(corner_handling=package.CornerHandling.STRICT_CORNERS))
        return generator.generate(problem.waypoints)

    def motion(self, problem: Problem, answer: Any) -> Trajectory:
        """Take the package's states where its phases begin and halfway; ValueError where its phases are others."""
        lines = list(zip(answer.segments(), np.diff(problem.waypoints, axis=0), strict=True))
        phases = [_phases(line.length, _scalars(problem, step)) for line, step in lines]
        wanted, widths = np.array([line.duration for line, _ in lines]), np.array([sum(phase) for phase in phases])
        if not np.allclose(widths, wanted, rtol=CLOSE, atol=0):
            raise ValueError("justblend's lines do not take the time of the known phases")
        phases = [phase[phase > CLOSE * phase.sum()] for phase in phases]
        knots = np.append(0.0, np.cumsum(np.concatenate(phases)))
        states, halfway = (_states(answer, times) for times in (knots[:-1], (knots[:-1] + knots[1:]) / 2))
        pieces = through_phases(knots, states, halfway, not np.isfinite(problem.limits.jerk).all())
        return Trajectory.from_pieces(*pieces, np.array([len(phase) for phase in phases]))


def _states(answer: Any, times: Floats) -> Floats:
    samples = answer.samples(times)
    return np.stack([samples.q, samples.qd, samples.qdd], axis=1)


def _scalars(problem: Problem, step: Floats) -> Floats:
    """Largest velocity, acceleration and jerk along a line, shape (3,)."""
    return along(step / np.linalg.norm(step), problem.limits.lowest_rates, problem.limits.highest_rates)


def _phases(length: float, limits: Floats) -> Floats:
    """Durations of the phases of the fastest symmetric move over a length, s."""
    velocity, acceleration, jerk = limits
    ramp = acceleration / jerk  # nothing where jerk is unlimited
    rise = velocity / acceleration + ramp if velocity >= acceleration * ramp else 2 * np.sqrt(velocity / jerk)
    if velocity * rise >= length:
        rise = (ramp + np.sqrt(ramp**2 + 4 * length / acceleration)) / 2
        if rise < 2 * ramp:
            rise = 2 * (length / (2 * jerk)) ** (1 / 3)
        still = 0.0
    else:
        still = length / velocity - rise
    ramp = min(ramp, rise / 2)
    return np.array([ramp, rise - 2 * ramp, ramp, still, ramp, rise - 2 * ramp, ramp])
