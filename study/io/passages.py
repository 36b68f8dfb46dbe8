"""Times at which a motion passes waypoints, found from its path alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from study import polynomial
from study.errors import StudyError
from study.problem import Floats

_FINER = 5
"""Times that a grid of 200 instants is laid between the neighbours of its best one."""

_NEAREST = 64  # pieces looked at for each waypoint

_LARGE = 10_000_000
"""Waypoints times pieces above which a tree finds the pieces."""

_TOGETHER = 256  # waypoints of a large motion that are looked for at once
FARTHEST = 1e150
"""Spans of the waypoints that a motion may be away from them; squares of larger distances are no numbers any more."""


def passages(knots: Floats, coefficients: Floats, waypoints: Floats, tolerances: Floats | None = None) -> Floats:
    """Find when a piecewise polynomial comes closest to waypoints, in their order.

    The first waypoint belongs to the first instant and the last one to the last. Of all increasing sequences of closest
    passages the one with the smallest sum of distances is taken.

    Parameters
    ----------
    knots : array of shape (n_pieces + 1,), s
    coefficients : array of shape (n_pieces, degree + 1, n_joints)
        Ascending powers of the time since the piece's first knot.
    waypoints : array of shape (n_waypoints, n_joints)
    tolerances : array of shape (n_waypoints, n_joints), optional
        Where the closest passage lies outside them, the time is taken at which the joints lie deepest inside.

    Returns
    -------
    array of shape (n_waypoints,), s

    Raises
    ------
    StudyError
        If the motion leaves the waypoints farther than `FARTHEST`.
    """
    span = np.ptp(waypoints, axis=0)
    widths = np.diff(knots)
    with np.errstate(all="ignore"):
        unit = np.moveaxis(coefficients, 1, 2) / np.where(span > 0, span, 1.0)[:, None]
        unit = unit * widths[:, None, None] ** np.arange(unit.shape[2])
    if not (np.abs(unit) < FARTHEST).all():
        raise StudyError(
            f"the motion is more than {FARTHEST:g} times the waypoints' span away from them; check its numbers"
        )
    targets = (waypoints / np.where(span > 0, span, 1.0))[1:-1]
    large = len(targets) * len(widths) > _LARGE
    near = _found_by_tree(unit, targets) if large else [_nearest(unit, target)[None] for target in targets]
    step = _TOGETHER if large else 1
    closest = [
        passage
        for k, pieces in zip(range(0, len(targets), step), near, strict=True)
        for passage in _closest(knots, widths, unit, pieces, targets[k : k + step])
    ]
    times = np.array([knots[0], *_in_order(closest), knots[-1]])
    return (
        times
        if tolerances is None or not tolerances.any()
        else _inside(knots, coefficients, waypoints, tolerances, times)
    )


def _inside(knots: Floats, coefficients: Floats, waypoints: Floats, tolerances: Floats, times: Floats) -> Floats:
    """Move passages, between those before and after, to where the largest share of a tolerance is least."""
    moved = times.copy()

    def shares(at: Floats, k: int) -> Floats:
        piece = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(knots) - 2)
        there = polynomial.value(np.moveaxis(coefficients[piece], 1, 2), (at - knots[piece])[:, None])
        return np.asarray((np.abs(there - waypoints[k]) / np.maximum(tolerances[k], 1e-12)).max(axis=1))

    for k in range(1, len(times) - 1):
        low, high, best = moved[k - 1], times[k + 1], float(shares(times[k : k + 1], k)[0])
        for _ in range(_FINER if best > 1 else 0):
            grid = np.linspace(low, high, 200)
            share = shares(grid, k)
            nearest = int(share.argmin())
            if share[nearest] < best:
                best, moved[k] = float(share[nearest]), grid[nearest]
            low, high = grid[max(nearest - 1, 0)], grid[min(nearest + 1, 199)]
    return moved


def _nearest(unit: Floats, target: Floats) -> NDArray[np.intp]:
    """Pieces whose ends lie nearest to one waypoint, in time order."""
    distance = np.linalg.norm(unit[:, :, 0] - target, axis=1)
    return np.sort(np.argsort(distance + np.append(distance[1:], distance[-1]), kind="stable")[:_NEAREST])


def _found_by_tree(unit: Floats, targets: Floats) -> Iterator[NDArray[np.intp]]:
    """The same for many waypoints, `_TOGETHER` at a time, shape (n, pieces): both ends of a piece are one point of a tree."""
    from scipy.spatial import KDTree  # here: slow to import

    starts = unit[:, :, 0]
    tree = KDTree(np.hstack([starts, np.vstack([starts[1:], starts[-1:]])]))
    for k in range(0, len(targets), _TOGETHER):
        yield np.sort(tree.query(np.tile(targets[k : k + _TOGETHER], 2), k=min(_NEAREST, len(starts)))[1], axis=1)


def _closest(
    knots: Floats, widths: Floats, unit: Floats, near: NDArray[np.intp], targets: Floats
) -> list[tuple[Floats, Floats]]:
    """Times of the closest passages of waypoints on pieces near to each, in time order, and the distances there."""
    offset = unit[near]
    offset[..., 0] -= targets[:, None]
    slope = polynomial.product(offset, polynomial.derivative(offset)).sum(axis=2)
    ends = np.zeros((*near.shape, 1))
    points = np.sort(np.concatenate([ends, polynomial.roots(slope), ends + 1.0], axis=-1), axis=-1)
    there = polynomial.value(offset[..., None, :], points[:, :, None, :])
    times = knots[near][..., None] + points * widths[near][..., None]
    distances = np.linalg.norm(there, axis=2)
    return list(zip(times.reshape(len(near), -1), distances.reshape(len(near), -1), strict=True))


def _in_order(closest: list[tuple[Floats, Floats]]) -> list[float]:
    """Pick one time for each waypoint, never decreasing, with the smallest sum of distances."""
    totals, choices = np.zeros(1), []
    before = np.array([-np.inf])
    for times, distances in closest:
        running = np.minimum.accumulate(totals)
        lower = np.append(True, running[1:] < running[:-1])
        best = np.maximum.accumulate(np.where(lower, np.arange(len(totals)), 0))
        last = np.searchsorted(before, times, side="right") - 1
        reachable = last >= 0
        choices.append(np.where(reachable, best[last], -1))
        totals = np.where(reachable, running[last] + distances, np.inf)
        before = times
    picked, index = [], int(totals.argmin())
    for (times, _), choice in zip(reversed(closest), reversed(choices), strict=True):
        picked.append(float(times[index]))
        index = int(choice[index])
    return picked[::-1]
