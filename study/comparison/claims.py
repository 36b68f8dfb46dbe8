"""The five papers' headline claims, each beside its honest counterparts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from study.analysis.published import published_methods
from study.cases.library import Case
from study.cases.published import claims as printed_claims
from study.comparison import statistics
from study.comparison.contestants import Contestant, Level, Reference, Runs, contestants, installed
from study.comparison.effort import Effort
from study.comparison.ranking import difference, levelled
from study.comparison.statistics import Interval
from study.problem import Floats
from study.runs.lineup import Spec, make_cells
from study.store.results import Cell


@dataclass(frozen=True)
class Headline:
    """A paper's headline claim and its counterparts here.

    Attributes
    ----------
    paper, case : str
    saving, total : str
        Ids of the paper's claims: the share of time saved, and the total time after it.
    against : str
        Opponent in the paper.
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


@dataclass(frozen=True)
class Against:
    """Totals of a search against another's at the same budget, on paired seeds.

    Attributes
    ----------
    difference : Interval, optional
        Median of the first minus the second, as a share of the second's median; None where a run gave no motion.
    a12 : float
        Probability that a run of the first is shorter.
    p : float
        Signed rank, adjusted by Holm for the claims.
    """

    difference: Interval | None
    a12: float
    p: float


@dataclass(frozen=True, eq=False)
class Counterpart:
    """A claim beside the same search in a fair comparison.

    Attributes
    ----------
    headline : Headline
    printed_saving, printed_total : str
        As the paper prints them.
    total : float, s
    published_feasible : bool, optional
        Whether the printed motion passes the judge; None where it cannot be judged.
    published_reason : str
    ours : Contestant
        The paper's search run the paper's own way.
    against_baseline, against_random : Against
        The baseline planner and random search.
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
    printed_saving: str
    printed_total: str
    total: float
    published_feasible: bool | None
    published_reason: str
    ours: Contestant
    against_baseline: Against
    against_random: Against
    reference: Reference
    above_optimum: float
    printed_above_optimum: float
    ruckig: Contestant | None
    ruckig_reason: str


def claim_cells(cases: Sequence[Case], effort: Effort) -> list[Cell]:
    """Cells of every headline: the paper's search, its opponent and random search, all the paper's own way."""
    cells: list[Cell] = []
    for case in cases:
        for headline in (headline for headline in HEADLINES if headline.case == case.name):
            names = installed((case.planner, headline.baseline, "random-search"))
            cells += make_cells([case], [Spec(name) for name in names], effort.budget)
    return list(dict.fromkeys(cells))


def counterparts(
    cases: Mapping[str, Case], runs: Runs, cells: Sequence[Cell], references: Mapping[str, Reference]
) -> list[Counterpart]:
    """Lay every claim whose case was run beside its counterparts."""
    own = contestants(runs, cells, Level.OWN)
    beside = []
    for headline in HEADLINES:
        if headline.case in cases and headline.case in references:
            by_name = {contestant.planner: contestant for contestant in own if contestant.case == headline.case}
            case = cases[headline.case]
            if {case.planner, headline.baseline, "random-search"} <= by_name.keys():
                beside.append(_counterpart(headline, case, by_name, runs, references[headline.case]))
    return _adjusted(beside)


def _counterpart(
    headline: Headline, case: Case, by_name: Mapping[str, Contestant], runs: Runs, reference: Reference
) -> Counterpart:
    printed = printed_claims(headline.paper)
    ours, baseline, chance = (by_name[name] for name in (case.planner, headline.baseline, "random-search"))
    total = printed[headline.total].value
    feasible, reason = _published(case, total)
    ruckig, ruckig_reason = _ruckig(case, runs)
    return Counterpart(
        headline,
        printed[headline.saving].printed,
        printed[headline.total].printed,
        total,
        feasible,
        reason,
        ours,
        against_baseline=against(ours.totals, baseline.totals),
        against_random=against(ours.totals, chance.totals),
        reference=reference,
        above_optimum=ours.total / reference.value - 1.0,
        printed_above_optimum=total / reference.value - 1.0,
        ruckig=ruckig,
        ruckig_reason=ruckig_reason,
    )


def against(first: Floats, second: Floats) -> Against:
    """Compare the totals of two searches, s; the p-value is not adjusted yet."""
    base = float(np.median(second))
    ours, theirs = (levelled(totals, base if np.isfinite(base) else 1.0) for totals in (first, second))
    return Against(difference(ours, theirs), statistics.a12(ours, theirs), statistics.signed_rank(ours, theirs))


def _adjusted(beside: Sequence[Counterpart]) -> list[Counterpart]:
    """Adjust the p-values for how many claims stand together, opponent by opponent."""
    for name in ("against_baseline", "against_random"):
        p_values = statistics.holm([getattr(claim, name).p for claim in beside])
        beside = [
            replace(claim, **{name: replace(getattr(claim, name), p=float(p))})
            for claim, p in zip(beside, p_values, strict=True)
        ]
    return list(beside)


def _published(case: Case, total: float) -> tuple[bool | None, str]:
    """Judge the printed motion whose total is the claimed one."""
    near = [
        method
        for method in published_methods(case)
        if method.joint is None and method.judged_duration is not None and abs(method.judged_duration - total) < 0.006
    ]
    if not near:
        return None, "no printed segment durations add up to it"
    return near[0].feasible, near[0].reason


def _ruckig(case: Case, runs: Runs) -> tuple[Contestant | None, str]:
    cells = [cell for cell in runs if cell.case == case.name and cell.planner == "ruckig-stops"]
    moved = contestants(runs, cells, Level.FREE)
    if moved and np.isfinite(moved[0].median):
        return moved[0], ""
    return None, next((runs[cell].message or "infeasible" for cell in cells), "Ruckig is not installed")
