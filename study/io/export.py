"""A motion as a file: samples at a rate, a ROS 2 message, arrays, or the exact polynomials."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from study.cautions import require_bounded
from study.errors import StudyError
from study.files import csv_text, write_file
from study.io.exact import exact_text
from study.io.joint_trajectory import message_json, message_yaml
from study.io.samples import NANOSECONDS, Samples
from study.io.sampling import Sampling
from study.parametric import ParametricTrajectory
from study.problem import Floats, Problem
from study.trajectory import Motion

STEP = 1e-6
"""Largest step in acceleration that is rounding, as a part of the largest acceleration."""

SMALLEST = 1e-9
"""Rates at both ends below this part of their largest value are rounding, and written as zero."""


def write_motion(
    motion: Motion,
    problem: Problem,
    path: Path,
    sampling: Sampling | None = None,
    *,
    accept_unbounded_acceleration: bool = False,
) -> Path:
    """Write a motion in the form that the file's name asks for.

    Parameters
    ----------
    motion : Motion
    problem : Problem
        Gives names to the joints.
    path : Path
        `.csv`: samples of time, positions, velocities and, where they are continuous, accelerations; `.yaml` and `.json`: the
        same as a ROS 2 `trajectory_msgs/JointTrajectory`; `.npz`: samples and exact coefficients as arrays; `.exact.json`: the
        piecewise polynomials, which `study.io.exact.read_exact` gives back to the last bit.
    sampling : Sampling, optional
    accept_unbounded_acceleration : bool
        Whether a motion may be written whose speed changes in an instant, which no arm can follow.

    Returns
    -------
    Path

    Raises
    ------
    StudyError
        If the ending is another, the sampling is impossible, the file cannot be written, or a joint that moves has no
        acceleration limit and that is not accepted.
    """
    form = form_of(path)
    if form in MESSAGES:
        points = controller_points(
            motion, problem, sampling, accept_unbounded_acceleration=accept_unbounded_acceleration
        )
        return write_file(path, WRITERS[form](points, motion, problem))
    require_bounded(problem, accept_unbounded_acceleration)
    if form == ".exact.json":
        return write_file(path, exact_text(motion, problem))
    times = (sampling or Sampling()).times(motion, problem)
    return write_file(path, WRITERS[form](points_of(motion, problem, times), motion, problem))


def controller_points(
    motion: Motion, problem: Problem, sampling: Sampling | None = None, *, accept_unbounded_acceleration: bool = False
) -> Samples:
    """Points of a motion for a controller object, the same as in a ROS message.

    Times are whole nanoseconds, and positions and rates are the motion's at these rounded times; the last point is the
    motion's end, at its duration to the nearest nanosecond. Nothing else is rounded. Velocities or accelerations that step
    somewhere are left out, as in files, and where the motion is at rest at its ends they are exactly zero there.

    Parameters
    ----------
    motion : Motion
    problem : Problem
        Gives names to the joints.
    sampling : Sampling, optional
    accept_unbounded_acceleration : bool
        As in `write_motion`.

    Returns
    -------
    Samples
        Names, times in s and as `nanoseconds`, positions, velocities and accelerations in rad or m and s.

    Raises
    ------
    StudyError
        If the sampling is impossible, or a joint that moves has no acceleration limit and that is not accepted.
    """
    require_bounded(problem, accept_unbounded_acceleration)
    times = (sampling or Sampling()).times(motion, problem)
    rounded = np.unique(np.round(times * NANOSECONDS)) / NANOSECONDS
    points = points_of(motion, problem, np.append(rounded[:-1], motion.duration))
    return replace(points, times=rounded)


def points_of(motion: Motion, problem: Problem, times: Floats) -> Samples:
    """Samples as controllers take them: rates only where they are continuous, and exact zeros at both ends.

    Parameters
    ----------
    motion : Motion
    problem : Problem
    times : array of shape (n_samples,), s
    """
    rates = [_rates(motion, times, order) for order in (1, 2)]
    smooth = [_continuous(motion, order, rate) for order, rate in enumerate(rates, start=1)]
    return Samples(
        positions=motion(times),
        names=tuple(problem.joint_names),
        si=True,
        times=times,
        velocities=rates[0] if smooth[0] else None,
        accelerations=rates[1] if all(smooth) else None,
    )


def _continuous(motion: Motion, order: int, values: Floats) -> bool:
    return bool(np.abs(motion.jumps(order)).max(initial=0.0) <= STEP * max(1.0, float(np.abs(values).max())))


def _rates(motion: Motion, times: Floats, order: int) -> Floats:
    """Rates at some instants, exactly zero at both ends where rounding is all that is there."""
    values = motion(times, order)
    small = np.abs(values) <= SMALLEST * motion.extrema(order).peak.max()
    small[1:-1] = False
    return np.where(small, 0.0, values)


def form_of(path: Path) -> str:
    """Ending that says in which form a file is written.

    Raises
    ------
    StudyError
        If there is no such form.
    """
    kind = ".exact.json" if path.name.endswith(".exact.json") else path.suffix.lower()
    if kind not in FORMS:
        raise StudyError(f"cannot write {str(path)!r}: its name must end in one of {', '.join(FORMS)}")
    return kind


def samples_text(samples: Samples, motion: Motion, problem: Problem) -> str:
    """Samples as `study check` reads them: time, then positions, velocities and accelerations of all joints."""
    columns = [samples.positions, *samples.rates]
    kinds = ("", "velocity of ", "acceleration of ")[: len(columns)]
    header = ["time", *(f"{kind}{name}" for kind in kinds for name in samples.names)]
    table = np.column_stack([np.asarray(samples.times), *columns])
    return csv_text([header, *([repr(value) for value in row] for row in table.tolist())], quoted=";\t")


def npz_bytes(samples: Samples, motion: Motion, problem: Problem) -> bytes:
    """Samples under `time`, `position`, `velocity`, `acceleration` and `jerk`, and the exact coefficients."""
    times = np.asarray(samples.times)
    exact = {name: np.asarray(getattr(motion, part)) for name, part in _parts(motion).items()}
    buffer = io.BytesIO()
    np.savez(
        buffer,
        allow_pickle=False,
        time=times,
        position=samples.positions,
        velocity=_rates(motion, times, 1),
        acceleration=_rates(motion, times, 2),
        jerk=motion(times, 3),
        joint_names=np.array(problem.joint_names),
        waypoints=problem.waypoints,
        waypoint_times=motion.waypoint_times,
        **exact,
    )
    return buffer.getvalue()


def _parts(motion: Motion) -> dict[str, str]:
    """Names in the archive of the arrays that make a motion."""
    if isinstance(motion, ParametricTrajectory):
        return {"knots": "knots", "time_coefficients": "time", "position_coefficients": "position"}
    return {"knots": "knots", "coefficients": "coefficients"}


WRITERS: dict[str, Callable[[Samples, Motion, Problem], str | bytes]] = {
    ".csv": samples_text,
    ".yaml": lambda samples, motion, problem: message_yaml(samples),
    ".yml": lambda samples, motion, problem: message_yaml(samples),
    ".json": lambda samples, motion, problem: message_json(samples),
    ".npz": npz_bytes,
}
MESSAGES = (".yaml", ".yml", ".json")
FORMS = (*WRITERS, ".exact.json")
