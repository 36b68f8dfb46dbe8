"""Tables of numbers as people write them: cells of a CSV file, rows of YAML or JSON, decimal commas, increasing times."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from study.errors import StudyError, plural
from study.io.text import read_text
from study.problem import Floats


@dataclass(frozen=True, eq=False)
class WaypointRows:
    """Waypoints as a file gives them.

    Attributes
    ----------
    values : array of shape (n_waypoints, n_joints)
    names : tuple of str
        Of the joints; empty where the file gives none.
    si : bool
        Whether the file's format says that they are rad and m.
    """

    values: Floats
    names: tuple[str, ...] = ()
    si: bool = False


def parsed(path: Path) -> Any:
    """Parse a YAML or JSON file.

    Raises
    ------
    StudyError
        If it is neither, or the package that reads YAML is missing.
    """
    text, where = read_text(path), f"file {str(path)!r}"
    if path.suffix.lower() == ".json":
        try:
            return json.loads(text)
        except (json.JSONDecodeError, RecursionError) as error:
            line = f" at line {error.lineno}" if isinstance(error, json.JSONDecodeError) else ""
            raise StudyError(f"{where} is not valid JSON{line}: {getattr(error, 'msg', 'nested too deeply')}") from None
    try:
        import yaml
    except ModuleNotFoundError:
        raise StudyError(f"{where}: reading YAML needs the package 'pyyaml'; pip install pyyaml, or use JSON") from None
    try:
        return yaml.safe_load(text)
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        mark = getattr(error, "problem_mark", None)
        line = f" at line {mark.line + 1}" if mark else ""
        reason = getattr(error, "problem", None) or "it could not be parsed"
        raise StudyError(f"{where} is not valid YAML{line}: {reason}") from None


def table(rows: Sequence[Any], where: str) -> Floats:
    """Make an array of rows of numbers, shape (n_rows, n_columns).

    Raises
    ------
    StudyError
        If there is no row, a row has another length than the first, or something is not a finite number.
    """
    if not rows:
        raise StudyError(f"{where}: there are no waypoints; give at least two")
    for line, row in enumerate(rows, start=1):
        if not isinstance(row, list) or not row:
            raise StudyError(f"{where}: waypoint {line} must be a list of numbers, got {str(row)[:60]!r}")
        if len(row) != len(rows[0]):
            raise StudyError(f"{where}: waypoint {line} has {plural(len(row), 'number')}, the first has {len(rows[0])}")
    return np.array([[number(value, f"{where}: waypoint {i}") for value in row] for i, row in enumerate(rows, 1)])


def increasing(times: Floats, where: str, what: str) -> None:
    """Refuse times that do not increase from row to row."""
    late = np.flatnonzero(np.diff(times) <= 0)
    if late.size:
        k = int(late[0])
        raise StudyError(
            f"{where}: times must increase, but {what} {k + 2} has {times[k + 1]:g} s after {times[k]:g} s; sort the rows"
        )


def csv_cells(text: str) -> list[tuple[int, list[str]]]:
    """Split a table into cells, each line with its number.

    Semicolons separate columns if there are any, else tabs, else commas, else blanks; `#` begins a comment.
    """
    lines = [(n, line) for n, line in enumerate(text.splitlines(), start=1) if line.split("#")[0].strip()]
    bare = [re.sub(r'"[^"]*"', "", line) for _, line in lines]
    mark = next((mark for mark in (";", "\t", ",") if any(mark in line for line in bare)), None)
    if mark is None:
        return [(n, line.split()) if '"' not in line else (n, next(csv.reader([line]))) for n, line in lines]
    return [(n, next(csv.reader([line], delimiter=mark, skipinitialspace=True))) for n, line in lines]


def decimal(text: str) -> float:
    """Read a number that may have a comma for its decimal point.

    Raises
    ------
    ValueError
        If it is no number.
    """
    plain = text.strip()
    if plain.count(",") == 1 and "." not in plain:
        plain = plain.replace(",", ".")
    return float(plain)


def number(value: Any, where: str) -> float:
    """Read a finite number.

    Raises
    ------
    StudyError
        If it is none.
    """
    try:
        read = decimal(value) if isinstance(value, str) else np.nan if isinstance(value, bool) else float(value)
    except (TypeError, ValueError, OverflowError):
        read = np.nan
    if not np.isfinite(read):
        raise StudyError(f"{where}: expected a finite number, got {str(value)[:60]!r}")
    return read


def all_numbers(cells: Sequence[str]) -> bool:
    """Tell a line of numbers from a header."""
    try:
        return bool([decimal(cell) for cell in cells])
    except ValueError:
        return False
