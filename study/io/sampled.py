"""A motion from samples in a CSV file, so that anyone's trajectory can be put before the judge."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import BPoly, CubicHermiteSpline, CubicSpline, PPoly

from study import polynomial
from study.errors import StudyError, unknown
from study.io.table import csv_cells, decimal
from study.problem import EndCondition, Floats, Problem
from study.trajectory import Trajectory

UNITS = ("rad", "deg")
_NEAREST = 64  # pieces looked at for each waypoint


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """A motion through samples and the sentence that says how it was made from them."""

    trajectory: Trajectory
    method: str


def read_motion(
    path: Path, problem: Problem, units: str = "rad", angular: tuple[bool, ...] | None = None
) -> SampledMotion:
    """Read samples and join them by polynomials.

    Parameters
    ----------
    path : Path
        CSV with the columns time (s), one position per joint and, optionally, one velocity and then one acceleration
        per joint; a header line is allowed.
    problem : Problem
    units : str
        `rad`: SI units; `deg`: angles in degrees, and their rates per second.
    angular : tuple of bool, optional
        Which joints are angles; all by default.

    Returns
    -------
    SampledMotion
        Positions alone make a cubic spline with continuous acceleration, positions and velocities a cubic, and
        accelerations too a quintic Hermite polynomial between samples. Waypoints are passed where the motion comes closest
        to them, in their order.

    Raises
    ------
    StudyError
        If the file cannot be read, is not a table of numbers with the right columns, or times do not increase.
    """
    if units not in UNITS:
        raise unknown("unit", units, UNITS)
    table = _table(path, problem.n_joints)
    if units == "deg":
        turning = np.array(angular if angular is not None else (True,) * problem.n_joints)
        factors = np.where(turning, np.pi / 180.0, 1.0)
        table[:, 1:] *= np.tile(factors, (table.shape[1] - 1) // problem.n_joints)
    times = table[:, 0] - table[0, 0]
    samples = [
        table[:, 1 + k * problem.n_joints : 1 + (k + 1) * problem.n_joints] for k in range(_orders(table, problem))
    ]
    pieces, method = _interpolated(times, samples, problem.end)
    coefficients = np.moveaxis(pieces.c[::-1], 0, 1)
    return SampledMotion(Trajectory(times, coefficients, passages(times, coefficients, problem.waypoints)), method)


def _orders(table: Floats, problem: Problem) -> int:
    return (table.shape[1] - 1) // problem.n_joints


def _table(path: Path, n_joints: int) -> Floats:
    rows = _rows(path)
    if len(rows) < 2:
        raise StudyError(f"file {path}: at least two samples are needed, got {len(rows)}")
    allowed = [1 + k * n_joints for k in (1, 2, 3)]
    for number, row in rows:
        if len(row) not in allowed or len(row) != len(rows[0][1]):
            raise StudyError(
                f"file {path}, line {number}: expected {', '.join(map(str, allowed[:-1]))} or {allowed[-1]} columns (time, then "
                f"positions, velocities, accelerations of {n_joints} joints), the same on every line, got {len(row)}"
            )
    table = np.array([[_number(path, number, text) for text in row] for number, row in rows])
    late = np.flatnonzero(np.diff(table[:, 0]) <= 0)
    if late.size:
        row = late[0]
        raise StudyError(
            f"file {path}, line {rows[row + 1][0]}: times must increase, got {table[row + 1, 0]:g} s after {table[row, 0]:g} s"
        )
    return table


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is not a text file"
        raise StudyError(f"cannot read file {path}: {reason}") from error
    rows = csv_cells(text)
    return rows[1:] if rows and not _numeric(rows[0][1][0]) else rows


def _numeric(text: str) -> bool:
    try:
        decimal(text)
    except ValueError:
        return False
    return True


def _number(path: Path, line: int, text: str) -> float:
    value = decimal(text) if _numeric(text) else np.nan
    if not np.isfinite(value):
        raise StudyError(f"file {path}, line {line}: expected a finite number, got {text.strip()!r}")
    return value


def _interpolated(times: Floats, samples: list[Floats], end: EndCondition) -> tuple[PPoly[np.float64], str]:
    if len(samples) == 3:
        bernstein = BPoly.from_derivatives(times, np.stack(samples, axis=1))
        return PPoly.from_bernstein_basis(bernstein), "positions, velocities and accelerations: quintic Hermite pieces"
    if len(samples) == 2:
        return CubicHermiteSpline(times, samples[0], samples[1]), "positions and velocities: cubic Hermite pieces"
    said = "positions only: a cubic spline with continuous acceleration"
    if end is EndCondition.FREE:
        return CubicSpline(times, samples[0], bc_type="not-a-knot"), f"{said}, its ends as the samples suggest"
    return CubicSpline(times, samples[0], bc_type="clamped"), f"{said}, taken to be at rest at both ends"


def passages(knots: Floats, coefficients: Floats, waypoints: Floats) -> Floats:
    """Find when a piecewise polynomial comes closest to waypoints, in their order.

    The first waypoint belongs to the first instant and the last one to the last. Of all increasing sequences of closest
    passages the one with the smallest sum of distances is taken.

    Parameters
    ----------
    knots : array of shape (n_pieces + 1,), s
    coefficients : array of shape (n_pieces, degree + 1, n_joints)
        Ascending powers of the time since the piece's first knot.
    waypoints : array of shape (n_waypoints, n_joints)

    Returns
    -------
    array of shape (n_waypoints,), s
    """
    span = np.ptp(waypoints, axis=0)
    unit = np.moveaxis(coefficients, 1, 2) / np.where(span > 0, span, 1.0)[:, None]
    widths = np.diff(knots)
    unit = unit * widths[:, None, None] ** np.arange(unit.shape[2])
    targets = waypoints / np.where(span > 0, span, 1.0)
    found = [_closest(knots, widths, unit, target) for target in targets[1:-1]]
    return np.array([knots[0], *_in_order(found), knots[-1]])


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


def _in_order(found: list[tuple[Floats, Floats]]) -> list[float]:
    """Pick one time for each waypoint, never decreasing, with the smallest sum of distances."""
    totals, choices = np.zeros(1), []
    before = np.array([-np.inf])
    for times, distances in found:
        running = np.minimum.accumulate(totals)
        best = np.array([int(np.flatnonzero(totals[: i + 1] == running[i])[0]) for i in range(len(totals))])
        last = np.searchsorted(before, times, side="right") - 1
        reachable = last >= 0
        choices.append(np.where(reachable, best[last], -1))
        totals = np.where(reachable, running[last] + distances, np.inf)
        before = times
    picked, index = [], int(totals.argmin())
    for (times, _), choice in zip(reversed(found), reversed(choices), strict=True):
        picked.append(float(times[index]))
        index = int(choice[index])
    return picked[::-1]
