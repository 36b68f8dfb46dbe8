"""Demands of a problem, each measured on a motion: the excess, and the sentence that says so."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from study.limits import RATES, JointLimits
from study.problem import Floats, Problem
from study.rules import StraightPath
from study.tolerances import TOLERANCE
from study.trajectory import Extrema, Motion


@dataclass(frozen=True)
class Finding:
    """Relative excess over one demand, and the sentence that goes with it."""

    excess: float
    sentence: str

    @property
    def broken(self) -> bool:
        """Whether the demand is not met; an excess that is not a number counts as broken."""
        return not self.excess <= TOLERANCE


@dataclass(frozen=True, eq=False)
class Passed:
    """A motion and the times at which it passes its waypoints: the first at its start and the last at its end."""

    motion: Motion

    @property
    def times(self) -> Floats:
        """Times, shape (n_waypoints,), s, whatever the motion says of the first and the last."""
        return np.concatenate([[0.0], self.motion.waypoint_times[1:-1], [self.motion.duration]])

    def part(self, segment: int) -> Motion | None:
        """Part of the motion on a segment, counted from 0; None where it takes no time."""
        start, stop = self.times[segment : segment + 2]
        return self.motion.between(start, stop) if 0 <= start < stop <= self.motion.duration else None


@dataclass(frozen=True, eq=False)
class Measured:
    """A motion, measured once for every demand.

    Attributes
    ----------
    problem : Problem
    motion : Motion
    extrema : list of Extrema
        Of position, velocity, acceleration and jerk.
    ratios : array of shape (3, n_joints)
        Largest share of a limit in use, in any direction and on any segment; 0 where there is no limit.
    times : array of shape (3, n_joints), s
        When that is, or when the rate peaks where there is no limit.
    steps : list of arrays of shape (n_joints,)
        Largest step in position, velocity and acceleration at a knot.
    errors : array of shape (n_waypoints, n_joints), rad or m
        Distance to every waypoint when it should be passed.
    passed : array of shape (n_waypoints,), s
        Times at which the waypoints are looked for: the first at the start, the last at the end, whatever the motion says.
    ends : list of arrays of shape (2, n_joints)
        Velocity and acceleration at both ends.
    scales : list of arrays of shape (n_joints,)
        Sizes that steps in position, velocity and acceleration are compared with.
    """

    problem: Problem
    motion: Motion
    extrema: list[Extrema] = field(init=False)
    ratios: Floats = field(init=False)
    times: Floats = field(init=False)
    steps: list[Floats] = field(init=False)
    errors: Floats = field(init=False)
    passed: Floats = field(init=False)
    ends: list[Floats] = field(init=False)
    scales: list[Floats] = field(init=False)

    def __post_init__(self) -> None:
        motion = self.motion
        passed = Passed(motion).times
        object.__setattr__(self, "passed", passed)
        extrema = [motion.extrema(order) for order in range(4)]
        ratios, times = _uses(self, extrema[1:])
        measures = {
            "extrema": extrema,
            "ratios": ratios,
            "times": times,
            "steps": [np.abs(motion.jumps(order)).max(axis=0, initial=0.0) for order in range(3)],
            "errors": np.abs(motion(passed) - self.problem.waypoints),
            "ends": [motion(np.array([0.0, motion.duration]), order) for order in (1, 2)],
            "scales": _scales(self.problem, extrema),
        }
        for name, value in measures.items():
            object.__setattr__(self, name, value)

    @property
    def position(self) -> Extrema:
        """Extrema of the position."""
        return self.extrema[0]

    def part(self, segment: int) -> Motion | None:
        """Part of the motion on a segment, counted from 0; None where it takes no time."""
        return Passed(self.motion).part(segment)

    def at(self, joint: int | np.intp) -> str:
        """Name of a joint."""
        return self.problem.joint_names[int(joint)]


def _uses(measured: Measured, rates: list[Extrema]) -> tuple[Floats, Floats]:
    """Shares of the limits in use and when, both of shape (3, n_joints)."""
    ratios, times = _use(measured.problem.limits, rates)
    for segment, limits in measured.problem.segment_limits.items():
        part = measured.part(segment)
        if part is not None:
            more, when = _use(limits, [part.extrema(order) for order in (1, 2, 3)])
            times = np.where(more > ratios, measured.passed[segment] + when, times)
            ratios = np.maximum(ratios, more)
    return ratios, times


def _use(limits: JointLimits, rates: list[Extrema]) -> tuple[Floats, Floats]:
    highest, lowest = limits.highest_rates, limits.lowest_rates
    up = np.stack([rate.highest for rate in rates]) / highest
    down = np.stack([rate.lowest for rate in rates]) / lowest
    up, down = np.where(np.isfinite(highest), up, 0.0), np.where(np.isfinite(lowest), down, 0.0)
    shares = np.maximum(np.maximum(up, down), 0.0)
    at_highest, at_lowest = (
        np.stack([getattr(rate, f"at_{side}") for rate in rates]) for side in ("highest", "lowest")
    )
    times = np.where(down > up, at_lowest, at_highest)
    times = np.where(shares == 0, np.stack([rate.at_peak for rate in rates]), times)
    return np.where(np.isnan(shares), np.inf, shares), times


def _scales(problem: Problem, extrema: list[Extrema]) -> list[Floats]:
    """Scale for steps in position, velocity and acceleration: the limit where there is one, else the largest peak."""
    scales = [problem.position_tolerance / TOLERANCE]
    for order in range(2):
        bound, peak = problem.limits.rates[order], extrema[order + 1].peak
        scales.append(np.where(np.isfinite(bound), bound, np.maximum(peak, peak.max())))
    return scales


def findings_of(measured: Measured) -> Iterator[Finding]:
    """Measure every demand but the shape of the path."""
    yield from _finite(measured)
    yield from _order(measured)
    yield from _rates(measured)
    yield from _waypoints(measured)
    yield from _steps(measured)
    yield from _ends(measured)
    yield from _positions(measured)
    yield from _stops(measured)
    yield from _dwells(measured)
    if measured.problem.timing is not None:
        duration = measured.motion.duration
        yield Finding(measured.problem.timing.excess(duration), f"lasts {duration:.9g} s, which is not as demanded")


def _finite(measured: Measured) -> Iterator[Finding]:
    """Nothing may overflow, not even a rate without a limit: what is not finite cannot be measured."""
    duration = measured.motion.duration
    if not 0 < duration < np.inf:
        yield Finding(np.inf, f"the duration is not a positive number, but {duration:g} s")
    broken = ~np.isfinite([extrema.peak for extrema in measured.extrema])
    if broken.any():
        order, joint = np.argwhere(broken)[0]
        yield Finding(np.inf, f"{('position', *RATES)[order]} of {measured.at(joint)} is not finite")
    elif not all(np.isfinite(values).all() for values in (measured.errors, *measured.steps, *measured.ends)):
        yield Finding(np.inf, "the motion is not finite at a knot, an end or a waypoint")


def _order(measured: Measured) -> Iterator[Finding]:
    """Waypoints are passed in order, the first at the start and the last at the end."""
    passed, duration = measured.motion.waypoint_times, measured.motion.duration
    yield Finding(
        float(max(abs(passed[0]), abs(passed[-1] - duration)) / duration),
        f"passes the first waypoint at {passed[0]:.6g} s and the last at {passed[-1]:.6g} s of {duration:.6g} s",
    )
    back = bool((np.diff(passed) >= 0).all())
    yield Finding(0.0 if back else np.inf, "passes the waypoints out of order")


def _rates(measured: Measured) -> Iterator[Finding]:
    for order, name in enumerate(RATES):
        joint = int(measured.ratios[order].argmax())
        ratio, time = float(measured.ratios[order, joint]), measured.times[order, joint]
        sentence = f"{name} of {measured.at(joint)} reaches {ratio:.6g} of its limit at {time:.4f} s"
        yield Finding(ratio - 1.0, sentence)


def _waypoints(measured: Measured) -> Iterator[Finding]:
    problem = measured.problem
    allowed = problem.tolerances.copy()
    if isinstance(problem.path, StraightPath):
        allowed[1:-1] = np.maximum(allowed[1:-1], problem.path.of(problem.n_joints))
    relative = np.maximum(measured.errors - allowed, 0.0) / measured.scales[0]
    row, joint = np.unravel_index(relative.argmax(), relative.shape)
    error = measured.errors[row, joint]
    yield Finding(float(relative[row, joint]), f"misses a waypoint by {error:.3g} in {measured.at(joint)}")


def _steps_forbidden(problem: Problem) -> list[NDArray[np.bool_]]:
    """Joints that may not step in position (all), velocity and acceleration (those that limit a higher rate)."""
    every = [problem.limits, *problem.segment_limits.values()]
    limited = np.any([np.isfinite(limits.rates) for limits in every], axis=0)
    heavy = problem.arm is not None and problem.arm.forbids_steps
    return [np.ones(problem.n_joints, dtype=bool), limited[1:].any(axis=0) | heavy, limited[2]]


def _relative(mask: NDArray[np.bool_], value: Floats, scale: Floats) -> Floats:
    return np.where(mask, np.abs(value) / np.where(scale > 0, scale, 1.0), 0.0)


def _steps(measured: Measured) -> Iterator[Finding]:
    forbidden = _steps_forbidden(measured.problem)
    for name, step, scale, mask in zip(("position", *RATES), measured.steps, measured.scales, forbidden, strict=False):
        relative = _relative(mask, step, scale)
        joint = int(relative.argmax())
        sentence = f"{name} of {measured.at(joint)} jumps by {step[joint]:.3g} at a knot"
        yield Finding(float(relative[joint]), sentence)


def _ends(measured: Measured) -> Iterator[Finding]:
    """A rate that may step inside may step at an end: what is demanded there is then reached in no time."""
    held = _steps_forbidden(measured.problem)[1:]
    states = measured.problem.end_states
    for order, name in enumerate(RATES[:2]):
        for instant, state in enumerate(states):
            demanded = state.rates[order]
            if demanded is None:
                continue
            value = measured.ends[order][instant]
            relative = _relative(held[order], value - demanded, measured.scales[order + 1])
            joint = int(relative.argmax())
            wanted = "zero" if demanded[joint] == 0 else f"{demanded[joint]:.3g}"
            place = ("start", "end")[instant]
            yield Finding(
                float(relative[joint]),
                f"{name} of {measured.at(joint)} is {value[joint]:.3g} at the {place}, not {wanted}",
            )


def _positions(measured: Measured) -> Iterator[Finding]:
    yield _outside(measured, measured.problem.limits, measured.position)
    for segment, limits in measured.problem.segment_limits.items():
        part = measured.part(segment)
        if part is not None:
            yield _outside(measured, limits, part.extrema())


def _outside(measured: Measured, limits: JointLimits, position: Extrema) -> Finding:
    outside = np.maximum(limits.lower - position.lowest, position.highest - limits.upper)
    relative = outside / measured.scales[0]
    joint = int(relative.argmax())
    return Finding(
        float(relative[joint]), f"{measured.at(joint)} leaves its range of positions by {outside[joint]:.3g}"
    )


def _stops(measured: Measured) -> Iterator[Finding]:
    problem, motion = measured.problem, measured.motion
    held = _steps_forbidden(problem)[1]
    for waypoint in sorted({*problem.stops, *problem.dwells}):
        velocity = motion(measured.passed[waypoint], 1)[0]
        relative = _relative(held, velocity, measured.scales[1])
        joint = int(relative.argmax())
        sentence = f"does not stop at waypoint {waypoint + 1}: {measured.at(joint)} moves at {velocity[joint]:.3g}"
        yield Finding(float(relative[joint]), sentence)


def _dwells(measured: Measured) -> Iterator[Finding]:
    motion = measured.motion
    for waypoint, time in measured.problem.dwells.items():
        start = measured.passed[waypoint]
        stop = min(start + time, measured.passed[waypoint + 1])
        late = (start + time - stop) / time
        moved = np.inf * np.ones(motion.n_joints)
        if 0 <= start < stop:
            position = motion.between(start, stop).extrema()
            moved = position.highest - position.lowest
        relative = moved / measured.scales[0]
        sentence = f"does not stand still for {time:g} s at waypoint {waypoint + 1}"
        yield Finding(float(max(late, relative.max())), sentence)
