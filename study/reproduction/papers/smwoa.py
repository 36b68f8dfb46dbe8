"""The UR5 paper on SMWOA: benchmark table with its ranks, durations of Table 6, claims."""

from __future__ import annotations

import numpy as np
from scipy import stats

from study.cases.library import load_case
from study.cases.published import Table, claims, tables
from study.planners import smwoa as planners
from study.problem import Floats
from study.reproduction import rules
from study.reproduction.benchmark_table import BenchmarkTable
from study.reproduction.common import (
    Drive,
    Panel,
    Rulings,
    Statement,
    inputs,
    line_of,
    optima,
    percentage,
    row_of,
    settings,
)
from study.reproduction.duration_rows import Row, rule
from study.reproduction.effort import Effort
from study.reproduction.jobs import Job, Runs
from study.reproduction.motion_runs import MotionCell, OptimumCell, Summary, summarised
from study.reproduction.verdicts import Outcome, Place, claim, missing
from study.testfunctions import benchmarks_of

PAPER = "ur5-smwoa"
CASE = "ur5-bspline"
SEARCHES = {
    "SMA": planners.SMA_PLANNER.search,
    "WOA": planners.WOA_PLANNER.search,
    "SMWOA": planners.SMWOA_PLANNER.search,
}
AS_PRINTED = {"SMA": planners.SMA_AS_PRINTED.search, "SMWOA": planners.SMWOA_AS_PRINTED.search}
SEGMENTS = ("h1", "h2", "h3", "h4", "h5")
USED = ("benchmark-count", "benchmark-population", "benchmark-iterations", "benchmark-runs", "population", "iterations")
STATEMENTS = (
    Statement("ranks-unimodal", "Section 3.3", "SMWOA is first on F1, F2, F3 and F5"),
    Statement("ranks-multimodal", "Section 3.3", "SMWOA is first on F7, F8 and F10, second on F6 and F9"),
    Statement("ranks-low", "Section 3.3", "SMWOA is first on F13 and F15, second on F11, F12 and F14"),
    Statement("best-overall", "Section 3.3", "SMWOA is the best of the six algorithms, significantly"),
    Statement("fastest", "Section 4.3", "SMWOA finds a shorter motion than SMA and WOA"),
)
CLAIMED = {
    "ranks-unimodal": dict.fromkeys(("F1", "F2", "F3", "F5"), 1),
    "ranks-multimodal": {"F7": 1, "F8": 1, "F10": 1, "F6": 2, "F9": 2},
    "ranks-low": {"F13": 1, "F15": 1, "F11": 2, "F12": 2, "F14": 2},
}


def motion(algorithm: str, effort: Effort, printed: bool = False) -> MotionCell:
    """Job of one row of Table 6."""
    search = (AS_PRINTED if printed else SEARCHES)[algorithm]
    return MotionCell(CASE, search, None, 100, effort.generations(100), effort.seeds)


def jobs(effort: Effort) -> list[Job]:
    """All that the paper's page needs."""
    found: list[Job] = [*BenchmarkTable(PAPER, effort).jobs(), OptimumCell(CASE), OptimumCell("ur5-bspline-rest")]
    found += [motion(algorithm, effort) for algorithm in SEARCHES]
    return found + [motion(algorithm, effort, True) for algorithm in AS_PRINTED if effort.all_readings]


def statements() -> tuple[Statement, ...]:
    """Claims without a number."""
    return STATEMENTS


def rulings(runs: Runs, effort: Effort) -> Rulings:
    """Rule on everything."""
    found = inputs(PAPER, ["Table 2", "Table 4", "Table 5"]) | settings(PAPER, USED)
    table2 = tables(PAPER)["Table 2"]
    rows = {row.split(",")[0]: row for row in dict.fromkeys(cell.row for cell in table2.cells)}
    found |= optima(table2, {rows[f.label]: f.minimum for f in benchmarks_of(PAPER, "as-printed")})
    found[Place("Table 2", "F8, Alpine", "dimension")] = missing("lost in the text we have; ours is 30", "30")
    found |= BenchmarkTable(PAPER, effort).rulings(runs) | _ranks(runs, effort)
    return found | _durations(runs, effort) | _statements(runs, effort)


def finals(runs: Runs, effort: Effort, column: str, function: str) -> list[float]:
    """Our final values of a column's stated reading."""
    table = BenchmarkTable(PAPER, effort)
    return list(runs[table.cell(function, column, table.readings(column)[0])]["finals"])


def printed_ranks(table: Table) -> Floats:
    """Rank of every column on every function by printed means, ties sharing theirs: shape (n_functions, n_columns)."""
    means = [[table.value(f"F{k}, Avg", column) for column in table.columns] for k in range(1, 16)]
    return np.array([stats.rankdata(row) for row in means])


def _ranks(runs: Runs, effort: Effort) -> Rulings:
    table = tables(PAPER)["Table 3"]
    averages = printed_ranks(table).mean(axis=0)
    own = np.array([
        stats.rankdata([np.mean(finals(runs, effort, column, f"F{k}")) for column in table.columns]) for k in range(1, 16)
    ]).mean(axis=0)  # fmt: skip
    totals = stats.rankdata([table.value("average ranking", column) for column in table.columns])
    found: Rulings = {}
    for j, column in enumerate(table.columns):
        cell = table["average ranking", column]
        why = f"the ranks counted from the printed means average {averages[j]:.4f}; ours average {own[j]:.4f}"
        found[Place("Table 3", cell.row, column)] = rules.exact(
            cell.printed, float(averages[j]), Outcome.CONTRADICTS, why
        )
        cell = table["total rank", column]
        found[Place("Table 3", cell.row, column)] = rules.exact(cell.printed, float(totals[j]), Outcome.CONTRADICTS)
        found[Place("Table 3", "p", column)] = missing(
            "between which samples the rank-sum test was made is not said"
            if column != "SMWOA"
            else "a dash: SMWOA against itself",
            "" if column == "SMWOA" else significance(runs, effort, column)[2],
        )
    return found


def significance(runs: Runs, effort: Effort, column: str) -> tuple[int, int, str]:
    """On how many functions SMWOA is significantly smaller and larger than a column by our runs, and that as text."""
    won = lost = 0
    for k in range(1, 16):
        own, other = (finals(runs, effort, name, f"F{k}") for name in ("SMWOA", column))
        won += rules.smaller(own, other)[0]
        lost += rules.smaller(other, own)[0]
    return won, lost, f"p < 0.05: SMWOA smaller on {won}, larger on {lost} of 15"


def summary(runs: Runs, effort: Effort, algorithm: str, printed: bool = False) -> Summary | None:
    """Our runs of one row of Table 6."""
    return summarised(load_case(CASE), np.array(runs[motion(algorithm, effort, printed)]["durations"]))


def _durations(runs: Runs, effort: Effort) -> Rulings:
    table, known, case = tables(PAPER)["Table 6"], claims(PAPER), load_case(CASE)
    fastest = runs[OptimumCell(CASE)]["total"]
    rest = runs[OptimumCell("ur5-bspline-rest")]["total"]
    note = f", which starts in motion (from rest, cubic spline: {rest:.4f} s)"
    found: Rulings = {}
    for algorithm in SEARCHES:
        row = Row(row_of(table, algorithm, SEGMENTS), table[algorithm, "total"], case)
        for cell, ruling in rule(row, summary(runs, effort, algorithm), fastest, note):
            found[Place("Table 6", algorithm, cell.column)] = ruling
    total = table.value("SMWOA", "total")
    found[claim("total")] = found[Place("Table 6", "SMWOA", "total")]
    found[claim("total-before")] = missing("the five durations behind it are not given")
    found[claim("reduction")] = percentage(known["reduction"].printed, known["total-before"].value, total)
    return found


def _statements(runs: Runs, effort: Effort) -> Rulings:
    table = tables(PAPER)["Table 3"]
    printed = printed_ranks(table)[:, 0]
    own = {
        k: stats.rankdata([np.mean(finals(runs, effort, column, f"F{k}")) for column in table.columns])[0]
        for k in range(1, 16)
    }
    found: Rulings = {}
    for identity, claimed in CLAIMED.items():
        wrong = [f"{f}: {printed[int(f[1:]) - 1]:g}" for f, rank in claimed.items() if printed[int(f[1:]) - 1] != rank]
        text = ", ".join(f"{f}: {own[int(f[1:])]:g}" for f in claimed)
        if wrong:
            found[claim(identity)] = rules.contradicts(
                f"the printed means rank SMWOA otherwise ({', '.join(wrong)})", text
            )
        else:
            found[claim(identity)] = rules.holds(
                all(own[int(f[1:])] == rank for f, rank in claimed.items()), text, "ranks of our means"
            )
    tests = {column: significance(runs, effort, column) for column in table.columns[1:]}
    found[claim("best-overall")] = rules.holds(
        all(won > lost for won, lost, _ in tests.values()),
        ", ".join(f"{column} {won}:{lost}" for column, (won, lost, _) in tests.items()),
        "functions on which SMWOA is significantly smaller : larger in our runs",
    )
    totals = {name: one.totals if (one := summary(runs, effort, name)) else () for name in SEARCHES}
    faster = {
        n: bool(totals[n] and totals["SMWOA"]) and rules.smaller(totals["SMWOA"], totals[n])[0] for n in ("SMA", "WOA")
    }
    medians = ", ".join(f"{name} {np.median(values):.4f} s" for name, values in totals.items() if values)
    found[claim("fastest")] = rules.holds(all(faster.values()), medians, "medians, and rank-sum test over seeds")
    return found


MAPS: tuple[str, ...] = ()


def panels(runs: Runs, effort: Effort) -> list[Panel]:
    """Convergence of the three algorithms on the arm."""
    return [Panel("total time, s", {name: line_of(runs[motion(name, effort)]) for name in SEARCHES})]


def drives(runs: Runs, effort: Effort) -> list[Drive]:
    """Printed, ours and fastest motion."""
    table = tables(PAPER)["Table 6"]
    motions: list[tuple[str, Floats]] = [("printed", np.array([table.value("SMWOA", column) for column in SEGMENTS]))]
    if (ours := summary(runs, effort, "SMWOA")) is not None:
        motions.append(("SMWOA, ours", ours.durations))
    return [Drive(CASE, [*motions, ("fastest on this curve", np.array(runs[OptimumCell(CASE)]["durations"]))])]
