"""The ablations that the papers owe: every improvement by itself against the plain search, on paired seeds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

import numpy as np
from markupsafe import Markup

from study.analysis.formatting import listed, seconds
from study.analysis.tables import Cell, Column, Grid, grid
from study.cases.library import Case
from study.comparison import statistics
from study.comparison.effort import Effort
from study.comparison.improvements import ABLATIONS, PLAIN, WHOLE, Ablation
from study.comparison.outcomes import FLOOR, SIGNIFICANT, Outcomes, grouped
from study.comparison.plots import Mark, Marks
from study.comparison.statistics import Interval
from study.comparison.tables import IntervalColumn, interval_text, p_value, probability
from study.comparison.tasks import FunctionView, TrajectoryView
from study.comparison.trials import Trial, TrialJob, repeated
from study.search.state import Search

FUNCTIONS = ("sphere", "rastrigin")
VIEWS = (FunctionView.ORIGIN, FunctionView.SHIFTED)


class Effect(StrEnum):
    """Effect of an improvement: large by A12, significant, and with an interval that excludes zero, or none."""

    HELPS = "helps"
    HARMS = "harms"
    NONE = "none"


def ablation_jobs(cases: Sequence[Case], effort: Effort) -> list[TrialJob]:
    """List every form of every paper's search on the paper's own cases, the audit's cases and the functions."""
    audited = set(effort.audited([case.name for case in cases]))
    jobs: list[TrialJob] = []
    for ablation in ABLATIONS:
        chosen = [case for case in cases if case.name in audited or case.paper == ablation.paper]
        for form, search in ablation.forms.items():
            jobs += _form_jobs(f"{ablation.paper}: {form}", search, chosen, effort)
    return jobs


def _form_jobs(name: str, search: Search[Any], cases: Sequence[Case], effort: Effort) -> list[TrialJob]:
    n, population = effort.trial_evaluations, effort.population
    jobs: list[TrialJob] = []
    for case in cases:
        trial = Trial(name, case.name, TrajectoryView.AS_IT_IS, 0, n, population, formulation="penalty")
        jobs += repeated(trial, search, effort.trial_seeds, case.problem, case.curve)
    for function in FUNCTIONS:
        for view in VIEWS:
            trial = Trial(name, function, view, 0, population * effort.generations, population, effort.dimensions)
            jobs += repeated(trial, search, effort.trial_seeds)
    return jobs


@dataclass(frozen=True)
class AblationFinding:
    """Effect of an improvement by itself on a task, against the plain search on paired seeds.

    Attributes
    ----------
    paper, improvement, task, view : str
    trajectory : bool
        Whether the task is a trajectory problem; otherwise a function.
    plain, improved : float
        Median results: total time in s, or error.
    a12 : float
        Probability that a run with the improvement ends lower.
    difference : Interval
        Median of improved minus plain, as a share of the plain median for trajectories, in decades for functions.
    p : float
        Signed rank, adjusted by Holm for the forms of the same paper on the same view of the same task.
    """

    paper: str
    improvement: str
    task: str
    view: str
    trajectory: bool
    plain: float
    improved: float
    a12: float
    difference: Interval
    p: float

    @property
    def effect(self) -> Effect:
        """Effect that counts."""
        strong = max(self.a12, 1 - self.a12) >= statistics.LARGE and self.p < SIGNIFICANT
        if not (strong and self.difference.excludes_zero):
            return Effect.NONE
        return Effect.HELPS if self.a12 > 0.5 else Effect.HARMS


def ablation_findings(outcomes: Outcomes) -> list[AblationFinding]:
    """Compare every form with the plain one on every task."""
    families: dict[tuple[str, str, str], list[AblationFinding]] = {}
    for finding in _unadjusted(grouped(outcomes)):
        families.setdefault((finding.paper, finding.task, finding.view), []).append(finding)
    return [
        replace(finding, p=float(p))
        for family in families.values()
        for finding, p in zip(family, statistics.holm([member.p for member in family]), strict=True)
    ]


def _unadjusted(values: Mapping[tuple[str, str, str, str], np.ndarray]) -> Iterator[AblationFinding]:
    for ablation in ABLATIONS:
        for form in [*ablation.improvements, WHOLE]:
            for (name, task, formulation, view), plain in values.items():
                improved = values.get((f"{ablation.paper}: {form}", task, formulation, view))
                if name == f"{ablation.paper}: {PLAIN}" and improved is not None:
                    yield _finding((ablation.paper, form, task, view), bool(formulation), plain, improved)


def _finding(
    subject: tuple[str, str, str, str], trajectory: bool, plain: np.ndarray, improved: np.ndarray
) -> AblationFinding:
    if trajectory:
        first, second = improved / np.median(plain), plain / np.median(plain)
    else:  # errors span hundreds of decades
        first, second = (np.log10(np.maximum(values, FLOOR)) for values in (improved, plain))
    return AblationFinding(
        *subject,
        trajectory,
        float(np.median(plain)),
        float(np.median(improved)),
        statistics.a12(first, second),
        statistics.median_difference(first, second),
        statistics.signed_rank(first, second),
    )


def _difference(finding: AblationFinding) -> str:
    ends = finding.difference
    if finding.trajectory:
        return interval_text(ends)
    return f"{ends.estimate:+.2f} ({ends.lower:+.2f} to {ends.upper:+.2f})"


def _median(finding: AblationFinding, value: float) -> str:
    return seconds(value) if finding.trajectory else f"{value:.2g}"


COLUMNS: tuple[Column[AblationFinding], ...] = (
    Column("paper", "", lambda finding: finding.paper),
    Column("improvement", "Improvement", lambda finding: finding.improvement),
    Column("", "Task", lambda finding: finding.task if finding.trajectory else f"{finding.task}, {finding.view}"),
    Column("task", "", lambda finding: finding.task),
    Column("view", "", lambda finding: finding.view),
    Column("kind", "", lambda finding: "trajectory" if finding.trajectory else "function"),
    Column("plain_median", "", lambda finding: finding.plain),
    Column("improved_median", "", lambda finding: finding.improved),
    Column("", "Plain", lambda finding: _median(finding, finding.plain)),
    Column("", "Improved", lambda finding: _median(finding, finding.improved)),
    Column("a12", "A12", lambda finding: finding.a12, probability),
    IntervalColumn("difference", "", lambda finding: finding.difference),
    Column("", "Median difference (95 %)", _difference),
    Column(
        "difference_unit", "", lambda finding: "share of the plain median" if finding.trajectory else "decades of error"
    ),
    Column("signed_rank_p_holm", "Signed rank p", lambda finding: finding.p, p_value),
    Column("effect", "Effect", lambda finding: finding.effect),
)


def ablation_grid(ablation: Ablation, findings: Sequence[AblationFinding]) -> Grid:
    """Every improvement of a paper on every task."""
    return grid(
        f"{ablation.title}: each improvement by itself against the plain search ({PLAIN}: {ablation.plain}), on paired seeds; "
        "differences in percent of the plain median for trajectories, in decades of error for functions.",
        COLUMNS,
        findings,
        {},
        names=2,
    )


def ablation_plot(ablation: Ablation, findings: Sequence[AblationFinding]) -> Marks:
    """Probability that an improvement helps: a row for each, a mark for each task."""
    return Marks(
        f"effects-{ablation.paper}",
        f"Ablation of {ablation.title}",
        "Effect sizes of the improvements; the numbers stand in the table.",
        [_mark(finding) for finding in findings],
        "A12: circle, trajectory; triangle, function; filled: significant",
        line=0.5,
        heading=ablation.title,
        edges=(1 - statistics.LARGE, statistics.LARGE),
        span=(0.0, 1.0),
    )


def _mark(finding: AblationFinding) -> Mark:
    shape, offset = ("o", -0.15) if finding.trajectory else ("^", 0.15)
    note = f"{_task(finding)}: A12 {finding.a12:.2f}, {finding.effect if finding.effect is not Effect.NONE else 'no effect that counts'}"
    return Mark(finding.improvement, finding.a12, shape, finding.effect is not Effect.NONE, offset, note)


def of_paper(findings: Sequence[AblationFinding], ablation: Ablation) -> list[AblationFinding]:
    """Findings on a paper's improvements."""
    return [finding for finding in findings if finding.paper == ablation.paper]


SIGNS = {Effect.HELPS: '<span class="good">+</span>', Effect.HARMS: '<span class="bad">−</span>', Effect.NONE: ""}
UNTRIED = "·"


def matrix(findings: Sequence[AblationFinding]) -> Grid:
    """Effect of every improvement, a row, on every task, a column: it helps, it harms, or neither."""
    tasks = list(dict.fromkeys(map(_task, sorted(findings, key=lambda finding: not finding.trajectory))))
    rows: list[list[Cell]] = []
    for ablation in ABLATIONS:
        for name in (*ablation.improvements, WHOLE):
            own = {_task(f): f.effect for f in findings if f.paper == ablation.paper and f.improvement == name}
            if own:
                cells = [Markup(SIGNS[own[task]]) if task in own else UNTRIED for task in tasks]  # noqa: S704 - our own
                rows.append([ablation.title, name, *cells])
    caption = (
        "+ helps, − harms, blank: neither that counts; a dot: not tried there. Trajectory problems first, then functions "
        "with the optimum at the origin and shifted."
    )
    return Grid(caption, ["Search", "Improvement", *tasks], rows, names=2)


def _task(finding: AblationFinding) -> str:
    return finding.task if finding.trajectory else f"{finding.task}, {finding.view}"


def matters(findings: Sequence[AblationFinding]) -> str:
    """Say how many improvements matter at all."""
    single = [finding for finding in findings if finding.improvement != WHOLE]

    def helping(trajectory: bool) -> list[str]:
        helps = [f for f in single if f.effect is Effect.HELPS and f.trajectory is trajectory]
        names = {(finding.paper, finding.improvement) for finding in helps}
        return [name for paper, name in every if (paper, name) in names]

    every = list(dict.fromkeys((finding.paper, finding.improvement) for finding in single))
    arms = helping(True)
    return (
        f"Improvements that help by themselves on at least one trajectory problem: {len(arms)} of {len(every)}"
        f"{f' ({listed(arms)})' if arms else ''}; on at least one function: {len(helping(False))}."
    )
