"""Verdicts as CSV: one file for each paper, one for all that lie in a folder, and the counts that the index shows."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from study.cases.published import papers
from study.errors import StudyError
from study.files import as_written, csv_text, read_file, write_file
from study.reproduction.book import Entry
from study.reproduction.tally import Counts, counted
from study.reproduction.verdicts import Basis, Outcome

COLUMNS = (
    "paper", "place", "row", "column", "quantity", "printed", "ours", "spread", "verdict", "rests on", "agrees", "reading", "reason",
    "other readings",
)  # fmt: skip


def write_cells(path: Path, entries: Iterable[Entry]) -> None:
    """Write entries as CSV: what is printed, ours, the verdict, what it rests on and why.

    Raises
    ------
    StudyError
        If the file cannot be written.
    """
    write_file(path, csv_text([COLUMNS, *map(_record, entries)]))


def gather(folder: Path) -> dict[str, Counts]:
    """Put the cells of all papers that lie in a folder into one file, and count each paper's verdicts.

    Raises
    ------
    StudyError
        If a file cannot be read or written.
    """
    rows: list[Sequence[str]] = []
    counts = {}
    for paper in papers():
        if (folder / f"{paper}.csv").is_file() and (folder / f"{paper}.html").is_file():
            own = _read(folder / f"{paper}.csv")
            counts[paper] = counted([(Basis(row["rests on"]), Outcome(row["verdict"])) for row in own])
            rows += [[row[column] for column in COLUMNS] for row in own]
    write_file(folder / "verdicts.csv", csv_text([COLUMNS, *rows]))
    return counts


def _read(path: Path) -> list[dict[str, str]]:
    reader = csv.DictReader(io.StringIO(read_file(path).decode("utf-8"), newline=""))
    if tuple(reader.fieldnames or ()) != COLUMNS:
        raise StudyError(f"{str(path)!r} has the columns of another version; reproduce that paper again")
    return [{column: as_written(cell) for column, cell in row.items()} for row in reader]


def _record(entry: Entry) -> list[str]:
    ruling = entry.ruling
    agrees = "" if ruling.agrees is None else "yes" if ruling.agrees else "no"
    others = "; ".join(f"{name}: {value}" for name, value in ruling.others.items())
    return [
        entry.paper, entry.section, entry.place.row, entry.place.column, entry.quantity, entry.printed, ruling.ours, ruling.spread,
        str(ruling.outcome), str(ruling.basis), agrees, ruling.reading, ruling.why, others,
    ]  # fmt: skip
