"""The arms side by side in 3D, their tool paths coloured by speed, and the waypoints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from study.problem import Floats
from study.report.recording.contents import NANOSECOND, Contents, Entry, seconds
from study.report.recording.stream import entity, time_column
from study.trajectory import Motion

if TYPE_CHECKING:
    from study.robots import Robot

SLOW_TO_FAST = np.array(
    [(70, 40, 120), (60, 82, 170), (40, 130, 170), (40, 170, 140), (120, 205, 90), (250, 230, 60)], dtype=float
)
"""Colours of the tool's speed, dark for standstill and bright for the fastest instant of the case."""

PER_ROW = 5


@dataclass(frozen=True, eq=False)
class Scene:
    """Where everything stands, for the camera: the middle of all arms and their extent, m."""

    middle: Floats
    extent: Floats


@dataclass(frozen=True, eq=False)
class _Arm:
    """One method's arm: times (n,) ns, joint places (n, n_links + 1, 3), tool speeds (n,), tool places at waypoints."""

    entry: Entry
    duration: float
    times: np.ndarray
    chain: Floats
    speeds: Floats
    waypoints: Floats


def log_scene(stream: rr.RecordingStream, contents: Contents) -> Scene | None:
    """Write an arm per method to `/arms`, set side by side; cases without a robot have no scene."""
    if contents.case.robot is None or not contents.moving:
        return None
    try:
        from study.robots import robot_named
    except ImportError:
        return None
    robot = robot_named(contents.case.robot)
    arms = [_arm(robot, contents, entry, motion) for entry, motion in contents.moving]
    points = np.concatenate([arm.chain.reshape(-1, 3) for arm in arms])
    low, high = points.min(axis=0), points.max(axis=0)
    reach = float(np.linalg.norm(high - low))
    places = _places(len(arms), high - low)
    fastest = max(float(arm.speeds.max()) for arm in arms)
    stream.log("arms", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for arm, place in zip(arms, places, strict=True):
        path = entity("arms", arm.entry.label)
        stream.log(path, rr.Transform3D(translation=place), static=True)
        _log_links(stream, path, arm, 0.02 * reach)
        _log_path(stream, path, arm, fastest, 0.004 * reach)
        _log_name(stream, path, arm, low)
    middle = places.mean(axis=0) + 0.5 * (low + high)
    return Scene(middle, high - low + np.ptp(places, axis=0))


def _arm(robot: Robot, contents: Contents, entry: Entry, motion: Motion) -> _Arm:
    end = np.floor(motion.duration / NANOSECOND)
    times = np.rint(np.linspace(0.0, end, contents.samples)).astype(np.int64)
    chain = _chain(robot, contents, motion(seconds(times)))
    waypoints = _chain(robot, contents, contents.case.problem.waypoints)[:, -1]
    velocity = np.gradient(chain[:, -1], seconds(times), axis=0)
    return _Arm(entry, motion.duration, times, chain, np.linalg.norm(velocity, axis=1), waypoints)


def _chain(robot: Robot, contents: Contents, q: Floats) -> Floats:
    """Origins of the base and of every link's frame, shape (n, n_links + 1, 3), m."""
    return robot.frames(contents.case.robot_configuration(q))[:, :, :3, 3]


def _places(count: int, size: Floats) -> Floats:
    """Where the arms stand: rows of a few, one behind the other, shape (count, 3), m."""
    columns = min(count, PER_ROW)
    row, column = np.divmod(np.arange(count), columns)
    return np.column_stack([-1.25 * size[0] * row, 1.25 * size[1] * column, np.zeros(count)])


def _log_links(stream: rr.RecordingStream, path: str, arm: _Arm, radius: float) -> None:
    """Draw a capsule from joint to joint; links without length are left out."""
    steps = np.diff(arm.chain, axis=1)
    lengths = np.linalg.norm(steps, axis=2)
    kept = lengths.max(axis=0) > 1e-6
    steps, lengths = steps[:, kept], lengths[0, kept]
    links = path + "/links"
    n_times, n_links = steps.shape[:2]
    shape = rr.Capsules3D.from_fields(
        lengths=lengths, radii=np.full(n_links, radius), colors=[arm.entry.color] * n_links, fill_mode="solid"
    )
    stream.log(links, shape, static=True)
    poses = rr.Capsules3D.columns(
        translations=arm.chain[:, :-1][:, kept].reshape(-1, 3),
        quaternions=_from_z(steps / lengths[:, None]).reshape(-1, 4),
    )
    stream.send_columns(links, time_column(arm.times), poses.partition([n_links] * n_times))


def _from_z(directions: Floats) -> Floats:
    """Quaternions (x, y, z, w) that turn the z axis into unit directions, shape (..., 4)."""
    x, y, z = np.moveaxis(directions, -1, 0)
    turned = np.stack([-y, x, np.zeros_like(x), 1.0 + z], axis=-1)
    norm = np.linalg.norm(turned, axis=-1, keepdims=True)
    opposite = np.array([1.0, 0.0, 0.0, 0.0])  # a half turn about x where the direction is -z
    return np.where(norm > 1e-9, turned / np.maximum(norm, 1e-9), opposite)


def _log_path(stream: rr.RecordingStream, path: str, arm: _Arm, fastest: float, radius: float) -> None:
    tool = arm.chain[:, -1]
    pieces = np.stack([tool[:-1], tool[1:]], axis=1).astype(np.float32)
    speed = 0.5 * (arm.speeds[:-1] + arm.speeds[1:])
    stream.log(
        path + "/tool_path", rr.LineStrips3D(pieces, colors=speed_colors(speed / fastest), radii=radius), static=True
    )
    labels = [f"waypoint {k + 1}" for k in range(len(arm.waypoints))]
    dots = rr.Points3D(arm.waypoints, labels=labels, show_labels=False, radii=2.5 * radius, colors=(240, 240, 240))
    stream.log(path + "/waypoints", dots, static=True)


def _log_name(stream: rr.RecordingStream, path: str, arm: _Arm, low: Floats) -> None:
    text = f"{arm.entry.label}  {arm.duration:.3f} s"
    verdict = arm.entry.verdict
    if verdict is None or not verdict.feasible:
        text += "  infeasible"
    name = rr.Points3D([[0.0, 0.0, low[2] - 0.1]], labels=[text], show_labels=True, colors=arm.entry.color, radii=0.0)
    stream.log(path + "/name", name, static=True)


def speed_colors(share: Floats) -> np.ndarray:
    """Colours (n, 3) for shares of the fastest speed in [0, 1]."""
    places = np.linspace(0.0, 1.0, len(SLOW_TO_FAST))
    channels = [np.interp(share, places, channel) for channel in SLOW_TO_FAST.T]
    return np.rint(np.column_stack(channels)).astype(np.uint8)
