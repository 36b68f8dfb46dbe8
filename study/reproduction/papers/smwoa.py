"""The UR5 paper on SMWOA: benchmark table with its ranks, durations of Table 6, claims."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from scipy import stats

from study.cases.library import load_case
from study.cases.published import Table
from study.planners import smwoa as planners
from study.problem import Floats
from study.reproduction import rules
from study.reproduction.duration_rows import Row, rule
from study.reproduction.jobs import RecordJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary
from study.reproduction.paper import Drive, Panel, PaperRuns
from study.reproduction.verdicts import Outcome, Place, Rulings, claim, missing

CASE = "ur5-bspline"
SEARCHES = {
    "SMA": planners.SMA_PLANNER.search,
    "WOA": planners.WOA_PLANNER.search,
    "SMWOA": planners.SMWOA_PLANNER.search,
}
AS_PRINTED = {"SMA": planners.SMA_AS_PRINTED.search, "SMWOA": planners.SMWOA_AS_PRINTED.search}
SEGMENTS = ("h1", "h2", "h3", "h4", "h5")
CLAIMED = {
    "ranks-unimodal": dict.fromkeys(("F1", "F2", "F3", "F5"), 1),
    "ranks-multimodal": {"F7": 1, "F8": 1, "F10": 1, "F6": 2, "F9": 2},
    "ranks-low": {"F13": 1, "F15": 1, "F11": 2, "F12": 2, "F14": 2},
}


class Smwoa(PaperRuns):
    """The UR5 paper on SMWOA: benchmark table with its ranks, durations of Table 6, claims."""

    key: ClassVar[str] = "ur5-smwoa"
    short: ClassVar[str] = "smwoa"
    maps: ClassVar[tuple[str, ...]] = ()

    def motion(self, algorithm: str, printed: bool = False) -> MotionJob:
        """Job of one row of Table 6."""
        search = (AS_PRINTED if printed else SEARCHES)[algorithm]
        return MotionJob(CASE, search, None, 100, self.effort.generations(100), self.effort.seeds)

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        found: list[RecordJob] = [*self.benchmarks.jobs(), OptimumJob(CASE), OptimumJob("ur5-bspline-rest")]
        found += [self.motion(algorithm) for algorithm in SEARCHES]
        return found + [self.motion(algorithm, True) for algorithm in AS_PRINTED if self.effort.all_readings]

    def rulings(self) -> Rulings:
        """Rule on everything."""
        return self.benchmarks.rulings() | self._ranks() | self._durations() | self._statements()

    def finals(self, column: str, function: str) -> list[float]:
        """Our final values of a column's stated reading."""
        return list(self.benchmarks.record(function, column)["finals"])

    def _ranks(self) -> Rulings:
        table = self.tables["Table 3"]
        averages = printed_ranks(table).mean(axis=0)
        own = np.array([
            stats.rankdata([np.mean(self.finals(column, f"F{k}")) for column in table.columns]) for k in range(1, 16)
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
                "" if column == "SMWOA" else self.significance(column)[2],
            )
        return found

    def significance(self, column: str) -> tuple[int, int, str]:
        """On how many functions SMWOA is significantly smaller and larger than a column by our runs, and that as text."""
        won = lost = 0
        for k in range(1, 16):
            own, other = (self.finals(name, f"F{k}") for name in ("SMWOA", column))
            won += rules.smaller(own, other)[0]
            lost += rules.smaller(other, own)[0]
        return won, lost, f"p < 0.05: SMWOA smaller on {won}, larger on {lost} of 15"

    def summary(self, algorithm: str, printed: bool = False) -> Summary | None:
        """Our runs of one row of Table 6."""
        return self.timed(CASE, [self.motion(algorithm, printed)])

    def _durations(self) -> Rulings:
        table, case = self.tables["Table 6"], load_case(CASE)
        fastest = self.fastest(CASE)
        rest = self.fastest("ur5-bspline-rest")
        note = f", which starts in motion (from rest, cubic spline: {rest:.4f} s)"
        found: Rulings = {}
        for algorithm in SEARCHES:
            row = Row(table.row(algorithm, SEGMENTS), table[algorithm, "total"], case)
            for cell, ruling in rule(row, self.summary(algorithm), fastest, note):
                found[Place("Table 6", algorithm, cell.column)] = ruling
        return found | {claim("total"): found[Place("Table 6", "SMWOA", "total")]}

    def _statements(self) -> Rulings:
        table = self.tables["Table 3"]
        printed = printed_ranks(table)[:, 0]
        own = {
            k: stats.rankdata([np.mean(self.finals(column, f"F{k}")) for column in table.columns])[0]
            for k in range(1, 16)
        }
        found: Rulings = {}
        for identity, claimed in CLAIMED.items():
            wrong = [
                f"{f}: {printed[int(f[1:]) - 1]:g}" for f, rank in claimed.items() if printed[int(f[1:]) - 1] != rank
            ]
            text = ", ".join(f"{f}: {own[int(f[1:])]:g}" for f in claimed)
            if wrong:
                found[claim(identity)] = rules.contradicts(
                    f"the printed means rank SMWOA otherwise ({', '.join(wrong)})", text
                )
            else:
                found[claim(identity)] = rules.holds(
                    all(own[int(f[1:])] == rank for f, rank in claimed.items()), text, "ranks of our means"
                )
        tests = {column: self.significance(column) for column in table.columns[1:]}
        found[claim("best-overall")] = rules.holds(
            all(won > lost for won, lost, _ in tests.values()),
            ", ".join(f"{column} {won}:{lost}" for column, (won, lost, _) in tests.items()),
            "functions on which SMWOA is significantly smaller : larger in our runs",
        )
        totals = {name: one.totals if (one := self.summary(name)) else () for name in SEARCHES}
        faster = {
            n: bool(totals[n] and totals["SMWOA"]) and rules.smaller(totals["SMWOA"], totals[n])[0]
            for n in ("SMA", "WOA")
        }
        medians = ", ".join(f"{name} {np.median(values):.4f} s" for name, values in totals.items() if values)
        found[claim("fastest")] = rules.holds(all(faster.values()), medians, "medians, and rank-sum test over seeds")
        return found

    def panels(self) -> list[Panel]:
        """Convergence of the three algorithms on the arm."""
        return [Panel("total time, s", {name: self.line(self.motion(name)) for name in SEARCHES})]

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion."""
        table = self.tables["Table 6"]
        printed = np.array([table.value("SMWOA", column) for column in SEGMENTS])
        return [self.drive(CASE, printed, "SMWOA", self.summary("SMWOA"))]


def printed_ranks(table: Table) -> Floats:
    """Rank of every column on every function by printed means, ties sharing theirs: shape (n_functions, n_columns)."""
    means = [[table.value(f"F{k}, Avg", column) for column in table.columns] for k in range(1, 16)]
    return np.array([stats.rankdata(row) for row in means])
