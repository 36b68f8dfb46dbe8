"""The three sentences that answer the study's question, made from the results."""

from __future__ import annotations

import re
from collections.abc import Sequence

from study.analysis.featured import LEVEL, Featured
from study.analysis.formatting import count, listed, percent, plural, seconds, wall
from study.analysis.methods import MethodSummary


def answer(cases: Sequence[Featured], budgets: Sequence[int] = ()) -> tuple[str, ...]:
    """Say who wins, what it costs, and what the curve costs; what the results do not show is left out.

    Parameters
    ----------
    cases : sequence of Featured
    budgets : sequence of int
        Evaluations that the papers spend, said beside ours where they differ.
    """
    return _whole(_who_wins(cases), _what_it_costs(cases, budgets), _what_the_curve_costs(cases))


def case_answer(best: Featured, budgets: Sequence[int] = ()) -> tuple[str, ...]:
    """Say the same of one case, with the names of the methods and their times."""
    return _whole(_who_wins_here(best), _what_it_costs([best], budgets), _off_the_curve(best))


def _whole(*sentences: str) -> tuple[str, ...]:
    """Keep a number and its unit on one line, and drop what is empty."""
    return tuple(re.sub(r"(?<=\d) (?=%|s\b|ms\b)", "\u00a0", sentence) for sentence in sentences if sentence)


def _compared(cases: Sequence[Featured]) -> list[tuple[MethodSummary, MethodSummary]]:
    return [
        (case.search, case.optimiser)
        for case in cases
        if case.search and case.optimiser and case.search.feasible and case.optimiser.feasible
    ]


def _relative(method: MethodSummary, reference: MethodSummary, best: bool = False) -> float:
    value = method.best if best else method.median
    return (value or 0.0) / (reference.median or 1.0) - 1.0


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
    return (
        f"{lead}: on the same curve the best metaheuristic is {counts} of {plural(len(gaps), 'case')} against a plain "
        f"deterministic optimiser; it takes {_span(gaps)} ({_seeds([search for search, _ in pairs], _span(best))})."
    )


def _who_wins_here(best: Featured) -> str:
    pairs = _compared([best])
    if not pairs:
        return ""
    search, plain = pairs[0]
    luck = _relative(search, plain, best=True)
    lead = "Yes" if luck < -LEVEL else "No"
    usual, lucky = _span([_relative(search, plain)]), _span([luck])
    return (
        f"{lead}: on the same curve the best metaheuristic (`{search.label}`) takes {seconds(search.median)} and the "
        f"deterministic `{plain.label}` {seconds(plain.median)}: {usual} "
        f"({_seeds([search], 'too' if lucky == usual else lucky)})."
    )


def _seeds(searches: Sequence[MethodSummary], lucky: str) -> str:
    """Say over how many seeds the median is taken, and the gain of the best one."""
    seeds = sorted({search.runs for search in searches})
    if seeds[-1] == 1:
        return "one seed"
    over = plural(seeds[0], "seed") if len(seeds) == 1 else f"{seeds[0]} to {seeds[-1]} seeds"
    return f"median over {over}; its best seed {lucky}"


def _what_it_costs(cases: Sequence[Featured], budgets: Sequence[int]) -> str:
    pairs = _compared(cases)
    times = [(search.wall_time, plain.wall_time) for search, plain in pairs if search.wall_time and plain.wall_time]
    if not times:
        return ""
    ours, theirs = ([pair[k] for pair in times] for k in (0, 1))
    spent = [search.evaluations for search, _ in pairs]
    whose = "the paper's" if len(budgets) == 1 else "the papers'"
    aside = f" ({whose} own budget is {_counts(budgets)}: `study run --full`)" if set(budgets) - set(spent) else ""
    return (
        f"That metaheuristic spends {_counts(spent)} curve evaluations{aside} and {_walls(ours)} of computing on every "
        f"run; the deterministic optimiser needs {_walls(theirs)}, once."
    )


def _counts(values: Sequence[int]) -> str:
    return " to ".join(dict.fromkeys((count(min(values)), count(max(values)))))


def _walls(values: Sequence[float]) -> str:
    return " to ".join(dict.fromkeys((wall(min(values)), wall(max(values)))))


def _what_the_curve_costs(cases: Sequence[Featured]) -> str:
    fair = [case for case in cases if not case.velocity_only and case.reference and _freed(case)]
    if not fair:
        return ""
    parts = []
    for role, words in (("free", "with the path between the waypoints free"), ("fixed", "along a fixed path")):
        freed = [(getattr(case, role), case.reference) for case in fair if getattr(case, role) in _freed(case)]
        if freed:
            parts.append(f"{_span([_relative(method, plain) for method, plain in freed if plain])} {words}")
    unlimited = sum(case.velocity_only for case in cases)
    aside = f"; {plural(unlimited, 'case')} without acceleration limits not counted" if unlimited else ""
    return (
        f"{_blame(fair)}against the optimum on it, deterministic planners take {' and '.join(parts)} "
        f"({plural(len(fair), 'case')}{aside})."
    )


def _freed(case: Featured) -> list[MethodSummary]:
    """Planners off the curve that found a feasible motion."""
    return [method for method in (case.free, case.fixed) if method is not None and method.feasible]


def _blame(cases: Sequence[Featured]) -> str:
    """In how many cases giving up the curve gains more than the search loses on it."""
    both = [
        (min(_relative(method, plain) for method in _freed(case)), abs(_relative(search, plain)))
        for case in cases
        for search, plain in _compared([case])
    ]
    blamed = sum(gain < -loss for gain, loss in both)
    if not blamed:
        return "As for the curve, "
    where = "" if blamed == len(both) else f"in {blamed} of {plural(len(both), 'case')} "
    return f"What costs time {where}is the curve, not the search: "


def _off_the_curve(best: Featured) -> str:
    """Say how much time the planners with more freedom gain on one case."""
    parts = [
        f"{words} `{method.label}` takes {_span([_relative(method, best.reference)])} ({seconds(method.median)})"
        for method, words in ((best.free, "with a free path"), (best.fixed, "along a fixed path"))
        if method is not None and method.feasible and best.reference is not None
    ]
    if not parts:
        return ""
    aside = (
        "; without an acceleration limit speed may step there, which no arm can follow" if best.velocity_only else ""
    )
    return f"Against the optimum on the curve, {' and '.join(parts)}{aside}."
