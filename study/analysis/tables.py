"""Tables: one list of columns for pages and files alike, and the one writer of CSV and Parquet."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Generic, TypeVar

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from markupsafe import Markup

from study.files import csv_text, replacing, write_file

Value = str | int | float | bool | None
Record = dict[str, Value]
Cell = str | Markup
Row = TypeVar("Row")
ARROW = {str: pa.string(), int: pa.int64(), float: pa.float64(), bool: pa.bool_()}
NO_FLAGS: Mapping[str, str] = MappingProxyType({})


@dataclass(frozen=True)
class Grid:
    """A table of a page: caption, heads and rows; the first `names` columns hold names, the others numbers.

    `choices` names the columns whose values a page lets people choose from: one value, or numbers up to one.
    """

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    names: int = 1
    choices: Sequence[str] = ()


@dataclass(frozen=True)
class Column(Generic[Row]):
    """A column of a table.

    Attributes
    ----------
    key : str
        Name in the files; empty for a column of the page alone.
    head : str
        Name on the page; empty for a column of the files alone.
    value : callable (row) -> value
    text : callable (value) -> str
        Form of the value on the page.
    kind : type, optional
        Python type of the values in the files; None leaves it to the values.
    hint : str
        Explanation of the head.
    """

    key: str
    head: str
    value: Callable[[Row], Any]
    text: Callable[[Any], Cell] = str
    kind: type | None = None
    hint: str = ""

    @property
    def numeric(self) -> bool:
        """True for a column of numbers."""
        return self.kind is not str

    def fields(self, row: Row, flags: Mapping[str, str]) -> Record:
        """Entries of a row in the files."""
        value = self.value(row)
        return {self.key: bare(value) if self.kind is None else None if value is None else self.kind(value)}

    def cell(self, row: Row, flags: Mapping[str, str]) -> Cell:
        """Entry of a row on the page."""
        return self.text(self.value(row))


def records(columns: Sequence[Column[Row]], rows: Iterable[Row], flags: Mapping[str, str] = NO_FLAGS) -> list[Record]:
    """Rows as they stand in the files; in a column without a kind a number that is not finite is left empty."""
    kept = [column for column in columns if column.key]
    return [{key: value for column in kept for key, value in column.fields(row, flags).items()} for row in rows]


def grid(
    caption: str,
    columns: Sequence[Column[Row]],
    rows: Iterable[Row],
    flags: Mapping[str, str] = NO_FLAGS,
    names: int = 1,
) -> Grid:
    """Rows as they stand on the page."""
    shown = [column for column in columns if column.head]
    cells = [[column.cell(row, flags) for column in shown] for row in rows]
    return Grid(caption, [column.head for column in shown], cells, names)


def markdown(table: Grid) -> str:
    """Write a table in Markdown."""
    align = ["---"] * table.names + ["---:"] * (len(table.head) - table.names)
    return "\n".join(
        "| " + " | ".join(str(cell).replace("\n", ", ") for cell in cells) + " |"
        for cells in [table.head, align, *table.rows]
    )


def bare(value: Any) -> Value:
    """Plain Python value for the files."""
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, bool | np.bool_):
        return bool(value)
    return str(value) if isinstance(value, str) else value


def raw(value: Value) -> str:
    """Write a value exactly as the CSV file does."""
    return "" if value is None else repr(value) if isinstance(value, float) else str(value)


def write_table(stem: Path, records: Sequence[Record], columns: Sequence[Column[Any]] = ()) -> None:
    """Write records as CSV and Parquet into a folder that exists.

    Parameters
    ----------
    stem : Path
        Path of both files without their endings.
    records : sequence of dict
    columns : sequence of Column, optional
        Columns with their kinds; by default those of the records themselves.
    """
    typed = pa.schema([(column.key, ARROW[column.kind]) for column in columns if column.kind]) if columns else None
    table = pa.Table.from_pylist(list(records), schema=typed)
    rows = ([raw(record[key]) for key in table.column_names] for record in records)
    write_file(stem.with_name(f"{stem.name}.csv"), csv_text([table.column_names, *rows]))
    with replacing(stem.with_name(f"{stem.name}.parquet")) as part:
        pq.write_table(table, part)
