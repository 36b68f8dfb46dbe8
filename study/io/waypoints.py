"""Waypoints from a file: a CSV table, rows in YAML or JSON, or a ROS 2 trajectory."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from study.errors import StudyError
from study.io.joint_trajectory import found_message, message_rows
from study.io.table import WaypointRows, all_numbers, csv_cells, increasing, number, parsed, table
from study.io.text import read_text

TIME = re.compile(r"(t|time|time[ _]from[ _]start|zeit|temps)\b.*", re.IGNORECASE)
"""How a header names the column of times."""


def read_rows(path: Path) -> WaypointRows:
    """Read waypoints from a CSV, YAML or JSON file.

    Parameters
    ----------
    path : Path
        `.csv`, `.tsv`, `.txt`: a table, one waypoint per line, with or without a header line of joint names and a column
        of times; `.yaml`, `.yml`, `.json`: a list of rows, or a `trajectory_msgs/JointTrajectory`.

    Raises
    ------
    StudyError
        If the file cannot be read or holds no table of numbers.
    """
    where = f"file {path.name!r}"
    if path.suffix.lower() in (".csv", ".tsv", ".txt"):
        return _from_csv(read_text(path), where)
    content = parsed(path)
    if (message := found_message(content)) is not None:
        return message_rows(message, where)
    rows = content.get("waypoints", content) if isinstance(content, dict) else content
    if not isinstance(rows, list):
        raise StudyError(f"{where}: expected a list of waypoints or a JointTrajectory with 'joint_names' and 'points'")
    return WaypointRows(table(rows, where))


def _from_csv(text: str, where: str) -> WaypointRows:
    lines = [(n, cells) for n, cells in csv_cells(text) if any(cell.strip() for cell in cells)]
    header = [] if not lines or all_numbers(lines[0][1]) else [cell.strip() for cell in lines[0][1]]
    body = lines[1:] if header else lines
    if not body:
        raise StudyError(f"{where}: there are no waypoints; give one line for each")
    width = len(header) or len(body[0][1])
    for line, cells in body:
        if len(cells) != width:
            raise StudyError(f"{where}, line {line}: expected {width} columns as in the first line, got {len(cells)}")
    values = np.array([[number(cell, f"{where}, line {line}") for cell in cells] for line, cells in body])
    if header and TIME.fullmatch(header[0]):
        increasing(values[:, 0], where, "waypoint")
        values, header = values[:, 1:], header[1:]
    return WaypointRows(values, tuple(header))
