"""Records as CSV and Parquet files: the one writer of all tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from study.files import csv_text, replacing, write_file

Value = str | int | float | bool | None
Record = dict[str, Value]
ARROW = {str: pa.string(), int: pa.int64(), float: pa.float64(), bool: pa.bool_()}


def raw(value: Value) -> str:
    """Write a value exactly as the CSV file does."""
    return "" if value is None else repr(value) if isinstance(value, float) else str(value)


def write_table(stem: Path, records: Sequence[Record], schema: Mapping[str, type] | None = None) -> None:
    """Write records as CSV and Parquet into a folder that exists.

    Parameters
    ----------
    stem : Path
        Path of both files without their endings.
    records : sequence of dict
    schema : mapping of str to type, optional
        Columns and the Python type of each; by default those of the records themselves.
    """
    typed = None if schema is None else pa.schema([(key, ARROW[of]) for key, of in schema.items()])
    table = pa.Table.from_pylist(list(records), schema=typed)
    rows = ([raw(record[key]) for key in table.column_names] for record in records)
    write_file(stem.with_name(f"{stem.name}.csv"), csv_text([table.column_names, *rows]))
    with replacing(stem.with_name(f"{stem.name}.parquet")) as part:
        pq.write_table(table, part)
