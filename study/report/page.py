"""Build the report: an index, one page for every case, and the tables, in one folder that needs nothing else."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from urllib.parse import quote

from markupsafe import Markup

from study.analysis import formatting
from study.analysis.case_summary import CaseSummary
from study.analysis.ends import end_steps
from study.analysis.featured import IN_ORDER, ROLE_NAMES, SEARCHES, Featured
from study.analysis.ladder import CauseKind, Rung, breakdown_of
from study.analysis.methods import Kind, MethodSummary, Standing, known_times, names_explained
from study.analysis.sentences import answer, case_answer
from study.analysis.tables import Record, raw, records
from study.cases.library import Case
from study.cases.papers import paper_of
from study.cautions import ends_said
from study.errors import StudyError
from study.files import write_file
from study.io.filenames import file_stem
from study.judge import RATES, TOLERANCE
from study.planning import Freedom
from study.report import bars, figures, plot_style
from study.report.convergence import convergence_of
from study.report.live import profiles_data
from study.report.rendering import render, write_scripts
from study.report.tables import COLUMNS, RESULTS, motion_files, write_motions, write_tables
from study.trajectory import Motion

TOO_LONG = 3.0
"""A motion that takes so many times as long as the reference would squeeze the others' profiles; it is left out of them."""

STANDINGS = {
    Standing.FEASIBLE: "",
    Standing.INFEASIBLE: "Infeasible: a limit is broken, or no motion was found",
    Standing.INAPPLICABLE: "Does not apply to this case",
    Standing.BOUND: "Proved lower bounds: times that no motion through the waypoints can undercut",
    Standing.UNJUDGED: "Printed without segment durations: nothing to judge",
}
"""Groups of the results table and their heads; sorting moves rows inside a group only."""

HATCHES = {Freedom.CURVE: "", Freedom.PATH: "...", Freedom.FREE: "///", None: "xxx"}

WIDTHS = {"wide": 720.0, "narrow": 370.0}
"""Pixels of a figure on a page and on a phone, where text would be too small if the wide one were shrunk."""


@dataclass(frozen=True, eq=False)
class CaseReport:
    """The page of one case: its summary, and what lies beside the page.

    Attributes
    ----------
    summary : CaseSummary
    slug : str
        Stem of the page's name.
    motions : mapping of str to str
        Files of sampled motions by method.
    recording, viewer : str, optional
        Links to the recording and to the page with the viewer inside.
    source : str
        Name or path that loads the case again.
    """

    summary: CaseSummary
    slug: str
    motions: Mapping[str, str]
    recording: str | None
    viewer: str | None
    source: str

    @property
    def budgets(self) -> list[int]:
        """Evaluations that the paper spends; none for a case without a paper."""
        case = self.summary.case
        return [case.settings.evaluations] if paper_of(case.paper) else []


def build_report(
    summaries: Sequence[CaseSummary],
    out: Path,
    environment: Mapping[str, str],
    flags: Mapping[str, str] = MappingProxyType({}),
    sources: Mapping[str, str] = MappingProxyType({}),
) -> Path:
    """Write `index.html`, one page per case and the tables.

    Parameters
    ----------
    summaries : sequence of CaseSummary
    out : Path
        Folder, made if need be. A recording `<case>.rrd` in its sibling folder `recordings` is linked.
    environment : mapping of str to str
        Versions and machine, printed as they are.
    flags : mapping of str to str, optional
        Planners that the bias audit flags, with the reason; every table marks them.
    sources : mapping of str to str, optional
        Name or path that loads a case again; its name by default.

    Returns
    -------
    Path
        The index.

    Raises
    ------
    StudyError
        If the folder cannot be written.
    """
    reports = [_case_report(summary, out, sources) for summary in summaries]
    pages = {report.slug: _case_page(report, environment, flags) for report in reports}
    pages["index"] = _index_page(reports, environment, out, flags)
    try:
        (out / "tables").mkdir(parents=True, exist_ok=True)
        for report in reports:
            write_tables(out / "tables", report.slug, [report.summary], sources)
            write_motions(out / "tables" / report.slug, report.summary, report.motions)
        write_tables(out / "tables", "all", summaries, sources)
        for name, text in pages.items():
            write_file(out / f"{name}.html", text)
        write_scripts(out)
    except OSError as error:
        raise StudyError(
            f"the report cannot be written to {str(out)!r}: {error.strerror}; choose another folder"
        ) from None
    return out / "index.html"


def _case_report(summary: CaseSummary, out: Path, sources: Mapping[str, str]) -> CaseReport:
    name, slug = summary.case.name, file_stem(summary.case.name)
    recording = out.parent / "recordings" / f"{slug}.rrd"
    return CaseReport(
        summary=summary,
        slug=slug,
        motions=motion_files(summary.methods),
        recording=f"../recordings/{quote(recording.name)}" if recording.is_file() else None,
        viewer=f"{slug}-viewer.html" if (out / f"{slug}-viewer.html").is_file() else None,
        source=sources.get(name, name),
    )


def write_viewers(scripts: Mapping[str, Sequence[str]], cases: Mapping[str, Case], out: Path) -> None:
    """Write a page with the viewer inside for every case of `cases`, which like `scripts` is by the page's stem."""
    for slug, needed in scripts.items():
        text = _render("viewer.html.j2", {"slug": slug, "case": cases[slug], "scripts": needed})
        write_file(out / f"{slug}-viewer.html", text)


def slugs(cases: Iterable[Case]) -> dict[str, Case]:
    """Cases by the stem of their pages."""
    return {file_stem(case.name): case for case in cases}


def _render(template: str, context: Mapping[str, object]) -> str:
    filters = {
        name: getattr(formatting, name)
        for name in ("seconds", "change", "wall", "percent", "share", "count", "plural", "listed", "coded")
    }
    shared = {
        "rates": RATES,
        "raw": raw,
        "columns": COLUMNS,
        "role_names": ROLE_NAMES,
        "roles": IN_ORDER,
        "freedoms": tuple(Freedom),
    }
    return render(template, {**shared, **context}, filters=filters)


def _index_page(
    reports: Sequence[CaseReport], environment: Mapping[str, str], out: Path, flags: Mapping[str, str]
) -> str:
    rows = [headline_row(report.summary) for report in reports]
    known = [row for row in rows if row is not None]
    reference = "the deterministic optimum on the same curve"
    pictures = {
        name: bars.headline(f"headline-{name}", known, reference, width) if known else None
        for name, width in (("wide", 1040.0), ("narrow", 370.0))
    }
    return _render(
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
            "compared": (out / "comparison" / "index.html").is_file(),
            "reproduced": (out / "reproduction" / "index.html").is_file(),
            "flags": flags,
            "environment": environment,
        },
    )


def _published_count(reports: Sequence[CaseReport]) -> tuple[int, int]:
    """Count the printed motions, and those of them that pass the judge."""
    methods = [method for report in reports for method in report.summary.methods]
    judged = [m for m in methods if m.kind is Kind.PUBLISHED and m.representative is not None]
    return len(judged), sum(method.feasible for method in judged)


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


def _case_page(report: CaseReport, environment: Mapping[str, str], flags: Mapping[str, str]) -> str:
    summary, case, problem = report.summary, report.summary.case, report.summary.case.problem
    series, near = featured_series(summary)
    roles = {method.label: ROLE_NAMES[role] for _, role, method in reversed(summary.best.present())}
    pictures = {
        "profiles": [
            figures.profile(f"profile-{joint}", problem, joint, case.units[joint], near)
            for joint in range(problem.n_joints)
            if near
        ],
        "segments": {
            name: bars.segments(f"segments-{name}", series, width) for name, width in WIDTHS.items() if series
        },
        "ladder": {name: ladder_figure(summary, width) for name, width in WIDTHS.items() if summary.rungs},
    }
    return _render(
        "case.html.j2",
        {
            "report": report,
            "case": case,
            "problem": problem,
            "ends": ends_said(problem),
            "best": summary.best,
            "rungs": summary.rungs,
            "paper": paper_of(case.paper),
            "sentences": case_answer(summary.best, report.budgets),
            "names": names_explained(summary.methods),
            "role_of": roles,
            "groups": _groups(report),
            "known": known_times(summary.methods),
            "single": [method for method in summary.methods if method.joint is not None],
            "featured": summary.best.present(),
            "apart": summary.best.on_the_curve(),
            "steps": end_steps(summary),
            "series": series,
            "near": near,
            "left_out": [each for each in series if each not in near],
            "figures": pictures,
            "live": profiles_data(problem, case.units, near, roles) if near else "",
            "convergence": convergence_of(summary, WIDTHS),
            "tolerance": TOLERANCE,
            "flags": flags,
            "infinity": float("inf"),
            "environment": environment,
        },
    )


def featured_series(summary: CaseSummary) -> tuple[list[plot_style.Series], list[plot_style.Series]]:
    """Give the featured motions with their styles, and those of them that fit into one plot of profiles."""
    series = [
        plot_style.Series(method.label, summary.slots[method.label], method.motion)
        for _, _, method in summary.best.distinct()
        if method.motion is not None
    ]
    return series, [each for each in series if not _too_long(each.motion, summary.best)]


def _too_long(motion: Motion, best: Featured) -> bool:
    """Tell if a motion would squeeze the others' profiles."""
    usual = best.reference.duration if best.reference else None
    return usual is not None and motion.duration > TOO_LONG * usual


def _groups(report: CaseReport) -> list[tuple[str, str, list[tuple[MethodSummary, Record]]]]:
    """Rows of the results table in the groups that sorting keeps apart: feasible, infeasible, never judged."""
    rows = records(RESULTS, [(report.summary, method, report.source) for method in report.summary.whole])
    whole = list(zip(report.summary.whole, rows, strict=True))
    return [(name, head, [pair for pair in whole if pair[0].standing is name]) for name, head in STANDINGS.items()]


def ladder_figure(summary: CaseSummary, width: float = WIDTHS["wide"]) -> Markup:
    """Draw the ladder of lost time, so many pixels wide; there must be a rung."""
    on_curve = [rung for rung in summary.rungs if rung.freedom is Freedom.CURVE]
    optimum = on_curve[-1].seconds if on_curve else None
    groups = []
    for head, belongs in RUNGS.items():
        rungs = sorted((rung for rung in summary.rungs if belongs(rung)), key=lambda rung: -rung.seconds)
        if rungs:
            groups.append((head, [_bar(rung, summary, optimum) for rung in rungs]))
    return bars.ladder(f"ladder-{width:.0f}", groups, width)


RUNGS: dict[str, Callable[[Rung], bool]] = {
    "As printed": lambda rung: rung.name == "Published",
    "On the case's curve": lambda rung: rung.freedom is Freedom.CURVE and rung.name != "Published",
    "Along a fixed path": lambda rung: rung.freedom is Freedom.PATH,
    "Path between the waypoints free": lambda rung: rung.freedom is Freedom.FREE and rung.kind is not CauseKind.PROOF,
    "Proved": lambda rung: rung.kind is CauseKind.PROOF,
}
"""Groups of the ladder figure; in each the slowest stands first."""


def _bar(rung: Rung, summary: CaseSummary, optimum: float | None) -> plot_style.Bar:
    beside = (
        "" if optimum is None or rung.seconds == optimum else f"  ({formatting.percent(rung.seconds / optimum - 1)})"
    )
    labels = (rung.method, f"published: {rung.method}", rung.method.partition(", ")[0])
    return plot_style.Bar(
        label=f"{rung.name}: {rung.method}",
        value=formatting.seconds(rung.seconds) + beside + ("" if rung.feasible else "  infeasible"),
        seconds=rung.seconds,
        hatch=HATCHES[rung.freedom],
        solid=rung.feasible,
        slot=None
        if rung.kind is CauseKind.PROOF
        else next((summary.slots[label] for label in labels if label in summary.slots), None),
        note=rung.cause,
    )
