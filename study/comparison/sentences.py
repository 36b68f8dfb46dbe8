"""Sentences with numbers, all of them made from the findings."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from study.analysis.formatting import listed, percent, plural, ratio, seconds, wall
from study.comparison.ablations import ABLATIONS, WHOLE, AblationFinding
from study.comparison.audit import ALARM, AXES, SIGNIFICANT, FunctionFinding, TrajectoryFinding
from study.comparison.build import Comparison
from study.comparison.claims import Against, Counterpart
from study.comparison.contestants import needs_scaling
from study.comparison.differences import Omnibus
from study.comparison.performance import Performance
from study.comparison.statistics import smallest_pair_p
from study.runs.selections import YARDSTICKS


def p_value(p: float) -> str:
    """Write a p-value as people read it."""
    return f"{p:.2g}" if p >= 1e-4 else "below 0.0001"


def ranking(found: Omnibus) -> str:
    """Say who ranks first, and where the trivial opponents stand."""
    scaled = [name for name in found.planners if found.level != "scaled" and needs_scaling(name)]
    note = f" ({listed(scaled)} with the scaled one, which they need)" if scaled else ""
    trivial = [f"{name} {found.planners.index(name) + 1}" for name in YARDSTICKS if name in found.planners]
    return (
        f"With the {found.level} formulation{note} {found.planners[0]} has the best mean rank over "
        f"{plural(len(found.cases), 'case')} ({found.friedman.mean_ranks[0]:.1f} of {len(found.planners)}); "
        f"the places of the trivial opponents among {len(found.planners)}: {', '.join(trivial)}."
    )


def weakness(found: Omnibus) -> str:
    """Say what so few cases can show at all."""
    n, k = len(found.cases), len(found.planners)
    return (
        f"The omnibus test is weak with {plural(n, 'case')}. It may say that not all planners are alike (p "
        f"{p_value(found.friedman.p)}; the smallest that it can give with {k} planners is {found.smallest_p:.0e}), but hardly which: "
        f"two planners are told apart only when their mean ranks differ by {found.difference:.1f} of at most {k - 1}, and a "
        f"signed rank test over the cases cannot give a p below {found.smallest_pair_p:.3g}."
    )


def targets_reached(level: str, measured: Sequence[Performance]) -> str:
    """Say which share of all runs and targets the best search and the trivial opponents reached."""
    shares: dict[str, list[float]] = {}
    for one in measured:
        shares.setdefault(one.contestant.planner, []).append(float(one.reached.mean()))
    means = {name: float(np.mean(values)) for name, values in shares.items()}
    best = max((name for name in means if name not in YARDSTICKS), key=lambda name: means[name], default=None)
    trivial = listed([f"{name} {percent(means[name], signed=False)}" for name in YARDSTICKS if name in means])
    if best is None:
        return f"With the {level} formulation no search was run."
    return (
        f"With the {level} formulation {best} reached {percent(means[best], signed=False)} of all cases, runs and targets, "
        f"the most of the searches; the trivial opponents: {trivial}."
    )


PRINTED = "-as-printed"
"""Ending of the names of searches that follow a paper's formulas exactly as printed."""


def named(searches: Mapping[str, str]) -> str:
    """List searches with a remark each, those that follow the papers as printed by their number only."""
    own = [f"{name}{remark}" for name, remark in searches.items() if not name.endswith(PRINTED)]
    printed = len(searches) - len(own)
    return listed([*own, *([f"{printed} as printed"] if printed else [])]) or "none"


def functions_audited(found: Sequence[FunctionFinding]) -> str:
    """Say whom the functions flag, and how the standard searches stand."""
    flagged = {one.search: f" ({ratio(one.shifted)})" for one in found if one.shifted > ALARM}
    plain = [f"{one.search} ({ratio(one.shifted)})" for one in found if one.search in ("pso", "de")]
    rest = (
        f" Not flagged: {listed(plain)}."
        if all(one.shifted <= ALARM for one in found if one.search in ("pso", "de"))
        else ""
    )
    return (
        f"On the functions the error of {len(flagged)} of {len(found)} searches grows more than "
        f"{ALARM:g}-fold when the optimum leaves the origin: {named(flagged)}.{rest}"
    )


def axes_audited(found: Sequence[FunctionFinding]) -> str:
    """Say whose result depends on the directions of the axes."""
    turned = [f"{one.search} ({ratio(one.rotated)})" for one in found if one.on_axes]
    return (
        f"The error of {len(turned)} of {len(found)} searches grows more than {ALARM:g}-fold when the axes of the functions are "
        f"turned about the optimum: {listed(turned) or 'none'}. Such a search gains from functions that fall apart into single "
        f"coordinates; that is no pull to a place, so it raises no flag, and is marked {AXES} here."
    )


def trajectories_audited(found: Sequence[TrajectoryFinding]) -> str:
    """Say what the audit finds on the trajectory problems."""
    names = {one.search for one in found}
    depends = [one for one in found if one.depends]
    if not depends:
        return (
            f"On the trajectory problems no result of {len(names)} searches depends significantly on how the durations "
            "are written."
        )
    by_search = dict.fromkeys((one.search for one in depends), "")
    worst = max(depends, key=lambda one: abs(math.log(one.seen / one.as_they_are)))
    flattered = len({one.search for one in depends if one.flattered})
    return (
        f"On the trajectory problems the results of {len(by_search)} of {len(names)} searches depend on how the durations are "
        f"written ({named(by_search)}), {flattered} of these with a better result for the durations as they are, which "
        f"a pull to zero flatters. The largest change: {worst.search} on {worst.case} takes {seconds(worst.as_they_are)} with "
        f"the durations as they are and {seconds(worst.seen)} with them {worst.view}."
    )


def improvements(found: Sequence[AblationFinding]) -> list[str]:
    """Say which improvements matter on trajectory problems, and which on functions only."""
    sentences = []
    for ablation in ABLATIONS:
        own = [one for one in found if one.paper == ablation.paper and one.improvement != WHOLE]
        parts = [
            f"{name}: {_counted([one for one in own if one.improvement == name])}" for name in ablation.improvements
        ]
        if own:
            sentences.append(f"{ablation.title}. {'; '.join(parts)}.")
    return sentences


def _counted(found: Sequence[AblationFinding]) -> str:
    texts = []
    for kind, chosen in (("trajectory", True), ("function", False)):
        tasks = [one for one in found if one.trajectory is chosen]
        helps, harms = (sum(one.effect == effect for one in tasks) for effect in ("helps", "harms"))
        texts.append(f"helps on {helps} and harms on {harms} of {len(tasks)} {kind} tasks")
    return ", ".join(texts)


def matters(found: Sequence[AblationFinding]) -> str:
    """Say how many improvements matter at all."""
    single = [one for one in found if one.improvement != WHOLE]
    names = dict.fromkeys((one.paper, one.improvement) for one in single)

    def helping(trajectory: bool) -> list[str]:
        return [
            name
            for paper, name in names
            if any(
                one.effect == "helps" and one.trajectory is trajectory
                for one in single
                if (one.paper, one.improvement) == (paper, name)
            )
        ]

    arms = helping(True)
    return (
        f"Of {len(names)} improvements, {len(arms)} help by themselves on at least one trajectory problem"
        f"{': ' + listed(arms) if arms else ''}; {len(helping(False))} help on at least one function."
    )


def claimed(one: Counterpart) -> str:
    """Lay a headline beside its counterparts."""
    ours = f"{one.feasible} of {len(one.ours.durations)} of our runs feasible"
    ruckig = f"Ruckig gives no motion ({one.ruckig_reason})"
    if one.ruckig is not None:
        ruckig = (
            f"Ruckig, stopping at every waypoint on a path of its own, takes {seconds(one.ruckig.median)} and "
            f"{wall(float(np.median(one.ruckig.wall)))} of computing against {wall(float(np.median(one.ours.wall)))}"
        )
    return (
        f"{one.headline.paper} claims {one.printed_saving} less time than {one.headline.against} ({one.printed_total}). "
        f"Its search, {one.planner}, run its own way ends at {seconds(one.our_total)} ({ours}): "
        f"{less(one.against_baseline)} than {one.headline.baseline} and {less(one.against_random)} than random search at the "
        f"same budget, {percent(one.above_optimum)} against the optimum of {seconds(one.reference.value)}; "
        f"the printed total is {percent(one.printed_above_optimum)} against that optimum. {ruckig}."
    )


def claimed_together(found: Sequence[Counterpart]) -> str:
    """Say what the papers' searches come to, all claims together."""

    def shorter(against: Sequence[Against]) -> str:
        gains = [one.difference.estimate for one in against if one.difference and one.p < SIGNIFICANT]
        won = [percent(-gain, signed=False) for gain in sorted(gains, reverse=True) if gain < 0]
        return f"{len(won)}{f' (by {listed(won)})' if won else ''}"

    ends = sorted(one.above_optimum for one in found)
    return (
        f"Of {len(found)} papers' searches, each run its paper's own way, {shorter([one.against_baseline for one in found])} "
        f"end significantly shorter than the plain search at the same budget, {shorter([one.against_random for one in found])} "
        f"than random search; against the optimum on the paper's curve they end at {percent(ends[0])} to {percent(ends[-1])}."
    )


def less(found: Against) -> str:
    """Say how much shorter a search's totals are, or longer, and whether that is more than chance."""
    if found.difference is None:
        return "not comparable, since runs gave no motion,"
    change = found.difference.estimate
    sure = "" if found.p < SIGNIFICANT else " (no significant difference)"
    return f"{percent(abs(change), signed=False)} {'shorter' if change <= 0 else 'longer'}{sure}"


def summary(found: Comparison) -> list[str]:
    """Say what the whole comparison comes to."""
    together = [claimed_together(found.claims)] if found.claims else []
    return [
        *together,
        *(ranking(one) for one in found.omnibus),
        functions_audited(found.functions),
        trajectories_audited(found.trajectories),
        matters(found.ablations),
    ]


def limitations(found: Comparison) -> list[str]:
    """What the numbers do not show."""
    effort = found.effort
    items = [
        f"{plural(len(found.cases), 'case')} from five papers; what ranks high here need not elsewhere.",
        "The reference of every case is the best known on its paper's curve family with all joints together; for it no "
        "proof of optimality is given here, and methods with other curves or paths are not measured against it.",
        "Populations are recorded whole, so a target counts as reached at the end of the generation that reached it.",
        "Seconds to target spread a run's wall time evenly over its evaluations.",
        f"Wall times are of runs beside one another on all processors, Ruckig's the median of {effort.seeds} calls; they "
        "depend on the machine, and no test uses them.",
        "Errors on functions below 1e-8 count as 1e-8.",
    ]
    if effort.seeds < 20:
        items.insert(
            0,
            f"Quick mode: {effort.seeds} repetitions of every planner and {effort.trial_seeds} of every trial; a signed rank "
            f"test of as many pairs cannot give a p below {smallest_pair_p(effort.seeds):.3g} and "
            f"{smallest_pair_p(effort.trial_seeds):.3g}, before any adjustment, so that what is not significant here may well be "
            "there. Run it with --full for 30 repetitions and the papers' budgets.",
        )
    if found.failures:
        broken = listed([f"{name} ({count})" for name, count in sorted(found.failures.items())])
        items.append(f"Searches that broke down in trials, with the number of runs that ended early: {broken}.")
    return items
