"""Tables and lines on what a run gave: the answer over all cases, and every method of a case."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

from rich.console import Console
from rich.table import Table
from rich.text import Text

from study.analysis.case_summary import CaseSummary, answer_of
from study.analysis.ends import end_steps
from study.analysis.featured import IN_ORDER, ROLE_NAMES
from study.analysis.formatting import DASH, figures, percent, seconds, share, wall
from study.analysis.methods import Kind, MethodSummary, Standing
from study.analysis.palette import terminal_color
from study.cli.screen import fitted

NOTE = (
    "path: what a method may change; times on different paths answer different questions. gap: above the shortest "
    "feasible duration known, on whatever path; above bound: above what no motion through the waypoints can undercut."
)


FLAGGED = "⚑: its result depends on where in its box the optimum stands (`study compare`)."


def answer_lines(summaries: Sequence[CaseSummary]) -> Iterator[str]:
    """The answer of the study in a few sentences."""
    yield from (f"• {sentence}" for sentence in answer_of(summaries))


def answer_table(console: Console, summaries: Sequence[CaseSummary]) -> Table:
    """Table with a row for each case: durations in s of the best method of every role."""
    heads = [ROLE_NAMES[role] for role in IN_ORDER]
    rows: list[list[str | Text]] = []
    for summary in summaries:
        best = summary.best
        cells: list[str | Text] = [summary.case.name + " †" * best.velocity_only]
        for role in IN_ORDER:
            method = getattr(best, role)
            text = figures(method.duration) if method is not None else DASH
            if method is not None and (behind := best.behind(method)) is not None:
                text += f"\n{percent(behind)}"
            cells.append(text)
        rows.append(cells)
    marked = "†: limits velocity only, so off its curve a motion may change its speed in an instant."
    return fitted(
        console,
        "Durations in s",
        ("case", *heads),
        rows,
        left=("case",),
        gives_way=(ROLE_NAMES["free"], ROLE_NAMES["fixed"], ROLE_NAMES["own"], ROLE_NAMES["published"]),
        notes=(marked,) * any(summary.best.velocity_only for summary in summaries),
    )


METHOD_HEADS = (
    "method",
    "path",
    "duration (s)",
    "gap",
    "above bound",
    "feasible",
    "worst ratio",
    "evaluations",
    "wall (s)",
)


def methods_table(console: Console, summary: CaseSummary, flags: Collection[str] = ()) -> Table:
    """Table of one case: every method, feasible ones first; `flags` get a mark."""
    case = summary.case
    return fitted(
        console,
        f"{case.name}: {case.title} (limits: {case.limits_label})",
        METHOD_HEADS,
        [_method_row(summary, method, method.planner in flags) for method in summary.methods],
        left=("method", "path"),
        gives_way=("wall (s)", "above bound", "path", "evaluations", "worst ratio"),
        styles=[
            "bold" if method.kind is Kind.BOUND else "" if method.feasible else "red" for method in summary.methods
        ],
        notes=(*_apart(summary), NOTE, *[FLAGGED] * bool(flags)),
    )


def reasons(summary: CaseSummary) -> Iterator[str]:
    """Why methods are infeasible, each reason once, with the methods."""
    named: dict[str, list[str]] = {}
    for method in summary.methods:
        if method.reason:
            named.setdefault(method.reason, []).append(method.label)
    for reason, labels in named.items():
        yield f"{', '.join(labels)}: {reason}"
    for method in summary.whole:
        if not summary.clear(method):
            yield f"{method.label}: {summary.driving[method.label]}"


def _apart(summary: CaseSummary) -> Iterator[str]:
    """Lines that tell the searches apart, each with its time against the optimum, its evaluations and its wall time."""
    for role, method in summary.best.on_the_curve():
        behind = summary.best.behind(method)
        against = "" if behind is None else f" ({percent(behind)})"
        spent = f"{method.evaluations:,} evaluations, " if method.kind is Kind.SEARCH else ""
        yield f"{role}: {method.label}, {seconds(method.duration)}{against}, {spent}{wall(method.wall_time)}"
    if text := end_steps(summary):
        yield text


def _method_row(summary: CaseSummary, method: MethodSummary, flagged: bool) -> tuple[str | Text, ...]:
    bound = method.kind is Kind.BOUND
    color = terminal_color(summary.slots[method.label]) if method.feasible and method.joint is None else ""
    return (
        Text(method.label + " ⚑" * (flagged and method.kind is Kind.SEARCH), style=color),
        "any" if bound else (method.freedom or "").removesuffix(" path"),
        f"≥ {figures(method.bound)}" if bound else _duration_text(method),
        percent(method.gap, signed=False),
        percent(method.above_bound, signed=False),
        _share(method),
        share(method.worst_ratio),
        f"{method.evaluations:,}" if method.evaluations else DASH,
        DASH if method.kind is Kind.PUBLISHED else f"{method.wall_time:.3g}",
    )


def _duration_text(method: MethodSummary) -> str:
    if method.standing is Standing.UNJUDGED and method.claimed is not None:
        return f"({method.claimed:g})"
    return figures(method.duration)


def _share(method: MethodSummary) -> str:
    said = {Standing.BOUND: "bound", Standing.UNJUDGED: "not judged", Standing.INAPPLICABLE: "n/a"}
    if method.standing in said:
        return said[method.standing]
    if method.runs == 1:
        return "yes" if method.feasible else "no"
    return f"{method.feasible_runs} of {method.runs}"
