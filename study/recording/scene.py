"""The arms side by side in 3D, their tool paths coloured by speed, and the waypoints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import rerun as rr

from study.cases.obstacles import world_of
from study.pathfinding.world import arm_clearance
from study.problem import Floats
from study.recording.contents import NANOSECOND, Contents, Shown, in_seconds
from study.recording.meshes import APART, chosen_meshes, log_meshes
from study.recording.stream import LIMIT_COLOR, entity, method_part, time_column
from study.robots import Robot, robot_named
from study.robots.meshes import Shape
from study.robots.urdf import UrdfRobot

SLOW_TO_FAST = np.array(
    [(70, 40, 120), (60, 82, 170), (40, 130, 170), (40, 170, 140), (120, 205, 90), (250, 230, 60)], dtype=float
)
"""Colours of the tool's speed, dark for standstill and bright for the fastest instant of the case."""

OBSTACLES = entity("arms", "_obstacles")
OBSTACLE_COLOR = (200, 120, 60)
VIEW = (0.56, 0.40)
"""Largest distance to the side and up at which a point is seen, as shares of its distance; measured in the first look's views."""

AROUND, LEAST = 1.5, 0.4
"""The first look's views hold so many times the size of the tool paths, and at least such a share of the arm's."""

FEW_WAYPOINTS = 6
"""Up to so many waypoints are labelled without pointing at them."""


@dataclass(frozen=True, eq=False)
class Look:
    """Camera: the eye and its target, arrays of shape (3,), m."""

    eye: Floats
    target: Floats


@dataclass(frozen=True, eq=False)
class _Arm:
    """One method's arm: times (n,) ns, frames (n, n_links + 1, 4, 4), tool speeds (n,), tool places at waypoints."""

    shown: Shown
    times: np.ndarray
    frames: Floats
    speeds: Floats
    waypoints: Floats

    @property
    def chain(self) -> Floats:
        """Places of the frames, shape (n, n_links + 1, 3), m."""
        return self.frames[:, :, :3, 3]


@dataclass(frozen=True, eq=False)
class Scene:
    """The arms, where to look from, and what is to be said of them.

    Attributes
    ----------
    arms : tuple
    shapes : tuple of Shape
        Meshes that stand for the links; capsules do where there are none.
    meshes : dict of Path to bytes
        Their files.
    first, every : Look
        At the tool paths of the first look's methods, and at all feasible ones' whole arms.
    words : str
    across : array of shape (n_arms, 3), m
        Where the arms' bases stand; all in one place where no mesh is shared.
    poses : tuple of int64 array of shape (n,), ns, and array of shape (n, n_arms, n_frames, 4, 4), m, optional
        Times that all arms have in common, and the frames of meshes, which are the arm's and those of joints that follow.
    """

    arms: tuple[_Arm, ...]
    shapes: tuple[Shape, ...]
    meshes: dict[Path, bytes]
    first: Look
    every: Look
    words: str
    across: Floats
    poses: tuple[np.ndarray, Floats] | None

    @property
    def fastest(self) -> float:
        """Speed of the tool's fastest instant, m/s."""
        return max(float(arm.speeds.max()) for arm in self.arms)


def scene_of(contents: Contents) -> Scene | None:
    """Place an arm per method, all in the robot's base frame; cases without a robot have no scene."""
    if contents.case.robot is None or not contents.shown:
        return None
    robot = robot_named(contents.case.robot, tuple(contents.case.problem.joint_names))
    arms = tuple(_arm(robot, contents, each) for each in contents.shown)
    shapes, meshes, said = chosen_meshes(robot) if isinstance(robot, UrdfRobot) else ((), {}, "")
    first = [arm for arm in arms if arm.shown in contents.first_look]
    far, right = _looking([arm for arm in arms if arm.shown.feasible] or first, contents.case.obstacles)
    near, _ = _looking(first, contents.case.obstacles, at_path=True)
    near = min(near, far, key=lambda look: float(np.linalg.norm(look.eye - look.target)))
    apart = APART * np.arange(len(arms)) if shapes else np.zeros(len(arms))
    poses = _common_poses(robot, contents) if shapes and isinstance(robot, UrdfRobot) else None
    scene = Scene(arms, shapes, meshes, near, far, said, apart[:, None] * right, poses)
    return replace(scene, words=f"Tool paths: dark where slow, yellow at {scene.fastest:.3g} m/s.{scene.words}")


def _common_poses(robot: UrdfRobot, contents: Contents) -> tuple[np.ndarray, Floats]:
    """Times that all arms have in common, and the frames that carry meshes; what has ended stands still."""
    longest = np.floor(contents.longest / NANOSECOND)
    times = np.rint(np.linspace(0.0, longest, 2 * contents.samples)).astype(np.int64)
    frames = []
    for each in contents.shown:
        q = each.motion(np.minimum(in_seconds(times), each.motion.duration))
        frames.append(robot.mesh_frames(contents.case.robot_configuration(q)))
    return times, np.stack(frames, axis=1)


def log_scene(stream: rr.RecordingStream, contents: Contents, scene: Scene) -> None:
    """Write the arms to `/arms`: links, tool path, waypoints; shared meshes to `/meshes`; and obstacles."""
    points = np.concatenate([arm.chain.reshape(-1, 3) for arm in scene.arms])
    reach = float(np.linalg.norm(np.ptp(points, axis=0)))
    stream.log("arms", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    if scene.poses is not None:
        log_meshes(stream, scene.shapes, scene.meshes, scene.poses, scene.across)
    for arm, base in zip(scene.arms, scene.across, strict=True):
        path = entity("arms", method_part(arm.shown.label))
        if scene.poses is None:
            _log_links(stream, path, arm, 0.016 * reach)
        else:
            stream.log(path, rr.Transform3D(translation=base), static=True)
            _log_ring(stream, path, arm, 0.12 * reach)
        _log_path(stream, path, arm, scene.fastest, 0.004 * reach)
    if len(contents.case.obstacles):
        low, high = np.moveaxis(contents.case.obstacles, 1, 0)
        bases = scene.across[:, None] if scene.poses is not None else np.zeros((1, 1, 3))
        sizes = np.tile(high - low, (len(bases), 1))
        boxes = rr.Boxes3D(mins=(low + bases).reshape(-1, 3), sizes=sizes, colors=OBSTACLE_COLOR)
        stream.log(OBSTACLES, boxes, static=True)
        _log_clearance(stream, contents, scene.arms)


def _log_ring(stream: rr.RecordingStream, path: str, arm: _Arm, radius: float) -> None:
    """Lay a ring in the method's colour around the base, as shared meshes cannot have it."""
    turn = np.linspace(0.0, 2.0 * np.pi, 49)
    ring = arm.chain[0, 0] + radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)])
    stream.log(path + "/base", rr.LineStrips3D([ring], colors=arm.shown.color, radii=0.06 * radius), static=True)


def _log_clearance(stream: rr.RecordingStream, contents: Contents, arms: Sequence[_Arm]) -> None:
    """Write the distance from arm to obstacles to `/clearance`, m, and mark where the tool is when the arm hits one."""
    stream.log(entity("clearance", "_contact"), rr.SeriesLines(names="contact", colors=LIMIT_COLOR), static=True)
    ends = time_column(np.array([0, np.ceil(contents.longest / NANOSECOND)]))
    stream.send_columns(entity("clearance", "_contact"), ends, rr.Scalars.columns(scalars=np.zeros(2)))
    world = world_of(contents.case)
    for arm in arms:
        distances = arm_clearance(world, arm.chain, contents.case.arm_radius)
        path = entity("clearance", method_part(arm.shown.label))
        stream.log(path, rr.SeriesLines(names=arm.shown.label, colors=arm.shown.color, widths=1.5), static=True)
        stream.send_columns(path, time_column(arm.times), rr.Scalars.columns(scalars=distances))
        hits = arm.chain[distances < 0, -1]
        if len(hits):
            where = entity("arms", method_part(arm.shown.label), "collisions")
            stream.log(where, rr.Points3D(hits, colors=LIMIT_COLOR, radii=0.4 * contents.case.arm_radius), static=True)


def _looking(arms: Sequence[_Arm], obstacles: Floats, at_path: bool = False) -> tuple[Look, Floats]:
    """Look across the arms' widest horizontal direction, from the tool's side and a little from above; and its right.

    The eye comes as near as it can with all arms and obstacles within `VIEW`, or, at the path, tool paths and obstacles,
    with some of the arm around them.
    """
    points = np.concatenate([*(arm.chain.reshape(-1, 3) for arm in arms), obstacles.reshape(-1, 3)])
    tool = np.concatenate([arm.chain[:, -1] for arm in arms])
    low, high = points.min(axis=0), points.max(axis=0)
    middle = 0.5 * (low + high)
    _, axes = np.linalg.eigh(np.cov(points[:, :2].T))
    towards = axes[:, 0] * (1.0 if (tool.mean(axis=0) - middle)[:2] @ axes[:, 0] >= 0 else -1.0)
    back = np.append(towards, 0.35) / np.linalg.norm([1.0, 0.35])
    right = np.append([-towards[1], towards[0]], 0.0)
    frame = np.array([right, np.cross(back, right)])
    if at_path:
        centre, size = 0.5 * (tool.min(axis=0) + tool.max(axis=0)), float(np.linalg.norm(np.ptp(tool, axis=0)))
        around = max(AROUND, LEAST * float(np.linalg.norm(high - low)) / max(size, 1e-9))
        wide = [centre + around * (tool - centre), obstacles.reshape(-1, 3)]
        points = np.concatenate(wide) if size > 1e-6 else points
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
    across = frame @ points.T
    target = middle + frame.T @ (0.5 * (across.min(axis=1) + across.max(axis=1)) - frame @ middle)
    beside = np.abs(frame @ (points - target).T) / np.array(VIEW)[:, None]
    return Look(target + back * float(((points - target) @ back + beside.max(axis=0)).max()), target), right


def _arm(robot: Robot, contents: Contents, shown: Shown) -> _Arm:
    end = np.floor(shown.motion.duration / NANOSECOND)
    times = np.rint(np.linspace(0.0, end, contents.samples)).astype(np.int64)
    frames, there = (
        robot.frames(contents.case.robot_configuration(q))
        for q in (shown.motion(in_seconds(times)), contents.case.problem.waypoints)
    )
    velocity = np.gradient(frames[:, -1, :3, 3], in_seconds(times), axis=0)
    return _Arm(shown, times, frames, np.linalg.norm(velocity, axis=1), there[:, -1, :3, 3])


def _log_links(stream: rr.RecordingStream, path: str, arm: _Arm, radius: float) -> None:
    """Draw a capsule from joint to joint; links without length are left out."""
    steps = np.diff(arm.chain, axis=1)
    lengths = np.linalg.norm(steps, axis=2)
    kept = lengths.max(axis=0) > 1e-6
    starts, steps, lengths = arm.chain[:, :-1][:, kept], steps[:, kept], lengths[:, kept]
    n_times, n_links = lengths.shape
    shape = rr.Capsules3D.from_fields(
        radii=np.full(n_links, radius), colors=[arm.shown.color] * n_links, fill_mode="solid"
    )
    stream.log(path + "/links", shape, static=True)
    poses = rr.Capsules3D.columns(
        lengths=lengths.ravel(),
        translations=starts.reshape(-1, 3),
        quaternions=_from_z(steps / np.maximum(lengths, 1e-9)[..., None]).reshape(-1, 4),
    )
    stream.send_columns(path + "/links", time_column(arm.times), poses.partition([n_links] * n_times))


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
    colors = speed_colors(0.5 * (arm.speeds[:-1] + arm.speeds[1:]) / max(fastest, 1e-12))
    apart = float(np.median(np.linalg.norm(np.diff(arm.waypoints, axis=0), axis=1)))
    thin = min(radius, 0.1 * apart) if apart > 0 else radius  # so that close waypoints do not hide the path
    stream.log(path + "/tool_path", rr.LineStrips3D(pieces, colors=colors, radii=thin), static=True)
    few = len(arm.waypoints) <= FEW_WAYPOINTS
    labels = _labels(arm.waypoints, 12.0 * radius)
    dots = rr.Points3D(arm.waypoints, labels=labels, show_labels=few, radii=2.0 * thin, colors=(240, 240, 240))
    stream.log(path + "/waypoints", dots, static=True)


def _labels(places: Floats, close: float) -> list[str]:
    """Numbers of the waypoints; those that lie together share the label of the first, as their own would hide it."""
    apart = np.linalg.norm(places[:, None] - places, axis=2)
    leader = (apart < close).argmax(axis=1)
    return [", ".join(str(j + 1) for j in np.flatnonzero(leader == k)) for k in range(len(places))]


def speed_colors(share: Floats | Sequence[float]) -> np.ndarray:
    """Colours (n, 3) for shares of the fastest speed in [0, 1]."""
    places = np.linspace(0.0, 1.0, len(SLOW_TO_FAST))
    channels = [np.interp(share, places, channel) for channel in SLOW_TO_FAST.T]
    return np.rint(np.column_stack(channels)).astype(np.uint8)
