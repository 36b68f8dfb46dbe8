"""The only judge: every motion of every method is measured here, exactly, before it may stand in a table."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from study.errors import StudyError
from study.limits import RATES
from study.problem import EndCondition, Floats, Problem
from study.trajectory import Extrema, Motion

TOLERANCE = 1e-6
"""Largest relative excess over a limit that still counts as rounding."""

__all__ = ["RATES", "TOLERANCE", "Verdict", "judge"]


@dataclass(frozen=True, eq=False)
class Verdict:
    """What the judge found.

    Attributes
    ----------
    duration : float, s
    ratios : array of shape (3, n_joints)
        Peak velocity, acceleration and jerk over their limits; 0 where there is no limit.
    peaks : array of shape (3, n_joints), rad/s^k or m/s^k
    times : array of shape (3, n_joints), s
        When the peaks occur.
    segments : int array of shape (3, n_joints)
        Between which waypoints they occur, counted from 0.
    position_excess : array of shape (n_joints,), rad or m
        How far the motion leaves the range of positions.
    waypoint_error : array of shape (n_joints,), rad or m
        Largest distance to a waypoint at the time it should be passed.
    continuity : int
        Highest derivative that is continuous at every knot; -1 if the position itself jumps.
    end_velocity, end_acceleration : arrays of shape (2, n_joints)
        Rates at the first and last instant.
    overshoot : array of shape (n_joints,), rad or m
        How far the motion leaves the envelope of the waypoints.
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
    violation: float
    reasons: tuple[str, ...]

    @property
    def feasible(self) -> bool:
        """Whether every demand of the problem is met."""
        return not self.reasons

    @property
    def worst_ratio(self) -> float:
        """Largest share of any rate limit in use."""
        return float(self.ratios.max())

    @property
    def stretch(self) -> float:
        """Slow-down factor, at least 1, after which the motion keeps every limit of rates; time scaling is exact."""
        return max(1.0, float((self.ratios.max(axis=1) ** (1.0 / np.arange(1, 4))).max()))


@dataclass(frozen=True)
class _Finding:
    excess: float
    sentence: str

    @property
    def broken(self) -> bool:
        """Whether the demand is not met; an excess that is not a number counts as broken."""
        return not self.excess <= TOLERANCE


def judge(problem: Problem, motion: Motion) -> Verdict:
    """Measure a motion against a problem with exact extrema, not samples.

    A step in velocity needs infinite acceleration and a step in acceleration infinite jerk, so each breaks a finite limit
    of that kind; where the problem gives no such limit, the step is allowed. At both ends only the problem's end
    condition counts, and a rate that may step inside may step there: a joint without acceleration limit leaves rest in
    no time, and one without jerk limit reaches full acceleration in no time.

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
        If the motion has another number of joints or of waypoints than the problem.
    """
    n_passed = len(motion.waypoint_times)
    if motion.n_joints != problem.n_joints or n_passed != problem.n_waypoints:
        raise StudyError(
            f"case {problem.name!r}: the motion must have {problem.n_joints} joints and pass {problem.n_waypoints} waypoints, "
            f"it has {motion.n_joints} and {n_passed}"
        )
    with np.errstate(over="ignore", invalid="ignore"):  # what is not finite becomes a finding
        return _measured(problem, motion)


def _measured(problem: Problem, motion: Motion) -> Verdict:
    passed = motion.waypoint_times
    position, *rates = [motion.extrema(order) for order in range(4)]
    peaks = np.stack([rate.peak for rate in rates])
    times = np.stack([rate.at_peak for rate in rates])
    low, high = problem.waypoints.min(axis=0), problem.waypoints.max(axis=0)
    ends = [motion(np.array([0.0, motion.duration]), order) for order in (1, 2)]
    error = np.abs(motion(_spanning(passed, motion.duration)) - problem.waypoints).max(axis=0)
    outside = np.maximum(problem.limits.lower - position.lowest, position.highest - problem.limits.upper)
    ratios = _ratios(problem, rates)
    steps = [np.abs(motion.jumps(order)).max(axis=0, initial=0.0) for order in range(3)]
    scales = _scales(problem, peaks)
    findings = [
        *_finite_findings(problem, motion.duration, np.stack([position.peak, *peaks]), [error, *steps, *ends]),
        *_time_findings(passed, motion.duration),
        *_rate_findings(problem, ratios, times),
        *_waypoint_findings(problem, error),
        *_step_findings(problem, steps, scales),
        *_end_findings(problem, ends, scales),
        *_position_findings(problem, outside),
    ]
    smooth = [bool((step <= TOLERANCE * scale).all()) for step, scale in zip(steps, scales, strict=True)]
    return Verdict(
        duration=motion.duration,
        ratios=ratios,
        peaks=peaks,
        times=times,
        segments=np.clip(np.searchsorted(passed, times, side="right") - 1, 0, problem.n_segments - 1),
        position_excess=np.maximum(outside, 0.0),
        waypoint_error=error,
        continuity=int(np.argmin([*smooth, False])) - 1,
        end_velocity=ends[0],
        end_acceleration=ends[1],
        overshoot=np.maximum(np.maximum(low - position.lowest, position.highest - high), 0.0),
        violation=float(
            np.nan_to_num([0.0, *(finding.excess for finding in findings)], nan=np.inf, posinf=np.inf).max()
        ),
        reasons=tuple(finding.sentence for finding in findings if finding.broken),
    )


def _spanning(passed: Floats, duration: float) -> Floats:
    """Times at which the waypoints are looked for: the first at the start, the last at the end, whatever the motion says."""
    return np.concatenate([[0.0], passed[1:-1], [duration]])


def _ratios(problem: Problem, rates: list[Extrema]) -> Floats:
    """Shares of the limits in use, shape (3, n_joints): 0 where there is no limit."""
    highest, lowest = problem.limits.highest_rates, problem.limits.lowest_rates
    up = np.stack([rate.highest for rate in rates]) / highest
    down = np.stack([rate.lowest for rate in rates]) / lowest
    shares = np.maximum(np.where(np.isfinite(highest), up, 0.0), np.where(np.isfinite(lowest), down, 0.0))
    return np.where(np.isnan(shares), np.inf, np.maximum(shares, 0.0))


def _spans(problem: Problem) -> Floats:
    """Length scale of every joint's motion, rad or m: its range over the waypoints, or what rounding can resolve."""
    span = np.ptp(problem.waypoints, axis=0)
    rounding = 1e-9 * np.maximum(np.abs(problem.waypoints).max(axis=0), span.max())
    return np.maximum(span, rounding)


def _scales(problem: Problem, peaks: Floats) -> list[Floats]:
    """Scale for steps in position, velocity and acceleration: the limit where there is one, else the largest peak."""
    rates = problem.limits.rates
    scales = [_spans(problem)]
    for order in range(2):
        bound, peak = rates[order], peaks[order]
        scales.append(np.where(np.isfinite(bound), bound, np.maximum(peak, peak.max())))
    return scales


def _at_joint(problem: Problem, joint: int) -> str:
    return problem.joint_names[joint]


def _finite_findings(problem: Problem, duration: float, peaks: Floats, others: list[Floats]) -> Iterator[_Finding]:
    """Nothing may overflow, not even a rate without a limit: what is not finite cannot be measured."""
    if not 0 < duration < np.inf:
        yield _Finding(np.inf, f"the duration is not a positive number, but {duration:g} s")
    broken = ~np.isfinite(peaks)
    if broken.any():
        order, joint = np.argwhere(broken)[0]
        yield _Finding(np.inf, f"{('position', *RATES)[order]} of {_at_joint(problem, int(joint))} is not finite")
    elif not all(np.isfinite(values).all() for values in others):
        yield _Finding(np.inf, "the motion is not finite at a knot, an end or a waypoint")


def _time_findings(passed: Floats, duration: float) -> Iterator[_Finding]:
    """Waypoints are passed in order, the first at the start and the last at the end."""
    late = float(max(abs(passed[0]), abs(passed[-1] - duration)) / duration)
    yield _Finding(
        late, f"passes the first waypoint at {passed[0]:.6g} s and the last at {passed[-1]:.6g} s of {duration:.6g} s"
    )
    back = float(-np.diff(passed).min() / duration)
    yield _Finding(np.inf if back > 0 else back, "passes the waypoints out of order")


def _rate_findings(problem: Problem, ratios: Floats, times: Floats) -> Iterator[_Finding]:
    for order, name in enumerate(RATES):
        joint = int(ratios[order].argmax())
        ratio = float(ratios[order, joint])
        yield _Finding(
            ratio - 1.0,
            f"{name} of {_at_joint(problem, joint)} reaches {ratio:.6g} of its limit at {times[order, joint]:.4f} s",
        )


def _waypoint_findings(problem: Problem, error: Floats) -> Iterator[_Finding]:
    relative = error / _spans(problem)
    joint = int(relative.argmax())
    yield _Finding(float(relative[joint]), f"misses a waypoint by {error[joint]:.3g} in {_at_joint(problem, joint)}")


def _steps_forbidden(problem: Problem) -> list[NDArray[np.bool_]]:
    """Which joints may not step in position (none), velocity and acceleration (those that limit a higher rate)."""
    limited = np.isfinite(problem.limits.rates)
    return [np.ones(problem.n_joints, dtype=bool), limited[1:].any(axis=0), limited[2]]


def _step_findings(problem: Problem, steps: list[Floats], scales: list[Floats]) -> Iterator[_Finding]:
    forbidden = _steps_forbidden(problem)
    for name, step, scale, mask in zip(("position", *RATES), steps, scales, forbidden, strict=False):
        relative = np.where(mask, step / np.where(scale > 0, scale, 1.0), 0.0)
        joint = int(relative.argmax())
        yield _Finding(
            float(relative[joint]), f"{name} of {_at_joint(problem, joint)} jumps by {step[joint]:.3g} at a knot"
        )


def _end_findings(problem: Problem, ends: list[Floats], scales: list[Floats]) -> Iterator[_Finding]:
    demanded = {EndCondition.FREE: 0, EndCondition.REST: 1, EndCondition.SMOOTH: 2}[problem.end]
    held = _steps_forbidden(problem)[1:]
    for name, value, scale, mask in list(zip(RATES, ends, scales[1:], held, strict=False))[:demanded]:
        relative = np.where(mask, np.abs(value) / np.where(scale > 0, scale, 1.0), 0.0)
        instant, joint = np.unravel_index(relative.argmax(), relative.shape)
        yield _Finding(
            float(relative[instant, joint]),
            f"{name} of {_at_joint(problem, int(joint))} is {value[instant, joint]:.3g} at the {('start', 'end')[instant]}, not zero",
        )


def _position_findings(problem: Problem, outside: Floats) -> Iterator[_Finding]:
    relative = outside / _spans(problem)
    joint = int(relative.argmax())
    yield _Finding(
        float(relative[joint]), f"{_at_joint(problem, joint)} leaves its range of positions by {outside[joint]:.3g}"
    )
