"""justblend as its users take it where every point counts: straight lines with a stop at each waypoint.

The extra `justblend`. Its blends cut corners, so that the motion passes beside the waypoints; where all are to be
passed, only STRICT_CORNERS is left. It goes on without a stop where neighbouring lines are one but for about 1e-7.
"""

from __future__ import annotations

import importlib
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.optimize import brentq

from baselines.base import along
from baselines.peers.base import Peer, needs, through_phases
from study.problem import Floats, Problem
from study.trajectory import Trajectory

needs("justblend")

CLOSE = 1e-9
"""Relative difference of a line's duration, here and in the package, that is rounding."""


class JustBlend(Peer):
    """Planner `justblend-stop`: S-curves, without jerk limits trapezoids of velocity, along straight lines."""

    about = "justblend's S-curves along straight lines, with a stop at each waypoint"

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
        speeds = np.asarray(answer.junction_speeds())  # above zero where neighbouring lines are one
        lines = answer.segments()
        every = zip(lines, np.diff(problem.waypoints, axis=0), pairwise(speeds), strict=True)
        phases = [_phases(line.length, *ends, _scalars(problem, step)) for line, step, ends in every]
        wanted, widths = np.array([line.duration for line in lines]), np.array([sum(phase) for phase in phases])
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


def _phases(length: float, first: float, last: float, limits: Floats) -> Floats:
    """Durations of the phases of the fastest move over a length between two speeds, s: up, along and down."""
    velocity, acceleration, jerk = limits

    def change(step: float) -> Floats:  # jerk, no jerk, jerk back; infinite jerk takes no time
        ramp = min(acceleration / jerk, np.sqrt(step / jerk))
        return np.array([ramp, max(step / acceleration - ramp, 0.0), ramp])

    def room(top: float) -> float:  # what is left of the length at a top speed
        up, down = change(top - first).sum(), change(top - last).sum()
        return float(length - (first + top) / 2 * up - (top + last) / 2 * down)

    top = velocity if room(velocity) >= 0 else brentq(room, max(first, last), velocity, xtol=1e-15, rtol=1e-15)
    return np.array([*change(top - first), max(room(top), 0.0) / top, *change(top - last)])
