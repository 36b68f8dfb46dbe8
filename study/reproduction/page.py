"""Write the reproduction pages: one self-contained page for each paper, and an index of all that lie beside it."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup, escape

from study.cases.ledger import ledger
from study.cases.library import load_case
from study.cases.papers import paper_of
from study.cases.published import papers, tables
from study.files import write_file
from study.report import figures as report_figures
from study.report.plot_style import Series
from study.report.rendering import render, write_scripts
from study.reproduction import figures
from study.reproduction.benchmark_table import BenchmarkTable
from study.reproduction.book import PAPERS, Entry
from study.reproduction.cells import gather, write_cells
from study.reproduction.effort import Effort
from study.reproduction.jobs import Runs
from study.reproduction.motion_runs import motion_of
from study.reproduction.page_tables import shown_table
from study.reproduction.paper import Drive, Panel, line_of
from study.reproduction.readings import FORMS, READINGS, STARTS
from study.reproduction.tally import counts_of, decided, sentences
from study.reproduction.uniformity import STARTS as CHAOS_STARTS
from study.reproduction.verdicts import BASES, CANNOT_STAND, CLAIM, CONVERGENCE, RULES, Outcome

TAGS = {
    **dict.fromkeys((Outcome.REPRODUCED, Outcome.BETTER), "ok"),
    **dict.fromkeys((Outcome.WORSE, Outcome.NOT_CONFIRMED), "no"),
    **dict.fromkeys(CANNOT_STAND, "odd"),
}
"""Style of a verdict's tag; the others are plain."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """One or more plots under a heading.

    Attributes
    ----------
    title : str
    legend : sequence of str
    pictures : sequence of (caption, picture)
    caption : str
    """

    title: str
    legend: Sequence[str]
    pictures: Sequence[tuple[str, Markup]]
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
    counts = counts_of(entries)
    known = paper_of(paper)
    prose = [entry for entry in entries if entry.place.table == CLAIM]
    context = {
        "title": title_of(paper),
        "citation": papers()[paper],
        "question": known.question if known else "",
        "main": decided(paper, entries),
        "sentences": sentences(counts),
        "counts": counts,
        "slug": paper,
        "shown": [shown_table(table, entries) for table in tables(paper).values()],
        "prose": [entry for entry in prose if entry.ruling.outcome is not Outcome.USED],
        "inputs": [entry for entry in prose if entry.ruling.outcome is Outcome.USED],
        "drawn": list(_drawn(paper, runs, effort)),
        "tallies": BenchmarkTable(paper, effort, runs).tallies() if paper in READINGS else [],
        "notes": _reading_notes(paper),
        "ledger": ledger(paper),
        "effort": effort,
        "environment": environment,
    }
    write_file(out / f"{paper}.html", _render("paper.html.j2", context))
    write_cells(out / f"{paper}.csv", entries)
    return out / f"{paper}.html"


def write_index(effort: Effort, out: Path, environment: Mapping[str, str]) -> Path:
    """Write the index of all papers whose pages lie in the folder, and one file with all of their cells.

    Raises
    ------
    StudyError
        If the folder cannot be written.
    """
    shown = [
        {"slug": paper, "title": title_of(paper), "counts": counts, "sentences": sentences(counts)}
        for paper, counts in gather(out).items()
    ]
    context = {"papers": shown, "effort": effort, "environment": environment}
    write_file(out / "index.html", _render("index_reproduction.html.j2", context))
    write_scripts(out.parent)
    return out / "index.html"


def title_of(paper: str) -> str:
    """Title of a paper, taken from its citation."""
    return papers()[paper].split(": ", 1)[1].rsplit(". ", 1)[0]


def _reading_notes(paper: str) -> list[str]:
    notes = [
        f"{function} is read {form.replace('-', ' ')}; the others as they must be meant."
        for (key, function), form in FORMS.items()
        if key == paper
    ]
    return notes + [
        f"{column} on {function} starts in [-{start:g}, {start:g}], outside the function's box: the "
        f"printed results lie above everything "
        "in it. Started inside, its results stand among the other readings."
        for (key, function, column), start in STARTS.items()
        if key == paper
    ]


def _drawn(paper: str, runs: Runs, effort: Effort) -> Iterable[Drawn]:
    own = PAPERS[paper](effort, runs)
    if paper in READINGS:
        yield _benchmarks(BenchmarkTable(paper, effort, runs))
    shown = own.panels()
    columns = 2 if len(shown) % 3 == 1 and len(shown) > 1 else min(3, len(shown))
    picture = figures.panels("descents", shown, columns, "Convergence on the arm")
    caption = (
        "Best total time so far in s, median over seeds. Dotted: what the paper prints, in its method's "
        "colour. Grey: the optimum on the same curve."
    )
    yield Drawn("Convergence on the arm", list(shown[0].lines), [("", picture)], caption)
    for number, drive in enumerate(own.drives()):
        yield _profiles(f"drive-{number}", drive)
    if own.maps:
        caption = (
            f"{own.map_numbers} numbers of one start in ten bins; the line is the expected count. χ²: median over "
            f"{CHAOS_STARTS} starts; above 16.9 uniformity is rejected at 5 %."
        )
        picture = figures.histograms("maps", own.maps, own.map_numbers)
        yield Drawn("Uniformity of the chaotic maps", (), [("", picture)], caption)


def _benchmarks(table: BenchmarkTable) -> Drawn:
    columns = table.table.columns
    shown = [
        Panel(f, {c: line_of(table.record(f, c)) for c in columns}, logarithmic=True, marks=table.printed_means(f))
        for f in table.functions
    ]
    picture = figures.panels("benchmarks", shown, 4, "Convergence on the benchmark functions")
    return Drawn(
        "Benchmark functions",
        columns,
        [("", picture)],
        "Best value so far, median over seeds; zero is drawn at 1e-300. Dotted: the printed mean, in its column's "
        "colour; a printed zero has no line.",
    )


def _profiles(key: str, drive: Drive) -> Drawn:
    case = load_case(drive.case)
    series = [
        Series(label, style, motion_of(case, durations)) for style, (label, durations) in enumerate(drive.motions)
    ]
    names = case.problem.joint_names
    pictures = [
        (names[joint], report_figures.profile(f"{key}-{joint}", case.problem, joint, case.units[joint], series))
        for joint in range(case.problem.n_joints)
    ]
    return Drawn(f"Joint profiles: {case.title}", [label for label, _ in drive.motions], pictures, "")


def _render(template: str, context: Mapping[str, object]) -> str:
    rules = {"rules": RULES, "bases": BASES, "convergence": CONVERGENCE, "tags": TAGS}
    return render(template, {**rules, **context}, package="study.reproduction", filters={"powers": powers}, root="../")


def powers(text: str) -> Markup:
    """Printed or our number with its power of ten raised, as papers set it."""
    raised = re.sub(
        r" ?x 10\^(-?)(\d+)", lambda m: f" × 10<sup>{m[1].replace('-', '−')}{m[2]}</sup>", str(escape(text))
    )
    return Markup(raised)  # noqa: S704 - escaped first
