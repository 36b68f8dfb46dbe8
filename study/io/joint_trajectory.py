"""ROS 2 `trajectory_msgs/JointTrajectory` as YAML or JSON, in and out.

References
----------
ROS 2 common_interfaces, trajectory_msgs/msg/JointTrajectory.msg and JointTrajectoryPoint.msg.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from study.errors import StudyError
from study.io.table import WaypointRows, increasing, table
from study.problem import Floats, Problem
from study.trajectory import Motion

NANOSECONDS = 1_000_000_000
WRAPPERS = ("joint_trajectory", "trajectory")
"""Fields under which moveit_msgs/RobotTrajectory and control_msgs/FollowJointTrajectory keep the message."""


def message(motion: Motion, problem: Problem, times: Floats) -> dict[str, Any]:
    """Build the message as plain data.

    Parameters
    ----------
    motion : Motion
    problem : Problem
        Gives names to the joints.
    times : array of shape (n_points,), s
    """
    orders = [motion(times, order).tolist() for order in range(3)]
    points = [
        {"positions": q, "velocities": v, "accelerations": a, "effort": [], "time_from_start": _stamp(t)}
        for q, v, a, t in zip(*orders, times.tolist(), strict=True)
    ]
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    return {"header": header, "joint_names": list(problem.joint_names), "points": points}


def _stamp(time: float) -> dict[str, int]:
    seconds, nanoseconds = divmod(round(time * NANOSECONDS), NANOSECONDS)
    return {"sec": seconds, "nanosec": nanoseconds}


def message_json(motion: Motion, problem: Problem, times: Floats) -> str:
    """Write the message as JSON."""
    return json.dumps(message(motion, problem, times), ensure_ascii=False, allow_nan=False) + "\n"


def message_yaml(motion: Motion, problem: Problem, times: Floats) -> str:
    """Write the message as YAML: block style, every point's lists on lines of their own as `ros2 topic pub` takes them."""
    content = message(motion, problem, times)
    lines = [f"header: {json.dumps(content['header'])}", "joint_names:"]
    lines += [f"- {json.dumps(name, ensure_ascii=False)}" for name in content["joint_names"]]
    lines.append("points:")
    for point in content["points"]:
        rows = [f"{key}: {_yaml(value)}" for key, value in point.items()]
        lines += [f"- {rows[0]}", *(f"  {row}" for row in rows[1:])]
    return "\n".join(lines) + "\n"


def _yaml(value: Any) -> str:
    """Flow style; YAML 1.1 takes a float without a point, such as 1e-05, for text, so it is given one."""
    if isinstance(value, list):
        return f"[{', '.join(_yaml(item) for item in value)}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {_yaml(item)}' for key, item in value.items())}}}"
    text = repr(value)
    return text.replace("e", ".0e") if "e" in text and "." not in text else text


def found_message(content: Any) -> Mapping[str, Any] | None:
    """The message inside parsed YAML or JSON, itself or wrapped; None where there is none."""
    for _ in range(3):
        if not isinstance(content, Mapping):
            return None
        if "joint_names" in content and "points" in content:
            return content
        content = next((content[key] for key in WRAPPERS if key in content), None)
    return None


def message_rows(content: Mapping[str, Any], where: str) -> WaypointRows:
    """Waypoints of a message; positions are rad or m by the message's definition.

    Raises
    ------
    StudyError
        If names or positions are missing or do not match, or times do not increase.
    """
    names, points = content["joint_names"], content["points"]
    if not isinstance(names, list) or not names or not isinstance(points, list):
        raise StudyError(f"{where}: 'joint_names' and 'points' must be lists, and joints must have names")
    for number, point in enumerate(points, start=1):
        if not isinstance(point, Mapping) or not isinstance(point.get("positions"), list):
            raise StudyError(f"{where}: point {number} has no list of positions")
        if len(point["positions"]) != len(names):
            raise StudyError(f"{where}: point {number} has {len(point['positions'])} positions for {len(names)} joints")
    values = table([point["positions"] for point in points], where)
    stamps = [_seconds(point.get("time_from_start"), where) for point in points]
    if any(stamps):
        increasing(np.array(stamps), where, "point")
    return WaypointRows(values, tuple(str(name) for name in names), si=True)


def _seconds(stamp: Any, where: str) -> float:
    """A duration message {sec, nanosec} (or ROS 1's {secs, nsecs}), or plain seconds, s."""
    try:
        if isinstance(stamp, Mapping):
            whole = stamp.get("sec", stamp.get("secs", 0))
            return float(whole) + float(stamp.get("nanosec", stamp.get("nsecs", 0))) / NANOSECONDS
        return float(stamp or 0.0)
    except (TypeError, ValueError):
        raise StudyError(f"{where}: 'time_from_start' must be {{sec, nanosec}}, got {str(stamp)[:60]!r}") from None
