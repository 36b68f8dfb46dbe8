"""Recordings as text: a table with or without a header."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from study.errors import StudyError
from study.io.columns import sampled_columns
from study.io.samples import Samples
from study.io.table import all_numbers, csv_cells, decimal, numbers, plain_table
from study.problem import Floats

Lines = list[tuple[int, list[str]]]


def samples_from_csv(text: str, where: str) -> Samples:
    """Read a table; without a header every column is a joint.

    Parameters
    ----------
    text : str
        As `study.io.table.csv_cells` takes it. A first line that begins with `#` is a header if it has as many cells as the
        line after it.
    where : str
        How a message begins.

    Raises
    ------
    StudyError
        If the lines differ in length, or a cell is not a finite number.
    """
    plain = plain_table(text)
    return _by_lines(text, where) if plain is None else _at_once(*plain, text, where)


def _at_once(first: list[str], values: Floats, text: str, where: str) -> Samples:
    header, body = _header([(1, first)], text, where)
    if not any(cell.strip() for cell in first) or (body and not all_numbers(first)):  # which no header is
        return _by_lines(text, where)
    rows = np.vstack([[decimal(cell) for cell in first], values]) if body else values
    if not np.isfinite(rows[0]).all():
        return _by_lines(text, where)
    return sampled_columns(header, rows) if header else Samples(rows)


def _by_lines(text: str, where: str) -> Samples:
    header, body = _header(csv_cells(text, where), text, where)
    if not body:
        raise StudyError(f"{where}: there are no waypoints; give one line for each")
    width = len(header) or len(body[0][1])
    for line, cells in body:
        if len(cells) != width:
            raise StudyError(f"{where}, line {line}: expected {width} columns as in the first line, got {len(cells)}")
    if not header:
        return Samples(_values(body, range(width), where))
    texts = [k for k in range(width) if not all_numbers([body[0][1][k]])]
    named = [k for k in texts if not header[k].startswith(("field.name", "field.header.frame_id"))]
    plain = [k for k in range(width) if k not in texts or k in named]
    samples = sampled_columns([header[k] for k in plain], _values(body, plain, where))
    titles = [body[0][1][k].strip() for k in texts if header[k].startswith("field.name")]
    return samples if len(titles) != samples.positions.shape[1] else _named(samples, titles)


def _header(lines: Lines, text: str, where: str) -> tuple[list[str], Lines]:
    first = next((line for line in text.splitlines() if line.strip()), "")
    if first.lstrip().startswith("#") and lines:
        commented = csv_cells(first.lstrip(" #"), where) + lines[:1]
        if len(commented) == 2 and len(commented[0][1]) == len(commented[1][1]) and not all_numbers(commented[0][1]):
            return [cell.strip() for cell in commented[0][1]], lines
    if not lines or all_numbers(lines[0][1]):
        return [], lines
    return [cell.strip() for cell in lines[0][1]], lines[1:]


def _values(body: Lines, columns: Sequence[int], where: str) -> Floats:
    chosen = [[cells[k] for k in columns] for _, cells in body]
    return numbers(chosen, _Places(where, [line for line, _ in body])) if columns else np.empty((len(body), 0))


class _Places(Sequence[str]):
    """Names of lines, made only where a message needs one."""

    def __init__(self, where: str, lines: Sequence[int]) -> None:
        self._where, self._lines = where, lines

    def __len__(self) -> int:
        return len(self._lines)

    def __getitem__(self, index: int) -> str:  # type: ignore[override]
        return f"{self._where}, line {self._lines[index]}"


def _named(samples: Samples, names: Sequence[str]) -> Samples:
    return Samples(
        samples.positions,
        tuple(names),
        True,
        samples.times,
        samples.velocities,
        samples.accelerations,
        samples.notes,
    )
