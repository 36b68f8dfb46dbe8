"""Any file that holds joint positions, by its ending."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import numpy as np

from study.errors import StudyError
from study.files import named
from study.io.arrays_file import POSITIONS, samples_from_arrays, samples_from_numpy, samples_from_parquet
from study.io.columns import sampled_columns
from study.io.csv_file import samples_from_csv
from study.io.documents import documents
from study.io.messages import samples_from_documents
from study.io.rosbag import samples_from_bag
from study.io.samples import Samples
from study.io.srdf import samples_from_srdf
from study.io.table import table
from study.io.text import read_text

TABLES = (".csv", ".tsv", ".txt")
ARRAYS = (".npy", ".npz")
BAGS = (".bag", ".db3", ".mcap")
DOCUMENTS = (".yaml", ".yml", ".json", ".jsonl", ".ndjson")
MESSAGE = re.compile(r"^(header|name|joint_names|position|points|- header|goal|trajectory)\s*:", re.MULTILINE)
"""Line of a message that was printed into a file of text."""


def read_samples(path: str | Path) -> Samples:
    """Read joint positions, and times and rates where the file has them.

    Parameters
    ----------
    path : str or Path
        `.csv`, `.tsv`, `.txt`: a table with or without header; `.yaml`, `.yml`, `.json`, `.jsonl`, and `.txt` that a tool printed:
        rows, columns by name, a `trajectory_msgs/JointTrajectory` or `sensor_msgs/JointState`s at any depth; `.npy`, `.npz`: arrays; `.parquet`: a table
        or a LeRobot episode; `.bag`, `.db3`, `.mcap`: a ROS bag; `.srdf#NAME,NAME`: group states of MoveIt.

    Raises
    ------
    StudyError
        If the file cannot be read, holds no table of numbers, or its times go back.
    """
    path = named(path)
    samples, where = _read(path), f"file {path.name!r}"
    times = np.zeros(1) if samples.times is None else samples.times
    late = np.flatnonzero(np.diff(times) < 0)
    if late.size:
        row = int(late[0])
        raise StudyError(
            f"{where}: times must increase, but row {row + 2} has {times[row + 1]:g} s after {times[row]:g} s; sort the rows"
        )
    return samples


def _read(path: Path) -> Samples:
    where, ending = f"file {path.name!r}", path.suffix.lower()
    if ending in TABLES and not (ending == ".txt" and MESSAGE.search(read_text(path))):
        return samples_from_csv(read_text(path), where)
    if ending in ARRAYS:
        return samples_from_numpy(path)
    if ending == ".parquet":
        return samples_from_parquet(path)
    if ending in BAGS or _is_bag(path):
        return samples_from_bag(path)
    if ".srdf" in path.name.lower():
        return samples_from_srdf(path)
    return _from_documents(documents(path), where)


def _is_bag(path: Path) -> bool:
    return os.path.isfile(path / "metadata.yaml")  # unlike the path's own question, never fails


def _from_documents(contents: list[Any], where: str) -> Samples:
    samples = samples_from_documents(contents, where)
    if samples is not None:
        return samples
    content: Any = contents if len(contents) > 1 else contents[0]
    if _is_columns(content):
        return sampled_columns(list(content), table(list(map(list, zip(*content.values(), strict=False))), where))
    if isinstance(content, dict) and POSITIONS & content.keys():
        return samples_from_arrays(content, where)
    if _is_records(content):
        return sampled_columns(list(content[0]), table([list(row.values()) for row in content], where))
    if len(contents) > 1:
        raise StudyError(f"{where} holds {len(contents)} documents, none of them a trajectory or a joint state")
    if not isinstance(content, list):
        raise StudyError(f"{where}: expected a list of waypoints or a JointTrajectory with 'joint_names' and 'points'")
    return Samples(table(content, where))


def _is_columns(content: Any) -> bool:
    """Whether a mapping holds lists of numbers of one length by their names."""
    if not isinstance(content, dict) or not all(
        isinstance(key, str) and isinstance(v, list) for key, v in content.items()
    ):
        return False
    plain = all(isinstance(value, int | float) for column in content.values() for value in column)
    return plain and len({len(column) for column in content.values()}) == 1


def _is_records(content: Any) -> bool:
    """Whether a list holds mappings of numbers by names, all with the same names."""
    rows: list[Any] = content if isinstance(content, list) else []
    return all(isinstance(row, dict) for row in rows) and len({tuple(row) for row in rows}) == 1


def holds_samples(path: Path) -> bool:
    """Whether a file holds positions alone, and is no case."""
    ending = path.suffix.lower()
    if ending in (*TABLES, *ARRAYS, *BAGS, ".parquet") or ".srdf" in path.name.lower() or _is_bag(path):
        return True
    if ending not in DOCUMENTS or path.name.lower().endswith(".exact.json") or not os.path.isfile(path):
        return False
    contents = documents(path)
    first = contents[0]
    if isinstance(first, list) or _is_columns(first):
        return True
    if isinstance(first, dict) and "waypoints" not in first and POSITIONS & first.keys():
        return True
    return len(contents) > 1 or samples_from_documents(contents, f"file {path.name!r}") is not None
