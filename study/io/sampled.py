"""A motion from samples, joined as controllers join them, so that anyone's trajectory can be put before the judge."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from study import polynomial
from study.errors import StudyError
from study.io.passages import passages
from study.io.samples import Samples
from study.io.waypoints import ROUNDED
from study.problem import EndCondition, Floats, Problem
from study.tolerances import TOLERANCE
from study.trajectory import Trajectory


class Interpolation(StrEnum):
    """Ways to join samples; ros2_controllers takes the one that the given rates allow."""

    LINEAR = "linear"
    CUBIC = "cubic"
    QUINTIC = "quintic"
    SPLINE = "spline"


SENTENCES = {
    Interpolation.LINEAR: "positions joined by straight lines",
    Interpolation.CUBIC: "positions and velocities: cubic Hermite pieces",
    Interpolation.QUINTIC: "positions, velocities and accelerations: quintic Hermite pieces",
    Interpolation.SPLINE: "positions only: a cubic spline with continuous acceleration",
}
NEEDS = {Interpolation.LINEAR: 0, Interpolation.CUBIC: 1, Interpolation.QUINTIC: 2, Interpolation.SPLINE: 0}
"""Rates that an interpolation needs beside positions."""


@dataclass(frozen=True, eq=False)
class SampledMotion:
    """A motion through samples and the sentence that says how it was made from them."""

    trajectory: Trajectory
    method: str


def joined(
    samples: Samples,
    problem: Problem,
    where: str,
    interpolation: Interpolation | None = None,
    passing: Floats | None = None,
) -> SampledMotion:
    """Join samples by polynomials.

    Parameters
    ----------
    samples : Samples
        In rad, m and s, its columns in the order of the problem's joints.
    problem : Problem
    where : str
        How a message begins.
    interpolation : Interpolation, optional
        By default positions alone make a cubic spline with continuous acceleration, positions and velocities a cubic, and
        accelerations too a quintic Hermite polynomial between samples.
    passing : array of shape (n_waypoints,), s, optional
        When the waypoints are passed; by default where the motion comes closest to them, in their order.

    Returns
    -------
    SampledMotion

    Raises
    ------
    StudyError
        If there are fewer than two samples, times are missing or do not increase, or the rates for an interpolation are
        missing.
    """
    times, rates = _times(samples, where), samples.rates
    chosen = interpolation or (Interpolation.SPLINE, Interpolation.CUBIC, Interpolation.QUINTIC)[len(rates)]
    if NEEDS[chosen] > len(rates):
        lacking = ("velocities", "accelerations")[len(rates)]
        raise StudyError(f"{where} has no {lacking}, which {chosen} interpolation needs")
    try:
        with np.errstate(all="ignore"):
            coefficients, said = _pieces(times, [samples.positions, *rates[: NEEDS[chosen]]], chosen, problem.end)
    except ValueError as error:
        raise StudyError(f"{where}: these samples cannot be joined in finite numbers: {error}") from None
    if not np.isfinite(coefficients).all():
        raise StudyError(
            f"{where}: these samples cannot be joined in finite numbers; look for steps in positions or times"
        )
    if passing is None:
        passing = passages(times, coefficients, problem.waypoints, problem.tolerances)
    return SampledMotion(Trajectory(times, coefficients, passing), said)


def _times(samples: Samples, where: str) -> Floats:
    if len(samples.positions) < 2:
        raise StudyError(f"{where}: at least two samples are needed, got {len(samples.positions)}")
    if samples.times is None:
        raise StudyError(f"{where} has no times; give a column 'time' in seconds")
    times = samples.times - samples.times[0]
    late = np.flatnonzero(np.diff(times) <= 0)
    if late.size:
        row = int(late[0])
        raise StudyError(
            f"{where}: times must increase, but sample {row + 2} has {samples.times[row + 1]:g} s after "
            f"{samples.times[row]:g} s"
        )
    return times


def _pieces(times: Floats, orders: Sequence[Floats], chosen: Interpolation, end: EndCondition) -> tuple[Floats, str]:
    """Ascending coefficients, shape (n_samples - 1, degree + 1, n_joints), and the sentence."""
    said = SENTENCES[chosen]
    if chosen is Interpolation.LINEAR:
        slopes = np.diff(orders[0], axis=0) / np.diff(times)[:, None]
        return np.stack([orders[0][:-1], slopes], axis=1), said
    if chosen is Interpolation.QUINTIC:
        return _quintic(times, np.stack(orders, axis=1)), said
    from scipy.interpolate import CubicHermiteSpline, CubicSpline  # here: slow to import

    if chosen is Interpolation.CUBIC:
        spline = CubicHermiteSpline(times, orders[0], orders[1])
    elif end is EndCondition.FREE:
        spline, said = CubicSpline(times, orders[0]), f"{said}, its ends as the samples suggest"
    else:
        spline, said = (
            CubicSpline(times, orders[0], bc_type="clamped"),
            f"{said}, taken to be at rest at both ends",
        )
    return np.moveaxis(spline.c[::-1], 0, 1), said


ROUNDING = 64 * float(np.finfo(float).eps)

CLOCK = 1e-9
"""Resolution of times in messages, s: where acceleration bends, the samples may stand as far from the bend."""


def _quintic(times: Floats, states: Floats) -> Floats:
    """Quintic pieces through positions, velocities and accelerations, states of shape (n_samples, 3, n_joints).

    In microseconds the third difference of positions is rounding and nothing else. Where linear acceleration meets the next
    sample to the last digits, or to what the clock's resolution leaves of a bend, the piece has linear acceleration.
    """
    h = np.diff(times)[:, None]
    (q0, v0, a0), (q1, v1, a1) = np.moveaxis(states[:-1], 1, 0), np.moveaxis(states[1:], 1, 0)
    unit = polynomial.hermite_quintic(q1 - q0, h * v0, h * v1, h**2 * a0, h**2 * a1)
    pieces = np.stack([q0, v0, a0 / 2, *(c / h**k for k, c in enumerate(unit[2:], 3))], axis=1)
    missed = np.abs(q0 + h * (v0 + h * (2 * a0 + a1) / 6) - q1), np.abs(v0 + h * (a0 + a1) / 2 - v1)
    position, velocity, _ = np.abs(states).max(axis=0)
    bent = 2 * CLOCK * h * (np.abs(a1 - a0) / h).max(axis=0)
    near = (missed[0] <= ROUNDING * position + h * bent) & (missed[1] <= ROUNDING * velocity + bent)
    linear = np.stack([q0, v0, a0 / 2, (a1 - a0) / (6 * h), np.zeros_like(q0), np.zeros_like(q0)], axis=1)
    return np.where(near[:, None], linear, pieces)


def breaches(samples: Samples, problem: Problem, room: float, where: str) -> list[str]:
    """Say of every joint which limits it breaks at the samples themselves, whatever happens between them.

    Parameters
    ----------
    samples : Samples
    problem : Problem
    room : float
        Share by which rates may exceed their limits; positions may lie beyond a range by rounding.
    where : str
        How a message begins.

    Returns
    -------
    list of str
        One sentence for each joint and limit. Rates that the file does not give are differences of neighbours.
    """
    times, most, said = _times(samples, where), 1.0 + max(room, TOLERANCE), list[str]()
    given = [*samples.rates]
    with np.errstate(all="ignore"):  # what is not finite is beyond every limit
        while len(given) < 2:
            given.append(np.gradient((samples.positions, *given)[len(given)], times, axis=0))
    for order, (name, values) in enumerate(zip(("velocity", "acceleration"), given, strict=True)):
        highest, lowest = problem.limits.highest_rates[order], problem.limits.lowest_rates[order]
        with np.errstate(all="ignore"):
            shares = np.where(np.isfinite(values), np.maximum(values / highest, values / lowest), np.inf)
        for joint in map(int, np.flatnonzero((shares > most).any(axis=0))):
            row = int(shares[:, joint].argmax())
            said.append(
                f"{name} of {problem.joint_names[joint]} reaches {shares[row, joint]:.6g} of its limit at {times[row]:.4f} s; "
                f"broken at {_listed_rows(shares[:, joint] > most)}"
            )
    excess = np.maximum(problem.limits.lower - samples.positions, samples.positions - problem.limits.upper)
    outside = excess > np.maximum(problem.position_tolerance, ROUNDED)
    for joint in map(int, np.flatnonzero(outside.any(axis=0))):
        row = int(excess[:, joint].argmax())
        said.append(
            f"{problem.joint_names[joint]} leaves its range by {excess[row, joint]:.3g} at {times[row]:.4f} s; "
            f"outside at {_listed_rows(outside[:, joint])}"
        )
    return said


def _listed_rows(marked: NDArray[np.bool_]) -> str:
    """Numbers of the marked samples, counted from 1, neighbours as ranges."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marked, [False]]).astype(int)))
    runs = [(int(first) + 1, int(last)) for first, last in edges.reshape(-1, 2)]
    texts = [f"{first}" if first == last else f"{first} to {last}" for first, last in runs[:6]]
    more = [f"{len(runs) - 6} more stretches"] if len(runs) > 6 else []
    return f"sample{'s' if marked.sum() > 1 else ''} {', '.join([*texts, *more])}"
