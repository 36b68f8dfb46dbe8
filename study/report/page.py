"""Build the report: an index, one page for every case, and the tables, in one folder that needs nothing else."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from urllib.parse import quote

from markupsafe import Markup

from study.analysis import formatting as wording
from study.analysis.causes import causes_of
from study.analysis.featured import ROLE_NAMES, Featured, featured
from study.analysis.glossary import glossary
from study.analysis.ladder import Rung, ladder_of
from study.analysis.methods import CURVE, FIXED_PATH, FREE_PATH
from study.analysis.rows import MEANING, Entry, entries_of, known_times
from study.analysis.sentences import answer, case_answer
from study.cases.library import Case
from study.cases.papers import paper_of
from study.errors import StudyError
from study.io.filenames import file_stem
from study.judge import RATES, TOLERANCE
from study.report import drawn, figures
from study.report.convergence import convergence_of
from study.report.motions import motion_files, write_motions
from study.report.rendering import render
from study.report.tables import COLUMNS, Record, raw, result_record, write_tables
from study.store.results import Result
from study.trajectory import Motion

TOO_LONG = 3.0
"""A motion that takes so many times as long as the reference would squeeze the others' profiles; it is left out of them."""

STANDINGS = {
    "feasible": "",
    "infeasible": "Infeasible: a limit is broken, or no motion was found",
    "inapplicable": "Does not apply to this case",
    "bound": "Proved lower bounds: times that no motion through the waypoints can undercut",
    "unjudged": "Printed without segment durations: nothing to judge",
}
"""Groups of the results table and their heads; sorting moves rows inside a group only."""

HATCHES: dict[str, str] = {CURVE: "", FIXED_PATH: "...", FREE_PATH: "///"}

WIDTHS = {"wide": 720.0, "narrow": 370.0}
"""Pixels of a figure on a page and on a phone, where text would be too small if the wide one were shrunk."""


@dataclass(frozen=True, eq=False)
class CaseReport:
    """Everything that the page of one case is made from."""

    case: Case
    slug: str
    entries: tuple[Entry, ...]
    best: Featured
    rungs: tuple[Rung, ...]
    motions: Mapping[str, str]
    recording: str | None
    viewer: str | None
    source: str

    @property
    def budgets(self) -> list[int]:
        """Evaluations that the paper spends; none for a case without a paper."""
        return [self.case.settings.evaluations] if paper_of(self.case.paper) else []


def build_report(
    cases: Mapping[str, Case],
    results: Sequence[Result],
    out: Path,
    environment: Mapping[str, str],
    flags: Mapping[str, str] = MappingProxyType({}),
    sources: Mapping[str, str] = MappingProxyType({}),
) -> Path:
    """Write `index.html`, one page per case and the tables.

    Parameters
    ----------
    cases : mapping of str to Case
    results : sequence of Result
    out : Path
        Folder, made if need be. A recording `<case>.rrd` in its sibling folder `recordings` is linked.
    environment : mapping of str to str
        Versions and machine, printed as they are.
    flags : mapping of str to str, optional
        Planners that the bias audit flags, with the reason; every table marks them.
    sources : mapping of str to str, optional
        What loads a case again, a name or a path; its name by default.

    Returns
    -------
    Path
        The index.

    Raises
    ------
    StudyError
        If the folder cannot be written.
    """
    reports = _case_reports(cases, results, out, sources)
    pages = {report.slug: _case_page(report, environment, flags) for report in reports}
    pages["index"] = _index_page(reports, environment, out, flags)
    try:
        (out / "tables").mkdir(parents=True, exist_ok=True)
        for report in reports:
            write_tables(out / "tables", report.slug, [(report.case, report.entries)], sources)
            write_motions(out / "tables" / report.slug, report.case, report.entries, report.motions)
        write_tables(out / "tables", "all", [(report.case, report.entries) for report in reports], sources)
        for name, text in pages.items():
            (out / f"{name}.html").write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise StudyError(
            f"the report cannot be written to {str(out)!r}: {error.strerror}; choose another folder"
        ) from None
    return out / "index.html"


def _case_reports(
    cases: Mapping[str, Case], results: Sequence[Result], out: Path, sources: Mapping[str, str]
) -> list[CaseReport]:
    reports: list[CaseReport] = []
    for slug, case in slugs(cases.values()).items():
        entries = entries_of(case, results)
        best = featured(entries, case.velocity_only)
        recording = out.parent / "recordings" / f"{file_stem(case.name)}.rrd"
        link = f"../recordings/{quote(recording.name)}" if recording.is_file() else None
        page = f"{slug}-viewer.html" if (out / f"{slug}-viewer.html").is_file() else None
        rungs = ladder_of(case, entries, best)
        source = sources.get(case.name, case.name)
        reports.append(CaseReport(case, slug, entries, best, rungs, motion_files(entries), link, page, source))
    return reports


def write_viewers(scripts: Mapping[str, Sequence[str]], cases: Mapping[str, Case], out: Path) -> None:
    """Write a page with the viewer inside for every case of `cases`, which like `scripts` is by the page's stem."""
    for slug, needed in scripts.items():
        text = _render("viewer.html.j2", {"slug": slug, "case": cases[slug], "scripts": needed})
        (out / f"{slug}-viewer.html").write_text(text, encoding="utf-8", newline="\n")


def slugs(cases: Iterable[Case]) -> dict[str, Case]:
    """Cases by the stem of their pages."""
    return {file_stem(case.name): case for case in cases}


def _render(template: str, context: Mapping[str, object]) -> str:
    filters = {
        name: getattr(wording, name)
        for name in ("seconds", "change", "wall", "percent", "share", "count", "plural", "listed", "coded")
    }
    shared = {"rates": RATES, "raw": raw, "columns": COLUMNS, "role_names": ROLE_NAMES, "meaning": MEANING}
    return render(template, {**shared, **context}, filters=filters)


def _index_page(
    reports: Sequence[CaseReport], environment: Mapping[str, str], out: Path, flags: Mapping[str, str]
) -> str:
    rows = [headline_row(report) for report in reports]
    known = [row for row in rows if row is not None]
    reference = "the deterministic optimum on the same curve"
    pictures = {
        name: figures.headline(f"headline-{name}", known, reference, width) if known else None
        for name, width in (("wide", 1040.0), ("narrow", 370.0))
    }
    return _render(
        "index.html.j2",
        {
            "reports": reports,
            "sentences": answer([report.best for report in reports], [one for each in reports for one in each.budgets]),
            "causes": [(report, causes) for report in reports if (causes := causes_of(report.rungs)) is not None],
            "names": glossary(entry.planner for report in reports for _, _, entry in report.best.present()),
            "headline": pictures,
            "legend": {style: ROLE_NAMES[role] for each in reports for style, role, _ in each.best.present()},
            "published": _published_count(reports),
            "compared": (out / "comparison" / "index.html").is_file(),
            "reproduced": (out / "reproduction" / "index.html").is_file(),
            "flags": flags,
            "environment": environment,
        },
    )


def _published_count(reports: Sequence[CaseReport]) -> tuple[int, int]:
    """How many printed motions there are in all, and how many of them pass the judge."""
    printed = [entry.row for report in reports for entry in report.entries if entry.row.kind == "published"]
    judged = [row for row in printed if row.representative is not None]
    return len(judged), sum(row.feasible for row in judged)


def headline_row(report: CaseReport) -> drawn.HeadlineRow | None:
    """Place the featured methods of a case against its reference; None where there is nothing to measure against."""
    reference = report.best.reference
    if reference is None or not reference.duration:
        return None
    marks = []
    for style, role, entry in report.best.present():
        if entry.duration:
            best = entry.row.best if role == "search" else None
            spread = None if best is None else best / reference.duration
            marks.append(drawn.Mark(style, entry.duration / reference.duration, entry.row.feasible, spread))
    return drawn.HeadlineRow(report.case.name + " †" * report.best.velocity_only, tuple(marks))


def _case_page(report: CaseReport, environment: Mapping[str, str], flags: Mapping[str, str]) -> str:
    series = [
        drawn.Series(entry.label, style, entry.motion)
        for style, _, entry in report.best.present()
        if entry.motion is not None
    ]
    problem = report.case.problem
    near = [one for one in series if not too_long(one.motion, report.best)]
    pictures = {
        "profiles": [
            figures.profile(f"profile-{joint}", problem, joint, report.case.units[joint], near)
            for joint in range(problem.n_joints)
            if near
        ],
        "segments": {
            name: figures.segments(f"segments-{name}", series, width) for name, width in WIDTHS.items() if series
        },
        "ladder": {name: ladder_figure(report.rungs, width) for name, width in WIDTHS.items() if report.rungs},
    }
    return _render(
        "case.html.j2",
        {
            "report": report,
            "case": report.case,
            "problem": problem,
            "paper": paper_of(report.case.paper),
            "sentences": case_answer(report.best, report.budgets),
            "names": glossary(entry.planner for entry in report.entries),
            "role_of": list(ROLE_NAMES.values()),
            "groups": _groups(report),
            "known": known_times(report.entries),
            "single": [entry for entry in report.entries if entry.row.joint is not None],
            "featured": report.best.present(),
            "series": series,
            "near": near,
            "left_out": [one for one in series if one not in near],
            "figures": pictures,
            "convergence": convergence_of(report.case, report.entries, report.best, WIDTHS),
            "tolerance": TOLERANCE,
            "flags": flags,
            "infinity": float("inf"),
            "environment": environment,
        },
    )


def too_long(motion: Motion, best: Featured) -> bool:
    """Whether a motion would squeeze the others' profiles."""
    usual = best.reference.duration if best.reference else None
    return usual is not None and motion.duration > TOO_LONG * usual


def _groups(report: CaseReport) -> list[tuple[str, str, list[tuple[Entry, Record]]]]:
    """Rows of the results table in the groups that sorting keeps apart: feasible, infeasible, never judged."""
    whole = [
        (entry, result_record(report.case, entry, report.source)) for entry in report.entries if entry.row.joint is None
    ]
    return [(name, head, [pair for pair in whole if pair[0].standing == name]) for name, head in STANDINGS.items()]


def ladder_figure(rungs: Sequence[Rung], width: float = WIDTHS["wide"]) -> Markup:
    """Draw the ladder of lost time, so many pixels wide; there must be a rung."""
    bars = [
        drawn.Bar(
            f"{rung.name}: {rung.method}",
            wording.seconds(rung.seconds)
            + (f"  ({wording.percent(rung.relative)})" if rung.relative is not None else "")
            + ("" if rung.feasible else "  infeasible"),
            rung.seconds,
            HATCHES.get(rung.path, "xxx"),
            rung.feasible,
        )
        for rung in rungs
    ]
    return figures.ladder(f"ladder-{width:.0f}", bars, width)
