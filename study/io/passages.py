"""Times at which a motion passes waypoints, found from its path alone."""

from __future__ import annotations

import numpy as np

from study import polynomial
from study.errors import StudyError
from study.problem import Floats

_FINER = 5
"""Times that a grid of 200 instants is laid between the neighbours of its best one."""

_NEAREST = 64  # pieces looked at for each waypoint
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
    targets = waypoints / np.where(span > 0, span, 1.0)
    closest = [_closest(knots, widths, unit, target) for target in targets[1:-1]]
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


def _closest(knots: Floats, widths: Floats, unit: Floats, target: Floats) -> tuple[Floats, Floats]:
    """Times of the closest passages of one waypoint in time order, and the distances there."""
    offset = unit.copy()
    offset[:, :, 0] -= target
    distance = np.linalg.norm(offset[:, :, 0], axis=1)
    near = np.sort(np.argsort(distance + np.append(distance[1:], distance[-1]), kind="stable")[:_NEAREST])
    slope = polynomial.product(offset[near], polynomial.derivative(offset[near])).sum(axis=1)
    points = np.sort(np.pad(polynomial.roots(slope), ((0, 0), (1, 1)), constant_values=((0, 0), (0, 1))), axis=1)
    there = polynomial.value(offset[near][:, :, None, :], points[:, None, :])
    times = knots[near][:, None] + points * widths[near][:, None]
    return times.ravel(), np.linalg.norm(there, axis=1).ravel()


def _in_order(closest: list[tuple[Floats, Floats]]) -> list[float]:
    """Pick one time for each waypoint, never decreasing, with the smallest sum of distances."""
    totals, choices = np.zeros(1), []
    before = np.array([-np.inf])
    for times, distances in closest:
        running = np.minimum.accumulate(totals)
        best = np.array([int(np.flatnonzero(totals[: i + 1] == running[i])[0]) for i in range(len(totals))])
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
