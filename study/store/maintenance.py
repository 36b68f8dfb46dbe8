"""Look after a results file: check every row, write its columns out, take another file in, give room back."""

from __future__ import annotations

import csv
import os
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from study.errors import StudyError
from study.registry import planner_code, planner_names
from study.store.file import check_file, explained, read_only, transaction
from study.store.store import CHECKED, Store, row_digest

COLUMNS = (
    "case_name", "label", "planner", "settings", "seed", "version", "status", "feasible", "duration", "worst_ratio",
    "evaluations", "wall_time", "key", "digest",
)  # fmt: skip
"""What `export_columns` writes, in this order."""

BATCH = 5000
_ALL = f"SELECT results.id, {CHECKED}, digest, document, arrays FROM results LEFT JOIN payloads USING (id)"  # noqa: S608


@dataclass(frozen=True)
class Merged:
    """What came of taking one file into another.

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
    case, label : str
    cells, feasible, cut_short : int
        Results, those that keep every limit, and those that a time limit decided.
    best, mean : float, s, optional
        Duration of the feasible ones.
    wall_time : float, s
        Of all.
    """

    case: str
    label: str
    cells: int
    feasible: int
    cut_short: int
    best: float | None
    mean: float | None
    wall_time: float


def verify(path: Path) -> tuple[int, list[str]]:
    """Read the whole file: every page, every result and trial against its checksum; count them and name the damaged ones.

    Raises
    ------
    StudyError
        If the file as a whole is damaged, or not a results file.
    """
    Store(path, {}, write=False).close()
    check_file(path, whole=True)
    with explained(path), closing(_reader(path)) as connection:
        rows = connection.execute(_ALL)
        checked, damaged = 0, []
        for row in rows:
            checked += 1
            if not _intact(row):
                damaged.append(f"{row[3]} on {row[2]} (seed {row[5]})")
        orphans = "SELECT count(*) FROM payloads WHERE id NOT IN (SELECT id FROM results)"
        if lost := connection.execute(orphans).fetchone()[0]:
            damaged.append(f"{lost} payloads without a result")
        trials = _trials(connection)
    return checked + len(trials), damaged + [name for name, intact in trials if not intact]


def _trials(connection: sqlite3.Connection) -> list[tuple[str, bool]]:
    """Name the trials of bare searches, and say whether they match their checksums; older files have no checksums there."""
    if "digest" not in [row[1] for row in connection.execute("PRAGMA table_info(trials)")]:
        return []
    rows = connection.execute("SELECT digest, key, trial, value, reason FROM trials")
    return [(f"trial {row[1]}", row_digest(tuple(row), "", b"") == digest) for digest, *row in rows]


def _reader(path: Path) -> sqlite3.Connection:
    return sqlite3.connect(read_only(path), uri=True, isolation_level=None)


def _intact(row: tuple[Any, ...]) -> bool:
    _, *columns, digest, document, arrays = row
    if not isinstance(document, str) or not isinstance(arrays, bytes):
        return False
    return row_digest(tuple(columns), document, arrays) == digest


def tallies(path: Path) -> list[Tally]:
    """Count and average per case and planner, without reading the rows: an index holds all that is asked."""
    query = """SELECT case_name, label, count(*), sum(feasible), sum(status = 'TIMED_OUT'),
      min(CASE WHEN feasible THEN duration END), avg(CASE WHEN feasible THEN duration END), sum(wall_time)
      FROM results GROUP BY case_name, label"""
    Store(path, {}, write=False).close()
    with explained(path), closing(_reader(path)) as connection:
        return [Tally(*row) for row in connection.execute(query)]


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
    Store(path, {}, write=False).close()
    unfinished = target.with_name(target.name + ".part")
    try:
        with explained(path), closing(_reader(path)) as connection:
            rows = connection.execute(f"SELECT {', '.join(COLUMNS)} FROM results ORDER BY case_name, label, key")  # noqa: S608
            count = writers[target.suffix](iter(lambda: rows.fetchmany(BATCH), []), unfinished)
        os.replace(unfinished, target)
    except OSError as error:
        unfinished.unlink(missing_ok=True)
        raise StudyError(f"cannot write {target}: {error.strerror or error}") from error
    return count


def _write_csv(batches: Iterator[list[Any]], target: Path) -> int:
    count = 0
    with target.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(COLUMNS)
        for rows in batches:
            writer.writerows([_harmless(value) for value in row] for row in rows)
            count += len(rows)
    return count


def _harmless(value: Any) -> Any:
    """Keep a spreadsheet from taking a name of someone's own for a formula."""
    return f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r")) else value


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
    """Take the results, and the searches' trials, of another file into this one; a damaged row stops it before anything is kept.

    Raises
    ------
    StudyError
        If a file is damaged, both are the same, or this one is being written to.
    """
    if not other.exists():
        raise StudyError(f"there are no results at {other}")
    if path.exists() and path.samefile(other):
        raise StudyError(f"{path} cannot be merged into itself")
    _, damaged = verify(other)
    if damaged:
        raise StudyError(f"results file {other} is damaged: {damaged[0]}; nothing was merged")
    with Store(path, {}) as store, explained(path):
        connection = store._connection
        connection.execute("ATTACH ? AS other", (str(other.absolute()),))
        with transaction(store._connection):
            same = "FROM other.results AS theirs JOIN results AS ours USING (key) WHERE ours.digest"
            known, contrary = (
                connection.execute(f"SELECT count(*) {same} {sign} theirs.digest").fetchone()[0] for sign in ("=", "!=")
            )
            count = connection.execute("SELECT count(*) FROM other.results").fetchone()[0]
            _copy(connection)
        connection.execute("DETACH other")
    return Merged(count - known - contrary, known, contrary)


def _copy(connection: sqlite3.Connection) -> None:
    names = [row[1] for row in connection.execute("PRAGMA table_info(results)") if row[1] != "id"]
    columns = ", ".join(names)
    first = connection.execute("SELECT coalesce(max(id), 0) FROM results").fetchone()[0]
    connection.execute(
        f"INSERT OR IGNORE INTO results ({columns}) SELECT {columns} FROM other.results ORDER BY other.results.id"  # noqa: S608
    )
    connection.execute(
        "INSERT INTO payloads SELECT ours.id, document, arrays FROM results AS ours JOIN other.results AS theirs "
        "USING (key) JOIN other.payloads AS load ON load.id = theirs.id WHERE ours.id > ? ORDER BY ours.id",
        (first,),
    )
    for name, definition in connection.execute("SELECT name, sql FROM other.sqlite_master WHERE name = 'trials'"):
        ours = connection.execute("SELECT sql FROM main.sqlite_master WHERE name = ?", (name,)).fetchone()
        if ours is None:
            connection.execute(definition)
        if ours in (None, (definition,)):  # an older version's trials are asked for no more
            connection.execute("INSERT OR IGNORE INTO main.trials SELECT * FROM other.trials")


def compact(path: Path, *, drop_stale: bool = False) -> tuple[int, int]:
    """Rewrite the file without gaps; return results dropped and bytes won.

    Parameters
    ----------
    path : Path
    drop_stale : bool
        Whether to drop results of installed planners whose code has changed since; no run asks for them any more.

    Raises
    ------
    StudyError
        If the file is damaged or being written to.
    """
    if not path.exists():
        raise StudyError(f"there are no results at {path}")
    before, dropped = path.stat().st_size, 0
    with Store(path, {}) as store, explained(path):
        if drop_stale:
            with transaction(store._connection):
                dropped = _drop_stale(store._connection)
        store._connection.execute("VACUUM")
        store._connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    return dropped, before - path.stat().st_size


def _drop_stale(connection: sqlite3.Connection) -> int:
    dropped = 0
    for name in planner_names():
        rows = "results WHERE planner = ? AND version != ?"
        values = (name, planner_code(name))
        connection.execute(f"DELETE FROM payloads WHERE id IN (SELECT id FROM {rows})", values)  # noqa: S608
        dropped += connection.execute(f"DELETE FROM {rows}", values).rowcount  # noqa: S608
    return dropped
