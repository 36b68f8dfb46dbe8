"""A folder of results: the runs that it remembers, its pages and its recordings."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from study.analysis.case_summary import CaseSummary, summarise
from study.cases.library import Case, load_case
from study.cases.suite_file import filed_suites
from study.io.filenames import file_stem
from study.runs.environment import environment
from study.runs.execute import stored_results
from study.runs.remembered import remembered_lineup
from study.store.results import Result
from study.store.store import Store

DEFAULT_OUT = Path("study-output")
STORE_NAME = "results.sqlite"
SUITE_NOTE = "suite"
"""Name of the note in the results file that says which suite was run last; empty after another run."""


def write(
    summaries: Sequence[CaseSummary],
    out: Path,
    flagged: Mapping[str, str],
    interactive: bool = False,
) -> tuple[Path, Path]:
    """Write report and recordings, searches that are flagged marked; where the report's first page and the recordings are."""
    keep_to_oneself()
    from study.recording import forget_pages, interactive_pages, record_case
    from study.report.page import slugs, write_viewers  # here: matplotlib and rerun are slow to import

    for summary in summaries:
        if summary.ran:  # a run that was stopped may not have come to every case
            record_case(summary, recording_file(out, summary.case.name))
    forget_pages(out / "report", slugs(summary.case for summary in summaries))
    if interactive:
        shown = slugs(summary.case for summary in summaries if summary.ran)
        files = {slug: recording_file(out, case.name) for slug, case in shown.items()}
        write_viewers(interactive_pages(files, out / "report"), shown, out / "report")
    return write_pages(out, flagged, summaries), out / "recordings"


def write_pages(out: Path, flagged: Mapping[str, str], summaries: Sequence[CaseSummary] = ()) -> Path:
    """Write the pages of some cases and an index of all that the folder holds, other runs and commands included.

    Returns
    -------
    Path
        The index.
    """
    from study.report.page import build_report  # here: matplotlib is slow to import

    cases, sources, results = last_run(out) if (out / STORE_NAME).is_file() else ({}, {}, [])
    shown = {summary.case.name: summary for summary in summaries}
    ran = {result.cell.case for result in results}
    others = summarise({name: case for name, case in cases.items() if name in ran and name not in shown}, results)
    there = [summary for summary in others if (out / "report" / f"{file_stem(summary.case.name)}.html").is_file()]
    return build_report([*there, *summaries], out / "report", environment(), flagged, sources, only=shown)


def last_run(out: Path, suite: str = "") -> tuple[dict[str, Case], dict[str, str], list[Result]]:
    """Cases of the folder, where each was loaded from, and the stored results of the last run of each.

    With the name of a suite its problems, without one everything else.
    """
    cells, remembered = remembered_lineup(out / STORE_NAME)
    known = filed_suites()
    sources = {
        name: source
        for name, source in remembered.items()
        if (name.partition(":")[0] if source == name and name.partition(":")[0] in known else "") == suite
    }
    cases = {name: load_case(source) for name, source in sources.items()}
    with Store(out / STORE_NAME, write=False) as store:
        return cases, sources, stored_results(store, [cell for cell in cells if cell.case in cases], cases)


def suite_noted(out: Path) -> dict[str, Any] | None:
    """Note on the suite of the last run; None where it was no run of a suite."""
    with Store(out / STORE_NAME, write=False) as store:
        noted: dict[str, Any] | None = store.noted(SUITE_NOTE)
    return noted


def audit_flags(out: Path) -> dict[str, str]:
    """Searches that the bias audit of `study compare` flags, with the reason; empty where it has not been made."""
    from study.comparison.build import flags  # here: the comparison is slow to import

    return flags(out / STORE_NAME)


def keep_to_oneself() -> None:
    """Nothing leaves the machine; rerun reads this when it is imported."""
    os.environ["RERUN_ANALYTICS_ENABLED"] = "false"


def recording_file(out: Path, name: str) -> Path:
    """Path of the recording of a case; its folder is made."""
    folder = out / "recordings"
    folder.mkdir(parents=True, exist_ok=True)
    return folder / f"{file_stem(name)}.rrd"
