"""Shortest time over a distance under limits of velocity, acceleration and jerk at once.

Let the velocity be at most a at first and b at last, its slope at first at most p and at last at least -q, and let its
slope always be at most A and its bend at least -J and at most J. Then

- up to a time t the velocity stays below F, which starts at a with the slope p, and whose slope grows with J up to A
  and stays there; looking back from the end it stays below B, made of b and q in the same way;
- between any two instants it stays below the parabola that bends with -J between any two values that it does not
  exceed there: the difference of the two is convex and not positive at both ends.

So for any s, t >= 0 with s + t <= T and L = T - s - t the displacement is at most

    integral of F up to t + integral of B up to s + (F(t) + B(s)) L / 2 + J L^3 / 12,

and for fixed s and t the distance is reached no sooner than at the last crossing of this cubic in L. **Any** s and t
give a proof for all T >= s + t; the best ones touch, F'(t) + B'(s) = J L, and are sought by Newton's method at the
time proved so far, which the next crossing moves up. The velocity limit takes part in the same way: F and a parabola
that ends at V without a slope bound the way up, B the way down, and V what is left.
"""

from __future__ import annotations

import numpy as np

from study.problem import Floats

SAFETY = 1e-9
"""Relative deduction for rounding."""

ROUNDING = 1e-12
"""Deduction from what is left of a distance, relative to what was taken from it."""

ROUNDS, STEPS = 3, 2
"""Proofs, and Newton's steps before each."""


def last_jerk_crossing(distance: Floats | float, a: Floats, b: Floats, jerk: float) -> Floats:
    """Largest T with (a + b) T / 2 + J T^3 / 12 = distance, s; 0 where there is none.

    Cardano's formula for T^3 + p T + q = 0, and Newton's steps against its cancellation; at a largest root the cubic
    rises, so the steps are safe.
    """
    p, q = 6 * (a + b) / jerk, -12 * distance / jerk
    discriminant = (q / 2) ** 2 + (p / 3) ** 3
    root = np.sqrt(np.maximum(discriminant, 0.0))
    single = np.cbrt(-q / 2 + root) + np.cbrt(-q / 2 - root)
    size = np.sqrt(np.maximum(-p / 3, 0.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = np.clip(np.nan_to_num(-q / 2 / size**3), -1.0, 1.0)
        time = np.maximum(np.where(discriminant < 0, 2 * size * np.cos(np.arccos(cosine) / 3), single), 0.0)
        for _ in range(3):
            slope = 3 * time**2 + p
            time = np.where(slope > 0, np.maximum(time - (time**3 + p * time + q) / slope, 0.0), time)
    return time


def joined_time(
    time: Floats, distance: float, ends: tuple[Floats, Floats], slopes: tuple[float, float], rates: Floats
) -> Floats:
    """Lower bounds on the time over a distance, s.

    Parameters
    ----------
    time : array, s
        Bounds that are proved already.
    distance : float
        Positive.
    ends : pair of arrays
        Highest velocity at either end.
    slopes : pair of floats
        Highest acceleration at the start, and highest deceleration at the end; at most A.
    rates : array of shape (3,)
        Limits; acceleration and jerk finite.
    """
    velocity, acceleration, jerk = map(float, rates)
    (a, b), (p, q) = ends, slopes
    time = np.maximum(time, last_jerk_crossing(distance, a, b, jerk) * (1 - SAFETY))
    for _ in range(ROUNDS):
        t, s = _guess(time, ends, slopes, acceleration, jerk)
        for _ in range(STEPS):
            t, s = _touching(time, t, s, ends, slopes, acceleration, jerk)
        (first, _, way), (last, _, back) = _rise(t, a, p, acceleration, jerk), _rise(s, b, q, acceleration, jerk)
        left = distance - way - back - ROUNDING * (distance + (np.abs(a) + np.abs(b)) * time)
        between = np.where(left > 0, last_jerk_crossing(left, first, last, jerk), 0.0)
        time = np.maximum(time, (t + s + between) * (1 - SAFETY))
    if np.isinf(velocity):
        return time
    (up, way), (down, back) = (_ramp(x, y, velocity, acceleration, jerk) for x, y in ((a, p), (b, q)))
    cruise = np.maximum(distance - way - back, 0.0) / velocity
    return np.where(time >= up + down, np.maximum(time, (up + down + cruise) * (1 - SAFETY)), time)


def _rise(time: Floats, start: Floats, slope: float, acceleration: float, jerk: float) -> tuple[Floats, Floats, Floats]:
    """F at an instant, its slope there, and its integral up to there."""
    bent = np.minimum(time, (acceleration - slope) / jerk)
    straight = time - bent
    steep = slope + jerk * bent
    corner = start + (slope + jerk * bent / 2) * bent
    way = (start + (slope / 2 + jerk * bent / 6) * bent) * bent + (corner + steep * straight / 2) * straight
    return corner + steep * straight, steep, way


def _guess(
    time: Floats, ends: tuple[Floats, Floats], slopes: tuple[float, float], acceleration: float, jerk: float
) -> tuple[Floats, Floats]:
    """Instants at which the parabola would touch F and B if both still bent there, or if neither did any more."""
    (a, b), (p, q) = ends, slopes
    width = (time + (p + q) / jerk) / 2
    late = width > 2 * acceleration / jerk
    width = np.minimum(np.minimum(width, 2 * acceleration / jerk), time)
    delay = ((acceleration - p) ** 2 - (acceleration - q) ** 2) / (2 * jerk)
    off = np.where(late, (b - a + delay) / (2 * acceleration), (b - a - (p - q) * time / 2) / (p + q + jerk * time))
    middle = np.clip(time / 2 + off, width / 2, time - width / 2)
    return (middle - width / 2) * (1 - SAFETY), (time - middle - width / 2) * (1 - SAFETY)


def _touching(
    time: Floats,
    t: Floats,
    s: Floats,
    ends: tuple[Floats, Floats],
    slopes: tuple[float, float],
    acceleration: float,
    jerk: float,
) -> tuple[Floats, Floats]:
    """One step of Newton's method towards the instants at which the parabola touches F and B, within the time."""
    first, rise, _ = _rise(t, ends[0], slopes[0], acceleration, jerk)
    last, fall, _ = _rise(s, ends[1], slopes[1], acceleration, jerk)
    left = np.maximum(time - t - s, SAFETY * time)
    half, bend = (first - last) / left, jerk * left / 2
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.maximum(t - (half + rise - bend) / np.where(rise < acceleration, 2 * jerk, jerk), 0.0)
        s = np.maximum(s - (fall - half - bend) / np.where(fall < acceleration, 2 * jerk, jerk), 0.0)
        scale = np.nan_to_num(np.minimum(1.0, time * (1 - SAFETY) / (t + s)), nan=1.0)
    return t * scale, s * scale


def _ramp(start: Floats, slope: float, velocity: float, acceleration: float, jerk: float) -> tuple[Floats, Floats]:
    """Time and integral of F and the parabola from it to V without a slope; nothing where F starts too high."""
    steep = np.sqrt(np.maximum(jerk * (velocity - start) + slope**2 / 2, 0.0))
    possible, steep = steep >= max(slope, 0.0), np.minimum(steep, acceleration)
    bent = np.maximum(steep - slope, 0.0) / jerk
    corner = start + (slope + jerk * bent / 2) * bent
    straight = np.maximum(velocity - steep**2 / (2 * jerk) - corner, 0.0) / acceleration
    straight = np.where(steep < acceleration, 0.0, straight)
    top, _, way = _rise(bent + straight, start, slope, acceleration, jerk)
    last = steep / jerk
    way = way + (top + steep * last / 2 - jerk * last**2 / 6) * last
    return np.where(possible, bent + straight + last, 0.0), np.where(possible, way, 0.0)
