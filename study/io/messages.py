"""ROS messages in YAML or JSON, read at whatever depth they stand: trajectories, and streams of joint states.

References
----------
ROS 2 common_interfaces: trajectory_msgs/msg/JointTrajectory.msg, sensor_msgs/msg/JointState.msg;
moveit_msgs/msg/DisplayTrajectory.msg.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from study.errors import StudyError
from study.io.samples import Samples
from study.io.table import number, table
from study.problem import Floats

NANOSECONDS = 1_000_000_000
RATES = {"velocities": "velocity", "accelerations": "acceleration"}
"""Fields of a trajectory's points, and of a joint state, where it has such."""


def samples_from_documents(contents: Sequence[Any], where: str) -> Samples | None:
    """Read the trajectory or the joint states in some documents; None where there are none.

    Parameters
    ----------
    contents : sequence of object
        Parsed documents; a message may stand under any keys and in lists.
    where : str
        How a message begins.

    Raises
    ------
    StudyError
        If names or positions are missing or do not match, or parts of a trajectory name other joints.
    """
    if trajectories := list(_holding(contents, ("joint_names", "points"))):
        return _joined([_trajectory(content, where) for content in trajectories], where)
    states = list(_holding(contents, ("name", "position")))
    return _states(states, where) if states and isinstance(states[0]["name"], list) else None


def _holding(content: Any, keys: tuple[str, str]) -> Iterator[Mapping[str, Any]]:
    """All mappings with some keys, in the order in which they stand; none inside another."""
    if isinstance(content, Mapping):
        if all(key in content for key in keys):
            yield content
            return
        content = list(content.values())
    if isinstance(content, list | tuple):
        for inner in content:
            if isinstance(inner, Mapping | list):
                yield from _holding(inner, keys)


def _trajectory(content: Mapping[str, Any], where: str) -> Samples:
    names, points = content["joint_names"], content["points"]
    if not isinstance(names, list) or not names or not isinstance(points, list):
        raise StudyError(f"{where}: 'joint_names' and 'points' must be lists, and joints must have names")
    if not points:
        raise StudyError(f"{where}: there are no waypoints; the trajectory has no points")
    for place, point in enumerate(points, start=1):
        if not isinstance(point, Mapping) or not isinstance(point.get("positions"), list):
            raise StudyError(f"{where}: point {place} has no list of positions")
    rates = {field: _rates(points, field, len(names), where) for field in RATES}
    stamps = np.array([seconds(point.get("time_from_start"), where) for point in points])
    efforts = any(point.get("effort") for point in points)
    return Samples(
        positions=_rows([point["positions"] for point in points], len(names), where),
        names=tuple(str(name) for name in names),
        si=True,
        times=stamps if stamps.any() else None,
        notes=("not used: the efforts of the message",) if efforts else (),
        **rates,
    )


def _rows(rows: list[Any], width: int, where: str, what: str = "positions") -> Floats:
    for place, row in enumerate(rows, start=1):
        if len(row) != width:
            raise StudyError(f"{where}: point {place} has {len(row)} {what} for {width} joints")
    return table(rows, where)


def _rates(points: Sequence[Any], field: str, width: int, where: str) -> Floats | None:
    rows = [point.get(field) for point in points]
    return _rows(rows, width, where, field) if all(isinstance(row, list) and row for row in rows) else None


def _joined(parts: list[Samples], where: str) -> Samples:
    """Parts of a displayed trajectory one after the other, each from where the one before it ends."""
    first = parts[0]
    for part in parts[1:]:
        if set(part.names) != set(first.names):
            raise StudyError(f"{where} holds trajectories of different joints; keep one of them in the file")
    if len(parts) == 1:
        return first
    parts = [part.of(first.names, where) for part in parts]
    times, end = [], 0.0
    for part in parts:
        times.append(end + (part.times if part.times is not None else np.zeros(len(part.positions))))
        end = float(times[-1][-1])
    timed = all(part.times is not None for part in parts)
    return Samples(
        np.concatenate([part.positions for part in parts]),
        first.names,
        True,
        np.concatenate(times) if timed else None,
        notes=(f"{len(parts)} trajectories were put one after the other, without their velocities",),
    )


def _states(states: list[Mapping[str, Any]], where: str) -> Samples:
    """Joint states one after the other; states of other joints are left out."""
    names = [str(name) for name in states[0]["name"]]
    same = [state for state in states if set(map(str, state["name"])) == set(names)]
    notes = ["not used: joint states of other joints"] if len(same) < len(states) else []
    rows, rates = [], []
    for place, state in enumerate(same, start=1):
        order = [list(map(str, state["name"])).index(name) for name in names]
        if not isinstance(state["position"], list) or len(state["position"]) != len(names):
            raise StudyError(f"{where}: joint state {place} must have {len(names)} positions")
        rows.append([state["position"][k] for k in order])
        rate = state.get("velocity")
        rates.append([rate[k] for k in order] if isinstance(rate, list) and len(rate) == len(names) else None)
    stamps = np.array([seconds((state.get("header") or {}).get("stamp"), where) for state in same])
    velocities = table(rates, where) if all(rate is not None for rate in rates) else None
    times = stamps - stamps[0] if stamps.any() else None
    return Samples(table(rows, where), tuple(names), True, times, velocities, notes=tuple(notes))


def seconds(stamp: Any, where: str) -> float:
    """Read a duration {sec, nanosec}, ROS 1's {secs, nsecs}, or plain seconds, s.

    Raises
    ------
    StudyError
        If it is none of these or not finite.
    """
    if stamp is None:
        return 0.0
    here = f"{where}: 'time_from_start' must be {{sec, nanosec}}"
    if not isinstance(stamp, Mapping):
        return number(stamp, here)
    whole = stamp.get("sec", stamp.get("secs", 0))
    return number(whole, here) + number(stamp.get("nanosec", stamp.get("nsecs", 0)), here) / NANOSECONDS
