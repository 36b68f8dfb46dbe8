"""ROS messages in YAML or JSON, read at whatever depth they stand: trajectories, and streams of joint states.

References
----------
ROS 2 common_interfaces: trajectory_msgs/msg/JointTrajectory.msg, sensor_msgs/msg/JointState.msg;
moveit_msgs/msg/DisplayTrajectory.msg.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from study.errors import StudyError, plural
from study.io.joint_trajectory import FIELDS
from study.io.samples import NANOSECONDS, Samples
from study.io.table import number, table
from study.problem import Floats

KNOWN = {"header", "joint_names", "points", *FIELDS, "effort", "time_from_start"}
"""Keys of a trajectory and of its points."""


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
        frames = [content for content in trajectories if _of_frames(content)]
        filled = [
            content
            for content in trajectories
            if content not in frames and (content["joint_names"] or content["points"])
        ]
        samples = _joined([_trajectory(content, where) for content in filled or trajectories[:1]], where)
        return (
            samples.noting("not used: the trajectory of joints with several degrees of freedom") if frames else samples
        )
    states = list(_holding(contents, ("name", "position")))
    states = [
        state for state in states if isinstance(state["name"], list)
    ]  # other things have a name and a position too
    return _states(states, where) if states else None


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


def _of_frames(content: Mapping[str, Any]) -> bool:
    """Whether a trajectory moves frames and no joints, as multi_dof_joint_trajectory does."""
    points = content["points"]
    return isinstance(points, list) and any(isinstance(point, Mapping) and "transforms" in point for point in points)


def _trajectory(content: Mapping[str, Any], where: str) -> Samples:
    names, points = content["joint_names"], content["points"]
    if not isinstance(names, list) or not names or not isinstance(points, list):
        raise StudyError(f"{where}: 'joint_names' and 'points' must be lists, and joints must have names")
    if not points:
        raise StudyError(f"{where}: there are no waypoints; the trajectory has no points")
    for place, point in enumerate(points, start=1):
        if not isinstance(point, Mapping) or not isinstance(point.get("positions"), list):
            raise StudyError(f"{where}: point {place} has no list of positions")
    stamps = np.array([seconds(point.get("time_from_start"), where) for point in points])
    notes = ["not used: the efforts of the message"] if any(point.get("effort") for point in points) else []
    for key in dict.fromkeys(str(key) for part in (content, *points) for key in part if key not in KNOWN):
        near = get_close_matches(key, KNOWN, n=1, cutoff=0.8)
        notes.append(f"not used: key {key!r} of the message" + (f"; did you mean {near[0]!r}?" if near else ""))
    velocities, accelerations = (_rates(points, field, len(names), where, notes) for field in FIELDS[1:])
    return Samples(
        positions=_rows([point["positions"] for point in points], len(names), where),
        names=tuple(str(name) for name in names),
        si=True,
        times=stamps if stamps.any() else None,
        velocities=velocities,
        accelerations=accelerations,
        notes=tuple(notes),
    )


def _rows(rows: list[Any], width: int, where: str, what: str = "positions") -> Floats:
    for place, row in enumerate(rows, start=1):
        if len(row) != width:
            raise StudyError(f"{where}: point {place} has {len(row)} {what} for {width} joints")
    return table(rows, where)


def _rates(points: Sequence[Any], field: str, width: int, where: str, notes: list[str]) -> Floats | None:
    rows = [point.get(field) for point in points]
    if all(isinstance(row, list) and row for row in rows):
        return _rows(rows, width, where, field)
    given = [place for place, row in enumerate(rows, start=1) if row]
    if given:
        hint = ""
        if field == FIELDS[1] and {1, len(points)} & set(given):
            hint = "; for a motion that begins or ends moving give 'start' or 'finish'"
        notes.append(f"not used: {field} of {plural(len(given), 'point')}, which not all points have{hint}")
    return None


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
        notes=(
            *dict.fromkeys(note for part in parts for note in part.notes),
            f"{len(parts)} trajectories were put one after the other, without their velocities",
        ),
    )


def _states(states: list[Mapping[str, Any]], where: str) -> Samples:
    """Joint states one after the other, of most joints that come together more than once; other states are left out."""
    sets = [frozenset(map(str, state["name"])) for state in states]
    counts = Counter(sets)
    chosen = max(counts, key=lambda names: (counts[names] > 1, len(names), counts[names]))
    same = [state for state, names in zip(states, sets, strict=True) if names == chosen]
    others = sorted({name for names in counts if names != chosen for name in names})
    left = plural(len(states) - len(same), "joint state")
    notes = [f"not used: {left} of {', '.join(others)}"] if len(counts) > 1 else []
    notes += ["not used: the efforts of the messages"] if any(state.get("effort") for state in same) else []
    names = [str(name) for name in same[0]["name"]]
    rows, rates = [], []
    for place, state in enumerate(same, start=1):
        order = [list(map(str, state["name"])).index(name) for name in names]
        if not isinstance(state["position"], list) or len(state["position"]) != len(names):
            raise StudyError(f"{where}: joint state {place} must have {len(names)} positions")
        rows.append([state["position"][k] for k in order])
        rate = state.get("velocity")
        rates.append([rate[k] for k in order] if isinstance(rate, list) and len(rate) == len(names) else None)
    headers = [state.get("header") for state in same]
    stamps = np.array([seconds(h.get("stamp") if isinstance(h, Mapping) else None, where) for h in headers])
    velocities = table(rates, where) if all(rate is not None for rate in rates) else None
    notes += ["not used: velocities, which not all joint states have"] if velocities is None and any(rates) else []
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
