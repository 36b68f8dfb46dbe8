"""TOPP-RA: time-optimal speed along a given path under velocity and acceleration limits.

Two paths are tried, both cubic splines through the waypoints, and the faster motion stays. The parameter of the clamped
spline grows from waypoint to waypoint by the distance between them, every joint measured in units of its velocity
limit; q'(s) is zero at both ends, so the joints are at rest there whatever the path speed, and the largest that the
limits allow is taken. The parameter of the natural spline grows by the root of that distance; its path speed starts and
ends at zero.

References
----------
E. T. Y. Lee, Choosing nodes in parametric curve interpolation, Computer-Aided Design 21(6), 1989.
H. Pham, Q.-C. Pham, A new approach to time-optimal path parameterization based on reachability analysis, IEEE
Transactions on Robotics 34(3), 2018.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
from toppra import algorithm, constraint

from baselines.base import Deterministic, where_something_moves
from baselines.path_timing.arm_limits import ArmConstraint, SpeedLaw, held
from baselines.path_timing.path import Path, PathRule, centripetal_path, chord_path, compose, grid, roomy_path
from study.deadline import Deadline, record_cut
from study.demands import ARM
from study.judge import judge
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status
from study.problem import Demand, Floats, JointLimits, Problem
from study.slowing import slow_down
from study.tolerances import TOLERANCE
from study.trajectory import Trajectory

GRID, LEAST_STEPS = 4000, 2
"""Grid steps at most on the whole path at first, but at least between neighbours, however many waypoints there are."""

BEFORE = 1e-7
"""Distance of a gridpoint before a knot, as a share of the segment."""

UNLIMITED = 1e9
"""Substitute for an infinite limit, in units of the joint's own scale: TOPP-RA needs finite numbers."""


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


def path_speeds(
    path: Path, limits: JointLimits, points: Floats, further: tuple[constraint.Constraint, ...] = ()
) -> Floats | None:
    """Largest path speed at every gridpoint, shape (n_gridpoints,); None where TOPP-RA finds none.

    Further constraints are held along a path that is not clamped.
    """
    both = np.stack([limits.lowest_rates, limits.highest_rates], axis=2)
    both = np.where(np.isfinite(both), both, np.sign(both) * UNLIMITED)
    acceleration = np.abs(both[1]).min(axis=1)
    wanted = [constraint.JointVelocityConstraint(both[0]), constraint.JointAccelerationConstraint(both[1])]
    if not path.clamped:
        return speeds_from_rest(path, [*wanted, *further], points)
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


def speeds_from_rest(path: Path, wanted: list[constraint.Constraint], points: Floats) -> Floats | None:
    """Largest path speeds from zero to zero, shape (n_gridpoints,); None where TOPP-RA finds none."""
    solver = algorithm.TOPPRA(wanted, _PathForToppra(path, points[[0, -1]]), gridpoints=points, solver_wrapper="seidel")
    _, speeds, _ = solver.compute_parameterization(0.0, 0.0)
    stands = speeds is None or not np.isfinite(speeds).all() or (speeds[1:-1] <= 0).any()
    return None if stands else speeds


def end_speeds(path: Path, acceleration: Floats, points: Floats) -> tuple[float, float]:
    """Largest constant path speeds over the first and the last grid step.

    At constant path speed v the acceleration is q'' v^2, and q'' is linear in the step. TOPP-RA itself is not asked
    about the two end points: with q' = 0 the path acceleration is unbounded there, and its linear programs degenerate.
    """
    about = path.at(points[[0, 1, -2, -1]])
    with np.errstate(divide="ignore"):
        squares = (acceleration / np.abs(2 * about[:, 2])).min(axis=1)
    return float(np.sqrt(squares[:2].min())), float(np.sqrt(squares[2:].min()))


def driven(problem: Problem, per_segment: int, lay: PathRule) -> Trajectory | None:
    """Drive a path with the limits held at gridpoints only; None where TOPP-RA finds no speeds."""
    fresh = np.append(True, (np.diff(problem.waypoints, axis=0) != 0).any(axis=1))
    path = lay(problem.waypoints[fresh], problem.limits)
    points = grid(path, per_segment)
    # TOPP-RA looks to the right of a gridpoint; where q'' steps, it is shown a second one, just before.
    before = (
        path.knots[1:-1] - BEFORE * np.diff(path.knots[:-1]) if path.rough and problem.arm is None else path.knots[:0]
    )
    shown = np.sort(np.concatenate([points, before]))

    def law(*further: ArmConstraint) -> SpeedLaw | None:
        speeds = path_speeds(path, problem.limits, shown, further)
        if speeds is None:
            return None
        speeds = speeds[np.searchsorted(shown, points)]
        durations, coefficients = compose(path, points, speeds)
        return Trajectory.from_pieces(durations, coefficients, np.where(fresh[1:], per_segment, 0)), speeds

    if problem.arm is not None and not path.clamped:
        return held(problem.arm, law)
    free = law()
    return None if free is None else free[0]


@dataclass(frozen=True, eq=False)
class Retimed:
    """A motion along a path, stretched by the exact factor that the limits between gridpoints still need.

    Attributes
    ----------
    stretch : float
        The factor, at least 1.
    leaves : bool
        Whether the path leaves the range of positions.
    """

    motion: Trajectory
    stretch: float
    leaves: bool
    lay: PathRule

    @property
    def rank(self) -> tuple[bool, float]:
        """Inside the range of positions first, then the shorter."""
        return self.leaves, self.motion.duration


def stretched(problem: Problem, motion: Trajectory, lay: PathRule) -> Retimed:
    """Judge a motion along a path and stretch it until it keeps all limits but those of jerk."""
    verdict = judge(without_jerk(problem), motion)
    leaves = bool(verdict.position_excess.max() > TOLERANCE)
    stretch = verdict.stretch
    if problem.arm is not None:
        stretch *= slow_down(problem.arm, motion.scaled(stretch))
    return Retimed(motion.scaled(stretch), stretch, leaves, lay)


def retime(problem: Problem, per_segment: int, lay: PathRule = chord_path) -> Retimed | None:
    """Retime a path as fast as the velocity and acceleration limits allow; None where TOPP-RA finds no speeds."""
    motion = driven(problem, per_segment, lay)
    return None if motion is None else stretched(problem, motion, lay)


def fastest(problem: Problem, per_segment: int, rules: tuple[PathRule, ...], deadline: Deadline) -> Retimed | None:
    """Retime along several paths and keep the best; a motion that is too slow before its stretch is not judged."""
    raw: list[tuple[Trajectory, PathRule]] = []
    for lay in rules:
        motion = None if raw and deadline.passed() else driven(problem, per_segment, lay)
        raw += [] if motion is None else [(motion, lay)]
    best: Retimed | None = None
    for motion, lay in sorted(raw, key=lambda pair: pair[0].duration):
        if best is None or best.leaves or motion.duration < best.motion.duration:
            retimed = stretched(problem, motion, lay)
            best = retimed if best is None else min(best, retimed, key=lambda each: each.rank)
    return best


def without_jerk(problem: Problem) -> Problem:
    """Drop the jerk limits, which no motion of TOPP-RA keeps, however slow."""
    limits = problem.limits
    free = np.full(problem.n_joints, np.inf)
    return replace(problem, limits=replace(limits, jerk=free, min_jerk=-free))


@dataclass(frozen=True)
class Toppra(Deterministic):
    """Planner `toppra`: the fastest way along a cubic spline through the waypoints.

    Settings for one of the papers' curves keep the clamped spline; `cubic-spline` tries the natural one, too. The
    acceleration steps, so under a jerk limit the motion is not feasible, however slowly it is driven.

    Parameters
    ----------
    per_segment : int
        Grid steps between neighbouring waypoints, fewer where the path would have more than `steps`; doubled up to
        twice while the stretch is more than `worst_stretch` and the time limit allows.
    worst_stretch : float
    steps : int
    rules : tuple of callables
        Ways to lay the path.
    """

    per_segment: int = 200
    worst_stretch: float = 1.001
    steps: int = GRID
    rules: tuple[PathRule, ...] = (chord_path, centripetal_path)
    about: str = "TOPP-RA: the fastest speed along a given path, without a jerk limit"
    freedom: ClassVar[Freedom] = Freedom.PATH
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS - {Demand.JERK} | {Demand.DIRECTIONAL_LIMITS} | ARM

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Retime the path; the settings' curve and time limit matter."""
        heavy = problem.arm is not None and problem.arm.forbids_steps
        if not (np.isfinite(problem.limits.acceleration).any() or heavy):
            return Plan(Status.NOT_APPLICABLE, message="no acceleration limit: the path speed could step")
        rules = self.rules if settings.curve == "cubic-spline" else (chord_path,)
        rules = rules if problem.arm is None else (centripetal_path,)
        retimed = self._refined(problem, rules, Deadline.after(settings.time_limit))
        if retimed is None:
            return Plan(Status.FAILED, message="TOPP-RA finds no path speeds")
        steps = len(retimed.motion.knots) - 1.0
        return Plan(Status.FINISHED, motion=retimed.motion, details={"stretch": retimed.stretch, "grid_steps": steps})

    def _refined(self, problem: Problem, rules: tuple[PathRule, ...], deadline: Deadline) -> Retimed | None:
        per_segment = min(
            self.per_segment, max(LEAST_STEPS if self.steps == GRID else 1, self.steps // problem.n_segments)
        )
        best: Retimed | None = None
        for steps in (per_segment, 2 * per_segment, 4 * per_segment):
            before = deadline.left()
            again = fastest(problem, steps, rules if best is None else (best.lay,), deadline)
            best = min((each for each in (best, again) if each), key=lambda each: each.rank, default=None)
            if best is not None and best.stretch <= self.worst_stretch:
                break
            if deadline.left() <= 2 * (before - deadline.left()):  # twice the grid takes twice the time
                record_cut()
                break
        return best


QUICK = Toppra(
    worst_stretch=1.1,
    steps=90,
    rules=(roomy_path,),
    about="TOPP-RA on few gridpoints of one natural spline, without a jerk limit",
)
"""Planner `toppra-quick`, for milliseconds."""
