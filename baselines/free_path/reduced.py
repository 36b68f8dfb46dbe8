"""Demands that come down to demands the interior point knows: a tube, and a duration with given rates at the ends.

A tube becomes points along the straight lines, each with a tolerance, and boxes around the steps between them. Where a
step is no longer than the radius in any joint, half of it and half the radius fit into the tube, whatever happens in
the box. Fewer points leave the motion more freedom; so they are tried first, and the judge decides.

With given rates at its ends a motion cannot be run more slowly. Where there is time for a stop on the way, it stops and
waits. Where there is not, the limits are tightened by a factor until the shortest motion takes as long as demanded.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from baselines.base import segment_rates
from baselines.free_path.question import Integers
from study.errors import StudyError
from study.judge import judge
from study.planning import Plan, Status
from study.problem import JointLimits, Problem
from study.trajectory import Trajectory

Solve = Callable[[Problem], Plan]

SHARES = (0.25, 0.5, 1.0)
"""Numbers of points along the lines that are tried, as shares of the number that is sure to do."""

MOST = 2000
"""Points along the lines of a tube at most."""

ROOM = 1.05
"""Limit over a rate given at an end, at least."""

SLOWEST = 100.0
"""Largest factor on the times in the limits that is tried."""

LEAST = 1e-3
"""Time for which a motion that waits does so at least, as a share of its duration."""

EXACT = 2e-7
"""Relative error of a duration that is left to a scaling of the whole motion, less than counts at its ends."""


def in_tube(problem: Problem, solve: Solve) -> Plan:
    """Plan in a tube by points along its lines; the first motion that stays inside is the answer.

    Parameters
    ----------
    problem : Problem
        Its path is a tube.
    solve : callable
        Plans without one.
    """
    plan = Plan(Status.FAILED, message="the tube is too narrow")
    for counts in _counts(problem):
        plan = solve(_along(problem, counts))
        if not isinstance(plan.motion, Trajectory):
            continue
        motion = replace(plan.motion, waypoint_times=plan.motion.waypoint_times[np.append(0, np.cumsum(counts))])
        plan, reasons = replace(plan, motion=motion), judge(problem, motion).reasons
        if not reasons:
            return plan
        plan = replace(plan, status=Status.FAILED, motion=None, message=f"in a tube: {'; '.join(reasons)}")
    return plan


def _counts(problem: Problem) -> Iterator[Integers]:
    """Numbers of steps along every line, shape (n_segments,), fewer first."""
    radius = problem.path.of(problem.n_joints) if problem.path is not None else np.ones(problem.n_joints)
    sure = np.ceil((np.abs(np.diff(problem.waypoints, axis=0)) / radius).max(axis=1))
    before: Integers | None = None
    for share in SHARES:
        share = min(share, MOST / sure.sum())
        counts = np.maximum(np.ceil(share * sure), 1).astype(int)
        if before is None or (counts != before).any():
            yield counts
        before = counts


def _along(problem: Problem, counts: Integers) -> Problem:
    """Points along the lines instead of the tube; boxes as ranges of positions, tolerances at the points."""
    radius = problem.path.of(problem.n_joints) if problem.path is not None else np.ones(problem.n_joints)
    first = np.concatenate([[0], np.cumsum(counts)])
    segment = np.repeat(np.arange(problem.n_segments), counts)
    place = (np.arange(first[-1]) - first[segment]) / counts[segment]
    step = np.diff(problem.waypoints, axis=0)
    points = np.concatenate([problem.waypoints[segment] + place[:, None] * step[segment], problem.waypoints[-1:]])
    room = np.maximum(radius / 2, radius - np.abs(step / counts[:, None]) / 2)
    tolerance = np.concatenate([room[segment], radius[None]])
    tolerance[first] = np.minimum(problem.tolerances, radius)
    lowest, highest = segment_rates(problem)
    limits = {}
    for k, line in enumerate(segment):
        own = [v for v in (problem.limits, problem.segment_limits.get(int(line))) if v is not None]
        low = np.maximum(np.minimum(points[k], points[k + 1]) - room[line], np.max([v.lower for v in own], axis=0))
        high = np.minimum(np.maximum(points[k], points[k + 1]) + room[line], np.min([v.upper for v in own], axis=0))
        velocity, acceleration, jerk = highest[:, line]
        limits[k] = JointLimits(velocity, acceleration, jerk, low, high, *lowest[:, line])
    stops = [int(first[k]) for k in problem.stops]
    dwells = {int(first[k]): time for k, time in problem.dwells.items()}
    return replace(
        problem, waypoints=points, tolerance=tolerance, segment_limits=limits, stops=stops, dwells=dwells, path=None
    )


def lasting(problem: Problem, solve: Solve) -> Plan:
    """Plan a motion with given rates at its ends that lasts as long as demanded.

    Parameters
    ----------
    problem : Problem
        Its ends move, and its duration is constrained.
    solve : callable
        Plans without such a constraint.
    """
    if problem.timing is None:
        return solve(problem)
    free = replace(problem, timing=None)
    plan = solve(free)
    if plan.motion is None:
        return plan
    try:
        wanted = plan.motion.duration * problem.timing.stretch(plan.motion.duration)
    except StudyError as error:
        return replace(plan, status=Status.FAILED, motion=None, message=str(error))
    for attempt in (_waiting, _slower):
        longer = attempt(free, solve, plan, wanted)
        if longer.motion is not None and abs(longer.motion.duration / wanted - 1) <= EXACT:
            return replace(longer, motion=longer.motion.scaled(wanted / longer.motion.duration))
    return replace(plan, status=Status.FAILED, motion=None, message=f"no motion of {wanted:.6g} s between these ends")


def _slower(problem: Problem, solve: Solve, plan: Plan, wanted: float) -> Plan:
    """Search for tighter limits under which the shortest motion takes as long as wanted; the nearest that was met."""
    plans = {1.0: plan}

    def late(factor: float) -> float:
        if factor not in plans:
            plans[factor] = solve(_tightened(problem, factor))
        error = _error(plans[factor], wanted)
        return 0.0 if abs(error) <= EXACT else error

    most = 1.0
    while late(most) < 0 and most < SLOWEST:
        most *= 1.5
    if late(most) >= 0:
        from scipy.optimize import brentq  # here: slow to import

        brentq(late, most / 1.5 if most > 1 else 1.0, most, xtol=1e-10, maxiter=40, disp=False)
    return min(plans.values(), key=lambda each: abs(_error(each, wanted)))


def _error(plan: Plan, wanted: float) -> float:
    """Relative excess of a duration over the one wanted; large where there is no motion."""
    return 1e3 if plan.motion is None else plan.motion.duration / wanted - 1


def _tightened(problem: Problem, factor: float) -> Problem:
    """Limits with all times longer by a factor, as far as the given rates at the ends allow."""
    zero = np.zeros(problem.n_joints)
    given = np.array([[zero if rate is None else rate for rate in (*end.rates, None)] for end in problem.end_states])

    def slower(limits: JointLimits) -> JointLimits:
        tight = limits.scaled(factor)
        velocity, acceleration, jerk = np.minimum(
            np.maximum(tight.highest_rates, ROOM * given.max(axis=0)), limits.highest_rates
        )
        lowest = np.maximum(np.minimum(tight.lowest_rates, ROOM * given.min(axis=0)), limits.lowest_rates)
        return JointLimits(velocity, acceleration, jerk, limits.lower, limits.upper, *lowest)

    by_segment = {k: slower(limits) for k, limits in problem.segment_limits.items()}
    return replace(problem, limits=slower(problem.limits), segment_limits=by_segment)


def _waiting(problem: Problem, solve: Solve, plan: Plan, wanted: float) -> Plan:
    """Stand still at the waypoint in the middle for as long as it takes; the plan itself where there is no time to."""
    if problem.n_waypoints < 3:
        return plan
    middle = problem.n_waypoints // 2
    dwell = problem.dwells.get(middle, LEAST * wanted)
    waiting = solve(replace(problem, dwells={**problem.dwells, middle: dwell}))
    if not isinstance(waiting.motion, Trajectory) or waiting.motion.duration > wanted:
        return plan
    motion, longer = waiting.motion, wanted - waiting.motion.duration
    piece = int(np.searchsorted(motion.knots, motion.waypoint_times[middle] + dwell / 2)) - 1
    knots, coefficients, times = motion.knots.copy(), motion.coefficients.copy(), motion.waypoint_times.copy()
    knots[piece + 1 :] += longer
    coefficients[piece, 1:] = 0.0
    times[middle + 1 :] += longer
    return replace(waiting, motion=Trajectory(knots, coefficients, times))
