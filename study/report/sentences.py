"""The three sentences that answer the study's question, made from the results."""

from __future__ import annotations

from collections.abc import Sequence

from study.report.featured import LEVEL, Featured
from study.report.rows import Entry
from study.report.wording import count, listed, percent, plural, wall

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
    """Say how much less or more time, such as `12.1 % to 34.5 % less time`."""
    low, high = min(values), max(values)
    near, far = sorted((abs(low), abs(high)))
    if far <= LEVEL:
        return "the same time to within 0.01 %"
    if low < -LEVEL and high > LEVEL:
        return f"from {percent(-low, False)} less to {percent(high, False)} more time"
    word = "less" if low < -LEVEL else "more"
    if near <= LEVEL:
        return f"up to {percent(far, False)} {word} time"
    ends = dict.fromkeys((percent(near, False), percent(far, False)))
    return f"{' to '.join(ends)} {word} time"


def _who_wins(cases: Sequence[Featured]) -> str:
    pairs = _compared(cases)
    if not pairs:
        return ""
    gaps = [_relative(search, plain) for search, plain in pairs]
    best = [_relative(search, plain, best=True) for search, plain in pairs]
    ahead = sum(value < -LEVEL for value in best)
    behind = sum(gap > LEVEL and value >= -LEVEL for gap, value in zip(gaps, best, strict=True))
    verdicts = (("ahead", ahead), ("level", len(gaps) - behind - ahead), ("behind", behind))
    counts = listed([f"{verb} in {n}" for verb, n in verdicts if n])
    lead = "No" if not ahead else "Sometimes" if ahead < len(gaps) else "Yes"
    seeds = sorted({search.row.runs for search, _ in pairs})
    seeds_text = plural(seeds[0], "seed") if len(seeds) == 1 else f"{seeds[0]} to {seeds[-1]} seeds"
    return (
        f"{lead}: on the paper's own curve the best metaheuristic is {counts} of {plural(len(gaps), 'case')} against a plain "
        f"deterministic optimiser; it takes {_span(gaps)} (median over {seeds_text}; its best seed {_span(best)})."
    )


def _what_it_costs(cases: Sequence[Featured]) -> str:
    pairs = _compared(cases)
    times = [
        (search.row.wall_time, plain.row.wall_time)
        for search, plain in pairs
        if search.row.wall_time and plain.row.wall_time
    ]
    if not times:
        return ""
    ours, theirs = ([pair[k] for pair in times] for k in (0, 1))
    evaluations = [search.row.evaluations for search, _ in pairs]
    used = (
        count(evaluations[0])
        if min(evaluations) == max(evaluations)
        else f"{count(min(evaluations))} to {count(max(evaluations))}"
    )
    return (
        f"That metaheuristic spends {used} curve evaluations and {_walls(ours)} of computing on every run; "
        f"the deterministic optimiser needs {_walls(theirs)}, once."
    )


def _walls(values: Sequence[float]) -> str:
    low, high = wall(min(values)), wall(max(values))
    return low if low == high else f"{low} to {high}"


def _what_the_curve_costs(cases: Sequence[Featured]) -> str:
    parts, gains = [], []
    for role, words in (("free", "with the path between the waypoints free"), ("fixed", "along a fixed path")):
        pairs = [(getattr(case, role), case.reference) for case in cases if not case.velocity_only]
        gaps = [_relative(entry, plain) for entry, plain in pairs if entry and plain and entry.row.feasible]
        gains += gaps
        if gaps:
            parts.append(f"{words} a deterministic planner takes {_span(gaps)} ({plural(len(gaps), 'case')})")
    if not parts:
        return ""
    losses = [abs(_relative(search, plain)) for search, plain in _compared(cases)]
    lead = "What costs time is the curve, not the search: " if losses and max(gains) < -max(losses) else ""
    text = f"against the optimum on the paper's curve, {', and '.join(parts)}"
    unlimited = sum(case.velocity_only for case in cases)
    aside = f"; not counted: {plural(unlimited, 'case')} without acceleration limits" if unlimited else ""
    return lead + (text if lead else text[0].upper() + text[1:]) + aside + "."
