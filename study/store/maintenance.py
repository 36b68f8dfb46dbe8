"""Look after a results file: check every row, write its columns out, take another file in, give room back."""

from __future__ import annotations

import csv
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from study.errors import StudyError
from study.files import harmless, replacing
from study.store.codec import decode, settings_from
from study.store.file import exists, explained, reading, transaction, writing
from study.store.provenance import is_stale
from study.store.results import Cell
from study.store.row import CHECKED, SEALED, Row

COLUMNS = (
    "kind", "subject", "label", "method", "settings", "seed", "code", "status", "feasible", "duration", "worst_ratio",
    "evaluations", "wall_time", "key", "digest",
)  # fmt: skip
"""Columns that `export_columns` writes, in this order."""

BATCH = 5000


@dataclass(frozen=True)
class Merged:
    """Result of merging one file into another.

    Attributes
    ----------
    added, known, contrary : int
        Results that are new, that were there already with the same content, and that were there with another content: of
        those the file keeps its own.
    """

    added: int
    known: int
    contrary: int


@dataclass(frozen=True)
class Tally:
    """One line of a sweep's table.

    Attributes
    ----------
    kind, subject, label : str
        Kind of job; case and planner of a cell, empty for all jobs of another kind.
    count, feasible, cut_short : int
        Results, those that keep every limit, and those that a time limit decided.
    best, mean : float, s, optional
        Duration of the feasible ones.
    wall_time : float, s
        Of all.
    """

    kind: str
    subject: str
    label: str
    count: int
    feasible: int
    cut_short: int
    best: float | None
    mean: float | None
    wall_time: float


def verify(path: Path) -> tuple[int, list[str]]:
    """Read the whole file, every page and every row, against the checksums; count the results, name the damaged ones.

    Raises
    ------
    StudyError
        If the file as a whole is damaged, or not a results file.
    """
    with reading(path, whole=True) as connection:
        rows = map(Row.of, connection.execute(Row.QUERY))
        count, damaged = 0, []
        for row in rows:
            count += 1
            if reason := _fault(row):
                damaged.append(f"{row.name}: {reason}")
        orphans = "SELECT count(*) FROM payloads WHERE id NOT IN (SELECT id FROM results)"
        if lost := connection.execute(orphans).fetchone()[0]:
            damaged.append(f"{lost} payloads without a result")
    return count, damaged


def _fault(row: Row) -> str:
    """Say why a row cannot be used; nothing where it can."""
    try:
        encoded = row.encoded()
        if row.checked[1] == Cell.KIND:
            decode(
                Cell(row.checked[2], row.checked[3], row.sealed[0], settings_from(row.checked[4], row.checked[5])),
                encoded,
            )
    except (ValueError, KeyError, TypeError, AttributeError, StudyError) as error:
        return str(error)
    return ""


def tallies(path: Path) -> list[Tally]:
    """Count and average per case and planner, without reading the rows: an index holds all that is asked."""
    sums = """count(*), sum(feasible), sum(status = 'TIMED_OUT'),
      min(CASE WHEN feasible THEN duration END), avg(CASE WHEN feasible THEN duration END), sum(wall_time) FROM results"""
    cells = f"SELECT kind, subject, label, {sums} WHERE kind = ? GROUP BY subject, label"
    others = f"SELECT kind, '', '', {sums} WHERE kind != ? GROUP BY kind"
    with reading(path) as connection:
        return [Tally(*row) for query in (cells, others) for row in connection.execute(query, (Cell.KIND,))]


def export_columns(path: Path, target: Path) -> int:
    """Write one line per result as CSV or Parquet, as the target's name ends; return how many.

    Raises
    ------
    StudyError
        If the name ends otherwise or the target cannot be written.
    """
    writers = {".csv": _write_csv, ".parquet": _write_parquet}
    if target.suffix not in writers:
        raise StudyError(f"{target}: results are exported to a file that ends in .csv or .parquet")
    try:
        with reading(path) as connection, replacing(target) as part:
            rows = connection.execute(f"SELECT {', '.join(COLUMNS)} FROM results ORDER BY kind, subject, label, key")  # noqa: S608
            return writers[target.suffix](iter(lambda: rows.fetchmany(BATCH), []), part)
    except ValueError as error:  # pyarrow says of a value that does not fit that it is invalid
        raise StudyError(f"cannot write {target}: {error}") from error


def _write_csv(batches: Iterator[list[Any]], target: Path) -> int:
    count = 0
    with target.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for rows in batches:
            writer.writerows([harmless(value) for value in row] for row in rows)
            count += len(rows)
    return count


def _write_parquet(batches: Iterator[list[Any]], target: Path) -> int:
    import pyarrow as pa  # here: slow to import
    from pyarrow import parquet

    whole, real = pa.int64(), pa.float64()
    kinds = {"seed": whole, "evaluations": whole, "feasible": pa.bool_()}
    kinds |= dict.fromkeys(("duration", "worst_ratio", "wall_time"), real)
    schema = pa.schema([(name, kinds.get(name, pa.string())) for name in COLUMNS])
    count = 0
    with parquet.ParquetWriter(target, schema) as writer:
        for rows in batches:
            columns = zip(*rows, strict=True)
            arrays = [
                pa.array([bool(value) for value in column] if pa.types.is_boolean(field.type) else column, field.type)
                for field, column in zip(schema, columns, strict=True)
            ]
            writer.write_table(pa.Table.from_arrays(arrays, schema=schema))
            count += len(rows)
    return count


def merge(path: Path, other: Path) -> Merged:
    """Take the results of another file into this one; a damaged row stops it before anything is kept.

    Raises
    ------
    StudyError
        If a file is damaged, both are the same, or this one is being written to.
    """
    if exists(path) and exists(other) and path.samefile(other):
        raise StudyError(f"{path} cannot be merged into itself")
    _, damaged = verify(other)
    if damaged:
        raise StudyError(f"results file {other} is damaged: {damaged[0]}; nothing was merged")
    with writing(path) as connection, explained(path):
        connection.execute("ATTACH ? AS other", (str(other.absolute()),))
        with transaction(connection):
            same = "FROM other.results AS theirs JOIN results AS ours USING (key) WHERE ours.digest"
            known, contrary = (
                connection.execute(f"SELECT count(*) {same} {sign} theirs.digest").fetchone()[0] for sign in ("=", "!=")
            )
            count = connection.execute("SELECT count(*) FROM other.results").fetchone()[0]
            _copy(connection)
    return Merged(count - known - contrary, known, contrary)


def _copy(connection: sqlite3.Connection) -> None:
    columns = f"{CHECKED}, {SEALED}, seal"
    first = connection.execute("SELECT coalesce(max(id), 0) FROM results").fetchone()[0]
    connection.execute(
        f"INSERT OR IGNORE INTO results ({columns}) SELECT {columns} FROM other.results ORDER BY other.results.id"  # noqa: S608
    )
    connection.execute(
        "INSERT INTO payloads SELECT ours.id, document, arrays FROM results AS ours JOIN other.results AS theirs "
        "USING (key) JOIN other.payloads AS load ON load.id = theirs.id WHERE ours.id > ? ORDER BY ours.id",
        (first,),
    )


def compact(path: Path, *, drop_stale: bool = False) -> tuple[int, int]:
    """Rewrite the file without gaps; return results dropped and bytes won.

    Parameters
    ----------
    path : Path
    drop_stale : bool
        Whether to drop results of installed planners and jobs whose code has changed since; no run asks for them.

    Raises
    ------
    StudyError
        If the file is damaged or being written to.
    """
    if not exists(path):
        raise StudyError(f"there are no results at {path}")
    before, dropped = path.stat().st_size, 0
    with writing(path) as connection, explained(path):
        if drop_stale:
            with transaction(connection):
                dropped = _drop_stale(connection)
        connection.execute("VACUUM")
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    return dropped, before - path.stat().st_size


def _drop_stale(connection: sqlite3.Connection) -> int:
    dropped = 0
    for (code,) in connection.execute("SELECT DISTINCT code FROM results").fetchall():
        if is_stale(code):
            rows = "results WHERE code = ?"
            connection.execute(f"DELETE FROM payloads WHERE id IN (SELECT id FROM {rows})", (code,))  # noqa: S608
            dropped += connection.execute(f"DELETE FROM {rows}", (code,)).rowcount  # noqa: S608
    return dropped
