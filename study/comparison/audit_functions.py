"""The invariance audit on functions: does a search's error depend on where the optimum lies?

References
----------
Kudela, A critical problem in benchmarking and analysis of evolutionary computation methods, Nat. Mach. Intell. 4
(2022); The evolutionary computation methods no one should use (2023): the ratio of the errors with the optimum moved
away from and at the centre, its geometric mean over functions, and the alarm level of 10.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from study.analysis.formatting import listed, ratio
from study.analysis.tables import Column, Grid, grid
from study.comparison.effort import Effort
from study.comparison.outcomes import FLOOR, Outcomes, grouped
from study.comparison.plots import Mark, Marks
from study.comparison.tables import FLAG, PlannerColumn
from study.comparison.tasks import DOSES, FunctionView
from study.comparison.trials import Trial, TrialJob, repeated
from study.search.state import Search

ALARM = 10.0
AXES = "↻"
"""Marks a search whose error grows beyond the alarm when the axes are turned."""

STANDARD = ("pso", "de")
"""Searches that the audit should not flag."""

LEAST = 1e-3
"""Smallest error ratio that the figure shows."""

PRINTED = "-as-printed"
"""Ending of the names of searches that follow a paper's formulas exactly as printed."""


def function_jobs(searches: Mapping[str, Search[Any]], effort: Effort) -> list[TrialJob]:
    """List every search on every view of every function, from every seed."""
    budget = effort.population * effort.generations
    return [
        job
        for name, search in searches.items()
        for function in effort.functions
        for view in (
            FunctionView
            if function in effort.dosed
            else (FunctionView.ORIGIN, FunctionView.SHIFTED, FunctionView.ROTATED)
        )
        for job in repeated(
            Trial(name, function, view, 0, budget, effort.population, effort.dimensions), search, effort.function_seeds
        )
    ]


Average = Callable[[np.ndarray], Any]


def error_ratio(moved: np.ndarray, home: np.ndarray, average: Average = np.mean) -> float:
    """Average error in one view over that in another, neither taken below the floor."""
    return float(max(float(average(moved)), FLOOR) / max(float(average(home)), FLOOR))


def geometric_mean(ratios: Sequence[float]) -> float:
    """Geometric mean; not a number where there is none."""
    return float(np.exp(np.mean(np.log(ratios)))) if len(ratios) else float("nan")


@dataclass(frozen=True)
class FunctionFinding:
    """Error ratios of a search on the functions.

    Attributes
    ----------
    search : str
    by_function : mapping of str to float
        Error with the optimum shifted over error with it at the origin.
    shifted : float
        Geometric mean of these.
    rotated : float
        Shifted and rotated over shifted, geometric mean: the cost of turned axes.
    doses : mapping of str to float
        Every shift of the dose test over the origin, geometric mean.
    diagonal : float
        Optimum off the diagonal over on it, geometric mean of ratios of medians: a few runs stuck on a wall of the box
        would decide over a mean.
    """

    search: str
    by_function: Mapping[str, float]
    shifted: float
    rotated: float
    doses: Mapping[str, float]
    diagonal: float

    @property
    def on_axes(self) -> bool:
        """True if the result depends on the directions of the axes."""
        return self.rotated > ALARM


def function_findings(outcomes: Outcomes) -> list[FunctionFinding]:
    """Judge every search on the functions, in the order of their ratios."""
    values = grouped({trial: outcome for trial, outcome in outcomes.items() if trial.dimensions})
    names = dict.fromkeys(key[0] for key in values)
    functions = list(dict.fromkeys(key[1] for key in values))

    def ratios(name: str, moved: str, home: str, average: Average = np.mean) -> dict[str, float]:
        pairs = {f: (values.get((name, f, "", moved)), values.get((name, f, "", home))) for f in functions}
        return {f: error_ratio(a, b, average) for f, (a, b) in pairs.items() if a is not None and b is not None}

    def mean(name: str, moved: str, home: str, average: Average = np.mean) -> float:
        return geometric_mean(list(ratios(name, moved, home, average).values()))

    findings = [
        FunctionFinding(
            search=name,
            by_function=ratios(name, FunctionView.SHIFTED, FunctionView.ORIGIN),
            shifted=mean(name, FunctionView.SHIFTED, FunctionView.ORIGIN),
            rotated=mean(name, FunctionView.ROTATED, FunctionView.SHIFTED),
            doses={dose: mean(name, dose, FunctionView.ORIGIN) for dose in DOSES},
            diagonal=mean(name, FunctionView.OFF_DIAGONAL, FunctionView.DIAGONAL, np.median),
        )
        for name in names
    ]
    return sorted(findings, key=lambda finding: (-finding.shifted, finding.search))


def function_columns(findings: Sequence[FunctionFinding]) -> list[Column[FunctionFinding]]:
    """Columns of the findings, which follow the functions and doses of the effort."""
    doses = list(findings[0].doses) if findings else []
    functions = list(findings[0].by_function) if findings else []

    def dosed(dose: str) -> Column[FunctionFinding]:
        head = "" if dose == FunctionView.SHIFTED else f"{dose} / origin"  # the first column shows the largest dose
        return Column(f"ratio {dose}", head, lambda finding: finding.doses[dose], ratio)

    def shifted(name: str) -> Column[FunctionFinding]:
        return Column(f"ratio_shifted {name}", f"{name}, shifted", lambda finding: finding.by_function[name], ratio)

    return [
        PlannerColumn("search", "Search", lambda finding: finding.search),
        Column("ratio_shifted", "Shifted / origin", lambda finding: finding.shifted, ratio),
        Column("ratio_rotated", "Rotated / shifted", lambda finding: finding.rotated, _turned),
        Column("ratio_diagonal", "Off / on the diagonal", lambda finding: finding.diagonal, ratio),
        *map(dosed, doses),
        *map(shifted, functions),
    ]


def _turned(rotated: float) -> str:
    return ratio(rotated) + (f" {AXES}" if rotated > ALARM else "")


def function_grid(findings: Sequence[FunctionFinding], flags: Mapping[str, str]) -> Grid:
    """Error ratios of every search."""
    return grid(
        "Mean error with the optimum moved over mean error with it at home; geometric means over functions, then every "
        "function by itself. Above 10 is the alarm: off the origin by three tenths of the half range, or off the diagonal, "
        f"it raises the flag {FLAG}; smaller doses show how small a move is enough; with the axes turned it sets the mark "
        f"{AXES}.",
        function_columns(findings),
        findings,
        flags,
    )


def function_plot(findings: Sequence[FunctionFinding]) -> Marks:
    """Every search's error ratios against the alarm level."""
    dots = [Mark(finding.search, max(finding.shifted, LEAST), "o") for finding in findings]
    diamonds = [Mark(finding.search, max(finding.diagonal, LEAST), "D", filled=False) for finding in findings]
    return Marks(
        "ratios",
        "Error ratios",
        "Geometric means over functions; the numbers stand in the table.",
        [*dots, *diamonds],
        "error ratio: dot, off the origin; diamond, off the diagonal; dashed: 10",
        edges=(ALARM,),
        logarithmic=True,
    )


def named(searches: Mapping[str, str]) -> str:
    """List searches with a remark each, those that follow the papers as printed by their number only."""
    own = [f"{name}{remark}" for name, remark in searches.items() if not name.endswith(PRINTED)]
    printed = len(searches) - len(own)
    return listed([*own, *([f"{printed} as printed"] if printed else [])]) or "none"


def functions_audited(findings: Sequence[FunctionFinding]) -> str:
    """Say whom the functions flag, and how the standard searches stand."""
    flagged = {finding.search: f" ({ratio(finding.shifted)})" for finding in findings if finding.shifted > ALARM}
    standard = [finding for finding in findings if finding.search in STANDARD]
    plain = listed([f"{finding.search} ({ratio(finding.shifted)})" for finding in standard])
    rest = f" Not flagged: {plain}." if all(finding.shifted <= ALARM for finding in standard) else ""
    return (
        f"On the functions the error of {len(flagged)} of {len(findings)} searches grows more than "
        f"{ALARM:g}-fold when the optimum leaves the origin: {named(flagged)}.{rest}"
    )


def axes_audited(findings: Sequence[FunctionFinding]) -> str:
    """Say whose result depends on the directions of the axes."""
    turned = [f"{finding.search} ({ratio(finding.rotated)})" for finding in findings if finding.on_axes]
    return (
        f"The error of {len(turned)} of {len(findings)} searches grows more than {ALARM:g}-fold when the axes of the functions are "
        f"turned about the optimum: {listed(turned) or 'none'}. Such a search gains from functions that fall apart into single "
        f"coordinates; that is no pull to a place, so it raises no flag, and is marked {AXES} here."
    )
