"""The invariance audit on trajectory problems: does a result depend on how the durations are written?"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from study.analysis.formatting import seconds
from study.analysis.tables import Column, Grid, grid
from study.cases.library import Case
from study.comparison import statistics
from study.comparison.audit_functions import named
from study.comparison.effort import Effort
from study.comparison.outcomes import SIGNIFICANT, Outcomes, grouped
from study.comparison.plots import Mark, Marks
from study.comparison.tables import PlannerColumn, p_value, probability
from study.comparison.tasks import TrajectoryView
from study.comparison.trials import Trial, TrialJob, repeated
from study.search.state import Search


def trajectory_jobs(
    searches: Mapping[str, Search[Any]], cases: Iterable[Case], effort: Effort, formulations: Sequence[str]
) -> list[TrialJob]:
    """List every search on every view of every case's durations, from every seed."""
    n, population = effort.trial_evaluations, effort.population
    return [
        job
        for name, search in searches.items()
        for case in cases
        for formulation in formulations
        for view in TrajectoryView
        for job in repeated(
            Trial(name, case.name, view, 0, n, population, formulation=formulation),
            search,
            effort.trial_seeds,
            case.problem,
            case.curve,
        )
    ]


@dataclass(frozen=True)
class TrajectoryFinding:
    """A search on a case and formulation: its durations as they are against another way to write them.

    Attributes
    ----------
    search, case, formulation, view : str
    as_they_are, seen : float, s
        Median best total time, as they are and in the view.
    a12 : float
        Probability that a run with the durations as they are ends shorter.
    p : float
        Rank sum, adjusted by Holm for all findings of the audit.
    """

    search: str
    case: str
    formulation: str
    view: str
    as_they_are: float
    seen: float
    a12: float
    p: float

    @property
    def depends(self) -> bool:
        """True if the result depends on how the durations are written, significantly and by a large effect."""
        return self.p < SIGNIFICANT and max(self.a12, 1.0 - self.a12) >= statistics.LARGE

    @property
    def flattered(self) -> bool:
        """True if it is better with the durations as they are."""
        return self.depends and self.a12 > 0.5


def trajectory_findings(outcomes: Outcomes) -> list[TrajectoryFinding]:
    """Compare the views of every search, case and formulation."""
    values = grouped({trial: outcome for trial, outcome in outcomes.items() if trial.formulation})
    keys = [
        (name, case, form, view)
        for name, case, form, view in values
        if view != TrajectoryView.AS_IT_IS and (name, case, form, TrajectoryView.AS_IT_IS) in values
    ]
    pairs = [
        (values[name, case, form, TrajectoryView.AS_IT_IS], values[name, case, form, view])
        for name, case, form, view in keys
    ]
    adjusted = statistics.holm([statistics.rank_sum(home, seen) for home, seen in pairs])
    return [
        TrajectoryFinding(*key, float(np.median(home)), float(np.median(seen)), statistics.a12(home, seen), float(p))
        for key, (home, seen), p in zip(keys, pairs, adjusted, strict=True)
    ]


TRAJECTORY_COLUMNS: tuple[Column[TrajectoryFinding], ...] = (
    PlannerColumn("search", "Search", lambda finding: finding.search),
    Column("case", "Case", lambda finding: finding.case),
    Column("formulation", "Formulation", lambda finding: finding.formulation),
    Column("view", "View", lambda finding: finding.view),
    Column("median_as_they_are_s", "As they are", lambda finding: finding.as_they_are, seconds),
    Column("median_seen_s", "In the view", lambda finding: finding.seen, seconds),
    Column("a12", "A12", lambda finding: finding.a12, probability),
    Column("rank_sum_p_holm", "Rank sum p", lambda finding: finding.p, p_value),
    Column("depends", "", lambda finding: finding.depends),
)


def trajectory_grid(findings: Sequence[TrajectoryFinding], flags: Mapping[str, str]) -> Grid:
    """Every search, case and formulation, a row for each view."""
    return grid(
        "Median best total time with the durations as they are, and reflected (lo + hi - t) or in a box centred at zero; A12 "
        "is the probability that a run with them as they are ends shorter; rank sum p, adjusted by Holm for all rows.",
        TRAJECTORY_COLUMNS,
        findings,
        flags,
        names=4,
    )


def trajectory_plots(findings: Sequence[TrajectoryFinding]) -> list[Marks]:
    """Changes of every search's median in the other views; one figure for each case and formulation."""
    groups: dict[tuple[str, str], list[TrajectoryFinding]] = {}
    for finding in findings:
        groups.setdefault((finding.case, finding.formulation), []).append(finding)
    return [
        _plot(f"views-{number}", f"{case}, {formulation} formulation", group)
        for number, ((case, formulation), group) in enumerate(groups.items())
    ]


def _plot(key: str, case: str, findings: Sequence[TrajectoryFinding]) -> Marks:
    return Marks(
        key,
        f"Views of {case}",
        "Change of the median time; the numbers stand in the table.",
        [_mark(finding) for finding in findings],
        f"change of the median, %: circle {TrajectoryView.REFLECTED}, square {TrajectoryView.CENTRED}; filled: significant",
        line=0.0,
        heading=case,
    )


def _mark(finding: TrajectoryFinding) -> Mark:
    shape, offset = ("o", -0.15) if finding.view == TrajectoryView.REFLECTED else ("s", 0.15)
    return Mark(finding.search, 100 * (finding.seen / finding.as_they_are - 1), shape, finding.depends, offset)


def trajectories_audited(findings: Sequence[TrajectoryFinding]) -> str:
    """Say on which trajectory problems a result depends on the view."""
    names = {finding.search for finding in findings}
    depends = [finding for finding in findings if finding.depends]
    if not depends:
        return (
            f"On the trajectory problems no result of {len(names)} searches depends significantly on how the durations "
            "are written."
        )
    by_search = dict.fromkeys((finding.search for finding in depends), "")
    worst = max(depends, key=lambda finding: abs(math.log(finding.seen / finding.as_they_are)))
    flattered = len({finding.search for finding in depends if finding.flattered})
    return (
        f"On the trajectory problems the results of {len(by_search)} of {len(names)} searches depend on how the durations are "
        f"written ({named(by_search)}), {flattered} of these with a better result for the durations as they are, which "
        f"a pull to zero flatters. The largest change: {worst.search} on {worst.case} takes {seconds(worst.as_they_are)} with "
        f"the durations as they are and {seconds(worst.seen)} with them {worst.view}."
    )
