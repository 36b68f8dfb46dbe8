"""The answer in the README: the report's sentences and one table of all cases, put between two marks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from study.analysis.case_summary import CaseSummary
from study.analysis.featured import ROLE_NAMES
from study.analysis.formatting import DASH, percent, seconds
from study.analysis.methods import Kind, MethodSummary, lower_bound
from study.analysis.sentences import answer
from study.errors import StudyError
from study.files import write_file

BEGIN, END = "<!-- answer -->", "<!-- /answer -->"
COLUMNS = ("published", "search", "optimiser", "fixed", "free")


def answer_in_markdown(summaries: Sequence[CaseSummary]) -> str:
    """Say what came out in three sentences and a table with one row for each case."""
    heads = ["case", *(ROLE_NAMES[role] for role in COLUMNS), "no motion is faster than"]
    lines = [heads, ["---"] * len(heads), *map(_row, summaries)]
    table = "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
    budgets = [summary.case.settings.evaluations for summary in summaries]
    sentences = answer([summary.best for summary in summaries], budgets)
    return "\n".join((*(f"- {sentence}" for sentence in sentences), "", table))


def _row(summary: CaseSummary) -> list[str]:
    best = summary.best
    times = [_time(getattr(best, role), best.reference) for role in COLUMNS]
    return [summary.case.name + " †" * best.velocity_only, *times, seconds(lower_bound(summary.methods))]


def _time(method: MethodSummary | None, reference: MethodSummary | None) -> str:
    if method is None:
        return DASH
    name = "" if method.kind is Kind.PUBLISHED else f" `{method.planner}`"
    if not method.feasible:
        return f"{seconds(method.duration)}{name}, {'not judged' if method.motion is None else 'breaks a limit'}"
    if reference is None or method is reference or not (method.median and reference.median):
        return seconds(method.duration) + name
    return f"{seconds(method.duration)}{name} ({percent(method.median / reference.median - 1.0)})"


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
        write_file(path, f"{before}{BEGIN}\n{text}\n{after}")
    except (OSError, UnicodeDecodeError) as error:
        raise StudyError(f"the answer cannot be put into {str(path)!r}: {error}") from None
