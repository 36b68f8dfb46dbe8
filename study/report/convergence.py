"""Convergence of the searches: the median and the quartiles over seeds, on a common grid of evaluations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from study.analysis.case_summary import CaseSummary
from study.analysis.methods import MethodSummary
from study.cases.library import Case
from study.problem import Floats
from study.report import figures, plot_style
from study.report.live import convergence_data
from study.store.results import Result

POINTS = 240


@dataclass(frozen=True)
class ConvergencePart:
    """The figure, wide and narrow, and the legend that goes with it."""

    figures: dict[str, Markup]
    data: Markup
    legend: tuple[tuple[int, str], ...]


def convergence_of(summary: CaseSummary, widths: Mapping[str, float]) -> ConvergencePart | None:
    """Draw the paper's own planner and the best other searches; None where no search left a history.

    Parameters
    ----------
    summary : CaseSummary
        Its methods are ranked, so the first searches are the best; its deterministic optimum is the line to reach.
    widths : mapping of str to float
        Pixels of every figure.
    """
    case = summary.case
    curves = [_curve(case, method, summary.slots[method.label]) for method in summary.converging]
    if not curves:
        return None
    plain = summary.best.optimiser
    reference = (plain.label, plain.duration) if plain and plain.feasible and plain.duration else None
    legend = tuple((curve.style, curve.label) for curve in curves)
    drawings = {
        name: figures.convergence(f"convergence-{name}", curves, reference, width) for name, width in widths.items()
    }
    shortest = figures.shortest_of(curves, reference)
    return ConvergencePart(drawings, convergence_data(curves, shortest), legend)


def _curve(case: Case, method: MethodSummary, style: int) -> plot_style.Convergence:
    first = min(run.history[0, 0] for run in method.results)
    last = max(run.history[-1, 0] for run in method.results)
    grid: Floats = np.unique(np.round(np.geomspace(max(first, 1.0), max(last, 1.0), POINTS))).astype(np.float64)
    values = np.stack([_on_grid(case, run, grid) for run in method.results])
    # a run without a feasible candidate counts as infinitely long, so that it does not flatter the median
    lower, median, upper = np.quantile(values, (0.25, 0.5, 0.75), axis=0, method="nearest")
    median = np.median(values, axis=0) if np.isfinite(values).all() else median
    return plot_style.Convergence(method.label, style, grid, *(_shown(line) for line in (median, lower, upper)))


def _on_grid(case: Case, result: Result, grid: Floats) -> Floats:
    """Best value so far at every grid point, s; infinite before there is a feasible candidate."""
    at = np.searchsorted(result.history[:, 0], grid, side="right") - 1
    values = np.where(at >= 0, result.history[at, 1], np.inf)
    if result.cell.settings.formulation == "penalty":
        # the penalty adds more than the longest total in the box, so what is above that total is infeasible
        ceiling = case.problem.n_segments * case.problem.duration_bounds[1]
        values = np.where(values > ceiling, np.inf, values)
    return np.asarray(values)


def _shown(values: Floats) -> Floats:
    return np.where(np.isfinite(values), values, np.nan)
