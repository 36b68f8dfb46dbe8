"""Joint states and trajectories in a ROS bag, by the package `rosbags`."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from study.errors import StudyError
from study.io.messages import samples_from_documents
from study.io.samples import Samples

KINDS = ("trajectory_msgs/msg/JointTrajectory", "sensor_msgs/msg/JointState", "moveit_msgs/msg/DisplayTrajectory")

MOST_MESSAGES = 500_000
"""Messages of one topic that are read; each takes two kilobytes of memory until their rows are taken together."""


def samples_from_bag(path: Path) -> Samples:
    """Read the joint states or trajectories of a bag: a folder of ROS 2, or a file `.bag` of ROS 1.

    Raises
    ------
    StudyError
        If the package is missing, the bag cannot be read, or holds no such message or several topics of them.
    """
    where = f"file {path.name!r}"
    try:
        from rosbags.highlevel import AnyReader
    except ModuleNotFoundError:
        raise StudyError(f"{where}: reading ROS bags needs the package 'rosbags'; pip install rosbags") from None
    folder = path.parent if path.suffix in (".db3", ".mcap") else path
    for file in (folder, *(folder.iterdir() if folder.is_dir() else ())):
        if file.exists() and not (file.is_file() or file.is_dir()):
            raise StudyError(f"file {str(file)!r} cannot be read: it is a pipe or a device, no regular file")
    try:
        with AnyReader([folder]) as reader:
            for kind in KINDS:
                topics = [connection for connection in reader.connections if connection.msgtype == kind]
                if len({connection.topic for connection in topics}) > 1:
                    names = ", ".join(sorted({connection.topic for connection in topics}))
                    raise StudyError(f"{where} holds several topics of {kind} ({names}); keep one of them in the bag")
                if (number := sum(connection.msgcount for connection in topics)) > MOST_MESSAGES:
                    raise StudyError(
                        f"{where} cannot be read: it holds {number:,} messages of {kind}, and at most {MOST_MESSAGES:,} are read; "
                        "cut the part out that is wanted"
                    )
                messages = [
                    _plain(reader.deserialize(raw, connection.msgtype))
                    for connection, _, raw in reader.messages(connections=topics)
                    if topics
                ]
                samples = samples_from_documents(messages, where) if messages else None
                if samples is not None:
                    others = sorted(
                        {c.topic for c in reader.connections if c.msgtype in KINDS} - {c.topic for c in topics}
                    )
                    return samples.noting(f"not used: topic {', '.join(others)}") if others else samples
    except StudyError:
        raise
    except Exception as error:  # the package names its errors by the format at work
        raise StudyError(f"{where} cannot be read as a ROS bag: {error}") from None
    raise StudyError(f"{where} holds no message of {', '.join(KINDS)}")


def _plain(message: Any) -> Any:
    """Message as mappings, lists and numbers."""
    if is_dataclass(message):
        return {part.name: _plain(getattr(message, part.name)) for part in fields(message) if part.name[:2] != "__"}
    if isinstance(message, np.ndarray):
        return message.tolist()
    return [_plain(item) for item in message] if isinstance(message, list | tuple) else message
