"""The answer in the README: the report's sentences and one table of all cases, put between two marks."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from study.analysis.case_summary import CaseSummary, answer_of
from study.analysis.ends import end_steps
from study.analysis.featured import ROLE_NAMES, SEARCHES, Featured
from study.analysis.formatting import DASH, count, percent, seconds, wall
from study.analysis.methods import Kind, MethodSummary, lower_bound
from study.errors import StudyError
from study.files import write_file
from study.io.text import read_text

ON_CURVE, OFF_CURVE = ("published", *SEARCHES, "optimiser"), ("optimiser", "fixed", "free")


def answer_in_markdown(summaries: Sequence[CaseSummary]) -> str:
    """Say what came out in a few sentences and two tables with one row for each case: on the papers' curves, and off them."""
    on_curve = _table(["case", *(ROLE_NAMES[role] for role in ON_CURVE)], map(_row_on_curve, summaries))
    heads = ["case", *(ROLE_NAMES[role] for role in OFF_CURVE), "no motion is faster than"]
    tables = f"{on_curve}\n\n{_table(heads, map(_row_off_curve, summaries))}"
    steps = [text for summary in summaries if (text := end_steps(summary))]
    return "\n".join(
        (*(f"- {sentence}" for sentence in answer_of(summaries)), "", tables, *(f"\n{text}" for text in steps))
    )


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (heads, ["---"] * len(heads), *rows))


def _row_on_curve(summary: CaseSummary) -> list[str]:
    best, step = summary.best, " ‡" * bool(end_steps(summary))
    cells = [_time(getattr(best, role), best) + _price(getattr(best, role)) for role in ON_CURVE]
    cells[-1] = cells[-1].replace(" s ", f" s{step} ", 1)
    return [_name(summary), *cells]


def _row_off_curve(summary: CaseSummary) -> list[str]:
    times = [_time(getattr(summary.best, role), summary.best) for role in OFF_CURVE]
    return [_name(summary), *times, seconds(lower_bound(summary.methods))]


def _name(summary: CaseSummary) -> str:
    return summary.case.name + " †" * summary.best.velocity_only


def _price(method: MethodSummary | None) -> str:
    """Second line of a cell: evaluations and wall time of a run."""
    if method is None or not method.wall_time or method.kind is Kind.PUBLISHED:
        return ""
    spent = f"{count(method.evaluations)} evaluations, " if method.kind is Kind.SEARCH else ""
    return f"<br>{spent}{wall(method.wall_time)}"


def _time(method: MethodSummary | None, best: Featured) -> str:
    if method is None:
        return DASH
    name = "" if method.kind is Kind.PUBLISHED else f" `{method.planner}`"
    if not method.feasible:
        return f"{seconds(method.duration)}{name}, {'not judged' if method.motion is None else 'breaks a limit'}"
    behind = best.behind(method)
    return f"{seconds(method.duration)}{name}" + ("" if behind is None else f" ({percent(behind)})")


def put(path: Path, text: str, name: str = "answer") -> None:
    """Replace what stands between the marks `<!-- NAME -->` and `<!-- /NAME -->` of a file.

    Raises
    ------
    StudyError
        If the file cannot be read or written, or does not hold the two marks.
    """
    begin, end, old = f"<!-- {name} -->", f"<!-- /{name} -->", read_text(path)
    if old.count(begin) != 1 or old.count(end) != 1 or old.index(begin) > old.index(end):
        raise StudyError(f"{str(path)!r} needs the marks {begin} and {end} once each, in this order")
    before, after = old[: old.index(begin)], old[old.index(end) :]
    write_file(path, f"{before}{begin}\n{text}\n{after}")
