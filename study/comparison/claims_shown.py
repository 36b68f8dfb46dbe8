"""The headline claims as tables and sentences."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from study.analysis.formatting import listed, percent, seconds, wall
from study.analysis.tables import Column, Grid, grid
from study.comparison.claims import Against, Counterpart
from study.comparison.outcomes import SIGNIFICANT
from study.comparison.tables import IntervalColumn, PlannerColumn, interval_text, p_value


def _text(against: Against) -> str:
    return f"{interval_text(against.difference)}, A12 {against.a12:.2f}, p {p_value(against.p)}"


def _printed(claim: Counterpart) -> str:
    words = {
        True: "feasible",
        False: f"infeasible: {claim.published_reason}",
        None: f"not judged: {claim.published_reason}",
    }
    return words[claim.published_feasible]


def _stopping(claim: Counterpart) -> str:
    if claim.ruckig is None:
        return claim.ruckig_reason
    return f"{seconds(claim.ruckig.median)}, computed in {wall(claim.ruckig.seconds)}; the search took {wall(claim.ours.seconds)}"


def _against_columns(name: str, against: Callable[[Counterpart], Against]) -> tuple[Column[Counterpart], ...]:
    return (
        IntervalColumn(f"difference_against_{name}", "", lambda claim: against(claim).difference),
        Column(f"a12_against_{name}", "", lambda claim: against(claim).a12),
        Column(f"signed_rank_p_holm_against_{name}", "", lambda claim: against(claim).p),
    )


COLUMNS: tuple[Column[Counterpart], ...] = (
    Column("paper", "", lambda claim: claim.headline.paper),
    Column("case", "Case", lambda claim: claim.headline.case),
    Column("", "Claim", lambda claim: f"{claim.printed_saving} less than {claim.headline.against}"),
    Column("", "Printed", _printed),
    PlannerColumn("planner", "Search", lambda claim: claim.ours.planner),
    Column("printed_saving", "", lambda claim: claim.printed_saving),
    Column("against", "", lambda claim: claim.headline.against),
    Column("printed_total_s", "", lambda claim: claim.total),
    Column("published_feasible", "", lambda claim: claim.published_feasible),
    Column("our_median_s", "", lambda claim: claim.ours.total),
    Column("our_feasible_runs", "", lambda claim: claim.ours.feasible),
    Column("our_runs", "", lambda claim: len(claim.ours.durations)),
    Column("", "Feasible", lambda claim: claim.ours.passed),
    Column("baseline", "", lambda claim: claim.headline.baseline),
    Column("", "Its opponent", lambda claim: f"{claim.headline.baseline}: {_text(claim.against_baseline)}"),
    *_against_columns("baseline", lambda claim: claim.against_baseline),
    Column("", "Random search", lambda claim: _text(claim.against_random)),
    *_against_columns("random", lambda claim: claim.against_random),
    Column("optimum_s", "", lambda claim: claim.reference.value),
    Column("above_optimum", "", lambda claim: claim.above_optimum),
    Column("printed_above_optimum", "", lambda claim: claim.printed_above_optimum),
    Column(
        "",
        "The optimum",
        lambda claim: f"ours {percent(claim.above_optimum)}, printed {percent(claim.printed_above_optimum)}",
    ),
    Column("wall_s", "", lambda claim: claim.ours.seconds),
    Column("ruckig_s", "", lambda claim: claim.ruckig.median if claim.ruckig else None),
    Column("ruckig_wall_s", "", lambda claim: claim.ruckig.seconds if claim.ruckig else None),
    Column("", "Ruckig, stopping", _stopping),
)


def claim_grid(claims: Sequence[Counterpart], flags: Mapping[str, str]) -> Grid:
    """Every headline beside its counterparts."""
    return grid(
        "The headline claims beside their honest counterparts: whether the printed motion keeps the limits, then our runs "
        "against four. Ours is the median total of the search run the paper's own way at the budget of this comparison, "
        "infeasible motions included, since the paper would have counted them. Its opponent and random search have the same "
        "budget and seeds: median difference of the totals (95 % by bootstrap; less is shorter), A12 the probability that a "
        "run of ours is shorter, signed rank p adjusted by Holm for the claims. The optimum is the best known on the paper's "
        "curve with all joints together. Ruckig may choose its own path and must stop at every waypoint.",
        COLUMNS,
        claims,
        flags,
        names=9,
    )


def claimed(claim: Counterpart) -> str:
    """Lay a headline beside its counterparts."""
    ours = f"{claim.ours.feasible} of {len(claim.ours.durations)} of our runs feasible"
    ruckig = f"Ruckig gives no motion ({claim.ruckig_reason})"
    if claim.ruckig is not None:
        ruckig = (
            f"Ruckig, stopping at every waypoint on a path of its own, takes {seconds(claim.ruckig.median)} and "
            f"{wall(claim.ruckig.seconds)} of computing against {wall(claim.ours.seconds)}"
        )
    return (
        f"{claim.headline.paper} claims {claim.printed_saving} less time than {claim.headline.against} ({claim.printed_total}). "
        f"Its search, {claim.ours.planner}, run its own way ends at {seconds(claim.ours.total)} ({ours}): "
        f"{less(claim.against_baseline)} than {claim.headline.baseline} and {less(claim.against_random)} than random search at "
        f"the same budget, {percent(claim.above_optimum)} against the optimum of {seconds(claim.reference.value)}; "
        f"the printed total is {percent(claim.printed_above_optimum)} against that optimum. {ruckig}."
    )


def claimed_together(claims: Sequence[Counterpart]) -> str:
    """Sum up the papers' searches over all claims."""

    def shorter(against: Sequence[Against]) -> str:
        gains = [each.difference.estimate for each in against if each.difference and each.p < SIGNIFICANT]
        won = [percent(-gain, signed=False) for gain in sorted(gains, reverse=True) if gain < 0]
        return f"{len(won)}{f' (by {listed(won)})' if won else ''}"

    ends = sorted(claim.above_optimum for claim in claims)
    return (
        f"Searches run their papers' own way: of {len(claims)}, "
        f"{shorter([claim.against_baseline for claim in claims])} end significantly shorter than the plain search at the same "
        f"budget, {shorter([claim.against_random for claim in claims])} than random search; against the optimum on the paper's "
        f"curve they end at {' to '.join(dict.fromkeys(map(percent, (ends[0], ends[-1]))))}."
    )


def less(against: Against) -> str:
    """Say how much shorter a search's totals are, or longer, and whether that is more than chance."""
    if against.difference is None:
        return "not comparable, since runs gave no motion,"
    change = against.difference.estimate
    sure = "" if against.p < SIGNIFICANT else " (no significant difference)"
    return f"{percent(abs(change), signed=False)} {'shorter' if change <= 0 else 'longer'}{sure}"
