"""The three sentences that answer the study's question, made from the results."""

from __future__ import annotations

from collections.abc import Sequence

from study.report.featured import Featured
from study.report.rows import Entry
from study.report.wording import count, listed, percent, plural, wall

LEVEL = 1e-4
"""Times closer than this share count as level."""

Pair = tuple[float, float]


def answer(cases: Sequence[Featured]) -> tuple[str, ...]:
    """Say who wins, what it costs, and what the curve costs; what the results do not show is left out."""
    sentences = (_who_wins(cases), _what_it_costs(cases), _what_the_curve_costs(cases))
    return tuple(sentence for sentence in sentences if sentence)


def _compared(cases: Sequence[Featured]) -> list[tuple[Entry, Entry]]:
    return [
        (case.search, case.optimiser)
        for case in cases
        if case.search and case.optimiser and case.search.row.feasible and case.optimiser.row.feasible
    ]


def _relative(entry: Entry, reference: Entry, best: bool = False) -> float:
    value = entry.row.best if best else entry.row.median
    return (value or 0.0) / (reference.row.median or 1.0) - 1.0


def _span(values: Sequence[float]) -> str:
    low, high = percent(min(values)), percent(max(values))
    return low if low == high else f"{low} to {high}"


def _who_wins(cases: Sequence[Featured]) -> str:
    pairs = _compared(cases)
    if not pairs:
        return ""
    gaps = [_relative(search, plain) for search, plain in pairs]
    behind = sum(gap > LEVEL for gap in gaps)
    ahead = sum(gap < -LEVEL for gap in gaps)
    counts = [f"{verb} in {n}" for verb, n in (("ahead", ahead), ("level", len(gaps) - behind - ahead), ("behind", behind)) if n]
    never = "" if ahead else " and never ahead"
    best = [_relative(search, plain, best=True) for search, plain in pairs]
    seeds = sorted({search.row.runs for search, _ in pairs})
    seeds_text = plural(seeds[0], "seed") if len(seeds) == 1 else f"{seeds[0]} to {seeds[-1]} seeds"
    return (
        f"On the papers' own curves the best metaheuristic, by its median over {seeds_text}, is {listed(counts)} "
        f"of {plural(len(gaps), 'case')}{never}, against a plain deterministic optimiser: its motions take {_span(gaps)} of time "
        f"(its best seed {_span(best)})."
    )


def _what_it_costs(cases: Sequence[Featured]) -> str:
    pairs = _compared(cases)
    times = [(search.row.wall_time, plain.row.wall_time) for search, plain in pairs if search.row.wall_time and plain.row.wall_time]
    if not times:
        return ""
    ours, theirs = ([pair[k] for pair in times] for k in (0, 1))
    evaluations = [search.row.evaluations for search, _ in pairs]
    used = count(evaluations[0]) if min(evaluations) == max(evaluations) else f"{count(min(evaluations))} to {count(max(evaluations))}"
    return (
        f"It spends {used} curve evaluations and {_walls(ours)} of computing per run on that; "
        f"the deterministic optimiser needs {_walls(theirs)}."
    )


def _walls(values: Sequence[float]) -> str:
    low, high = wall(min(values)), wall(max(values))
    return low if low == high else f"{low} to {high}"


def _what_the_curve_costs(cases: Sequence[Featured]) -> str:
    parts = []
    for role, words in (("free", "with a free path between the waypoints"), ("fixed", "on a fixed path")):
        pairs = [(getattr(case, role), case.reference) for case in cases]
        gaps = [_relative(entry, plain) for entry, plain in pairs if entry and plain and entry.row.feasible]
        if gaps:
            parts.append(f"{words} a deterministic planner takes {_span(gaps)} ({plural(len(gaps), 'case')})")
    if not parts:
        return ""
    return f"The curve itself decides more or less than the search does: against the optimum on the same curve, {'; '.join(parts)}."
