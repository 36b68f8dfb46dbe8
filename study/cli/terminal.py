"""Terminal output of the command `study`: tables and progress."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from itertools import groupby

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table
from rich.text import Text

from study.analysis.arm_uses import arm_uses
from study.analysis.case_summary import CaseSummary
from study.analysis.ends import end_steps
from study.analysis.featured import IN_ORDER, ROLE_NAMES
from study.analysis.formatting import DASH, figures, percent, seconds, share, wall
from study.analysis.methods import Kind, MethodSummary, Standing
from study.analysis.palette import terminal_color
from study.analysis.sentences import answer
from study.bounds import Method, kind_of
from study.cases.ledger import Entry
from study.cases.library import Case
from study.cases.obstacles import DRIVEN, Nearest
from study.cautions import ends_said
from study.cli.screen import clean, fitted
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
        TextColumn("left"),
        TimeRemainingColumn(),
        console=console,
        transient=False,
    )


NOTE = (
    "path: what a method may change; times on different paths answer different questions. gap: above the shortest "
    "feasible duration known, on whatever path; above bound: above what no motion through the waypoints can undercut."
)


FLAGGED = "⚑: its result depends on where in its box the optimum stands (`study compare`)."


def answer_lines(summaries: Sequence[CaseSummary]) -> Iterator[str]:
    """The answer of the study in a few sentences."""
    budgets = [summary.case.settings.evaluations for summary in summaries]
    for sentence in answer([summary.best for summary in summaries], budgets):
        yield f"• {sentence}"


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


def times_text(times: Sequence[float] | Floats, duration: float) -> str:
    """Times with four decimals, or more where the whole motion takes less than a second; of many, the first and the last."""
    places = 4 + max(0, -math.floor(math.log10(duration))) if duration > 0 else 4
    first, last = _shown(len(times))
    hidden = [f"... {last.start - first.stop:,} more ..."] * bool(last)
    return ", ".join([*(f"{times[k]:.{places}f}" for k in first), *hidden, *(f"{times[k]:.{places}f}" for k in last)])


def _shown(count: int) -> tuple[range, range]:
    """Rows of a table to print: all of a few; of many, the first ones and the last ones."""
    return (range(count), range(0)) if count <= MOST_ROWS else (range(EDGE_ROWS), range(count - EDGE_ROWS, count))


def card(case: Case, verdict: Verdict, good: bool, clearance: Nearest | None, facts: Mapping[str, str]) -> Table:
    """Lines that open what is said of a motion: duration, whether it may be driven, what binds, clearance, `facts`."""
    grid = Table.grid(padding=(0, 2))
    grid.add_column(style="bold", no_wrap=True)
    grid.add_column(overflow="fold")
    drive = Text(DRIVEN[good], style="bold green" if good else "bold red")
    grid.add_row(Text(case.name), Text.assemble(f"{verdict.duration:.9g} s, ", drive))
    if np.isfinite(case.problem.limits.rates).any():
        grid.add_row("binding", Text(_binding(case.problem, verdict)))
    for name, text in arm_uses(case.problem, verdict).items():
        grid.add_row(name, Text(text))
    if clearance is not None and clearance.clear:
        grid.add_row("clearance", Text(clearance.sentence))
    for name, text in facts.items():
        grid.add_row(name, Text(text))
    return grid


def _binding(problem: Problem, verdict: Verdict) -> str:
    if problem.arm is not None and verdict.worst_ratio > verdict.ratios.max():
        place = int(verdict.arm_shares[1].argmax())
        name, time = problem.arm.names(problem.joint_names)[place], verdict.arm_times[place]
        return f"{name} at {times_text([time], verdict.duration)} s, {100 * verdict.worst_ratio:.4f} % of its limit"
    order, j = divmod(int(np.nanargmax(verdict.ratios)), problem.n_joints)
    return (
        f"{RATES[order]} of {problem.joint_names[j]} at {times_text([verdict.times[order, j]], verdict.duration)} s, "
        f"{100 * verdict.worst_ratio:.4f} % of its limit"
    )


def verdict_table(console: Console, problem: Problem, verdict: Verdict) -> Table:
    """Table of what the judge found, joint by joint; the largest share of a limit stands in bold."""
    heads = ["joint"]
    for name in RATES:
        heads += [name, f"{name} at (s)"]
    rows = []
    for j, joint in enumerate(problem.joint_names):
        row: list[str | Text] = [Text(joint)]
        for order, limits in enumerate(problem.limits.rates):
            limited = np.isfinite(limits[j])
            ratio = verdict.ratios[order, j]
            shown = f"{100 * float(ratio):.4f} %" if limited else "no limit"
            row.append(Text(shown, style="bold" if limited and ratio == verdict.worst_ratio else ""))
            row.append(times_text([verdict.times[order, j]], verdict.duration) if limited else DASH)
        rows.append([*row, f"{verdict.waypoint_error[j]:.2e}", f"{verdict.overshoot[j]:.2e}"])
    times = [f"{name} at (s)" for name in reversed(RATES)]
    heads += ["waypoint error", "overshoot"]
    return fitted(
        console,
        "Largest share of every limit, and when",
        heads,
        rows,
        left=("joint",),
        gives_way=("overshoot", "waypoint error", *times),
    )


def cases_table(console: Console, cases: Iterable[Case]) -> Table:
    """Table of cases; those of the default run are marked, variants stand indented under their case."""
    rows = [
        (
            "  " * bool(case.variant_of) + case.name,
            "yes" if case.default else "",
            Text(case.title),
            case.limits_label,
            str(case.problem.n_waypoints),
            str(case.problem.n_joints),
            case.curve,
            case.planner,
        )
        for case in cases
    ]
    return fitted(
        console,
        "Cases",
        ("name", "default", "description", "limits", "waypoints", "joints", "curve", "paper's planner"),
        rows,
        left=("name", "default", "curve", "paper's planner"),
        wraps=("description", "limits"),
        gives_way=("limits", "joints", "waypoints", "curve", "paper's planner"),
    )


def planners_table(console: Console, entries: Sequence[tuple[str, Method | str]], defaults: Iterable[str]) -> Table:
    """Table of planners and bounds; one that cannot be loaded shows the reason."""
    taken = set(defaults)
    rows: list[tuple[str | Text, ...]] = []
    for name, method in entries:
        broken = isinstance(method, str)
        kind, freedom, about = (
            ("not available", "", method)
            if isinstance(method, str)
            else (kind_of(method), method.freedom, method.about)
        )
        rows.append((name, "yes" if name in taken else "", kind, freedom, Text(about, style="red" if broken else "")))
    return fitted(
        console,
        "Planners",
        ("name", "default", "kind", "may change", "how it works"),
        rows,
        left=("name", "default", "kind", "may change"),
        wraps=("how it works",),
        gives_way=("may change", "kind", "default"),
    )


def case_tables(console: Console, case: Case) -> list[Table]:
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
    return [facts, *_waypoints_tables(console, case), _limits_table(console, case)]


def ledger_lines(entries: Iterable[Entry]) -> Iterator[Text]:
    """The ledger paper by paper, each entry in a few lines."""
    for paper, group in groupby(entries, key=lambda entry: entry.paper):
        yield Text(f"\n{paper}", style="bold underline")
        for entry in group:
            yield Text(f"\n{entry.place} ({entry.kind})", style="bold")
            parts = {"printed": entry.printed, "problem": entry.problem, "reading": entry.reading}
            for name, text in (parts | {"consequence": entry.consequence}).items():
                if text:
                    yield Text.assemble((f"{name}: ", "dim"), text)


def _waypoints_tables(console: Console, case: Case) -> Iterator[Table]:
    """Tables of waypoints, as many joints in each as stand beside each other."""
    problem = case.problem
    first, last = _shown(problem.n_waypoints)
    indices = [*first, *last]
    cells = [[f"{problem.waypoints[k, j]:.6g}" for k in indices] for j in range(problem.n_joints)]
    heads = [clean(f"{name}\n({unit})") for name, unit in zip(problem.joint_names, case.units, strict=True)]
    widths = [3 + max(map(cell_len, [*column, *head.split("\n")])) for head, column in zip(heads, cells, strict=True)]
    start = 0
    while start < problem.n_joints:
        stop, total = start, 4 + len(str(problem.n_waypoints))
        while stop < problem.n_joints and (stop == start or total + widths[stop] <= console.width):
            total, stop = total + widths[stop], stop + 1
        table = Table(
            title="Waypoints", title_justify="left", header_style="bold", caption_justify="left", box=SIMPLE_HEAD
        )
        table.add_column("", justify="right", no_wrap=True)
        for head in heads[start:stop]:
            table.add_column(Text(head), justify="right", no_wrap=True)
        for row, index in enumerate(indices):
            if last and index == last.start:
                table.add_row(*["..."] * (stop - start + 1))
                table.caption = f"waypoints {first.stop + 1:,} to {last.start:,} are not shown"
            table.add_row(str(index + 1), *(column[row] for column in cells[start:stop]))
        yield table
        start = stop


def _rate_text(low: float, high: float, unit: str) -> str:
    """Limits of a rate, in both directions where they differ."""
    if low == -high:
        return f"{high:g} {unit}" if np.isfinite(high) else "none"
    return " to ".join(f"{end:g}" if np.isfinite(end) else "none" for end in (low, high)) + f" {unit}"


def _limits_table(console: Console, case: Case) -> Table:
    limits, problem = case.problem.limits, case.problem
    both = zip(limits.lowest_rates, limits.highest_rates, strict=True)
    columns = dict(zip(RATES, zip(("/s", "/s²", "/s³"), both, strict=True), strict=True))
    for name, ends in (("lowest position", limits.lower), ("highest position", limits.upper)):
        if np.isfinite(ends).any():
            columns[name] = ("", (-ends, ends))
    rows: list[list[str | Text]] = [
        [Text(joint), *(_rate_text(low[j], high[j], case.units[j] + unit) for unit, (low, high) in columns.values())]
        for j, joint in enumerate(problem.joint_names)
    ]
    return fitted(console, "Limits", ("joint", *columns), rows, left=("joint",))
