"""Write the reproduction pages: one self-contained page for each paper, an index, and all cells as CSV."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from study.cases.ledger import ledger
from study.cases.library import load_case
from study.cases.published import Table, papers, tables
from study.files import csv_text, write_file
from study.report import figures as report_figures
from study.report.plot_style import Series
from study.report.rendering import render
from study.reproduction import figures
from study.reproduction.benchmark_table import BenchmarkTable
from study.reproduction.book import PAPERS, Entry
from study.reproduction.effort import Effort
from study.reproduction.jobs import Runs
from study.reproduction.motion_runs import motion_of
from study.reproduction.paper import Drive, Panel, line_of
from study.reproduction.readings import FORMS, READINGS, STARTS
from study.reproduction.uniformity import STARTS as CHAOS_STARTS
from study.reproduction.verdicts import CLAIM, RULES, Outcome

TAGS = {
    Outcome.REPRODUCED: "ok",
    Outcome.BETTER: "ok",
    Outcome.WORSE: "no",
    Outcome.INFEASIBLE: "odd",
    Outcome.IMPOSSIBLE: "odd",
    Outcome.CONTRADICTS: "odd",
    Outcome.NOT_REPRODUCIBLE: "",
    Outcome.USED: "",
}
COLUMNS = (
    "paper",
    "place",
    "row",
    "column",
    "quantity",
    "printed",
    "ours",
    "verdict",
    "agrees",
    "reading",
    "reason",
    "other readings",
)


@dataclass(frozen=True, eq=False)
class ShownTable:
    """A printed table as the page shows it."""

    table: Table
    slug: str
    rows: Sequence[tuple[str, Sequence[Entry]]]
    reasons: Sequence[Entry]
    others: Sequence[Entry]
    remark: str


@dataclass(frozen=True, eq=False)
class Drawn:
    """One or more plots under a heading."""

    title: str
    legend: Sequence[str]
    pictures: Sequence[Markup]
    caption: str


def write_paper(
    paper: str, entries: Sequence[Entry], runs: Runs, effort: Effort, out: Path, environment: Mapping[str, str]
) -> Path:
    """Write one paper's page and its cells.

    Parameters
    ----------
    paper : str
        Key of the paper.
    entries : sequence of Entry
    runs : Runs
    effort : Effort
    out : Path
        Folder, made if need be.
    environment : mapping of str to str
        Versions and machine.

    Raises
    ------
    StudyError
        If the folder cannot be written.
    """
    counts = Counter(entry.ruling.outcome for entry in entries)
    text = _render(
        "paper.html.j2",
        {
            "title": papers()[paper].split(": ", 1)[1].rsplit(". ", 1)[0],
            "citation": papers()[paper],
            "sentence": _sentence(counts, len(entries)),
            "counts": [(outcome, counts[outcome]) for outcome in Outcome if counts[outcome]],
            "slug": paper,
            "shown": [_shown(table, entries) for table in tables(paper).values()],
            "prose": [entry for entry in entries if entry.place.table == CLAIM],
            "drawn": list(_drawn(paper, runs, effort)),
            "readings": list(READINGS.get(paper, {}).items()),
            "notes": _reading_notes(paper),
            "ledger": ledger(paper),
            "effort": effort,
            "linked": (out.parent / "index.html").is_file(),
            "environment": environment,
        },
    )
    write_file(out / f"{paper}.html", text)
    write_cells(out / f"{paper}.csv", entries)
    return out / f"{paper}.html"


def write_index(
    entries: Mapping[str, Sequence[Entry]], effort: Effort, out: Path, environment: Mapping[str, str]
) -> Path:
    """Write the index of the papers and one file with all cells."""
    rows = [
        {
            "slug": paper,
            "title": papers()[paper].split(": ", 1)[1].rsplit(". ", 1)[0],
            "counts": Counter(entry.ruling.outcome for entry in found),
        }
        for paper, found in entries.items()
    ]
    linked = (out.parent / "index.html").is_file()
    context = {
        "papers": rows,
        "effort": effort,
        "outcomes": list(Outcome),
        "linked": linked,
        "environment": environment,
    }
    write_file(out / "index.html", _render("index_reproduction.html.j2", context))
    write_cells(out / "verdicts.csv", [entry for found in entries.values() for entry in found])
    return out / "index.html"


def write_cells(path: Path, entries: Iterable[Entry]) -> None:
    """Write entries as CSV: what is printed, ours, the verdict and why.

    Raises
    ------
    StudyError
        If the file cannot be written.
    """
    write_file(path, csv_text([COLUMNS, *map(_record, entries)]))


def _record(entry: Entry) -> list[str]:
    ruling = entry.ruling
    agrees = "" if ruling.agrees is None else "yes" if ruling.agrees else "no"
    others = "; ".join(f"{name}: {value}" for name, value in ruling.others.items())
    place = entry.section
    return [
        entry.paper, place, entry.place.row, entry.place.column, entry.quantity, entry.printed, ruling.ours,
        ruling.outcome.value, agrees, ruling.reading, ruling.why, others,
    ]  # fmt: skip


def _sentence(counts: Mapping[Outcome, int], total: int) -> str:
    results = total - counts.get(Outcome.USED, 0)
    own = counts.get(Outcome.REPRODUCED, 0)
    odd = sum(counts.get(outcome, 0) for outcome in (Outcome.IMPOSSIBLE, Outcome.CONTRADICTS, Outcome.INFEASIBLE))
    return (
        f"Of {results} printed results and statements {own} are reproduced, and {odd} cannot stand as they are printed: "
        "arithmetic, another printed number or the judge says otherwise."
    )


def _shown(table: Table, entries: Sequence[Entry]) -> ShownTable:
    own = [entry for entry in entries if entry.place.table == table.number]
    rows: dict[str, list[Entry]] = {}
    for entry in own:
        rows.setdefault(entry.place.row, []).append(entry)
    telling = {
        Outcome.IMPOSSIBLE,
        Outcome.CONTRADICTS,
        Outcome.INFEASIBLE,
        Outcome.NOT_REPRODUCIBLE,
        Outcome.WORSE,
        Outcome.BETTER,
    }
    return ShownTable(
        table,
        table.number.lower().replace(" ", "-"),
        list(rows.items()),
        [entry for entry in own if entry.ruling.outcome in telling and entry.ruling.why],
        [entry for entry in own if entry.ruling.others],
        "Inputs." if all(entry.ruling.outcome is Outcome.USED for entry in own) else "",
    )


def _reading_notes(paper: str) -> list[str]:
    notes = [
        f"{function} is read {form.replace('-', ' ')}; the others as they must be meant."
        for (key, function), form in FORMS.items()
        if key == paper
    ]
    for (key, function, column), start in STARTS.items():
        if key == paper:
            notes.append(
                f"{column} on {function} starts in [-{start:g}, {start:g}], outside the function's box: the printed results lie above everything in it."
            )
    return notes


def _drawn(paper: str, runs: Runs, effort: Effort) -> Iterable[Drawn]:
    own = PAPERS[paper](effort, runs)
    if paper in READINGS:
        table = BenchmarkTable(paper, effort, runs)
        shown = [Panel(f, {c: line_of(table.record(f, c)) for c in table.table.columns}, True) for f in table.functions]
        picture = figures.panels("benchmarks", shown, 4, "Convergence on the benchmark functions")
        yield Drawn(
            "Benchmark functions",
            table.table.columns,
            [picture],
            "Best value so far, median over seeds; zero is drawn at 1e-300.",
        )
    shown = own.panels()
    picture = figures.panels("descents", shown, min(3, len(shown)), "Convergence on the arm")
    yield Drawn(
        "Convergence on the arm",
        list(shown[0].lines),
        [picture],
        "Objective of the best candidate so far, median over seeds.",
    )
    for number, drive in enumerate(own.drives()):
        yield _profiles(f"drive-{number}", drive)
    if own.maps:
        caption = f"1000 numbers of one start in ten bins; the line is the expected count. χ²: median over {CHAOS_STARTS} starts; above 16.9 uniformity is rejected at 5 %."
        yield Drawn("Uniformity of the chaotic maps", (), [figures.histograms("maps", own.maps)], caption)


def _profiles(key: str, drive: Drive) -> Drawn:
    case = load_case(drive.case)
    series = [
        Series(label, style, motion_of(case, durations)) for style, (label, durations) in enumerate(drive.motions)
    ]
    pictures = [
        report_figures.profile(f"{key}-{joint}", case.problem, joint, case.units[joint], series)
        for joint in range(case.problem.n_joints)
    ]
    return Drawn(f"Joint profiles: {case.title}", [label for label, _ in drive.motions], pictures, "")


def _render(template: str, context: Mapping[str, object]) -> str:
    return render(template, {"rules": RULES, "tags": TAGS, **context}, package="study.reproduction")
