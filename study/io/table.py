"""Tables of numbers as people write them: cells of CSV, rows of YAML, decimal commas, times in order."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from study.errors import StudyError, plural
from study.problem import Floats


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
    return numbers(rows, [f"{where}: waypoint {line}" for line in range(1, len(rows) + 1)])


def numbers(rows: Sequence[Sequence[Any]], places: Sequence[str]) -> Floats:
    """Make an array of rows of one length, shape (n_rows, n_columns); `places` begin the message about each row.

    Raises
    ------
    StudyError
        If something is not a finite number.
    """
    plain = {str} if isinstance(rows[0][0], str) else {float, int}
    if all(type(value) in plain for row in rows for value in row):
        # One by one where this fails, which knows decimal commas and names the place.
        with suppress(ValueError, OverflowError), np.errstate(over="ignore"):
            values = np.array(rows, dtype=str if plain == {str} else float).astype(float)
            if np.isfinite(values).all():
                return values
    return np.array([[number(value, place) for value in row] for row, place in zip(rows, places, strict=True)])


COMMENT = re.compile(r"\s*(#+|//|%+(?=\s))")
TRAILING = re.compile(r"\s#(\s.*)?$")
SEPARATOR = re.compile(r"\s*sep=.\s*", re.IGNORECASE)
"""First line by which spreadsheets tell each other the separator."""

Lines = list[tuple[int, str]]
Cells = list[tuple[int, list[str]]]


def table_lines(text: str) -> tuple[Lines, list[str]]:
    """Lines with content, each with its number; and the comments before them, without their marks, the nearest first.

    A comment begins with `#`, `//`, or `%` and a blank; behind numbers it begins with `#` between blanks.
    """
    lines = [(n, line) for n, line in enumerate(text.splitlines(), start=1) if line.strip()]
    if lines and SEPARATOR.fullmatch(lines[0][1]):
        del lines[0]
    if not any(mark in text for mark in "#/%"):
        return lines, []
    kept = [(n, TRAILING.sub("", line)) for n, line in lines if not COMMENT.match(line)]
    before = [line for n, line in lines if not kept or n < kept[0][0]]
    return kept, [COMMENT.sub("", line, count=1).strip() for line in reversed(before)]


def separator(lines: Lines) -> str | None:
    """Semicolons separate columns if there are any, else tabs, else commas, else blanks."""
    bare = [re.sub(r'"[^"]*"', "", line) if '"' in line else line for _, line in lines]
    return next((mark for mark in (";", "\t", ",") if any(mark in line for line in bare)), None)


def split_lines(lines: Lines, mark: str | None, where: str) -> Cells:
    """Split lines into cells; lines of empty cells and columns of empty cells at the end are left out.

    Raises
    ------
    StudyError
        If a cell is too long.
    """
    try:
        rows = [(n, _split(line, mark) if '"' in line else line.split(mark)) for n, line in lines]
    except csv.Error as error:
        raise StudyError(f"{where} is no table: {error}") from None
    rows = [(n, cells) for n, cells in rows if any(cell.strip() for cell in cells)]
    width = max((len(cells) for _, cells in rows), default=0)
    while rows and not any(cells[width - 1].strip() for _, cells in rows if len(cells) == width):
        rows, width = [(n, cells[: width - 1]) for n, cells in rows], width - 1
    return rows


def plain_table(lines: Lines, mark: str | None) -> tuple[list[str], Floats] | None:
    """Read a table at once, its first line as cells and all lines after it as numbers, shape (n_lines - 1, n_columns).

    None where a quotation mark, a decimal comma, a line of another length or anything else but a finite number stands in
    those lines; `split_lines` and `numbers` take such a table line by line.
    """
    if len(lines) < 2 or any('"' in line for _, line in lines):
        return None
    try:
        values = np.loadtxt([line for _, line in lines[1:]], delimiter=mark, comments=None, ndmin=2)
    except ValueError:
        return None
    first = lines[0][1].split(mark)
    return (first, values) if len(first) == values.shape[1] and np.isfinite(values).all() else None


def _split(line: str, mark: str | None) -> list[str]:
    if mark is None:
        return next(csv.reader([line]))
    return next(csv.reader([line], delimiter=mark, skipinitialspace=True))


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


def is_number(cell: str) -> bool:
    """Tell a cell that holds a number, finite or not, from text."""
    try:
        decimal(cell)
    except ValueError:
        return False
    return True
