"""Terminal output of the command `study`: tables and progress."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import groupby

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from study.analysis.case_summary import CaseSummary
from study.analysis.ends import end_steps
from study.analysis.formatting import DASH, figures, percent, seconds, share, wall
from study.analysis.methods import Kind, MethodSummary, Standing
from study.bounds import Method, kind_of
from study.cases.ledger import Entry
from study.cases.library import Case
from study.cautions import ends_said
from study.judge import RATES, Verdict
from study.problem import Floats, Problem

MOST_ROWS = 40
"""Rows up to which a table of waypoints is printed whole."""

EDGE_ROWS = 8
"""Rows at the beginning and at the end of a longer one that are printed."""


def progress(console: Console) -> Progress:
    """Build the live display of a run."""
    return Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
        transient=False,
    )


NOTE = (
    "path: what a method may change; times on different paths answer different questions. gap: above the shortest "
    "feasible duration known, on whatever path; above bound: above what no motion through the waypoints can undercut."
)


FLAGGED = " ⚑: its result depends on where in its box the optimum stands (`study compare`)."


def methods_table(summary: CaseSummary, flags: Collection[str] = ()) -> Table:
    """Table of one case: every method, feasible ones first, with the reason where one is infeasible; `flags` get a mark."""
    case = summary.case
    table = Table(
        title=f"{case.name}: {case.title} (limits: {case.limits_label})",
        title_justify="left",
        header_style="bold",
        caption="\n".join((*_apart(summary), NOTE + FLAGGED * bool(flags))),
        caption_justify="left",
    )
    table.add_column("method", no_wrap=True)
    table.add_column("path", no_wrap=True)
    for name in ("duration (s)", "gap", "above bound", "feasible", "worst ratio", "evaluations", "wall (s)"):
        table.add_column(name, justify="right", no_wrap=True)
    table.add_column("reason", overflow="fold", style="dim")
    for method in summary.methods:
        style = "bold" if method.kind is Kind.BOUND else "" if method.feasible else "red"
        table.add_row(*_method_row(method, method.kind is Kind.SEARCH and method.planner in flags), style=style)
    return table


def _apart(summary: CaseSummary) -> Iterator[str]:
    """Lines that tell the searches apart, each with its time against the optimum, its evaluations and its wall time."""
    reference = summary.best.reference
    for role, method in summary.best.on_the_curve():
        against = ""
        if method.median and reference and reference.median and method is not reference:
            against = f" ({percent(method.median / reference.median - 1)})"
        spent = f"{method.evaluations:,} evaluations, " if method.kind is Kind.SEARCH else ""
        yield f"{role}: {method.label}, {seconds(method.duration)}{against}, {spent}{wall(method.wall_time)}"
    if text := end_steps(summary):
        yield text


def _method_row(method: MethodSummary, flagged: bool) -> tuple[str | Text, ...]:
    bound = method.kind is Kind.BOUND
    return (
        Text(method.label + " ⚑" * flagged),
        "any" if bound else (method.freedom or "").removesuffix(" path"),
        f"≥ {figures(method.bound)}" if bound else _duration_text(method),
        percent(method.gap, signed=False),
        percent(method.above_bound, signed=False),
        _share(method),
        share(method.worst_ratio),
        f"{method.evaluations:,}" if method.evaluations else DASH,
        DASH if method.kind is Kind.PUBLISHED else f"{method.wall_time:.3g}",
        Text(method.reason),
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


def times_text(times: Sequence[float] | Floats, duration: float) -> str:
    """Times with four decimals, or more where the whole motion takes less than a second; of many, the first and the last."""
    places = 4 + max(0, -math.floor(math.log10(duration))) if duration > 0 else 4
    first, last = _shown(len(times))
    hidden = [f"... {last.start - first.stop:,} more ..."] * bool(last)
    return ", ".join([*(f"{times[k]:.{places}f}" for k in first), *hidden, *(f"{times[k]:.{places}f}" for k in last)])


def _shown(count: int) -> tuple[range, range]:
    """Rows of a table to print: all of a few; of many, the first ones and the last ones."""
    return (range(count), range(0)) if count <= MOST_ROWS else (range(EDGE_ROWS), range(count - EDGE_ROWS, count))


def verdict_table(problem: Problem, verdict: Verdict) -> Table:
    """Table of what the judge found, joint by joint."""
    table = Table(header_style="bold")
    table.add_column("joint")
    for name in RATES:
        table.add_column(f"{name}: share of limit", justify="right")
        table.add_column("at (s)", justify="right")
    table.add_column("waypoint error", justify="right")
    table.add_column("overshoot", justify="right")
    for j, joint in enumerate(problem.joint_names):
        rates = []
        for order, limits in enumerate(problem.limits.rates):
            rates += [
                f"{verdict.ratios[order, j]:.6f}" if np.isfinite(limits[j]) else "no limit",
                times_text([verdict.times[order, j]], verdict.duration),
            ]
        table.add_row(joint, *rates, f"{verdict.waypoint_error[j]:.2e}", f"{verdict.overshoot[j]:.2e}")
    return table


def cases_table(cases: Iterable[Case]) -> Table:
    """Table of cases; those of the default run are marked, variants stand indented under their case."""
    table = Table(title="Cases", title_justify="left", header_style="bold")
    for name in ("name", "default", "what", "limits", "waypoints", "joints", "curve", "paper's planner"):
        table.add_column(
            name,
            overflow="fold",
            justify="right" if name in ("waypoints", "joints") else "left",
            no_wrap=name == "name",
        )
    for case in cases:
        if not case.variant_of:
            table.add_section()
        name, size = "  " * bool(case.variant_of) + case.name, (case.problem.n_waypoints, case.problem.n_joints)
        default = "yes" if case.default else ""
        table.add_row(name, default, case.title, case.limits_label, *map(str, size), case.curve, case.planner)
    return table


def planners_table(entries: Sequence[tuple[str, Method | str]], defaults: Iterable[str]) -> Table:
    """Table of planners and bounds; one that cannot be loaded shows the reason."""
    table = Table(title="Planners", title_justify="left", header_style="bold")
    for name in ("name", "default", "kind", "may change", "how it works"):
        table.add_column(name, overflow="fold", no_wrap=name == "name")
    taken = set(defaults)
    for name, method in entries:
        default = "yes" if name in taken else ""
        if isinstance(method, str):
            table.add_row(name, default, "not available", "", method, style="red")
            continue
        table.add_row(name, default, kind_of(method), method.freedom, method.about)
    return table


def case_tables(case: Case) -> list[Table]:
    """Tables of one case: where its numbers come from, its waypoints and its limits."""
    facts = Table(title=f"{case.name}: {case.title}", title_justify="left", show_header=False)
    facts.add_column(style="bold")
    facts.add_column(overflow="fold")
    lower, upper = case.problem.duration_bounds
    own = case.paper == "own"
    if not own:
        facts.add_row("paper", case.paper)
    facts.add_row("curve", f"{case.curve}; the motion {ends_said(case.problem)}")
    facts.add_row("segment durations", f"{lower:g} to {upper:g} s")
    settings = case.settings
    ways = f"{settings.formulation}, {settings.synchronisation}, population {settings.population}"
    planner = "searches" if own else "paper's planner"
    facts.add_row(planner, f"{'' if own else case.planner + ', '}{ways}, {settings.evaluations:,} evaluations")
    facts.add_row("limits", case.limits_label)
    for name, source in case.sources.items():
        facts.add_row(f"source of {name}", source)
    for note in case.notes:
        facts.add_row("note", note)
    return [facts, _waypoints_table(case), _limits_table(case)]


def ledger_tables(entries: Iterable[Entry]) -> Iterator[Table]:
    """Tables of the ledger, one for each paper."""
    for paper, group in groupby(entries, key=lambda entry: entry.paper):
        table = Table(title=paper, title_justify="left", header_style="bold", show_lines=True)
        for name in ("kind", "place", "printed", "problem", "reading", "consequence"):
            table.add_column(name, overflow="fold")
        for entry in group:
            table.add_row(entry.kind, entry.place, entry.printed, entry.problem, entry.reading, entry.consequence)
        yield table


def _waypoints_table(case: Case) -> Table:
    table = Table(title="Waypoints", title_justify="left", header_style="bold")
    table.add_column("", justify="right")
    for name, unit in zip(case.problem.joint_names, case.units, strict=True):
        table.add_column(f"{name} ({unit})", justify="right")
    first, last = _shown(case.problem.n_waypoints)
    for index in (*first, *last):
        if last and index == last.start:
            table.add_row(*["..."] * (case.problem.n_joints + 1))
            table.caption = f"waypoints {first.stop + 1:,} to {last.start:,} are not shown"
        table.add_row(str(index + 1), *(f"{value:.6g}" for value in case.problem.waypoints[index]))
    return table


def _rate_text(low: float, high: float, unit: str) -> str:
    """Limits of a rate, in both directions where they differ."""
    if low == -high:
        return f"{high:g} {unit}" if np.isfinite(high) else "none"
    return " to ".join(f"{end:g}" if np.isfinite(end) else "none" for end in (low, high)) + f" {unit}"


def _limits_table(case: Case) -> Table:
    table = Table(title="Limits", title_justify="left", header_style="bold")
    table.add_column("")
    for name in case.problem.joint_names:
        table.add_column(name, justify="right")
    units = ("/s", "/s²", "/s³")
    robot = case.problem.limits
    for name, unit, lows, highs in zip(RATES, units, robot.lowest_rates, robot.highest_rates, strict=True):
        both = zip(lows.tolist(), highs.tolist(), case.units, strict=True)
        table.add_row(name, *(_rate_text(low, high, of + unit) for low, high, of in both))
    for name, ends in (("lowest position", case.problem.limits.lower), ("highest position", case.problem.limits.upper)):
        if np.isfinite(ends).any():
            values = [f"{v:g} {of}" if np.isfinite(v) else "none" for v, of in zip(ends, case.units, strict=True)]
            table.add_row(name, *values)
    return table
