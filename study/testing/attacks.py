"""Random motions that try to fool a judge: near every limit from both sides, and broken in ways that are easy to overlook."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import cast

import numpy as np

from study.curves import CURVES
from study.errors import StudyError
from study.problem import EndCondition, Floats, JointLimits, Problem, State, StraightPath, Timing, Tube
from study.tolerances import TOLERANCE
from study.trajectory import Trajectory

Pair = tuple[Problem, Trajectory]


def adversarial(seed: int, number: int) -> tuple[str, Problem, Trajectory]:
    """Draw one motion and a problem that it may or may not solve; the kind of attack comes first."""
    rng = np.random.default_rng([seed, number])
    problem, motion = _base(rng)
    if rng.random() < 0.5:
        problem, motion = _demanding(rng, problem, motion)
    kind = list(ATTACKS)[number % len(ATTACKS)]
    try:
        with np.errstate(all="ignore"):
            problem, motion = ATTACKS[kind](rng, problem, motion)
    except StudyError:  # such a motion or problem is refused before it can be judged
        kind = "none"
    return kind, problem, motion


def _base(rng: np.random.Generator) -> Pair:
    """A curve through random waypoints, and limits that it just keeps, or nearly keeps."""
    n_joints, n_waypoints = int(rng.integers(1, 4)), int(rng.integers(2, 7))
    points = 10.0 ** rng.uniform(-3, 3, n_joints) * rng.normal(size=(n_waypoints, n_joints))
    if n_joints > 1 and rng.random() < 0.3:
        points[:, 0] = points[0, 0] * (1 + 1e-16 * rng.normal(size=n_waypoints))
    durations = 10.0 ** rng.uniform(-2, 2) * rng.uniform(0.2, 1.0, n_waypoints - 1)
    smooth = cast(Trajectory, CURVES["cubic-spline"].motion(points, durations))
    motion = _stopping(points, durations) if rng.random() < 0.4 else smooth
    peaks = np.stack([motion.extrema(order).peak for order in (1, 2, 3)])
    share = 1 + rng.choice([0.0, 0.9e-6, 1.1e-6, -0.1, 0.1, 1e-3, -1e-3]) * rng.random((3, n_joints))
    rates = np.where(peaks > 0, peaks, 1.0) * share
    rates[int(rng.integers(1, 4)) :] = np.inf
    return Problem("adversarial", points, JointLimits(*rates), list(EndCondition)[int(rng.integers(2))]), motion


def _stopping(points: Floats, durations: Floats) -> Trajectory:
    """Straight from waypoint to waypoint, 10s^3 - 15s^4 + 6s^5: it stops smoothly at each."""
    step, t = np.diff(points, axis=0), durations[:, None]
    pieces = [points[:-1], 0 * step, 0 * step, 10 * step / t**3, -15 * step / t**4, 6 * step / t**5]
    return Trajectory.from_pieces(durations, np.stack(pieces, axis=1))


def _near(rng: np.random.Generator, value: float) -> float:
    """Put a bound just inside, just outside or clearly on one side of a value."""
    return value * (1 + float(rng.choice([1e-9, -1e-9, 2e-6, -2e-6, 0.1, -0.1])))


def _demanding(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    """Ask for one thing more, nearly what the motion does."""
    demand = rng.choice(list(_MORE))
    try:
        return _MORE[demand](rng, problem, motion)
    except StudyError:  # what the motion does cannot be asked for
        return problem, motion


def _by_direction(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    lowest = np.stack([np.minimum(motion.extrema(order).lowest, -1e-3) for order in (1, 2, 3)])
    lowest = lowest * (1 + rng.choice([1e-9, 2e-6, -2e-6]))
    limits = replace(problem.limits, min_velocity=lowest[0], min_acceleration=lowest[1])
    return replace(problem, limits=limits), motion


def _by_segment(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    segment = int(rng.integers(problem.n_segments))
    part = motion.between(*motion.waypoint_times[segment : segment + 2])
    peak = np.maximum(part.extrema(1).peak, 1e-6)
    return replace(problem, segment_limits={segment: JointLimits(peak * _near(rng, 1.0))}), motion


def _with_range(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    span = motion.extrema()
    room = np.maximum(span.highest - span.lowest, 1e-6) * (_near(rng, 1.0) - 1)
    limits = replace(problem.limits, lower=span.lowest - room, upper=span.highest + room)
    return replace(problem, limits=limits), motion


def _with_states(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    rates = [motion(0.0, order)[0] * _near(rng, 1.0) for order in (1, 2)]
    return replace(problem, start=State(*rates), finish=EndCondition.FREE), motion


def _with_stop(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    return replace(problem, stops=[int(rng.integers(1, problem.n_waypoints))]), motion


def _with_dwell(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    """Stand still at a waypoint that the motion stops at, for about as long as demanded."""
    waypoint, time = int(rng.integers(1, problem.n_waypoints)), float(rng.uniform(0.1, 1.0))
    dwelling = replace(problem, dwells={waypoint: time})
    piece = int(np.searchsorted(motion.knots, motion.waypoint_times[waypoint]))
    rest = np.zeros((1, *motion.coefficients.shape[1:]))
    rest[0, 0] = problem.waypoints[waypoint]
    coefficients = np.concatenate([motion.coefficients[:piece], rest, motion.coefficients[piece:]])
    durations = np.insert(np.diff(motion.knots), piece, _near(rng, time))
    counts = np.bincount(np.arange(problem.n_segments), minlength=problem.n_segments)
    counts[waypoint] += 1
    return dwelling, Trajectory.from_pieces(durations, coefficients, counts)


def _with_tolerance(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    tolerance = 10.0 ** rng.uniform(-8, 0, problem.waypoints.shape)
    moved = problem.waypoints + tolerance * rng.choice([0.0, 0.999, 1.001], tolerance.shape)
    return replace(problem, waypoints=moved, tolerance=tolerance), motion


def _with_path(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    size = np.maximum(np.ptp(problem.waypoints, axis=0), 1e-3) * 10.0 ** rng.uniform(-2, 0.5)
    path = Tube(size) if rng.random() < 0.5 else StraightPath(size * rng.integers(2))
    return replace(problem, path=path), motion


def _with_timing(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    kind = rng.choice(["exactly", "at_least", "cycle"])
    time = motion.duration / (int(rng.integers(1, 2000)) if kind == "cycle" else 1)
    return replace(problem, timing=Timing(**{kind: _near(rng, time)})), motion


_MORE: dict[str, Callable[[np.random.Generator, Problem, Trajectory], Pair]] = {
    "directions": _by_direction,
    "segments": _by_segment,
    "range": _with_range,
    "states": _with_states,
    "stop": _with_stop,
    "dwell": _with_dwell,
    "tolerance": _with_tolerance,
    "path": _with_path,
    "timing": _with_timing,
}


def _as_it_is(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    return problem, motion


def _ulp(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    """Limits one unit in the last place above or below what the motion reaches with the tolerance."""
    peaks = np.stack([motion.extrema(order).peak for order in (1, 2, 3)])
    rates = np.where(peaks > 0, peaks, 1.0) / (1 + TOLERANCE)
    rates = np.nextafter(rates, rates * rng.choice([0.5, 2.0], rates.shape))
    return replace(problem, limits=JointLimits(*rates)), motion


def _bump(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    """A bump inside a piece that leaves both its ends, and their rates, as they were."""
    piece, joint = int(rng.integers(len(motion.knots) - 1)), int(rng.integers(motion.n_joints))
    width, size = np.diff(motion.knots)[piece], 10.0 ** rng.uniform(-9, 1) * np.ptp(problem.waypoints[:, joint])
    power = int(rng.integers(1, 4))
    bump = np.array([1.0])
    for _ in range(power):
        bump = np.convolve(bump, [0.0, 4.0, -4.0])
    degree = max(motion.degree, len(bump) - 1)
    coefficients = np.zeros((len(motion.knots) - 1, degree + 1, motion.n_joints))
    coefficients[:, : motion.degree + 1] = motion.coefficients
    coefficients[piece, : len(bump), joint] += size * bump / width ** np.arange(len(bump))
    return problem, replace(motion, coefficients=coefficients)


def _jump(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    """Everything after a knot is moved, or turns, a little."""
    piece, joint, order = (
        int(rng.integers(len(motion.knots) - 1)),
        int(rng.integers(motion.n_joints)),
        int(rng.integers(3)),
    )
    coefficients = motion.coefficients.copy()
    span = np.ptp(problem.waypoints[:, joint]) / motion.duration**order
    coefficients[piece:, order, joint] += 10.0 ** rng.uniform(-9, 0) * span
    return problem, replace(motion, coefficients=coefficients)


def _swap(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    """Two waypoints, and the times at which they are said to be passed, change places."""
    i, j = rng.integers(problem.n_waypoints, size=2)
    order = np.arange(problem.n_waypoints)
    order[[i, j]] = order[[j, i]]
    swapped = replace(problem, waypoints=problem.waypoints[order], tolerance=problem.tolerances[order])
    return swapped, replace(motion, waypoint_times=motion.waypoint_times[order])


def _late(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    """The motion begins before its first waypoint or ends after its last."""
    shares = rng.uniform(0.0, 0.5, 2) * rng.integers(2, size=2)
    passed = motion.duration * np.array([shares[0], 1 - shares[1]])
    times = np.concatenate([passed[:1], motion.waypoint_times[1:-1], passed[1:]])
    return replace(problem, waypoints=motion(times), path=None, segment_limits={}), replace(
        motion, waypoint_times=times
    )


def _overflow(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    """A first piece of next to no time, with coefficients that overflow, vanish or hide a distance."""
    width = 10.0 ** rng.uniform(-250, -30)
    first = np.zeros((1, *motion.coefficients.shape[1:]))
    first[0, 0] = motion.coefficients[0, 0]
    power = int(rng.integers(1, motion.degree + 1))
    first[0, power, 0] = min(10.0 ** rng.uniform(0, 307), 1e-3 / max(width**power, 1e-300))
    knots = np.concatenate([[0.0, width], motion.knots[1:]])
    return problem, Trajectory(knots, np.concatenate([first, motion.coefficients]), motion.waypoint_times)


def _extreme(rng: np.random.Generator, problem: Problem, motion: Trajectory) -> Pair:
    """The same motion in units in which numbers come near the end of double precision."""
    factor = 10.0 ** rng.uniform(-15, 15)
    dwells = {waypoint: time * factor for waypoint, time in problem.dwells.items()}
    limits = problem.limits.scaled(factor)
    return replace(problem, limits=limits, dwells=dwells, duration_bounds=(0.0, 1e300)), motion.scaled(factor)


ATTACKS: dict[str, Callable[[np.random.Generator, Problem, Trajectory], Pair]] = {
    "none": _as_it_is,
    "one unit in the last place": _ulp,
    "bump between knots": _bump,
    "jump": _jump,
    "swapped waypoints": _swap,
    "begins early or ends late": _late,
    "overflow": _overflow,
    "extreme units": _extreme,
}
