"""Build the report: an index, one page for every case, and the tables, in one folder that needs nothing else."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from urllib.parse import quote

from study.analysis.case_summary import CaseSummary
from study.cases.library import Case
from study.errors import StudyError
from study.files import write_file
from study.io.filenames import file_stem
from study.report.case_page import CaseReport, case_page
from study.report.filling import filled
from study.report.index_page import index_page
from study.report.own_page import own_page, trajectory_files
from study.report.rendering import write_scripts
from study.report.tables import motion_files, write_motions, write_tables


def build_report(
    summaries: Sequence[CaseSummary],
    out: Path,
    environment: Mapping[str, str],
    flags: Mapping[str, str] = MappingProxyType({}),
    sources: Mapping[str, str] = MappingProxyType({}),
    only: Collection[str] | None = None,
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
    only : collection of str, optional
        Cases whose pages are written; the others' pages are there already, and the index leads to them too.

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
    changed = [report for report in reports if only is None or report.summary.case.name in only]
    pages = {report.slug: (own_page if report.own else case_page)(report, environment, flags) for report in changed}
    pages["index"] = index_page(reports, environment, out, flags)
    try:
        (out / "tables").mkdir(parents=True, exist_ok=True)
        for report in changed:
            write_tables(out / "tables", report.slug, [report.summary], sources)
            write_motions(out / "tables" / report.slug, report.summary, report.motions)
        if summaries:
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
        trajectories=trajectory_files(out.parent / "trajectories", slug),
    )


def write_viewers(scripts: Mapping[str, Sequence[str]], cases: Mapping[str, Case], out: Path) -> None:
    """Write a page with the viewer inside for every case of `cases`, which like `scripts` is by the page's stem."""
    for slug, needed in scripts.items():
        text = filled("viewer.html.j2", {"slug": slug, "case": cases[slug], "parts": needed})
        write_file(out / f"{slug}-viewer.html", text)


def slugs(cases: Iterable[Case]) -> dict[str, Case]:
    """Cases by the stem of their pages."""
    return {file_stem(case.name): case for case in cases}
