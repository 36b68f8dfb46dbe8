"""ROS 2 `trajectory_msgs/JointTrajectory` as YAML or JSON, as controllers take it.

References
----------
ROS 2 common_interfaces, trajectory_msgs/msg/JointTrajectory.msg and JointTrajectoryPoint.msg.
"""

from __future__ import annotations

import json
from typing import Any

from study.io.samples import NANOSECONDS, Samples

FIELDS = ("positions", "velocities", "accelerations")


def message(samples: Samples) -> dict[str, Any]:
    """Build the message as plain data; points without accelerations have an empty list."""
    orders = [column.tolist() for column in (samples.positions, *samples.rates)]
    rows = zip(*orders, strict=True)
    points = [
        {
            **dict(zip(FIELDS, [*row, [], []][:3], strict=True)),
            "effort": [],
            "time_from_start": {"sec": time // NANOSECONDS, "nanosec": time % NANOSECONDS},
        }
        for row, time in zip(rows, samples.nanoseconds.tolist(), strict=True)
    ]
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": ""}
    return {"header": header, "joint_names": list(samples.names), "points": points}


def message_json(samples: Samples) -> str:
    """Write the message as JSON."""
    return json.dumps(message(samples), ensure_ascii=False, allow_nan=False) + "\n"


def message_yaml(samples: Samples) -> str:
    """Write the message as YAML: block style, every point's lists on lines of their own as `ros2 topic pub` takes them."""
    content = message(samples)
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
        whole = str(value)
        return whole if "e" not in whole else f"[{', '.join(_yaml(item) for item in value)}]"
    if isinstance(value, dict):
        return f"{{{', '.join(f'{key}: {_yaml(item)}' for key, item in value.items())}}}"
    text = repr(value)
    return text.replace("e", ".0e") if "e" in text and "." not in text else text
