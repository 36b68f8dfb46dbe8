"""Any file that holds joint positions, by its ending."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from study.errors import StudyError
from study.io.arrays_file import samples_from_numpy, samples_from_parquet
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
DOCUMENTS = (".yaml", ".yml", ".json")


def read_samples(path: Path) -> Samples:
    """Read joint positions, and times and rates where the file has them.

    Parameters
    ----------
    path : Path
        `.csv`, `.tsv`, `.txt`: a table with or without header; `.yaml`, `.yml`, `.json`: a list of rows, a
        `trajectory_msgs/JointTrajectory` or `sensor_msgs/JointState`s at any depth; `.npy`, `.npz`: arrays; `.parquet`: a table
        or a LeRobot episode; `.bag`, `.db3`, `.mcap`: a ROS bag; `.srdf#NAME,NAME`: group states of MoveIt.

    Raises
    ------
    StudyError
        If the file cannot be read, holds no table of numbers, or its times go back.
    """
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
    if ending in TABLES:
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
    if len(contents) > 1:
        raise StudyError(f"{where} holds {len(contents)} documents, none of them a trajectory or a joint state")
    content = contents[0]
    rows = content.get("waypoints", content) if isinstance(content, dict) else content
    if not isinstance(rows, list):
        raise StudyError(f"{where}: expected a list of waypoints or a JointTrajectory with 'joint_names' and 'points'")
    return Samples(table(rows, where))


def holds_samples(path: Path) -> bool:
    """Whether a file holds positions alone, and is no case."""
    ending = path.suffix.lower()
    if ending in (*TABLES, *ARRAYS, *BAGS, ".parquet") or ".srdf" in path.name.lower() or _is_bag(path):
        return True
    if ending not in DOCUMENTS or path.name.lower().endswith(".exact.json") or not os.path.isfile(path):
        return False
    contents = documents(path)
    return isinstance(contents[0], list) or samples_from_documents(contents, f"file {path.name!r}") is not None
