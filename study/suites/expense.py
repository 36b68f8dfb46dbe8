"""Wall time of a suite's whole line-up, reckoned from the runs that are committed."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from study.analysis.formatting import plural, wall
from study.bounds import is_stochastic
from study.cases.suites import PAPERS, Suite
from study.registry import method_named
from study.store.results import Cell
from study.suites.lineups import suite_cells, usual_lineup
from study.suites.measures import Field
from study.suites.runs import Run


def expense(suite: Suite, field: Field) -> str:
    """Say what the whole line-up of a suite costs on one processor, and how much of it is committed; empty for the papers.

    A cell costs the median of the committed runs of its planner on its problem with its budget, or, without such runs, of all
    budgets in proportion to the evaluations. Without these it costs the planner's median for one segment times the segments,
    and never more than its time limit.
    """
    if suite.name == PAPERS:
        return ""
    cells = suite_cells(suite.cases.values(), usual_lineup(suite), quick=False)
    seconds = _seconds(cells, field.runs, {name: case.problem.n_segments for name, case in suite.cases.items()})
    if not seconds:
        return ""
    by_budget = defaultdict[int, list[float]](list)
    for cell, cost in seconds.items():
        by_budget[_budget(cell)].append(cost)
    there = {(run.problem, run.planner, run.evaluations, run.seed) for run in field.runs}
    kept = sum((cell.case, cell.planner, _budget(cell), cell.settings.seed) in there for cell in cells)
    each = [
        f"{plural(len(costs), 'cell')} {f'of {budget:,} evaluations' if budget else 'without a search'} {wall(float(np.mean(costs)))} each"
        for budget, costs in sorted(by_budget.items())
    ]
    unknown = len(cells) - len(seconds)
    left = f" {plural(unknown, 'cell')} of planners without a committed run are not in it." if unknown else ""
    return (
        f"The whole line-up has {len(cells):,} cells, {kept:,} of them committed, and takes about {sum(seconds.values()) / 3600:.2g} h on one "
        f"processor: {', '.join(each)} in the mean.{left}"
    )


def _budget(cell: Cell) -> int:
    return cell.settings.evaluations if is_stochastic(method_named(cell.planner)) else 0


def _seconds(cells: Sequence[Cell], runs: Sequence[Run], segments: dict[str, int]) -> dict[Cell, float]:
    """Wall time of every cell, s; without those of planners of which no run is committed."""
    exactly, on = defaultdict[tuple[str, str, int], list[float]](list), defaultdict[tuple[str, str], list[float]](list)
    usual = defaultdict[str, list[float]](list)
    for run in runs:
        rate = run.wall_time / (run.evaluations or 1)
        exactly[run.planner, run.problem, run.evaluations].append(rate)
        on[run.planner, run.problem].append(rate)
        usual[run.planner].append(rate / run.segments)
    costs = {}
    for cell in cells:
        if cell.planner not in usual:
            continue
        known = exactly.get((cell.planner, cell.case, _budget(cell))) or on.get((cell.planner, cell.case))
        rate = float(np.median(known)) if known else float(np.median(usual[cell.planner])) * segments[cell.case]
        costs[cell] = min(rate * (_budget(cell) or 1), cell.settings.time_limit)
    return costs
