"""The only judge: every motion of every method is measured here, exactly, before it may stand in a table."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import ref

import numpy as np

from study.arm_findings import Enclosure, arm_findings, enclosed
from study.arrays import of_kind
from study.errors import StudyError
from study.findings import Finding, Measured, findings_of
from study.limits import RATES
from study.path_findings import path_findings
from study.problem import Floats, Problem
from study.tolerances import TOLERANCE
from study.trajectory import Motion, Trajectory

__all__ = ["RATES", "TOLERANCE", "Verdict", "judge"]


@dataclass(frozen=True, eq=False)
class Verdict:
    """Result of checking a motion.

    Attributes
    ----------
    duration : float, s
    ratios : array of shape (3, n_joints)
        Largest share of the velocity, acceleration and jerk limits in use; 0 where there is no limit.
    peaks : array of shape (3, n_joints), rad/s^k or m/s^k
        Largest absolute values.
    times : array of shape (3, n_joints), s
        When the largest shares occur, or the peaks where there is no limit.
    segments : int array of shape (3, n_joints)
        Between which waypoints that is, counted from 0.
    position_excess : array of shape (n_joints,), rad or m
        How far the motion leaves the range of positions.
    waypoint_error : array of shape (n_joints,), rad or m
        Largest distance to a waypoint at the time it should be passed.
        Where the problem grants a tolerance, this may be as large.
    continuity : int
        Highest derivative that is continuous at every knot; -1 if the position itself jumps.
    end_velocity, end_acceleration : arrays of shape (2, n_joints)
        Rates at the first and last instant.
    overshoot : array of shape (n_joints,), rad or m
        How far the motion leaves the envelope of the waypoints.
    arm_shares : array of shape (2, n_joints + 2)
        Proved bounds, lower and upper, of the largest share of the limits of the arm in use: torques by joint, speed of the
        tool, its acceleration. They are apart by one part in a thousand at most where the motion keeps its limits; 0 where
        there is no limit.
    arm_times : array of shape (n_joints + 2,), s
        When the lower ones are reached.
    violation : float
        Largest relative excess of any kind; at most 1e-6 for a feasible motion.
    reasons : tuple of str
        One sentence for each kind of violation; empty for a feasible motion.
    """

    duration: float
    ratios: Floats
    peaks: Floats
    times: Floats
    segments: np.ndarray
    position_excess: Floats
    waypoint_error: Floats
    continuity: int
    end_velocity: Floats
    end_acceleration: Floats
    overshoot: Floats
    arm_shares: Floats
    arm_times: Floats
    violation: float
    reasons: tuple[str, ...]

    @property
    def feasible(self) -> bool:
        """Whether every demand of the problem is met."""
        return not self.reasons

    @property
    def worst_ratio(self) -> float:
        """Largest share of any limit in use, of rates or of the arm."""
        return float(max(self.ratios.max(), self.arm_shares[1].max()))

    @property
    def least_scale(self) -> float:
        """Factor of all times at which the motion touches a limit of rates; below 1 where it may be run faster."""
        return float((self.ratios.max(axis=1) ** (1.0 / np.arange(1, 4))).max())

    @property
    def stretch(self) -> float:
        """Slow-down factor, at least 1, after which the motion keeps every limit of rates; time scaling is exact."""
        return max(1.0, self.least_scale)


def judge(problem: Problem, motion: Motion) -> Verdict:
    """Measure a motion against a problem with exact extrema, not samples.

    A step in velocity needs infinite acceleration and a step in acceleration infinite jerk, so each breaks a finite limit
    of that kind; where the problem gives no such limit, the step is allowed. At both ends only the problem's own demands
    count, and a rate that may step inside may step there: a joint without acceleration limit leaves rest in
    no time, and one without jerk limit reaches full acceleration in no time. What is not finite, not in order or not there
    is a reason, never a pass.

    Parameters
    ----------
    problem : Problem
    motion : Motion

    Returns
    -------
    Verdict

    Raises
    ------
    StudyError
        If there is no motion, or it has another number of joints or of waypoints than the problem.
    """
    of_kind(problem, Problem, "problem")
    if not isinstance(motion, Motion):
        raise StudyError(f"case {problem.name!r}: there is no motion to judge, but a {type(motion).__name__}")
    n_passed = len(motion.waypoint_times)
    if motion.n_joints != problem.n_joints or n_passed != problem.n_waypoints:
        raise StudyError(
            f"case {problem.name!r}: the motion must have {problem.n_joints} joints and pass {problem.n_waypoints} waypoints, "
            f"it has {motion.n_joints} and {n_passed}"
        )
    if (known := _recent(problem, motion)) is not None:
        return known
    with np.errstate(over="ignore", invalid="ignore"):  # what is not finite becomes a finding
        measured = Measured(problem, motion)
        arm = enclosed(problem.arm, motion)
        findings = [*findings_of(measured), *path_findings(measured), *arm_findings(problem, arm)]
        verdict = _verdict(measured, arm, findings)
    if isinstance(motion, Trajectory):  # which never changes
        _LAST[:] = [(ref(problem), ref(motion), verdict)]
    return verdict


_LAST: list[tuple[ref[Problem], ref[Trajectory], Verdict]] = []
"""The last verdict: a planner judges its motion before it hands it over, and whoever asked for it judges it again."""


def _recent(problem: Problem, motion: Motion) -> Verdict | None:
    """The verdict where this very motion was judged last, on this very problem."""
    return next((verdict for p, m, verdict in _LAST[:] if p() is problem and m() is motion), None)


def _verdict(measured: Measured, arm: Enclosure, findings: list[Finding]) -> Verdict:
    problem, motion, position = measured.problem, measured.motion, measured.position
    low, high = problem.waypoints.min(axis=0), problem.waypoints.max(axis=0)
    outside = np.maximum(problem.limits.lower - position.lowest, position.highest - problem.limits.upper)
    smooth = [
        bool((step <= TOLERANCE * scale).all()) for step, scale in zip(measured.steps, measured.scales, strict=True)
    ]
    segments = np.searchsorted(measured.passed, measured.times, side="right") - 1
    excesses = np.nan_to_num([0.0, *(finding.excess for finding in findings)], nan=np.inf, posinf=np.inf)
    return Verdict(
        duration=motion.duration,
        ratios=measured.ratios,
        peaks=np.stack([extrema.peak for extrema in measured.extrema[1:]]),
        times=measured.times,
        segments=np.clip(segments, 0, problem.n_segments - 1),
        position_excess=np.maximum(outside, 0.0),
        waypoint_error=measured.errors.max(axis=0),
        continuity=int(np.argmin([*smooth, False])) - 1,
        end_velocity=measured.ends[0],
        end_acceleration=measured.ends[1],
        overshoot=np.maximum(np.maximum(low - position.lowest, position.highest - high), 0.0),
        arm_shares=np.stack([arm.lowest, arm.highest]),
        arm_times=arm.times,
        violation=float(excesses.max()),
        reasons=tuple(finding.sentence for finding in findings if finding.broken),
    )
