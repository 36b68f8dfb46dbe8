"""Command `study reproduce`: run, rule, write pages, and compare with the committed verdicts."""

from __future__ import annotations

import csv
import io
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from study.cli.folder import DEFAULT_OUT, STORE_NAME, audit_flags, write_pages
from study.cli.screen import make_console
from study.cli.shared import Dask, Fresh, Jobs, Memory, Out, Workers, run_missing
from study.datafiles import data_folder
from study.errors import StudyError, plural
from study.files import as_written, csv_text, read_file, write_file
from study.reproduction.book import PAPERS, SHORT, Entry, entries_of, jobs_of, paper_named
from study.reproduction.effort import FULL, QUICK, Effort
from study.reproduction.jobs import Runs
from study.reproduction.page import write_index, write_paper
from study.reproduction.tally import line
from study.reproduction.verdicts import CLAIM
from study.runs.environment import environment
from study.store.store import Store

COMMITTED = ("paper", "place", "row", "column", "printed", "verdict", "rests on")
Key = tuple[str, str, str, str]


def reproduce(
    papers: Sequence[str], effort: Effort, out: Path, workers: Workers, console: Console
) -> dict[str, tuple[Entry, ...]]:
    """Run what is missing, rule, write the pages, and say what became of every paper's numbers.

    Parameters
    ----------
    papers : sequence of str
        Keys of the papers.
    effort : Effort
    out : Path
        Its results file and its folder `report/reproduction` are written.
    workers : Workers
    console : Console

    Returns
    -------
    dict of str to tuple of Entry
        Everything that the papers print, with its ruling.
    """
    begun = time.perf_counter()
    wanted = sorted(dict.fromkeys(jobs_of(papers, effort)), key=lambda job: -job.weight)
    with Store(out / STORE_NAME) as store:
        run_missing(wanted, store, console, workers, word="run")
        runs = Runs(store.outcomes(wanted))
    entries = {paper: entries_of(paper, runs, effort) for paper in papers}
    pages = out / "report" / "reproduction"
    facts = {**environment(), "effort": effort.label}
    with console.status("writing the pages"):
        for paper, printed in entries.items():
            write_paper(paper, printed, runs, effort, pages, facts)
        index = write_index(effort, pages, facts)
        write_pages(out, audit_flags(out))
    for paper, printed in entries.items():
        console.print(f"{paper}: {line(printed)}")
    console.print(f"pages: {index}", f"{time.perf_counter() - begun:.0f} s", sep="\n")
    return entries


def committed_path() -> Path:
    """Path of the verdicts of a full run under version control."""
    return data_folder() / "verdicts.csv"


def key_of(entry: Entry) -> Key:
    """Key of an entry in the committed table."""
    place = entry.section if entry.place.table == CLAIM else entry.place.table
    return entry.paper, place, entry.place.row, entry.place.column


def write_committed(entries: Sequence[Entry], path: Path) -> None:
    """Write the table of verdicts, one line for each printed number."""
    rows = ([*key_of(entry), entry.printed, entry.ruling.outcome, entry.ruling.basis] for entry in entries)
    write_file(path, csv_text([COMMITTED, *rows]))


def read_committed(path: Path) -> dict[Key, str]:
    """Read the table of verdicts.

    Raises
    ------
    StudyError
        If there is none.
    """
    if not path.is_file():
        raise StudyError(
            f"there is no table of verdicts at {str(path)!r}; write it with `study reproduce --all --commit`"
        )
    rows = csv.DictReader(io.StringIO(read_file(path).decode("utf-8"), newline=""))
    keys = ("paper", "place", "row", "column")
    return {tuple(as_written(row[key]) for key in keys): row["verdict"] for row in rows}  # type: ignore[misc]


def changes(entries: Sequence[Entry], committed: dict[Key, str]) -> list[str]:
    """Say which verdicts differ from the committed ones, entry by entry."""
    lines = []
    for entry in entries:
        before, now = committed.get(key_of(entry)), entry.ruling.outcome.value
        if before != now:
            name = " / ".join(filter(None, key_of(entry)))
            lines.append(
                f"{name}: {before or 'not there'} -> {now} (printed {entry.printed or '–'}, ours {entry.ruling.ours or '–'})"
            )
    return lines


def reproduce_command(
    paper: Annotated[
        str | None, typer.Argument(metavar="PAPER", help="woodworking, aubo, smwoa, sparrow, puma or a paper's key.")
    ] = None,
    all_papers: Annotated[bool, typer.Option("--all", help="All five papers.")] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer seeds, the stated readings only; labelled as quick.")
    ] = False,
    out: Out = DEFAULT_OUT,
    jobs: Jobs = None,
    commit: Annotated[
        bool, typer.Option("--commit", help="With --all: write the verdicts into the data of a checkout.")
    ] = False,
    fresh: Fresh = False,
    memory: Memory = None,
    dask: Dask = None,
) -> None:
    """Put every printed number of a paper beside ours, with a verdict; what has been run is not run again."""
    if (paper is None) != all_papers:
        raise StudyError(
            f"name one paper ({', '.join(SHORT)}) or give --all, not {'both' if all_papers else 'neither'}"
        )
    if commit and (quick or not all_papers):
        raise StudyError("--commit writes the verdicts of a full run: give --all, without --quick")
    console = make_console()
    papers = list(PAPERS) if paper is None else [paper_named(paper)]
    reproduced = reproduce(papers, QUICK if quick else FULL, out, Workers.of(jobs, fresh, memory, dask), console)
    flat = [entry for entries in reproduced.values() for entry in entries]
    if commit:
        write_committed(flat, committed_path())
        console.print(f"verdicts: {committed_path()}")
    elif not quick and committed_path().is_file():
        changed = changes(flat, read_committed(committed_path()))
        console.print(f"{plural(len(changed), 'verdict')} unlike the committed ones", *changed, sep="\n")
