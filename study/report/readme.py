"""The answer in the README: the report's sentences and one table of all cases, put between two marks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from study.analysis.featured import ROLE_NAMES, Featured, featured
from study.analysis.formatting import DASH, percent, seconds
from study.analysis.rows import Entry, entries_of, lower_bound
from study.analysis.sentences import answer
from study.cases.library import Case
from study.errors import StudyError
from study.store.results import Result

BEGIN, END = "<!-- answer -->", "<!-- /answer -->"
COLUMNS = ("published", "search", "optimiser", "fixed", "free")


def answer_in_markdown(cases: Mapping[str, Case], results: Sequence[Result]) -> str:
    """Say what came out in three sentences and a table with one row for each case.

    Parameters
    ----------
    cases : mapping of str to Case
    results : sequence of Result
    """
    tables = [(case, entries_of(case, results)) for case in cases.values()]
    best = [featured(entries, case.velocity_only) for case, entries in tables]
    heads = ["case", *(ROLE_NAMES[role] for role in COLUMNS), "no motion is faster than"]
    rows = [_row(case, entries, chosen) for (case, entries), chosen in zip(tables, best, strict=True)]
    lines = [heads, ["---"] * len(heads), *rows]
    table = "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
    budgets = [case.settings.evaluations for case in cases.values()]
    return "\n".join((*(f"- {sentence}" for sentence in answer(best, budgets)), "", table))


def _row(case: Case, entries: Sequence[Entry], best: Featured) -> list[str]:
    times = [_time(getattr(best, role), best.reference) for role in COLUMNS]
    return [case.name + " †" * best.velocity_only, *times, seconds(lower_bound(entries))]


def _time(entry: Entry | None, reference: Entry | None) -> str:
    if entry is None:
        return DASH
    name = "" if entry.row.kind == "published" else f" `{entry.planner}`"
    if not entry.row.feasible:
        return f"{seconds(entry.duration)}{name}, {'not judged' if entry.motion is None else 'breaks a limit'}"
    if reference is None or entry is reference or not (entry.row.median and reference.row.median):
        return seconds(entry.duration) + name
    return f"{seconds(entry.duration)}{name} ({percent(entry.row.median / reference.row.median - 1.0)})"


def put_answer(path: Path, text: str) -> None:
    """Replace what stands between the marks `<!-- answer -->` and `<!-- /answer -->` of a file.

    Raises
    ------
    StudyError
        If the file cannot be read or written, or does not hold the two marks.
    """
    try:
        old = path.read_text(encoding="utf-8")
        if old.count(BEGIN) != 1 or old.count(END) != 1 or old.index(BEGIN) > old.index(END):
            raise StudyError(f"{str(path)!r} needs the marks {BEGIN} and {END} once each, in this order")
        before, after = old[: old.index(BEGIN)], old[old.index(END) :]
        path.write_text(f"{before}{BEGIN}\n{text}\n{after}", encoding="utf-8", newline="\n")
    except (OSError, UnicodeDecodeError) as error:
        raise StudyError(f"the answer cannot be put into {str(path)!r}: {error}") from None
