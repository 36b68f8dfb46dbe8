"""The sentences that answer the study's question, made from the results."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

from study.analysis.featured import LEVEL, SEARCHES, Featured
from study.analysis.formatting import count, listed, percent, plural, seconds, wall
from study.analysis.methods import MethodSummary

WHO = {
    "own": "the paper's own method",
    "search": "the best of the papers' searches",
    "modern": "the best modern search",
}
"""Roles of searches as sentences name them."""

Pairs = list[tuple[MethodSummary, MethodSummary]]
"""Searches and the deterministic optimum on the same curve, both feasible, one pair for each case that has them."""


def answer(cases: Sequence[Featured], budgets: Sequence[int] = ()) -> tuple[str, ...]:
    """Say who wins, what it costs, and what the curve costs; what the results do not show is left out.

    Parameters
    ----------
    cases : sequence of Featured
    budgets : sequence of int
        Evaluations that the papers spend, said beside ours where they differ.
    """
    return _whole(
        *_who_wins(cases, _standing), _what_it_costs(cases, budgets), _how_chosen(cases), _what_the_curve_costs(cases)
    )


def case_answer(best: Featured, budgets: Sequence[int] = ()) -> tuple[str, ...]:
    """Say the same of one case, with the names of the methods and their times."""
    return _whole(
        *_who_wins([best], _standing_here), _what_it_costs([best], budgets), _how_chosen([best]), _off_the_curve(best)
    )


def _whole(*sentences: str) -> tuple[str, ...]:
    """Keep a number and its unit on one line, and drop what is empty."""
    return tuple(re.sub(r"(?<=\d) (?=%|s\b|ms\b)", "\u00a0", sentence) for sentence in sentences if sentence)


def _compared(cases: Sequence[Featured], role: str) -> Pairs:
    pairs = [(getattr(case, role), case.optimiser) for case in cases]
    return [(search, plain) for search, plain in pairs if search and plain and search.feasible and plain.feasible]


def _groups(cases: Sequence[Featured]) -> dict[str, Pairs]:
    """Pairs of every role of a search; the paper's own method is left out where it is the only search of the papers."""
    groups = {role: pairs for role in SEARCHES if (pairs := _compared(cases, role))}
    if groups.get("own") == groups.get("search"):
        groups.pop("own", None)
    return groups


def _all_pairs(case: Featured) -> Pairs:
    return [pair for role in SEARCHES for pair in _compared([case], role)]


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


def _who_wins(cases: Sequence[Featured], said: Callable[[Pairs], str]) -> list[str]:
    """Lead with the verdict and the strongest group of searches, then name the others."""
    groups = _groups(cases)
    order = sorted(groups, key=lambda role: sum(_relative(*pair) for pair in groups[role]) / len(groups[role]))
    sentences = [f"{WHO[role]} {said(groups[role])}" for role in order]
    if not sentences:
        return []
    lead = f"{_lead(cases)}: against a plain deterministic optimiser on the same curve, "
    return [lead + sentences[0], *(sentence[0].upper() + sentence[1:] for sentence in sentences[1:])]


def _lead(cases: Sequence[Featured]) -> str:
    """Verdict over all searches: ahead in all cases, in some, or in none, and whether a modern search is level."""
    pairs = [each for case in cases if (each := _all_pairs(case))]
    ahead = [any(_relative(*pair, best=True) < -LEVEL for pair in each) for each in pairs]
    if any(ahead):
        return "Yes" if all(ahead) else "Sometimes"
    modern = _compared(cases, "modern")
    level = bool(modern) and all(_relative(*pair) <= LEVEL for pair in modern)
    return "No, but a modern metaheuristic is level" if level else "No"


def _standing(pairs: Pairs) -> str:
    """Say in how many cases a group is ahead, level and behind, and by how much."""
    gaps = [_relative(*pair) for pair in pairs]
    best = [_relative(*pair, best=True) for pair in pairs]
    ahead = sum(value < -LEVEL for value in best)
    behind = sum(gap > LEVEL and value >= -LEVEL for gap, value in zip(gaps, best, strict=True))
    verdicts = (("ahead", ahead), ("level", len(gaps) - behind - ahead), ("behind", behind))
    counts = listed([f"{verb} in {n}" for verb, n in verdicts if n])
    return (
        f"is {counts} of {plural(len(gaps), 'case')}; it takes {_span(gaps)} "
        f"({_seeds([search for search, _ in pairs], _span(best))})."
    )


def _standing_here(pairs: Pairs) -> str:
    """Say the same of one case, with names and times."""
    ((search, plain),) = pairs
    usual, lucky = _span([_relative(search, plain)]), _span([_relative(search, plain, best=True)])
    return (
        f"(`{search.label}`) takes {seconds(search.median)} and the deterministic `{plain.label}` {seconds(plain.median)}: "
        f"{usual} ({_seeds([search], 'too' if lucky == usual else lucky)})."
    )


def _seeds(searches: Sequence[MethodSummary], lucky: str) -> str:
    """Say over how many seeds the median is taken, and the gain of the best one."""
    seeds = sorted({search.runs for search in searches})
    if seeds[-1] == 1:
        return "one seed"
    over = plural(seeds[0], "seed") if len(seeds) == 1 else f"{seeds[0]} to {seeds[-1]} seeds"
    return f"median over {over}; its best seed {lucky}"


def _what_it_costs(cases: Sequence[Featured], budgets: Sequence[int]) -> str:
    groups = _groups(cases)
    plain = list({id(plain): plain.wall_time for pairs in groups.values() for _, plain in pairs}.values())
    if not plain or not all(plain):
        return ""
    spent = sorted({search.evaluations for pairs in groups.values() for search, _ in pairs})
    whose = "the paper's" if len(budgets) == 1 else "the papers'"
    aside = f" ({whose} own budget is {_counts(budgets)}: `study run --full`)" if set(budgets) - set(spent) else ""
    costs = [f"{WHO[role]} in {_walls([search.wall_time for search, _ in pairs])}" for role, pairs in groups.items()]
    return (
        f"Every run of a search spends {_counts(spent)} curve evaluations{aside}, {listed(costs)} of computing; the "
        f"deterministic optimiser needs {_walls(plain)}, once."
    )


def _how_chosen(cases: Sequence[Featured]) -> str:
    """State the rule by which the best of a group is chosen, and how far the choice flatters it."""
    changes = [case.flattery for case in cases if case.flattery is not None]
    if not changes:
        return ""
    change = f"changes by at most {percent(max(changes), False)}" if max(changes) > LEVEL else "does not change"
    return (
        "Best of a group: the lowest median over all seeds, the same seeds and budget for every search. Chosen by every "
        f"second seed and timed by the other seeds, its time {change}."
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
    """In how many cases giving up the curve gains more than the closest search loses on it."""
    both = [
        (min(_relative(method, plain) for method in _freed(case)), min(abs(_relative(*pair)) for pair in pairs))
        for case in cases
        if (pairs := _all_pairs(case)) and (plain := pairs[0][1])
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
