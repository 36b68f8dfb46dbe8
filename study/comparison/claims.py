"""The five papers' headline claims, each beside its honest counterparts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from study.comparison import statistics
from study.comparison.contestants import Contestant, Reference, Runs, contestants, installed
from study.comparison.effort import Effort
from study.experiment.cases import Case
from study.experiment.lineup import Spec, make_cells
from study.experiment.published import claims
from study.experiment.results import Cell
from study.experiment.summary import published_rows


@dataclass(frozen=True)
class Headline:
    """Where a paper's headline stands.

    Attributes
    ----------
    paper, case : str
    saving, total : str
        Ids of the paper's claims: the share of time saved, and the total time after it.
    against : str
        What the paper compares with.
    baseline : str
        The planner that stands for the paper's own opponent here.
    """

    paper: str
    case: str
    saving: str
    total: str
    against: str
    baseline: str


HEADLINES = (
    Headline("woodworking-golds-pso", "woodworking", "reduction-pso", "total-golds-pso", "PSO", "pso-basic"),
    Headline("aubo-dynamic-adaptive-pso", "aubo-i5", "reduction-1", "total-1", "three segments of 2 s each", "pso"),
    Headline("ur5-smwoa", "ur5-bspline", "reduction", "total", "the unoptimised motion of 39.526 s", "pso"),
    Headline("ur5-tadf-ssa", "ur5-helix", "reduction", "total", "the unoptimised motion of 50 s", "ssa"),
    Headline("puma560-chaotic-spso", "puma560", "reduction-abstract", "total", "the unoptimised motion of 3 s", "pso"),
)


@dataclass(frozen=True, eq=False)
class Counterpart:
    """A claim and what the same search is worth when the comparison is fair; shares of time saved, not percent.

    Attributes
    ----------
    headline : Headline
    planner : str
    printed_saving, printed_total : str
        As the paper prints them.
    total : float, s
    published_feasible : bool, optional
        Whether the printed motion passes the judge; None where it cannot be judged.
    published_reason : str
    ours : Contestant
        The paper's search run the paper's own way.
    feasible : int
        How many of our runs pass the judge.
    our_total : float, s
        Median total of our runs, feasible or not: the papers do not judge the motion that their joints make together.
    saving_baseline, saving_random : float
        Median total saved against the baseline planner and against random search, at the same budget.
    a12_baseline, a12_random : float
        Probability that a run is shorter than theirs.
    p_baseline, p_random : float
        Signed rank on paired seeds.
    reference : Reference
        Optimum of the same problem as far as known.
    above_optimum, printed_above_optimum : float
        Median of ours, and the printed total, above it.
    ruckig : Contestant, optional
        Ruckig, stopping at every waypoint.
    ruckig_reason : str
        Why there is no motion of Ruckig's.
    """

    headline: Headline
    planner: str
    printed_saving: str
    printed_total: str
    total: float
    published_feasible: bool | None
    published_reason: str
    ours: Contestant
    feasible: int
    our_total: float
    saving_baseline: float
    saving_random: float
    a12_baseline: float
    a12_random: float
    p_baseline: float
    p_random: float
    reference: Reference
    above_optimum: float
    printed_above_optimum: float
    ruckig: Contestant | None
    ruckig_reason: str


def claim_cells(cases: Sequence[Case], effort: Effort) -> list[Cell]:
    """Cells of every headline: the paper's search, its opponent and random search, all the paper's own way."""
    cells: list[Cell] = []
    for case in cases:
        for headline in (one for one in HEADLINES if one.case == case.name):
            names = installed((case.planner, headline.baseline, "random-search"))
            cells += make_cells([case], [Spec(name) for name in names], effort.budget)
    return list(dict.fromkeys(cells))


def counterparts(
    cases: Mapping[str, Case], runs: Runs, cells: Sequence[Cell], references: Mapping[str, Reference]
) -> list[Counterpart]:
    """Lay every claim whose case was run beside its counterparts."""
    own = contestants(runs, cells, "own")
    found = []
    for headline in HEADLINES:
        if headline.case in cases and headline.case in references:
            by_name = {one.planner: one for one in own if one.case == headline.case}
            case = cases[headline.case]
            if {case.planner, headline.baseline, "random-search"} <= by_name.keys():
                found.append(_counterpart(headline, case, by_name, runs, references[headline.case]))
    return found


def _counterpart(
    headline: Headline, case: Case, by_name: Mapping[str, Contestant], runs: Runs, reference: Reference
) -> Counterpart:
    printed = claims(headline.paper)
    ours, baseline, chance = (by_name[name] for name in (case.planner, headline.baseline, "random-search"))
    total = printed[headline.total].value
    feasible, reason = _published(case, total)
    ruckig, ruckig_reason = _ruckig(case, runs)
    return Counterpart(
        headline,
        case.planner,
        printed[headline.saving].printed,
        printed[headline.total].printed,
        total,
        feasible,
        reason,
        ours,
        feasible=int(np.isfinite(ours.durations).sum()),
        our_total=_total(ours),
        saving_baseline=_saving(ours, baseline),
        saving_random=_saving(ours, chance),
        a12_baseline=statistics.a12(ours.totals, baseline.totals),
        a12_random=statistics.a12(ours.totals, chance.totals),
        p_baseline=statistics.signed_rank(ours.totals, baseline.totals),
        p_random=statistics.signed_rank(ours.totals, chance.totals),
        reference=reference,
        above_optimum=_total(ours) / reference.value - 1.0,
        printed_above_optimum=total / reference.value - 1.0,
        ruckig=ruckig,
        ruckig_reason=ruckig_reason,
    )


def _total(one: Contestant) -> float:
    return float(np.median(one.totals))


def _saving(first: Contestant, second: Contestant) -> float:
    """Share of the second's median total that the first saves."""
    return 1.0 - _total(first) / _total(second)


def _published(case: Case, total: float) -> tuple[bool | None, str]:
    """Judge the printed motion whose total is the claimed one."""
    near = [
        row
        for row in published_rows(case)
        if row.joint is None and row.duration is not None and abs(row.duration - total) < 0.006
    ]
    if not near:
        return None, "no printed segment durations add up to it"
    return near[0].feasible, near[0].reason


def _ruckig(case: Case, runs: Runs) -> tuple[Contestant | None, str]:
    cells = [cell for cell in runs if cell.case == case.name and cell.planner == "ruckig-stops"]
    found = contestants(runs, cells, "free path")
    if found and np.isfinite(found[0].median):
        return found[0], ""
    return None, next((runs[cell].message or "infeasible" for cell in cells), "Ruckig is not installed")
