"""The second judge's answer on curves t(u), q(u), whose rates are rational in u: it only asks where polynomials are negative.

As t' is positive, a rate N / t'^m stays below a limit L exactly where N - L t'^m is not positive, which is a polynomial;
the first judge divides and looks for roots of the quotient's derivative instead. The shape of a path does not depend on time.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from study.limits import JointLimits
from study.parametric import ParametricTrajectory
from study.problem import Problem, StraightPath
from study.testing.bernstein import Long, as_bernstein, stacked, suprema
from study.testing.second_judge import SecondVerdict, along_line
from study.tolerances import TOLERANCE

MET, BROKEN, OPEN = SecondVerdict(0.0, 0.0), SecondVerdict(1.0, 1.0), SecondVerdict(0.0, 1.0)


def second_judge_parametric(problem: Problem, motion: ParametricTrajectory) -> SecondVerdict:
    """Decide whether a motion meets what a problem demands: enclosures (0, 0) for yes, (1, 1) for no, (0, 1) undecided.

    Parameters
    ----------
    problem : Problem
    motion : ParametricTrajectory
    """
    time, position = motion.time[:, None].astype(np.longdouble), np.moveaxis(motion.position, 1, 2)
    rates = _rates(time, position.astype(np.longdouble))
    if max(_excesses(problem, motion, rates)) > TOLERANCE:
        return BROKEN
    low, high = suprema(stacked(list(_questions(problem, rates))))
    if (low > 1 + 1e-9).any():
        return BROKEN
    shapes = [(0.0, 0.0)]
    if problem.path is not None:
        shapes = [along_line(problem, as_bernstein(rates[0][0][k : k + 1]), k) for k in range(problem.n_segments)]
    if any(lower > 0 for lower, _ in shapes):
        return BROKEN
    decided = (high <= 1 + 1e-12).all() and all(upper == 0 for _, upper in shapes) and not problem.dwells
    return MET if decided else OPEN


def _rates(time: Long, position: Long) -> list[tuple[Long, Long]]:
    """Numerator and denominator of position, velocity, acceleration and jerk, in powers of u."""
    slope, bend = _derivative(time), _derivative(_derivative(time))
    rates, power = [(position, np.ones_like(time[..., :1])), (_derivative(position), slope)], 1
    for _ in range(2):
        over, under = rates[-1]
        over = _sum(_product(_derivative(over), slope), -power * _product(over, bend))
        rates.append((over, _product(_product(under, slope), slope)))
        power += 2
    return rates


def _derivative(power: Long) -> Long:
    return power[..., 1:] * np.arange(1, power.shape[-1]) if power.shape[-1] > 1 else 0 * power


def _product(first: Long, second: Long) -> Long:
    shape = np.broadcast_shapes(first.shape[:-1], second.shape[:-1])
    result = np.zeros((*shape, first.shape[-1] + second.shape[-1] - 1), dtype=np.longdouble)
    for k in range(second.shape[-1]):
        result[..., k : k + first.shape[-1]] += first * second[..., k : k + 1]
    return result


def _sum(first: Long, second: Long) -> Long:
    longest = max(first.shape[-1], second.shape[-1])
    padded = [np.pad(part, [(0, 0)] * (part.ndim - 1) + [(0, longest - part.shape[-1])]) for part in (first, second)]
    return np.asarray(padded[0] + padded[1])


def _questions(problem: Problem, rates: list[tuple[Long, Long]]) -> Iterator[Long]:
    """Polynomials that must nowhere exceed 1."""
    span = problem.position_tolerance / TOLERANCE
    for segment, limits in [(None, problem.limits), *problem.segment_limits.items()]:
        pieces = slice(None) if segment is None else slice(segment, segment + 1)
        for order in range(1, 4):
            over, under = (part[pieces] for part in rates[order])
            yield from _below(over, under, limits, order)
        for bound, sign in ((limits.upper, 1.0), (limits.lower, -1.0)):
            limited = np.isfinite(bound)
            position = sign * rates[0][0][pieces][:, limited]
            position[..., 0] -= sign * bound[limited]
            yield 1 - TOLERANCE + as_bernstein(position / span[limited, None])


def _below(over: Long, under: Long, limits: JointLimits, order: int) -> Iterator[Long]:
    size = as_bernstein(under).max(axis=-1, keepdims=True)
    for bound in (limits.highest_rates[order - 1], limits.lowest_rates[order - 1]):
        limited = np.isfinite(bound)
        share = over[:, limited] / bound[limited, None]
        yield 1 + as_bernstein(_sum(share, -(1 + TOLERANCE) * under) / size)


def _excesses(problem: Problem, motion: ParametricTrajectory, rates: list[tuple[Long, Long]]) -> Iterator[float]:
    """Excesses at single instants: waypoints, steps at knots, ends, stops and the duration."""
    first, last = (
        [over[..., 0] / under[..., 0] for over, under in rates],
        [over.sum(-1) / under.sum(-1) for over, under in rates],
    )
    at = [np.concatenate([start, stop[-1:]]) for start, stop in zip(first, last, strict=True)]
    span, allowed = problem.position_tolerance / TOLERANCE, problem.tolerances.copy()
    if isinstance(problem.path, StraightPath):
        allowed[1:-1] = np.maximum(allowed[1:-1], problem.path.of(problem.n_joints))
    yield float(((np.abs(at[0] - problem.waypoints) - allowed) / span).max())
    every = [problem.limits, *problem.segment_limits.values()]
    limited = np.any([np.isfinite(limits.rates) for limits in every], axis=0)
    held = [np.full(problem.n_joints, True), limited[1] | limited[2], limited[2]]
    peaks = [
        np.maximum(np.abs(start).max(axis=0), np.abs(stop).max(axis=0)) for start, stop in zip(first, last, strict=True)
    ]
    scales = [span]
    for order in (1, 2):
        bound, peak = problem.limits.rates[order - 1], peaks[order]
        scale = np.where(np.isfinite(bound), bound, np.maximum(peak, peak.max()))
        scales.append(np.where(scale > 0, scale, 1.0))
    for order in range(3):
        steps = np.abs(first[order][1:] - last[order][:-1]) / scales[order]
        yield float(steps[:, held[order]].max(initial=0.0))
    for place, state in zip((0, -1), problem.end_states, strict=True):
        for order, rate in enumerate(state.rates, start=1):
            if rate is not None:
                yield float((np.abs(at[order][place] - rate) / scales[order])[held[order]].max(initial=0.0))
    for waypoint in {*problem.stops, *problem.dwells}:
        yield float((np.abs(at[1][waypoint]) / scales[1])[held[1]].max(initial=0.0))
    if problem.timing is not None:
        yield problem.timing.excess(motion.duration)
