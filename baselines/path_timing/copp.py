"""COPP: third-order path parameterization on `toppra`'s paths, by a cone program; the extra `copp`.

COPP's open core returns path speed and acceleration at stations. Between stations the motion here follows the quintic
in time that meets both states; what this interpolation lets above a limit is removed by stretching by the exact factor.

References
----------
Package copp-py (open core), solvers topp2_ra and topp3_socp.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import copp_py as copp
import numpy as np

from baselines.base import Deterministic, where_something_moves
from baselines.path_timing.path import Path, PathRule, centripetal_path, chord_path, grid
from study import polynomial
from study.deadline import Deadline, record_cut
from study.judge import judge
from study.planning import Freedom, Plan, RunSettings, Status
from study.problem import Floats, Problem
from study.trajectory import Trajectory

STATIONS, LEAST = 800, 4
"""Stations at most on the whole path, but at least that many for each segment."""

COST = 3e-4
"""Processor time of the cone program for each station and joint, s; told beforehand, since nothing stops it."""


def stations_states(problem: Problem, path: Path, points: Floats) -> tuple[Floats, Floats]:
    """Times and states at stations.

    Parameters
    ----------
    problem : Problem
    path : Path
    points : array of shape (n_stations,)
        Path parameters, with the knots among them.

    Returns
    -------
    times : array of shape (n_stations,), s
    states : array of shape (n_stations, 3)
        Path parameter, speed and acceleration.
    """
    count = len(points)
    robot = copp.Robot(problem.n_joints, capacity=count)
    robot.append_s(points)
    about = path.at(points) * np.array([1.0, 1.0, 2.0, 6.0])[:, None]
    robot.set_q(
        *(np.ascontiguousarray(about[:, order]) for order in range(3)), 0, dddq=np.ascontiguousarray(about[:, 3])
    )
    velocity, acceleration, jerk = problem.limits.rates
    robot.add_velocity_limits(velocity, -velocity, start_idx_s=0, length=count)
    robot.add_acceleration_limits(acceleration, -acceleration, start_idx_s=0, length=count)
    second = copp.solver.topp2_ra
    reference = second.solve(
        second.Problem(robot.constraints, idx_s_interval=(0, count - 1), a_boundary=(0.0, 0.0)), second.Options()
    )
    robot.add_jerk_limits(jerk, -jerk, start_idx_s=0, length=count)
    third = copp.solver.topp3_socp
    profile = third.solve(third.Problem(robot.constraints, reference))
    _, times = copp.interpolation.s_to_t_topp3(points, profile)
    return np.asarray(times), np.stack([points, np.sqrt(np.maximum(profile.a, 0.0)), profile.b], axis=1)


def driven(path: Path, times: Floats, states: Floats, marks: Floats) -> Trajectory:
    """Drive a path through states at stations, quintic in time between them: exact, degree 15.

    Parameters
    ----------
    path : Path
    times : array of shape (n_stations,), s
    states : array of shape (n_stations, 3)
    marks : int array of shape (n_segments,)
        Stations per segment.
    """
    h = np.diff(times)
    (s0, v0, a0), (s1, v1, a1) = states[:-1].T, states[1:].T
    v0, v1, a0, a1, d = v0 * h, v1 * h, a0 * h**2, a1 * h**2, s1 - s0
    quintic = polynomial.hermite_quintic(d, v0, v1, a0, a1)
    along = np.stack([np.zeros_like(d), *quintic], axis=1)[:, None, :]
    result = polynomial.composed(np.moveaxis(path.at(states[:-1, 0]), 1, 2), along)
    powers = h[:, None] ** np.arange(result.shape[-1])
    return Trajectory.from_pieces(h, np.moveaxis(result / powers[:, None], 1, 2), marks)


@dataclass(frozen=True)
class Copp(Deterministic):
    """Planner `copp`: a fixed path from path rest to path rest under velocity, acceleration and jerk limits.

    The jerk limit is linearised once, about TOPP-RA's profile; more rounds gain less than a hundredth. Settings for a
    cubic spline try the clamped path of `toppra` and its natural one, and keep the faster motion; others the clamped.

    Parameters
    ----------
    per_segment : int
        Stations per segment, fewer where the path would have more than `STATIONS`.
    """

    per_segment: int = 20
    about: ClassVar[str] = "speed along a given path with a jerk limit, by cone programs (COPP)"
    freedom: ClassVar[Freedom] = Freedom.PATH

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Parameterize the path; the settings' curve and time limit matter."""
        if not np.isfinite(problem.limits.rates).all():
            return Plan(
                Status.NOT_APPLICABLE, message="COPP's third order needs velocity, acceleration and jerk limits"
            )
        stations = min(self.per_segment, max(LEAST, STATIONS // problem.n_segments))
        needed = COST * stations * problem.n_segments * problem.n_joints
        if needed > settings.time_limit:
            return Plan(
                Status.NOT_APPLICABLE,
                message=f"COPP cannot be stopped and needs about {needed:.2g} s here, more than the time limit",
            )
        return self._fastest(problem, settings, stations)

    def _fastest(self, problem: Problem, settings: RunSettings, stations: int) -> Plan:
        """Parameterize every path that there is time for, and keep the best motion."""
        deadline, plans, reason = Deadline.after(settings.time_limit), list[tuple[bool, float, Plan]](), ""
        paths = (chord_path, centripetal_path) if settings.curve.startswith("cubic-spline") else (chord_path,)
        for lay in paths:
            before = deadline.left()
            try:
                plans.append(_ranked(problem, lay, stations))
            except copp.CoppError as error:
                reason = f"COPP stopped: {error}"
            if lay is not paths[-1] and deadline.left() <= before - deadline.left():  # the next would take as long
                record_cut()
                break
        return min(plans, key=lambda ranked: ranked[:2])[2] if plans else Plan(Status.FAILED, message=reason)


def _ranked(problem: Problem, lay: PathRule, stations: int) -> tuple[bool, float, Plan]:
    """Motion along a path, stretched to its limits; whether the judge rejects it, and its duration, rank it."""
    path = lay(problem.waypoints, problem.limits)
    times, states = stations_states(problem, path, grid(path, stations))
    motion = driven(path, times, states, np.full(problem.n_segments, stations))
    stretch = judge(problem, motion).stretch
    slowed = motion.scaled(stretch)
    answer = Plan(Status.FINISHED, motion=slowed, details={"stretch": stretch, "stations": float(stations)})
    return not judge(problem, slowed).feasible, slowed.duration, answer
