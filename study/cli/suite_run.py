"""The run of a suite, and what is shown of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.table import Table

from study.analysis.formatting import percent
from study.analysis.tables import Grid
from study.cases.case import Case
from study.cases.library import load_case
from study.cases.records import ProblemRecords, known_times, records_file, records_of
from study.cases.suite_file import suites_folder
from study.cases.suites import PAPERS, Suite, suite_named
from study.cli.check import report_verdict
from study.cli.folder import STORE_NAME, SUITE_NOTE, audit_flags, last_run, suite_noted, write_pages
from study.cli.screen import SafeConsole, complain, fitted, make_console
from study.cli.shared import Workers, run_missing
from study.errors import StudyError, plural
from study.files import replacing, write_file
from study.io.filenames import file_stem
from study.planning import Planner
from study.registry import method_named, unavailable_planners
from study.runs.environment import environment
from study.runs.execute import cell_jobs, stored_results
from study.runs.remembered import remember_lineup
from study.store.results import Result
from study.store.store import Store
from study.suites.export import Platform, export
from study.suites.law import committed_field
from study.suites.lineups import Lineup, chosen_cases, given_lineup, lineup_named, suite_cells, usual_lineup
from study.suites.measures import Field, best_in
from study.suites.page import write_page
from study.suites.papers import papers_marks
from study.suites.records import contradictions, improved, records_text
from study.suites.runs import Run, added, read_runs, runs_file, runs_of, write_runs
from study.suites.submission import ENDING, record_text, submission
from study.suites.tables import result_grids


@dataclass(frozen=True)
class Asked:
    """Wishes about the run of a suite beyond its line-up.

    Attributes
    ----------
    quick : bool
    planners : sequence of str
        In the place of the line-up's, with one time limit.
    lineup : str, optional
        Name of a line-up in the place of the suite's own.
    seeds, evaluations : int, optional
    time_limit : float, s
        Of planners that were asked for.
    """

    quick: bool
    planners: Sequence[str]
    lineup: str | None
    seeds: int | None
    evaluations: int | None
    time_limit: float


def run_suite(name: str, asked: Asked, out: Path, workers: Workers, console: SafeConsole) -> None:
    """Run what the store does not have of a suite, and show it."""
    suite = suite_named(name)
    lineup = _lineup(suite, asked)
    cases = chosen_cases(suite, asked.quick)
    chosen = {case.name: case for case in cases}
    cells = suite_cells(cases, lineup, asked.quick, asked.seeds, asked.evaluations)
    console.print(*_head(suite, len(cases), lineup), sep="\n")
    with Store(out / STORE_NAME) as store:
        remember_lineup(store, cells, {case.name: case.name for case in cases})
        store.note(SUITE_NOTE, {"name": name, "version": suite.version, "checksum": suite.checksum})
        for method, reason in unavailable_planners().items():
            if method in lineup.limits or method in lineup.searches:
                complain(f"left out: {reason}")
        run_missing(cell_jobs(cells, chosen), store, console, workers)
        results = stored_results(store, cells, chosen)
    show_suite(suite, chosen, results, out, console)


def show_last_suite(out: Path, console: SafeConsole) -> None:
    """Show the suite of the last run again, from the stored results."""
    suite = suite_of_last_run(out)
    show_suite(suite, *_last_of(suite, out), out, console)


def _last_of(suite: Suite, out: Path) -> tuple[dict[str, Case], list[Result]]:
    """Cases and results of the last runs into a folder that belong to a suite; the papers' cases have no suite in their names."""
    cases, _, results = last_run(out, suite.name if suite.problems else "")
    own = {name: case for name, case in cases.items() if name in suite.cases}
    return own, [result for result in results if result.cell.case in own]


def _lineup(suite: Suite, asked: Asked) -> Lineup:
    if asked.planners:
        if asked.lineup:
            raise StudyError("give --planners or --lineup, not both")
        return given_lineup(asked.planners, asked.time_limit)
    return lineup_named(asked.lineup) if asked.lineup else usual_lineup(suite)


def _head(suite: Suite, problems: int, lineup: Lineup) -> list[str]:
    limits = ", ".join(f"{name} {limit:g} s" for name, limit in {**lineup.limits, **lineup.searches}.items())
    return [
        f"suite {suite.name}, version {suite.version}, checksum {suite.checksum}: {plural(problems, 'problem')}",
        f"line-up {lineup.name}, with the time limit of each: {limits}",
    ]


def suite_of_last_run(out: Path) -> Suite:
    """Suite of the last run into a folder.

    Raises
    ------
    StudyError
        If the last run was no run of a suite, or the suite has changed since.
    """
    noted = suite_noted(out)
    if not noted:
        raise StudyError(f"the last run in {out} was no run of a suite; run `study run --suite SUITE` first")
    suite = suite_named(noted["name"])
    if suite.checksum != noted["checksum"]:
        raise StudyError(
            f"suite {suite.name!r} has changed since it was run (checksum {noted['checksum']}, now {suite.checksum}); "
            f"run `study run --suite {suite.name}` again"
        )
    return suite


def show_suite(
    suite: Suite, cases: Mapping[str, Case], results: Sequence[Result], out: Path, console: SafeConsole
) -> None:
    """Print the scores of all methods, and write all runs as files."""
    runs = runs_of(results, cases)
    if not runs:
        raise StudyError(f"no stored result belongs to suite {suite.name!r}; run `study run --suite {suite.name}`")
    field = _field(suite, runs)
    with console.status("writing the page"):
        page = write_page(suite, field, records_of(suite), papers_marks(), out / "report" / "suite", environment())
        write_pages(out, audit_flags(out))
    with console.paged():
        console.print(f"suite {suite.name}, checksum {suite.checksum}")
        for table in result_grids(field):
            console.print(grid_table(console, table))
        console.print(bound_line(runs, field), f"page: {page}", sep="\n")


def kept_run(out: Path) -> Iterator[tuple[Path, str]]:
    """Add the runs of the last run of a suite and the records that it improves to the data; places and what stands there.

    Raises
    ------
    StudyError
        If the last run was no run of a suite, or a record contradicts a bound or the judge.
    """
    suite = suite_of_last_run(out)
    cases, results = _last_of(suite, out)
    runs = runs_of(results, cases)
    before = read_runs(runs_file(suite)) if runs_file(suite).is_file() else []
    every = added(runs, [run for run in before if run.problem in suite.cases])
    methods = {name: method_named(name) for name in {run.planner for run in runs}}
    kinds = {name: method.freedom if isinstance(method, Planner) else None for name, method in methods.items()}
    known = records_of(suite)
    records = improved(known, results, kinds)
    if wrong := contradictions(records, suite.cases):
        raise StudyError(f"the records of suite {suite.name!r} cannot be kept: {wrong[0]}")
    folder = suites_folder() / "results"
    for place in (folder, records_file(suite).parent):
        place.mkdir(parents=True, exist_ok=True)
    with replacing(runs_file(suite)) as part:
        write_runs(part, every)
    yield runs_file(suite), f"{plural(len(runs), 'run')}, {len(every)} in all"
    better = sum(records[name] != known.get(name) for name in records)
    write_file(records_file(suite), records_text(suite, records))
    yield records_file(suite), f"records of {plural(len(records), 'problem')}, {better} of them new or better"


def submitted(file: Path, problem: str, by: str, units: str | None, out: Path | None) -> bool:
    """Judge a trajectory against the best known one of its problem, print the verdict and write the record; whether it holds."""
    suite = suite_named(problem.partition(":")[0] if ":" in problem else PAPERS)
    case = load_case(problem)
    if case.name not in suite.cases:
        raise StudyError(f"case {case.name!r} is in no suite; name a problem of one, see `study list --suites`")
    given = submission(file, case, units)
    console = make_console()
    if given.stretch > 1.0:
        console.print(f"it breaks limits and is slowed down by {given.stretch:.6g}, the least that keeps them")
    if not report_verdict(case, given.motion, console):
        return False
    best = records_of(suite).get(case.name, ProblemRecords())
    for kind, record in best.best.items():
        gap = percent(given.verdict.duration / record.duration - 1.0)
        console.print(f"best known, {kind}: {record.duration:.6f} s by {record.by}; this one {gap}")
    if best.bound:
        console.print(
            f"{percent(given.verdict.duration / best.bound - 1.0)} above the proved bound of {best.bound:.6f} s"
        )
    path = write_file(out or Path(f"{file_stem(problem)}{ENDING}"), record_text(given, suite, by))
    console.print(f"record: {path}; to contribute it, put it into data/suites/records/{suite.name}/")
    return True


GIVES_WAY = (
    "Near 10 s", "Near 0.1 s", "Kind", "Own kind", "Median time", "To 10 %", "To 0.01 %", "Delta", "Problems", "Much worse",
    "Much better", "Near 1 s",
)  # fmt: skip
"""Columns that are left out, one after the other, where the terminal is narrow."""


def grid_table(console: SafeConsole, table: Grid) -> Table:
    """Table of the page as the terminal shows it."""
    rows = [[str(cell).replace("\n", ", ") for cell in row] for row in table.rows]
    names = (*table.head[: table.names], "Failures")
    gives_way = [name for name in GIVES_WAY if name in table.head]
    return fitted(console, table.caption, table.head, rows, names, ("Failures",), gives_way)


def exported(name: str, to: str, folder: Path, own: Path | None) -> str:
    """Write committed runs of a suite, or those of one's own last run, in another platform's format; a sentence on it."""
    suite, platform = suite_named(name), Platform(to)
    if own is None:
        field = committed_field(suite)
    else:
        if suite_of_last_run(own).name != suite.name:
            raise StudyError(f"the last run in {own} was of suite {suite_of_last_run(own).name!r}, not {name!r}")
        cases, results = _last_of(suite, own)
        field = _field(suite, runs_of(results, cases))
    files = export(suite, field, platform, folder)
    return f"{plural(len(field.runs), 'run')} of suite {name!r} written for {platform}: {plural(len(files), 'file')} in {folder}"


def _field(suite: Suite, runs: Sequence[Run]) -> Field:
    return Field(tuple(runs), best_in(runs, known_times(suite)))


def bound_line(runs: Sequence[Run], field: Field) -> str:
    """Say how far the best known times stand above what is proved."""
    bounds: dict[str, float] = {}
    for run in runs:
        if run.bound and run.kind == "bound":
            bounds[run.problem] = max(run.bound, bounds.get(run.problem, 0.0))
    gaps = sorted(field.best_of_any[name] / bound - 1.0 for name, bound in bounds.items() if name in field.best_of_any)
    if not gaps:
        return "no bound was proved"
    middle: Any = gaps[len(gaps) // 2]
    return (
        f"best known above the proved bound of any motion: median {percent(middle)}, least {percent(gaps[0])}, most "
        f"{percent(gaps[-1])}, on {plural(len(gaps), 'problem')}"
    )
