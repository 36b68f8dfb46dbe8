"""Tables of a case and of one motion on the terminal: limits, waypoints, verdict, and whether it may be driven."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.cells import cell_len
from rich.console import Console
from rich.table import Table
from rich.text import Text

from study.analysis.arm_uses import arm_uses
from study.analysis.formatting import DASH
from study.cases.library import Case
from study.cases.obstacles import DRIVEN, Nearest, said_of
from study.cases.paper_file import SI
from study.cautions import ends_said
from study.cli.screen import clean, fitted
from study.judge import RATES, Verdict
from study.problem import Floats, Problem

MOST_ROWS = 40
"""Rows up to which a table of waypoints is printed whole."""

EDGE_ROWS = 8
"""Rows at the beginning and at the end of a longer one that are printed."""


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
    said = said_of(case.problem, verdict, good)
    drive = Text(said, style="bold green" if said == DRIVEN[True] else "bold red")
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


def _waypoints_tables(console: Console, case: Case) -> Iterator[Table]:
    """Tables of waypoints, as many joints in each as stand beside each other."""
    problem = case.problem
    first, last = _shown(problem.n_waypoints)
    indices = [*first, *last]
    units, size = _typed(case)
    cells = [[f"{problem.waypoints[k, j] / size[j]:.6g}" for k in indices] for j in range(problem.n_joints)]
    heads = [clean(f"{name}\n({unit})") for name, unit in zip(problem.joint_names, units, strict=True)]
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


def _typed(case: Case) -> tuple[tuple[str, ...], Floats]:
    """Units of the joints as the file has them, and how many rad or m each is, shape (n_joints,)."""
    units = case.typed or case.units
    return units, np.array([SI[unit][1] for unit in units])


def _rate_text(low: float, high: float, unit: str) -> str:
    """Limits of a rate, in both directions where they differ."""
    if low == -high:
        return f"{high:g} {unit}" if np.isfinite(high) else "none"
    return " to ".join(f"{end:g}" if np.isfinite(end) else "none" for end in (low, high)) + f" {unit}"


def _limits_table(console: Console, case: Case) -> Table:
    limits, problem = case.problem.limits, case.problem
    units, size = _typed(case)
    both = zip(limits.lowest_rates / size, limits.highest_rates / size, strict=True)
    columns = dict(zip(RATES, zip(("/s", "/s²", "/s³"), both, strict=True), strict=True))
    for name, ends in (("lowest position", limits.lower), ("highest position", limits.upper)):
        if np.isfinite(ends).any():
            columns[name] = ("", (-ends / size, ends / size))
    rows: list[list[str | Text]] = [
        [Text(joint), *(_rate_text(low[j], high[j], units[j] + unit) for unit, (low, high) in columns.values())]
        for j, joint in enumerate(problem.joint_names)
    ]
    return fitted(console, "Limits", ("joint", *columns), rows, left=("joint",))
