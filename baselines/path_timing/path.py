"""Paths through waypoints, cubic splines in a parameter, and motions along them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from study import polynomial
from study.curves import cubic_spline
from study.problem import Floats, JointLimits
from study.tolerances import FLOOR

PathRule = Callable[[Floats, JointLimits], "Path"]
"""A way to lay a path through distinct neighbouring waypoints."""


@dataclass(frozen=True, eq=False)
class Path:
    """A cubic spline q(s) through waypoints.

    Attributes
    ----------
    knots : array of shape (n_segments + 1,)
        Path parameter at the waypoints, from 0.
    cubics : array of shape (n_segments, 4, n_joints)
        Ascending powers of the parameter since the segment's start.
    clamped : bool
        Whether q' is zero at both ends, so that the joints rest there at any path speed.
    rough : bool
        Whether q'' steps at knots.
    """

    knots: Floats
    cubics: Floats
    clamped: bool = True
    rough: bool = False

    def at(self, s: Floats) -> Floats:
        """Cubics rewritten about given parameters, shape (n, 4, n_joints)."""
        segment = np.clip(np.searchsorted(self.knots, s, side="right") - 1, 0, len(self.cubics) - 1)
        ascending = np.moveaxis(self.cubics[segment], 1, 2)
        return np.moveaxis(polynomial.shifted(ascending, (s - self.knots[segment])[:, None]), 2, 1)


def chord_path(waypoints: Floats, limits: JointLimits) -> Path:
    """Lay the clamped cubic spline through distinct neighbouring waypoints.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    limits : JointLimits
        Joints are measured by their velocity limits, or by the next limit that is finite.
    """
    chords = chord_lengths(waypoints, limits)
    cubics = np.moveaxis(cubic_spline.unit_coefficients(waypoints, chords[None])[0], 1, 2)
    return Path(np.concatenate([[0.0], np.cumsum(chords)]), cubics / chords[:, None, None] ** np.arange(4)[:, None])


def centripetal_path(waypoints: Floats, limits: JointLimits) -> Path:
    """Lay the natural cubic spline, its parameter by the roots of the chords, through distinct neighbouring waypoints.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    limits : JointLimits
        As for `chord_path`.
    """
    knots = np.concatenate([[0.0], np.cumsum(np.sqrt(chord_lengths(waypoints, limits)))])
    spline = CubicSpline(knots, waypoints, bc_type="natural")
    return Path(knots, np.moveaxis(spline.c[::-1], 0, 1), clamped=False)


def roomy_path(waypoints: Floats, limits: JointLimits) -> Path:
    """Lay `centripetal_path`, with gentler slopes at waypoints next to which it would leave the range of positions.

    A cubic between neighbours is monotone where its slopes have the sign of the step and are at most three times its
    mean slope, and then stays between them. Slopes are cut down to that where they must be, so q'' steps there.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    limits : JointLimits
        As for `chord_path`; the range counts, too.

    References
    ----------
    J. M. Hyman, Accurate monotonicity preserving cubic interpolation, SIAM J. Sci. Stat. Comput. 4(4), 1983.
    """
    path = centripetal_path(waypoints, limits)
    slopes, wanted = np.append(path.cubics[:, 1], path.at(path.knots[-1:])[:, 1], axis=0), _monotone(path, waypoints)
    for _ in range(len(waypoints)):
        leaves = _leaves(path, limits)
        if not leaves.any():
            break
        near = np.pad(leaves, ((0, 1), (0, 0))) | np.pad(leaves, ((1, 0), (0, 0)))
        slopes = np.where(near, np.clip(slopes, *wanted), slopes)
        cubics = CubicHermiteSpline(path.knots, waypoints, slopes).c
        path = Path(path.knots, np.moveaxis(cubics[::-1], 0, 1), clamped=False, rough=True)
    return path


def _monotone(path: Path, waypoints: Floats) -> tuple[Floats, Floats]:
    """Lowest and highest slopes at the waypoints with which cubics are monotone, each (n_waypoints, n_joints)."""
    mean = 3 * np.diff(waypoints, axis=0) / np.diff(path.knots)[:, None]
    left, right = np.concatenate([mean[:1], mean]), np.concatenate([mean, mean[-1:]])
    return np.minimum(np.maximum(left, right), 0.0), np.maximum(np.minimum(left, right), 0.0)


def _leaves(path: Path, limits: JointLimits) -> np.ndarray:
    """Tell of cubics if they leave the range of positions, shape (n_segments, n_joints)."""
    unit = polynomial.stretched(np.moveaxis(path.cubics, 1, 2), np.diff(path.knots)[:, None])
    lowest, _, highest, _ = polynomial.extrema(unit)
    return np.asarray((lowest < limits.lower - FLOOR) | (highest > limits.upper + FLOOR))


def chord_lengths(waypoints: Floats, limits: JointLimits) -> Floats:
    """Distances between neighbours, every joint in units of its first finite limit, shape (n_segments,)."""
    unit = np.array([next((rate for rate in joint if np.isfinite(rate)), 1.0) for joint in limits.rates.T])
    return np.linalg.norm(np.diff(waypoints, axis=0) / unit, axis=1)


def grid(path: Path, per_segment: int) -> Floats:
    """Grid of the path parameter with every knot on it, shape (n_segments * per_segment + 1,)."""
    inner = [np.linspace(a, b, per_segment, endpoint=False) for a, b in zip(path.knots, path.knots[1:], strict=False)]
    return np.append(np.concatenate(inner), path.knots[-1])


def compose(path: Path, points: Floats, speeds: Floats) -> tuple[Floats, Floats]:
    """Drive a path with constant path acceleration between gridpoints.

    Returns
    -------
    durations : array of shape (n_gridpoints - 1,), s
    coefficients : array of shape (n_gridpoints - 1, 7, n_joints)
        The cubic of the path in the quadratic s(t): exact, degree 6.
    """
    steps = np.diff(points)
    durations = 2 * steps / (speeds[:-1] + speeds[1:])
    s = np.stack([np.zeros_like(steps), speeds[:-1], np.diff(speeds) / durations / 2], axis=1)[:, None, :]
    driven = polynomial.composed(np.moveaxis(path.at(points[:-1]), 1, 2), s)
    return durations, np.moveaxis(driven, 1, 2)
