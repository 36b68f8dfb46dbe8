"""Recordings as text: a table with or without a header."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

import numpy as np

from study.errors import StudyError
from study.io.columns import UNIT, is_time, sampled_columns
from study.io.samples import Samples
from study.io.table import (
    Cells,
    decimal,
    is_number,
    numbers,
    plain_table,
    separator,
    split_lines,
    table_lines,
)
from study.problem import Floats

WORDS = re.compile(
    r"name|label|comment|note|remark|text|date|file|frame|state|mode|phase|event|description", re.IGNORECASE
)
"""Names of columns that hold words."""


def samples_from_csv(text: str, where: str) -> Samples:
    """Read a table; without a header every column is a joint.

    Parameters
    ----------
    text : str
        As `study.io.table.table_lines` takes it. Over lines of numbers alone, the nearest comment with as many cells is the header.
    where : str
        How a message begins.

    Raises
    ------
    StudyError
        If the lines differ in length, a cell is not a finite number, or text stands beside numbers without a header.
    """
    lines, comments = table_lines(text)
    mark = separator(lines)
    candidates = [
        [cell.strip() for _, cells in split_lines([(0, line)], mark, where) for cell in cells] for line in comments
    ]
    plain = plain_table(lines, mark)
    if plain is not None:
        first, values = plain
        if not all(map(is_number, first)):
            return sampled_columns(first, values) if any(cell.strip() for cell in first) else Samples(values)
        values = np.vstack([[decimal(cell) for cell in first], values])
        if np.isfinite(values).all():
            header = _commented(candidates, len(first))
            return _said(sampled_columns(header, values), header) if header else Samples(values)
    return _by_lines(split_lines(lines, mark, where), candidates, where)


def _commented(candidates: Sequence[list[str]], width: int) -> list[str]:
    """Cells of the nearest comment that can be the header: neither numbers nor units alone."""
    names = (c for c in candidates if len(c) == width)
    return next((c for c in names if not all(is_number(cell) or UNIT.fullmatch(f"[{cell}]") for cell in c)), [])


def _said(samples: Samples, header: Sequence[str]) -> Samples:
    return samples.noting(f"a comment was taken as the header: {', '.join(header)}")


def _by_lines(rows: Cells, candidates: Sequence[list[str]], where: str) -> Samples:
    kinds = [list(map(is_number, cells)) for _, cells in rows[:2]]
    header, commented = _commented(candidates, len(kinds[0]) if kinds else 0), False
    if kinds and all(kinds[0]) and not header:
        _check_widths(rows, len(rows[0][1]), where)
        return Samples(_values(rows, range(len(rows[0][1])), where))
    if kinds and (all(kinds[0]) or (any(kinds[0]) and kinds[0] == kinds[-1] and len(rows) > 1)):
        if not header:
            line, cells = rows[0]
            text = cells[kinds[0].index(False)]
            raise StudyError(f"{where}, line {line}: {text[:60]!r} is no number; name the columns in a first line")
        commented = True
    elif rows:
        header, rows = [cell.strip() for cell in rows[0][1]], rows[1:]
    if not rows:
        raise StudyError(f"{where}: there are no waypoints; give one line for each")
    _check_widths(rows, len(header), where)
    samples = _with_texts(header, rows, where)
    return _said(samples, header) if commented else samples


def _check_widths(rows: Cells, width: int, where: str) -> None:
    for line, cells in rows:
        if len(cells) != width:
            raise StudyError(f"{where}, line {line}: expected {width} columns as in the first line, got {len(cells)}")


def _with_texts(header: Sequence[str], body: Cells, where: str) -> Samples:
    """Columns of text are left out, but for dates, which are times, and names of joints as `rostopic echo -p` writes them."""
    texts = [k for k, cell in enumerate(body[0][1]) if not is_number(cell)]
    texts = [k for k in texts if _is_text(header[k], [cells[k] for _, cells in body])]
    dates = {k for k in texts if is_time(header[k]) and _dated(body, k)}
    plain = [k for k in range(len(header)) if k not in texts or k in dates]
    if not plain:
        raise StudyError(f"{where} has no columns of numbers")
    samples = sampled_columns([header[k] for k in plain], _values(body, plain, where))
    titled = [k for k in texts if header[k].startswith("field.name")]
    titles = tuple(body[0][1][k].strip() for k in titled)
    if len(titles) == samples.positions.shape[1]:
        samples, texts = replace(samples, names=titles), [k for k in texts if k not in titled]
    unused = [repr(header[k]) for k in texts if k not in dates]
    return samples.noting(f"not used: column {', '.join(unused[:8])}, which holds no numbers") if unused else samples


def _is_text(name: str, column: Sequence[str]) -> bool:
    """Whether a column is words, and no numbers that were written in a way that is not read."""
    if any(map(is_number, column)):
        return False
    wordy = len(column) > 1 and not any(character.isdigit() for cell in column for character in cell)
    return wordy or is_time(name) or bool(WORDS.search(name)) or not any(cell.strip() for cell in column)


def _dated(body: Cells, column: int) -> bool:
    """Put seconds since the first date in place of a column's dates; nothing where a cell is no date."""
    try:
        dates = [datetime.fromisoformat(cells[column].strip()) for _, cells in body]
        seconds = [(date - dates[0]).total_seconds() for date in dates]
    except (ValueError, TypeError):
        return False
    for (_, cells), value in zip(body, seconds, strict=True):
        cells[column] = repr(value)
    return True


def _values(body: Cells, columns: Sequence[int], where: str) -> Floats:
    chosen = [[cells[k] for k in columns] for _, cells in body]
    return numbers(chosen, _Places(where, [line for line, _ in body]))


class _Places(Sequence[str]):
    """Names of lines, made only where a message needs one."""

    def __init__(self, where: str, lines: Sequence[int]) -> None:
        self._where, self._lines = where, lines

    def __len__(self) -> int:
        return len(self._lines)

    def __getitem__(self, index: int) -> str:  # type: ignore[override]
        return f"{self._where}, line {self._lines[index]}"
