"""Global optimum of 3-5-3 problems, with a proven lower bound, by branch and bound over two duration ratios.

Of B-splines and short clamped cubic splines the NLP's answer is enclosed too, less tightly: the first by a linear
programme from velocity limits (`bspline_curve.velocity_bound`), the second by branch and bound over durations
(`cubic_spline`).

The upper bound is a motion that is exactly feasible: the NLP's, or better where the middle of a box is better. The
lower bound needs neither the NLP nor the upper bound to be good; see `poly353` for the proof and for rounding.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from baselines.base import Deterministic, longest, parts, where_something_moves
from baselines.bounds.branch_bound import Enclosure, enclose
from baselines.bounds.cubic_spline import shortest_durations, spline_bound
from baselines.bounds.poly353 import Bounds353
from baselines.segment_times.bspline_curve import velocity_bound
from baselines.segment_times.nlp import optimise
from study.curves import curve_named
from study.deadline import Deadline
from study.formulation import Scaled
from study.planning import Freedom, Plan, RunSettings, Status
from study.problem import Floats, Problem

GAP = 1e-6
"""Relative distance between upper and lower bound at which the search ends."""

MOST_BOXES = 500_000
MOST_SEGMENTS = 6
"""Of a cubic spline: every segment is a dimension of the boxes."""

SHORT = 1e-3
"""Smallest share of the longest duration that a cubic spline's segment may take."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """Proven bounds on the shortest total time of one problem, and durations that reach the upper one.

    Attributes
    ----------
    lower, upper : float, s
    durations : array of shape (3,), s
    boxes : int
    finished : bool
        Whether the gap is at most 1e-6 of the upper bound.
    """

    lower: float
    upper: float
    durations: Floats
    boxes: int
    finished: bool


def obstacle(problem: Problem, curve: str) -> str:
    """Why no certificate can be had; empty where it can."""
    if curve == "bspline":
        return ""
    if curve == "cubic-spline":
        return _spline_obstacle(problem)
    if curve != "poly353":
        return f"only poly353, bspline and cubic-spline problems are certified, the curve is {curve}"
    if problem.n_waypoints != 4:
        return f"the 3-5-3 curve needs exactly 4 waypoints, got {problem.n_waypoints}"
    if problem.duration_bounds[0] == 0 and not np.diff(problem.waypoints, axis=0).any(axis=1).all():
        return "a segment in which nothing moves may shrink to nothing; give a positive lower bound on durations"
    moves = np.ptp(problem.waypoints, axis=0) > 0
    if np.isinf(problem.limits.rates[:, moves]).all(axis=0).any():
        return "a joint that moves has no limit"
    return ""


def _spline_obstacle(problem: Problem) -> str:
    if problem.n_segments > MOST_SEGMENTS:
        return f"cubic splines of at most {MOST_SEGMENTS} segments are certified, here there are {problem.n_segments}"
    shortest = shortest_durations(problem)
    if shortest.min() < SHORT * max(shortest.max(), problem.duration_bounds[1]):
        return "a segment may shrink to almost nothing; give velocity limits and a larger lower bound on durations"
    return ""


def enclose_curve(problem: Problem, curve: str, *, seed: int, time_limit: float, deadline: Deadline) -> Certificate:
    """Enclose the shortest total time on any curve for which `obstacle` is empty, all joints together.

    Only for 3-5-3 curves is the gap always closed; the others keep one, which is stated.

    Parameters
    ----------
    problem : Problem
    curve : str
    seed : int
        Of the NLP's starts.
    time_limit : float, s
        This problem's share.
    deadline : Deadline
        Of all shares: after it the NLP is left out and boxes are not cut any more. Both
        bounds hold all the same.

    Raises
    ------
    StudyError
        If the curve does not fit the waypoints.
    """
    if deadline.passed():
        time_limit = 0.0
    if curve == "poly353":
        return certify(problem, seed=seed, time_limit=time_limit)
    durations = _optimum(problem, curve, seed, time_limit)
    if not np.isfinite(durations).all():
        durations = Scaled(problem, curve_named(curve)).durations(np.ones((1, problem.n_segments)))[0]
    upper = float(durations.sum())
    if curve == "bspline":
        lower, boxes = velocity_bound(problem), 1
    else:
        lower, boxes = spline_bound(problem, upper, deadline=deadline)
    return Certificate(lower, upper, durations, boxes, upper <= lower * (1 + GAP))


def certify(problem: Problem, *, seed: int = 0, time_limit: float = 60.0) -> Certificate:
    """Enclose the shortest total time of a 3-5-3 problem, all joints together.

    Parameters
    ----------
    problem : Problem
        For which `obstacle` is empty.
    seed : int
        Of the NLP's starts.
    time_limit : float, s

    Returns
    -------
    Certificate

    Raises
    ------
    StudyError
        If there are not four waypoints.
    """
    deadline = Deadline.after(time_limit)
    bounds, scaled = Bounds353(problem), Scaled(problem, curve_named("poly353"))
    durations = _reachable(problem, scaled, seed, time_limit)
    upper = float(durations.sum())

    def value(points: Floats) -> Floats:
        return scaled(bounds.durations(points))

    enclosure: Enclosure = enclose(bounds, value, bounds.box(upper), upper, gap=GAP, deadline=deadline, most=MOST_BOXES)
    if enclosure.point is not None:
        durations = scaled.durations(bounds.durations(enclosure.point[None]))[0]
    return Certificate(enclosure.lower, float(durations.sum()), durations, enclosure.boxes, enclosure.finished)


def _reachable(problem: Problem, scaled: Scaled, seed: int, time_limit: float) -> Floats:
    """Feasible durations: the NLP's answer, or equal ones where it has none."""
    answer = _optimum(problem, "poly353", seed, time_limit / 2)
    candidate = answer if np.isfinite(answer).all() else np.ones(3)
    return np.asarray(scaled.durations(candidate[None])[0])


def _optimum(problem: Problem, curve: str, seed: int, time_limit: float) -> Floats:
    """Durations of the NLP, infinite where it has none or no time."""
    if time_limit <= 0:
        return np.full(problem.n_segments, np.inf)
    return optimise(problem, curve, seed=seed, time_limit=time_limit).durations


@dataclass(frozen=True)
class Certified(Deterministic):
    """Planner `certified`."""

    about: ClassVar[str] = "the global optimum on the curve by branch and bound, with a proof"
    freedom: ClassVar[Freedom] = Freedom.CURVE

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Certify all joints together, or each alone and then take the longest duration of every segment.

        The bounds belong to the shared problem, or are the largest of the joints' own: no motion of all joints is
        shorter than the slowest joint alone.
        """
        problems, deadline = parts(problem, settings), Deadline.after(settings.time_limit)
        reason = next((text for text in (obstacle(part, settings.curve) for part in problems) if text), "")
        if reason:
            return Plan(Status.NOT_APPLICABLE, message=reason)
        share, seed = settings.time_limit / len(problems), settings.seed
        certificates = [
            enclose_curve(part, settings.curve, seed=seed, time_limit=share, deadline=deadline) for part in problems
        ]
        durations = longest(part.durations for part in certificates)
        finished = all(part.finished for part in certificates)
        gap = max(part.upper / part.lower - 1 if part.lower else np.inf for part in certificates)
        boxes = sum(part.boxes for part in certificates)
        return Plan(
            Status.FINISHED if finished else Status.NOT_CONVERGED,
            motion=curve_named(settings.curve).motion(problem.waypoints, durations),
            durations=durations,
            iterations=boxes,
            message="" if finished else f"both bounds hold, but they are {gap:.2g} of the time apart",
            lower_bound=max(part.lower for part in certificates),
            details={
                "upper_bound": max(part.upper for part in certificates),
                "boxes": float(boxes),
            },
        )
