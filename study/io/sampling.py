"""Instants at which a motion is written down: at a rate, so many of them, or wherever its polynomials change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.arrays import positive, whole
from study.errors import StudyError
from study.problem import Floats, Problem
from study.trajectory import Motion

FEW_SAMPLES, MANY_SAMPLES = 10, 100_000
HIGHEST_RATE = 1e9
"""Hz; a ROS message counts nanoseconds."""
MOST_SAMPLES = 10_000_000
"""More samples than this are taken for a mistake in the rate."""


CLOSEST = 1e-4
"""Part of the usual distance of samples below which a sample at the rate gives way to a switching instant."""


@dataclass(frozen=True)
class Sampling:
    """Wish about the instants; without any, samples at the usual rate and at all switching instants.

    Attributes
    ----------
    rate : float, Hz, optional
        Equal steps from the start on, and the end point.
    points : int, optional
        So many points.
    """

    rate: float | None = None
    points: int | None = None

    def times(self, motion: Motion, problem: Problem) -> Floats:
        """Instants for a motion, shape (n_samples,), s.

        Raises
        ------
        StudyError
            If rate and points are both given, or one of them is impossible.
        """
        cycle = None if problem.timing is None else problem.timing.cycle
        if self.points is not None:
            if self.rate is not None:
                raise StudyError("give a rate or a number of points, not both")
            return point_times(motion, self.points)
        if self.rate is not None:
            return sample_times(motion.duration, self.rate)
        return switching_times(motion) if cycle is None else sample_times(motion.duration, 1.0 / cycle)


def usual_rate(duration: float, rate: float = 100.0, most: int = MANY_SAMPLES) -> float:
    """Samples per second where nobody chose: the usual ones, or ten, a hundred... times more or fewer.

    Parameters
    ----------
    duration : float, s
    rate : float, Hz
        For motions of seconds and minutes.
    most : int
        Samples; at least 10 come, too, unless they lay less than a nanosecond apart.
    """
    while duration * rate > most:
        rate /= 10.0
    while duration * rate < FEW_SAMPLES and rate < HIGHEST_RATE:
        rate *= 10.0
    return rate


def sample_times(duration: float, rate: float) -> Floats:
    """Every 1/rate seconds from 0, and the end point.

    Parameters
    ----------
    duration : float, s
    rate : float, Hz

    Returns
    -------
    array of shape (n_samples,), s

    Raises
    ------
    StudyError
        If the rate is not positive, or there would be more than ten million samples.
    """
    rate = positive(rate, "the rate, samples per second,")
    if duration * rate > MOST_SAMPLES:
        raise StudyError(
            f"{duration:g} s at {rate:g} samples per second are more than {MOST_SAMPLES} samples; lower the rate"
        )
    inner = np.arange(np.ceil(duration * rate)) / rate
    return np.append(inner[inner < duration * (1 - 1e-12)], duration)


def switching_times(motion: Motion) -> Floats:
    """Samples at the usual rate, and the knots, so that polynomials through the samples are the motion's own.

    Knots that differ by rounding only count once, and a sample at the rate gives way to a knot close to it.
    """
    rate = usual_rate(motion.duration)
    knots = _apart(motion.knots, CLOSEST / rate)
    grid = sample_times(motion.duration, rate)[:-1]
    after = np.searchsorted(knots, grid)
    near = np.minimum(np.abs(knots[np.minimum(after, len(knots) - 1)] - grid), np.abs(knots[after - 1] - grid))
    return np.union1d(grid[near > 0.1 / rate], knots)


def _apart(knots: Floats, distance: float) -> Floats:
    """Knots at least so far from each other, the first and the last among them."""
    kept = [float(knots[0])]
    for knot in knots[1:-1]:
        if knot - kept[-1] >= distance and knots[-1] - knot >= distance:
            kept.append(float(knot))
    return np.array([*kept, knots[-1]])


def point_times(motion: Motion, points: int) -> Floats:
    """So many instants: the knots and halves of the longest gaps between them, or equal steps where there are more knots.

    Raises
    ------
    StudyError
        If fewer than two points, or too many, are asked for.
    """
    whole(points, 2, "the number of points", MOST_SAMPLES)
    times = _apart(motion.knots, motion.duration / (10.0 * points))
    if len(times) > points:
        return np.linspace(0.0, motion.duration, points)
    gaps = np.diff(times)
    parts = np.ones(len(gaps), dtype=int)
    for _ in range(points - len(times)):
        parts[(gaps / parts).argmax()] += 1
    inner = [start + gap * np.arange(n) / n for start, gap, n in zip(times, gaps, parts, strict=False)]
    return np.append(np.concatenate(inner), times[-1])
