"""Shape of a path, measured exactly: how far a motion is from the straight lines between its waypoints.

Within a radius r of the line from waypoint a to a + d, in every joint, is a motion q for which some s of [0, 1] has
abs(q_i - a_i - s d_i) <= r_i for all joints i. Every joint leaves an interval of s, and the intervals, with [0, 1], have a point
in common exactly if each two of them do. With e_i = sign(d_i) (q_i - a_i) this is, for each two joints,
abs(d_j) e_i - abs(d_i) e_j <= r_i abs(d_j) + r_j abs(d_i), and for each joint -r_i <= e_i <= abs(d_i) + r_i: linear in the
position, so the extrema of a few affine images of the motion settle it, without sampling.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from study import polynomial
from study.findings import Finding, Measured, Passed
from study.problem import Floats, Problem
from study.rules import Tube
from study.tolerances import TOLERANCE
from study.trajectory import Motion, Trajectory


def path_findings(measured: Measured) -> Iterator[Finding]:
    """Measure a problem's rule for the path, segment by segment."""
    problem = measured.problem
    if problem.path is None:
        return
    radius, measure = problem.path.of(problem.n_joints), _tube if isinstance(problem.path, Tube) else _straight
    for segment in range(problem.n_segments):
        part = measured.part(segment)
        if part is not None:
            yield from measure(problem, part, segment, radius)


def _tube(problem: Problem, part: Motion, segment: int, radius: Floats) -> Iterator[Finding]:
    share = line_share(problem, part, segment, radius)
    words = f"leaves the tube between waypoints {segment + 1} and {segment + 2}: {share:.6g} of its radius"
    yield Finding(share - 1.0, words)


def line_share(problem: Problem, part: Motion, segment: int, radius: Floats) -> float:
    """Largest distance of a motion from a segment's straight line, as a share of the radius.

    Parameters
    ----------
    problem : Problem
    part : Motion
    segment : int
        Counted from 0.
    radius : array of shape (n_joints,), rad or m
        All positive.
    """
    matrix, offset = _images(problem.waypoints[segment], problem.waypoints[segment + 1], radius)
    return float(part.mapped(matrix, offset).extrema().highest.max())


def largest_deviation(problem: Problem, motion: Motion) -> float:
    """Radius of the narrowest tube, the same for every joint, around the straight lines that holds a motion, rad or m.

    Parameters
    ----------
    problem : Problem
    motion : Motion
        Passes the problem's waypoints.
    """
    measured = Passed(motion)
    if not isinstance(motion, Trajectory):
        parts = ((measured.part(k), k) for k in range(problem.n_segments))
        ones = np.ones(problem.n_joints)
        return max((line_share(problem, part, k, ones) for part, k in parts if part is not None), default=0.0)
    knots = np.union1d(motion.knots, measured.times)
    knots = np.append(knots[:-1][np.diff(knots) > 1e-12 * motion.duration], motion.duration)
    middles = 0.5 * (knots[1:] + knots[:-1])
    piece = np.searchsorted(motion.knots, middles) - 1
    segment = np.clip(np.searchsorted(measured.times, middles) - 1, 0, problem.n_segments - 1)
    local = np.moveaxis(motion.coefficients[piece], 1, 2)
    away = polynomial.shifted(local, (knots[:-1] - motion.knots[piece])[:, None])
    away = polynomial.stretched(away, np.diff(knots)[:, None])
    away[..., 0] -= problem.waypoints[segment]
    step = np.diff(problem.waypoints, axis=0)[segment]
    away *= np.where(step < 0, -1.0, 1.0)[..., None]
    largest = 0.0
    for image in _distances(away, np.abs(step)):
        largest = max(largest, float(image[..., 0].max()), float(image.sum(axis=-1).max()))
        highest = image[..., 0] + np.maximum(image[..., 1:], 0.0).sum(axis=-1)
        if (near := highest > largest).any():
            largest = max(largest, float(polynomial.extrema(image[near])[2].max()))
    return largest


def _distances(away: Floats, length: Floats) -> Iterator[Floats]:
    """Images of the way from each line's start, along its signs, whose largest value is the distance from the line."""
    yield -away
    beyond = away.copy()
    beyond[..., 0] -= length
    yield beyond
    for shift in range(1, away.shape[1]):
        other, others = np.roll(away, shift, axis=1), np.roll(length, shift, axis=1)
        room = length + others
        share = np.divide(others, room, out=np.zeros_like(room), where=room > 0)[..., None]
        yield np.where(room[..., None] > 0, share * away - (1 - share) * other, 0.0)


def _images(start: Floats, stop: Floats, radius: Floats) -> tuple[Floats, Floats]:
    """Affine map of the position that is at most 1 everywhere within the radius of the line."""
    length = np.abs(stop - start)
    signed = np.diag(np.where(stop < start, -1.0, 1.0))
    rows, offsets = [signed / radius[:, None], -signed / radius[:, None]], [-length / radius, np.zeros(len(length))]
    first, second = np.nonzero(~np.eye(len(length), dtype=bool))
    room = radius[first] * length[second] + radius[second] * length[first]
    used = room > 0
    first, second, room = first[used], second[used], room[used, None]
    rows.append((length[second, None] * signed[first] - length[first, None] * signed[second]) / room)
    offsets.append(np.zeros(len(first)))
    matrix = np.concatenate(rows)
    return matrix, np.concatenate(offsets) - matrix @ start


def _straight(problem: Problem, part: Motion, segment: int, radius: Floats) -> Iterator[Finding]:
    """Outside the boxes around inner waypoints the motion is on the line, to the tolerance of positions."""
    words = f"leaves the straight line from waypoint {segment + 1} to {segment + 2}"
    for start, stop in _outside_corners(problem, part, segment, radius):
        share = line_share(problem, part.between(start, stop), segment, problem.position_tolerance)
        yield Finding(share * TOLERANCE, f"{words}: by {share * problem.position_tolerance.max():.3g}")


def _outside_corners(problem: Problem, part: Motion, segment: int, radius: Floats) -> list[tuple[float, float]]:
    """Spells of time, s, at which no corner may be cut."""
    corners = [k for k in (segment, segment + 1) if 0 < k < problem.n_waypoints - 1]
    points = problem.waypoints[corners]
    levels = [point + side * radius for point in points for side in (-1.0, 1.0)]
    cuts = np.unique(np.concatenate([[0.0, part.duration], *(part.crossings(level) for level in levels)]))
    cuts = np.clip(cuts[np.append(True, np.diff(cuts) > 1e-12 * part.duration)], 0.0, part.duration)
    cuts[-1] = part.duration
    middle = part(0.5 * (cuts[1:] + cuts[:-1]))
    inside = np.zeros(len(middle), dtype=bool)
    for point in points:
        inside |= (np.abs(middle - point) <= radius).all(axis=1)
    edges = np.flatnonzero(np.diff(np.concatenate([[True], inside, [True]])))
    return [(float(cuts[a]), float(cuts[b])) for a, b in edges.reshape(-1, 2)]
