"""Shortest time of one joint to the next waypoint when its velocities at both are known only as intervals.

Let a and b be the upper ends of the intervals, T the time and d >= 0 the distance (the mirrored case is the same). The
velocity never exceeds any of these curves over the segment, so the displacement never exceeds their integrals:

- min(a + A t, b + A (T - t), V), from the acceleration and velocity limits: `reach`;
- a + (b - a) t / T + J t (T - t) / 2, from the jerk limit: the difference of the velocity and this parabola is convex,
  as its second derivative is at least -J + J = 0, and not positive at both ends: `jerk_reach`,
  (a + b) T / 2 + J T^3 / 12.

From d > 0 on either integral grows with T, so d is reached no sooner than at its last crossing with d. Mirrored, with
the lower ends of the intervals, the displacement is never less than the negative of such an integral; a T at which that
exceeds d is impossible, and so is every later T up to where it no longer does.

Under all three limits `baselines.bounds.joined_times` joins the first curve's lines by the second's parabolas.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baselines.bounds.joined_times import SAFETY, joined_time, last_jerk_crossing
from baselines.closed_forms import peak_velocity
from study.problem import Floats


@dataclass(frozen=True, eq=False)
class Cells:
    """Intervals of velocity at one waypoint, arrays of shape (n_cells,), and the largest acceleration there."""

    low: Floats
    high: Floats
    steepest: float = np.inf

    @property
    def mirrored(self) -> Cells:
        """The same cells for a joint that counts in the other direction."""
        return Cells(-self.high, -self.low, self.steepest)

    def picked(self, mask: NDArray[np.bool_]) -> Cells:
        """Keep some of the cells."""
        return Cells(self.low[mask], self.high[mask], self.steepest)

    def halved(self) -> Cells:
        """Cut every cell that is not a point in two."""
        wide = self.high > self.low
        middle = (self.low + self.high) / 2
        low = np.concatenate([self.low, middle[wide]])
        return Cells(low, np.concatenate([np.where(wide, middle, self.high), self.high[wide]]), self.steepest)


def reach(time: Floats, a: Floats, b: Floats, velocity: float, acceleration: float) -> Floats:
    """Integral of min(a + A t, b + A (T - t), V) over [0, T], for a, b <= V: the upper bound on displacements."""
    w = (a + b + acceleration * time) / 2
    over = np.maximum(w - velocity, 0.0)
    with np.errstate(invalid="ignore"):
        both = (w**2 - over**2 - (a**2 + b**2) / 2) / acceleration
    low = np.minimum(a, b)
    return np.where(acceleration * time >= np.abs(a - b), both, low * time + acceleration * time**2 / 2)


def last_crossing(distance: Floats | float, a: Floats, b: Floats, velocity: float, acceleration: float) -> Floats:
    """Largest T with reach(T; a, b) = distance, s; 0 where reach exceeds the distance at all times."""
    low, high = np.minimum(a, b), np.maximum(a, b)
    single = low**2 + 2 * acceleration * distance
    early = (np.sqrt(np.maximum(single, 0.0)) - low) / acceleration
    square = acceleration * distance + (a**2 + b**2) / 2
    w = peak_velocity(square, velocity)
    late = (2 * w - a - b) / acceleration
    return np.maximum(np.where(w >= high, late, np.where(single >= 0, early, 0.0)), 0.0)


def jerk_reach(time: Floats, a: Floats, b: Floats, jerk: float) -> Floats:
    """Integral of the parabola from a to b that bends with J, over [0, T]."""
    return (a + b) / 2 * time + jerk / 12 * time**3


def shortest_times(distance: float, start: Cells, end: Cells, rates: Floats, at_least: float) -> Floats:
    """Lower bounds on the time between two waypoints for all pairs of cells, shape (n_start, n_end), s.

    Parameters
    ----------
    distance : float
        Signed.
    start, end : Cells
    rates : array of shape (3,)
        The joint's limits; velocity and acceleration finite.
    at_least : float, s
        A bound that is known already.
    """
    return past_gaps(np.maximum(first_times(distance, start, end, rates), at_least), distance, start, end, rates)


def first_times(distance: float, start: Cells, end: Cells, rates: Floats) -> Floats:
    """Least times to get as far, and from one velocity to the other; arguments as above."""
    if distance < 0:
        start, end = start.mirrored, end.mirrored
    d, (velocity, acceleration, jerk) = abs(distance), map(float, rates)
    a, b = start.high[:, None], end.high[None]
    change = np.maximum(np.maximum(end.low[None] - a, start.low[:, None] - b), 0.0)
    time = change / acceleration
    slopes = min(start.steepest, acceleration), min(end.steepest, acceleration)
    if np.isfinite(jerk) and min(slopes) < acceleration:
        slowly = last_crossing(change, np.array(slopes[0]), np.array(slopes[1]), acceleration, jerk) * (1 - SAFETY)
        time = np.maximum(time, np.where(change > 0, slowly, 0.0))
    if d > 0:
        time = np.maximum(time, last_crossing(d, a, b, velocity, acceleration))
        if np.isfinite(jerk):
            time = joined_time(time, d, (a, b), slopes, rates)
    return time


def past_gaps(time: Floats, distance: float, start: Cells, end: Cells, rates: Floats) -> Floats:
    """Times at least as long as those given in which the joint does not have to go too far; arguments as above."""
    if distance < 0:
        start, end = start.mirrored, end.mirrored
    d, (velocity, acceleration, jerk) = abs(distance), map(float, rates)
    a, b = -start.low[:, None], -end.low[None]
    if np.isfinite(jerk):
        late = last_jerk_crossing(-d, a, b, jerk) * (1 - SAFETY)
        time = _past_gap(time, jerk_reach(time, a, b, jerk), late, d, np.abs(a) + np.abs(b))
    late = last_crossing(-d, a, b, velocity, acceleration)
    return _past_gap(time, reach(time, a, b, velocity, acceleration), late, d, np.abs(a) + np.abs(b))


def _past_gap(time: Floats, farthest_back: Floats, late: Floats, d: float, speed: Floats) -> Floats:
    """Lengthen times at which even the least displacement overshoots, by more than rounding, until it does not."""
    overshoots = farthest_back < -d - SAFETY * (d + speed * time)
    return np.where(overshoots, np.maximum(time, late), time)
