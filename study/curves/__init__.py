"""Curve families: waypoints and segment durations make a motion; a whole population is evaluated in one call."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from study.curves import bspline, cubic_spline, cubic_spline_smooth, poly353
from study.errors import StudyError, unknown
from study.problem import EndCondition, Floats
from study.trajectory import Motion, Trajectory


class Peaks(Protocol):
    """Exact peak rates of a whole population."""

    def __call__(self, waypoints: Floats, durations: Floats, orders: tuple[int, ...] = (1, 2, 3)) -> Floats:
        """Shape (n_candidates, len(orders), n_joints)."""


def demanded(peaks: Floats, limits: Floats, orders: tuple[int, ...]) -> Floats:
    """Stretch factor that peak rates demand, k = max(v/V, sqrt(a/A), cbrt(j/J)) over orders and joints.

    Parameters
    ----------
    peaks : array of shape (n_candidates, len(orders), n_joints)
    limits : array of shape (len(orders), n_joints)
    orders : tuple of int

    Returns
    -------
    array of shape (n_candidates,)
    """
    ratios = (peaks / limits).max(axis=2)
    return (ratios ** (1.0 / np.array(orders))).max(axis=1)


def penalised(durations: Floats, factors: Floats, charge: float) -> Floats:
    """Penalised total times: an infeasible candidate pays a charge in proportion to its stretch factor.

    Parameters
    ----------
    durations : array of shape (n_candidates, n_segments), s
    factors : array of shape (n_candidates,)
        As `demanded` has them.
    charge : float, s

    Returns
    -------
    array of shape (n_candidates,), s
    """
    total = np.add.reduce(durations, axis=1)  # for few candidates in half the time of their own `sum`
    return np.where(factors > 1.0, total + charge * factors, total)


@dataclass(frozen=True)
class Curve:
    """Curve family through waypoints.

    Attributes
    ----------
    name : str
    end : EndCondition
        What the family guarantees at both ends.
    peaks : callable (waypoints, durations of shape (n_candidates, n_segments), orders) -> array
        Exact peak rates of the asked orders, shape (n_candidates, len(orders), n_joints).
    motion : callable (waypoints, durations of shape (n_segments,)) -> Motion
    demand : callable (peaks, limits, orders) -> array
        The factor on all durations that peak rates demand, shape (n_candidates,); see `demanded`.
    penalty : callable (durations, factors, charge) -> array
        Penalised total times, shape (n_candidates,); see `penalised`.
    """

    name: str
    end: EndCondition
    peaks: Peaks
    motion: Callable[[Floats, Floats], Motion]
    demand: Callable[[Floats, Floats, tuple[int, ...]], Floats] = demanded
    penalty: Callable[[Floats, Floats, float], Floats] = penalised


def _polynomial_motion(unit_coefficients: Callable[[Floats, Floats], Floats]) -> Callable[[Floats, Floats], Motion]:
    def motion(waypoints: Floats, durations: Floats) -> Motion:
        durations = _checked(waypoints, durations)
        unit = np.moveaxis(unit_coefficients(waypoints, durations[None])[0], 1, 2)
        powers = durations[:, None] ** np.arange(unit.shape[1])
        return Trajectory.from_pieces(durations, unit / powers[:, :, None])

    return motion


def _smooth_spline_motion(waypoints: Floats, durations: Floats) -> Motion:
    durations = _checked(waypoints, durations)
    pieces = cubic_spline_smooth.halved(durations[None])[0]
    unit = np.moveaxis(cubic_spline_smooth.unit_coefficients(waypoints, durations[None])[0], 1, 2)
    counts = np.ones(len(durations), dtype=int)
    counts[[0, -1]] = 2
    return Trajectory.from_pieces(pieces, unit / (pieces[:, None] ** np.arange(4))[:, :, None], counts)


def _checked(waypoints: Floats, durations: Floats) -> Floats:
    durations = np.asarray(durations, dtype=float)
    if durations.shape != (len(waypoints) - 1,) or not (durations > 0).all():
        raise StudyError(
            f"durations must be {len(waypoints) - 1} positive numbers, one for each segment, got {durations.tolist()}"
        )
    return durations


CURVES = {
    curve.name: curve
    for curve in (
        Curve("poly353", EndCondition.SMOOTH, poly353.peaks, _polynomial_motion(poly353.unit_coefficients)),
        Curve(
            "cubic-spline", EndCondition.REST, cubic_spline.peaks, _polynomial_motion(cubic_spline.unit_coefficients)
        ),
        Curve("cubic-spline-smooth", EndCondition.SMOOTH, cubic_spline_smooth.peaks, _smooth_spline_motion),
        Curve("bspline", EndCondition.FREE, bspline.peaks, bspline.trajectory),
    )
}


def curve_named(name: str) -> Curve:
    """Curve family of a name.

    Raises
    ------
    StudyError
        If there is no such family.
    """
    if not isinstance(name, str) or name not in CURVES:
        raise unknown("curve", name, CURVES)
    return CURVES[name]
