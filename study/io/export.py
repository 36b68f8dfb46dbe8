"""A motion as a file: samples at a rate, a ROS 2 message, arrays, or the exact polynomials."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np

from study.cautions import require_bounded
from study.errors import StudyError
from study.io.exact import exact_text
from study.io.joint_trajectory import message_json, message_yaml
from study.parametric import ParametricTrajectory
from study.problem import Floats, Problem
from study.trajectory import Motion

FEW_SAMPLES, MANY_SAMPLES = 10, 100_000
HIGHEST_RATE = 1e9
"""Hz; a ROS message counts nanoseconds."""
MOST_SAMPLES = 10_000_000
"""More samples than this are taken for a mistake in the rate."""


def usual_rate(duration: float, rate: float = 100.0, most: int = MANY_SAMPLES) -> float:
    """Samples per second where nobody chose: the usual ones, or ten, a hundred... times more or fewer.

    Parameters
    ----------
    duration : float, s
    rate : float, Hz
        For motions of seconds and minutes.
    most : int
        Samples; at least 10 come, too, unless they lay less than a nanosecond apart.
    """
    while duration * rate > most:
        rate /= 10.0
    while duration * rate < FEW_SAMPLES and rate < HIGHEST_RATE:
        rate *= 10.0
    return rate


def sample_times(duration: float, rate: float) -> Floats:
    """Every 1/rate seconds from 0, and the end point.

    Parameters
    ----------
    duration : float, s
    rate : float, Hz

    Returns
    -------
    array of shape (n_samples,), s

    Raises
    ------
    StudyError
        If the rate is not positive, or there would be more than ten million samples.
    """
    if not 0 < rate < np.inf:
        raise StudyError(f"the rate must be a positive number of samples per second, got {rate:g}")
    if duration * rate > MOST_SAMPLES:
        raise StudyError(
            f"{duration:g} s at {rate:g} samples per second are more than {MOST_SAMPLES} samples; lower the rate"
        )
    inner = np.arange(np.ceil(duration * rate)) / rate
    return np.append(inner[inner < duration * (1 - 1e-12)], duration)


def write_motion(
    motion: Motion,
    problem: Problem,
    path: Path,
    rate: float | None = None,
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
        `.csv`: samples of time, positions, velocities and accelerations; `.yaml` and `.json`: a ROS 2
        `trajectory_msgs/JointTrajectory`; `.npz`: samples and exact coefficients as arrays; `.exact.json`: the piecewise
        polynomials, which `study.io.exact.read_exact` gives back to the last bit.
    rate : float, Hz, optional
        Of the samples, `usual_rate` by default; the end point is always there.
    accept_unbounded_acceleration : bool
        Whether a motion may be written whose speed changes in an instant, which no arm can follow.

    Returns
    -------
    Path

    Raises
    ------
    StudyError
        If the ending is another, the rate is impossible, the file cannot be written, or a joint that moves has no
        acceleration limit and that is not accepted.
    """
    require_bounded(problem, accept_unbounded_acceleration)
    content = WRITERS[form_of(path)](motion, problem, usual_rate(motion.duration) if rate is None else rate)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        raise StudyError(f"cannot write {str(path)!r}: {error.strerror or error}; choose another place") from None
    return path


def form_of(path: Path) -> str:
    """Ending that says in which form a file is written.

    Raises
    ------
    StudyError
        If there is no such form.
    """
    kind = ".exact.json" if path.name.endswith(".exact.json") else path.suffix.lower()
    if kind not in WRITERS:
        raise StudyError(f"cannot write {str(path)!r}: its name must end in one of {', '.join(WRITERS)}")
    return kind


def csv_text(motion: Motion, problem: Problem, rate: float) -> str:
    """Samples as `study check` reads them: time, then positions, velocities and accelerations of all joints."""
    times = sample_times(motion.duration, rate)
    names = [f"{kind}{name}" for kind in ("", "velocity of ", "acceleration of ") for name in problem.joint_names]
    table = np.hstack([times[:, None], *(motion(times, order) for order in range(3))])
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["time", *names])
    writer.writerows([repr(value) for value in row] for row in table.tolist())
    return text.getvalue()


def npz_bytes(motion: Motion, problem: Problem, rate: float) -> bytes:
    """Samples under `time`, `position`, `velocity`, `acceleration` and `jerk`, and what makes the motion exact."""
    times = sample_times(motion.duration, rate)
    orders = dict(zip(("position", "velocity", "acceleration", "jerk"), range(4), strict=True))
    arrays = {name: motion(times, order) for name, order in orders.items()}
    exact = {name: np.asarray(getattr(motion, part)) for name, part in _parts(motion).items()}
    buffer = io.BytesIO()
    np.savez(
        buffer,
        allow_pickle=False,
        time=times,
        joint_names=np.array(problem.joint_names),
        waypoints=problem.waypoints,
        waypoint_times=motion.waypoint_times,
        **arrays,
        **exact,
    )
    return buffer.getvalue()


def _parts(motion: Motion) -> dict[str, str]:
    """Names in the archive of the arrays that make a motion."""
    if isinstance(motion, ParametricTrajectory):
        return {"knots": "knots", "time_coefficients": "time", "position_coefficients": "position"}
    return {"knots": "knots", "coefficients": "coefficients"}


WRITERS: dict[str, Callable[[Motion, Problem, float], bytes]] = {
    ".csv": lambda motion, problem, rate: csv_text(motion, problem, rate).encode(),
    ".yaml": lambda motion, problem, rate: message_yaml(motion, problem, sample_times(motion.duration, rate)).encode(),
    ".yml": lambda motion, problem, rate: message_yaml(motion, problem, sample_times(motion.duration, rate)).encode(),
    ".json": lambda motion, problem, rate: message_json(motion, problem, sample_times(motion.duration, rate)).encode(),
    ".npz": npz_bytes,
    ".exact.json": lambda motion, problem, rate: exact_text(motion, problem).encode(),
}
