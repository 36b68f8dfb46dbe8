"""TOPP-RA: time-optimal speed along a given path under velocity and acceleration limits.

The path is the clamped cubic spline through the waypoints. Its parameter grows by the chord rule: from waypoint to
waypoint by the distance between them, every joint measured in units of its velocity limit. As the spline is clamped,
q'(s) is zero at both ends, so the joints are at rest there whatever the path speed; the path speed at the ends is
therefore free, and the largest that the limits allow is taken.

References
----------
H. Pham, Q.-C. Pham, A new approach to time-optimal path parameterization based on reachability analysis, IEEE
Transactions on Robotics 34(3), 2018.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from toppra import algorithm, constraint

from baselines.base import Deterministic, where_something_moves
from study import polynomial
from study.curves import cubic_spline
from study.deadline import Deadline
from study.judge import judge
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status
from study.problem import Demand, Floats, JointLimits, Problem
from study.trajectory import Trajectory

UNLIMITED = 1e9
"""What stands for an infinite limit, in units of the joint's own scale: TOPP-RA needs finite numbers."""


@dataclass(frozen=True, eq=False)
class Path:
    """A clamped cubic spline q(s) through waypoints.

    Attributes
    ----------
    knots : array of shape (n_segments + 1,)
        Path parameter at the waypoints, from 0.
    cubics : array of shape (n_segments, 4, n_joints)
        Ascending powers of the parameter since the segment's start.
    """

    knots: Floats
    cubics: Floats

    def at(self, s: Floats) -> Floats:
        """Cubics rewritten about given parameters, shape (n, 4, n_joints)."""
        segment = np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.cubics) - 1)
        ascending = np.moveaxis(self.cubics[segment], 1, 2)
        return np.moveaxis(polynomial.shifted(ascending, (s - self.knots[segment])[:, None]), 2, 1)


def chord_path(waypoints: Floats, limits: JointLimits) -> Path:
    """Lay the clamped cubic spline through distinct neighbouring waypoints.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    limits : JointLimits
        Joints are measured by their velocity limits, or by the next limit that is finite.
    """
    unit = np.array([next((rate for rate in joint if np.isfinite(rate)), 1.0) for joint in limits.rates.T])
    chords = np.linalg.norm(np.diff(waypoints, axis=0) / unit, axis=1)
    cubics = np.moveaxis(cubic_spline.unit_coefficients(waypoints, chords[None])[0], 1, 2)
    return Path(np.concatenate([[0.0], np.cumsum(chords)]), cubics / chords[:, None, None] ** np.arange(4)[:, None])


def grid(path: Path, per_segment: int) -> Floats:
    """Grid of the path parameter with every knot on it, shape (n_segments * per_segment + 1,)."""
    inner = [np.linspace(a, b, per_segment, endpoint=False) for a, b in zip(path.knots, path.knots[1:], strict=False)]
    return np.append(np.concatenate(inner), path.knots[-1])


class _PathForToppra:
    """The path as TOPP-RA wants to see it."""

    def __init__(self, path: Path, interval: Floats) -> None:
        self._path = path
        self.dof = path.cubics.shape[2]
        self.path_interval = interval
        self.waypoints = None

    def __call__(self, s: Floats, order: int = 0) -> Floats:
        taylor = self._path.at(np.atleast_1d(s))[:, order] * (1.0, 1.0, 2.0, 6.0)[order]
        return taylor if np.ndim(s) else taylor[0]


def path_speeds(path: Path, limits: JointLimits, points: Floats) -> Floats | None:
    """Largest path speed at every gridpoint, shape (n_gridpoints,); None where TOPP-RA finds none."""
    velocity = np.where(np.isfinite(limits.velocity), limits.velocity, UNLIMITED)
    acceleration = np.where(np.isfinite(limits.acceleration), limits.acceleration, UNLIMITED)
    wanted = [
        constraint.JointVelocityConstraint(np.stack([-velocity, velocity], axis=1)),
        constraint.JointAccelerationConstraint(np.stack([-acceleration, acceleration], axis=1)),
    ]
    first, last = end_speeds(path, acceleration, points)
    solver = algorithm.TOPPRA(
        wanted, _PathForToppra(path, points[[1, -2]]), gridpoints=points[1:-1], solver_wrapper="seidel"
    )
    controllable = solver.compute_controllable_sets(0.0, last)
    if np.isnan(controllable).any() or controllable[0, 0] > first**2:
        return None
    solver.compute_controllable_sets = lambda _low, _high: controllable
    _, speeds, _ = solver.compute_parameterization(min(float(np.sqrt(controllable[0, 1])), first), last)
    if speeds is None or not np.isfinite(speeds).all():
        return None
    return np.concatenate([speeds[:1], speeds, speeds[-1:]])


def end_speeds(path: Path, acceleration: Floats, points: Floats) -> tuple[float, float]:
    """Largest constant path speeds over the first and the last grid step.

    At constant path speed v the acceleration is q'' v^2, and q'' is linear in the step. TOPP-RA itself is not asked about
    the two end points: with q' = 0 the path acceleration is unbounded there, and its linear programs degenerate.
    """
    about = path.at(points[[0, 1, -2, -1]])
    with np.errstate(divide="ignore"):
        squares = (acceleration / np.abs(2 * about[:, 2])).min(axis=1)
    return float(np.sqrt(squares[:2].min())), float(np.sqrt(squares[2:].min()))


def compose(path: Path, points: Floats, speeds: Floats) -> tuple[Floats, Floats]:
    """Drive a path with constant path acceleration between gridpoints.

    Returns
    -------
    durations : array of shape (n_gridpoints - 1,), s
    coefficients : array of shape (n_gridpoints - 1, 7, n_joints)
        The cubic of the path in the quadratic s(t): exact, degree 6.
    """
    steps = np.diff(points)
    durations = 2 * steps / (speeds[:-1] + speeds[1:])
    s = np.stack([np.zeros_like(steps), speeds[:-1], np.diff(speeds) / durations / 2], axis=1)[:, None, :]
    driven = polynomial.composed(np.moveaxis(path.at(points[:-1]), 1, 2), s)
    return durations, np.moveaxis(driven, 1, 2)


def retime(problem: Problem, per_segment: int) -> tuple[Trajectory, float] | None:
    """Retime the chord path as fast as the velocity and acceleration limits allow.

    TOPP-RA holds the limits at gridpoints only, so the result is stretched by the exact factor that they still need.

    Returns
    -------
    trajectory : Trajectory
    stretch : float
        The factor, at least 1.
    """
    fresh = np.append(True, (np.diff(problem.waypoints, axis=0) != 0).any(axis=1))
    path = chord_path(problem.waypoints[fresh], problem.limits)
    points = grid(path, per_segment)
    speeds = path_speeds(path, problem.limits, points)
    if speeds is None:
        return None
    durations, coefficients = compose(path, points, speeds)
    motion = Trajectory.from_pieces(durations, coefficients, np.where(fresh[1:], per_segment, 0))
    stretch = judge(without_jerk(problem), motion).stretch
    return motion.scaled(stretch), stretch


def without_jerk(problem: Problem) -> Problem:
    """Drop the jerk limits, which no motion of TOPP-RA keeps, however slow."""
    limits = problem.limits
    free = np.full(problem.n_joints, np.inf)
    return replace(problem, limits=replace(limits, jerk=free, min_jerk=-free))


@dataclass(frozen=True)
class Toppra(Deterministic):
    """Planner `toppra`: the fastest way along the clamped cubic spline through the waypoints.

    Its acceleration steps, so under a jerk limit its motion is not feasible, however slowly it is driven.

    Parameters
    ----------
    per_segment : int
        Grid steps between neighbouring waypoints; doubled up to twice while the stretch is more than `worst_stretch`.
    worst_stretch : float
    """

    per_segment: int = 200
    worst_stretch: float = 1.001
    about: ClassVar[str] = "TOPP-RA: the fastest speed along a given path, without a jerk limit"
    freedom: ClassVar[Freedom] = Freedom.PATH
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS - {Demand.JERK}

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Retime the path; only the settings' time limit matters."""
        if not np.isfinite(problem.limits.acceleration).any():
            return Plan(Status.NOT_APPLICABLE, message="no acceleration limit: the path speed could step")
        deadline, retimed = Deadline.after(settings.time_limit), None
        for per_segment in (self.per_segment, 2 * self.per_segment, 4 * self.per_segment):
            retimed = retime(problem, per_segment) or retimed
            if (retimed and retimed[1] <= self.worst_stretch) or deadline.passed():
                break
        if retimed is None:
            return Plan(Status.FAILED, message="TOPP-RA finds no path speeds")
        motion, stretch = retimed
        return Plan(Status.FINISHED, motion=motion, details={"stretch": stretch, "grid_steps": len(motion.knots) - 1.0})
