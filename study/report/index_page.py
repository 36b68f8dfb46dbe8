"""The index of a report's folder: the answer of the study, cases of one's own, and all pages that lie beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from study.analysis.case_summary import CaseSummary
from study.analysis.ends import end_steps
from study.analysis.featured import IN_ORDER, ROLE_NAMES, SEARCHES
from study.analysis.ladder import breakdown_of
from study.analysis.methods import Kind, names_explained
from study.analysis.sentences import answer
from study.cases.papers import paper_of
from study.report import bars, plot_style
from study.report.case_page import CaseReport
from study.report.filling import filled
from study.report.own_page import own_row

BESIDE = {
    "comparison/index.html": (
        "Fair comparison",
        "the papers' searches against one another: targets, tests, an invariance audit, ablations, and every headline claim "
        "beside its honest counterparts",
    ),
    "reproduction/index.html": ("Reproduction", "every printed number of the papers beside ours, with a verdict"),
    "suite/index.html": ("Suite", "planners on many problems of many kinds"),
    "performance.html": ("Performance", "speed of the parts next to other packages"),
}
"""Pages of other commands that may lie in the folder; each leads back to the index."""


def index_page(shown: Sequence[CaseReport], environment: Mapping[str, str], out: Path, flags: Mapping[str, str]) -> str:
    """Index of the folder `out`.

    Parameters
    ----------
    shown : sequence of CaseReport
        The papers' cases and those of one's own, which stand in a table by themselves.
    environment : mapping of str to str
    out : Path
    flags : mapping of str to str
    """
    reports = [report for report in shown if not report.own]
    own = [report for report in shown if report.own]
    rows = [headline_row(report.summary) for report in reports]
    known = [row for row in rows if row is not None]
    reference = "the deterministic optimum on the same curve"
    pictures = {
        name: bars.headline(f"headline-{name}", known, reference, width) if known else None
        for name, width in (("wide", 1040.0), ("narrow", 370.0))
    }
    return filled(
        "index.html.j2",
        {
            "reports": reports,
            "sentences": answer(
                [report.summary.best for report in reports], [count for report in reports for count in report.budgets]
            ),
            "causes": [(each, causes) for each in reports if (causes := breakdown_of(each.summary.rungs)) is not None],
            "names": names_explained(method for each in reports for _, _, method in each.summary.best.present()),
            "headline": pictures,
            "legend": {style: ROLE_NAMES[role] for each in reports for style, role, _ in each.summary.best.present()},
            "steps": [steps for each in reports if (steps := end_steps(each.summary))],
            "published": _published_count(reports),
            "ran": any(report.summary.ran for report in own),
            "own": [(report, own_row(report)) for report in own],
            "earlier": _earlier(shown, out),
            "papers": _papers(out),
            "beside": {path: said for path, said in BESIDE.items() if (out / path).is_file()},
            "flags": flags,
            "environment": environment,
        },
    )


def _papers(out: Path) -> dict[str, str]:
    """Pages of reproduced papers in the folder, and the paper that each is about."""
    pages = sorted((out / "reproduction").glob("*.html"))
    asked = {f"reproduction/{page.name}": paper_of(page.stem) for page in pages}
    return {path: paper.citation for path, paper in asked.items() if paper is not None}


def _published_count(reports: Sequence[CaseReport]) -> tuple[int, int]:
    """Count the printed motions, and those of them that pass the judge."""
    methods = [method for report in reports for method in report.summary.methods]
    judged = [m for m in methods if m.kind is Kind.PUBLISHED and m.representative is not None]
    return len(judged), sum(method.feasible for method in judged)


def _earlier(shown: Sequence[CaseReport], out: Path) -> list[str]:
    """Names of pages of cases whose results the folder no longer has, such as those of an older release."""
    known = {"index", *(path.removesuffix(".html") for path in BESIDE), *(report.slug for report in shown)}
    stems = {path.stem for path in out.glob("*.html")}
    return sorted(stem for stem in stems - known if stem.removesuffix("-viewer") not in known | stems - {stem})


def headline_row(summary: CaseSummary) -> plot_style.HeadlineRow | None:
    """Place the featured methods of a case against its reference; None where there is nothing to measure against."""
    reference = summary.best.reference
    if reference is None or not reference.duration:
        return None
    marks = []
    drawn = {role: (style, method) for style, role, method in summary.best.present()}
    for role in IN_ORDER:
        style, method = drawn.get(role, (0, None))
        stepping = summary.best.velocity_only and role in ("free", "fixed")
        if method is not None and method.duration and not stepping:
            best = method.best if role in SEARCHES else None
            spread = None if best is None else best / reference.duration
            name = method.label.removeprefix("published: ")
            marks.append(plot_style.Mark(style, method.duration / reference.duration, method.feasible, spread, name))
    return plot_style.HeadlineRow(summary.case.name + " †" * summary.best.velocity_only, tuple(marks))
