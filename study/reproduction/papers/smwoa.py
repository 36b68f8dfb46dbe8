"""The UR5 paper on SMWOA: benchmark table with its ranks, durations of Table 6, claims."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from scipy import stats

from study.cases.library import load_case
from study.planners import smwoa as planners
from study.problem import Floats
from study.reproduction import rules
from study.reproduction.duration_rows import Row, rule
from study.reproduction.jobs import RecordJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary, judged, motion_of
from study.reproduction.paper import Drive, Panel, PaperRuns
from study.reproduction.readings import SMA_PRINTED, SMWOA_BRANCHES, SMWOA_PRINTED
from study.reproduction.sampling import compared, in_every
from study.reproduction.verdicts import BY_RUNS, Basis, Place, Ruling, Rulings, claim, missing
from study.search.smwoa import SMWOA
from study.search.state import Search

CASE, REST = "ur5-bspline", "ur5-bspline-rest"
SEARCHES: dict[str, Search[Any]] = {
    "SMA": planners.SMA_PLANNER.search,
    "WOA": planners.WOA_PLANNER.search,
    "SMWOA": SMWOA(),
}
OTHERS: dict[str, dict[str, Search[Any]]] = {
    "SMA": {"as printed": SMA_PRINTED},
    "SMWOA": {"with SMA's branches": SMWOA_BRANCHES, "as printed": SMWOA_PRINTED},
}
SEGMENTS = ("h1", "h2", "h3", "h4", "h5")
FUNCTIONS = [f"F{k}" for k in range(1, 16)]
CLAIMED = {
    "ranks-unimodal": dict.fromkeys(("F1", "F2", "F3", "F5"), 1),
    "ranks-multimodal": {"F7": 1, "F8": 1, "F10": 1, "F6": 2, "F9": 2},
    "ranks-low": {"F13": 1, "F15": 1, "F11": 2, "F12": 2, "F14": 2},
}


class Smwoa(PaperRuns):
    """The UR5 paper on SMWOA: benchmark table with its ranks, durations of Table 6, claims."""

    key: ClassVar[str] = "ur5-smwoa"
    short: ClassVar[str] = "smwoa"

    def motion(self, algorithm: str, reading: str = "") -> MotionJob:
        """Job of one row of Table 6."""
        search = OTHERS[algorithm][reading] if reading else SEARCHES[algorithm]
        return MotionJob(CASE, search, None, 100, self.effort.generations(100), self.effort.seeds)

    def readings(self, algorithm: str) -> list[str]:
        """Readings that are run beside the stated one."""
        return [*OTHERS.get(algorithm, {})] if self.effort.all_readings else []

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        gathered: list[RecordJob] = [*self.benchmarks.jobs(), OptimumJob(CASE), OptimumJob(REST)]
        return gathered + [self.motion(name, reading) for name in SEARCHES for reading in ("", *self.readings(name))]

    def rulings(self) -> Rulings:
        """Rule on everything that the print alone does not decide."""
        gathered = self.benchmarks.rulings() | self._ranks() | self._durations()
        return gathered | self._places() | self._orders() | self._formulas()

    def finals(self, column: str, function: str) -> list[float]:
        """Our final values of a column's stated reading."""
        return list(self.benchmarks.record(function, column)["finals"])

    def means(self, function: str) -> list[float]:
        """Our means of all columns on a function."""
        return [float(np.mean(self.finals(column, function))) for column in self.tables["Table 3"].columns]

    def printed_means(self, function: str) -> list[float]:
        """Printed means of all columns on a function."""
        return self.tables["Table 3"].row_values(f"{function}, Avg", self.tables["Table 3"].columns)

    def _ranks(self) -> Rulings:
        table = self.tables["Table 3"]
        averages, own = (
            np.mean([stats.rankdata(means(f)) for f in FUNCTIONS], axis=0) for means in (self.printed_means, self.means)
        )
        totals = stats.rankdata(table.row_values("average ranking", table.columns))
        gathered: Rulings = {}
        for j, column in enumerate(table.columns):
            cell = table["average ranking", column]
            why = f"ranks counted from the printed means average {averages[j]:.4f}; those of our means {own[j]:.4f}"
            gathered[Place("Table 3", cell.row, column)] = rules.exact(
                cell.printed, float(averages[j]), Basis.PRINT, why
            )
            cell = table["total rank", column]
            gathered[Place("Table 3", cell.row, column)] = rules.exact(cell.printed, float(totals[j]), Basis.PRINT)
            gathered[Place("Table 3", "p", column)] = self._significance(column)
        return gathered

    def _significance(self, column: str) -> Ruling:
        if column == "SMWOA":
            return missing("a dash: SMWOA against itself")
        won, lost = self._score(column)
        ours = f"p < 0.05: SMWOA smaller on {won}, larger on {lost} of 15"
        return missing("between which samples the rank-sum test was made is not said", ours)

    def _score(self, column: str) -> tuple[int, int]:
        """Functions on which SMWOA is significantly smaller and larger than a column by our runs."""
        pairs = [(self.finals("SMWOA", f), self.finals(column, f)) for f in FUNCTIONS]
        won, lost = (sum(compared(*pair[::way]).smaller for pair in pairs) for way in (1, -1))
        return won, lost

    def summary(self, algorithm: str, reading: str = "") -> Summary | None:
        """Our runs of one row of Table 6."""
        return self.timed(CASE, [self.motion(algorithm, reading)])

    def _durations(self) -> Rulings:
        table, case = self.tables["Table 6"], load_case(CASE)
        note = f", which starts in motion (from rest, cubic spline: {self.fastest(REST):.4f} s)"
        gathered: Rulings = {}
        for name in SEARCHES:
            row = Row(table.row(name, SEGMENTS), table[name, "total"], case)
            others = self.told({reading: self.summary(name, reading) for reading in self.readings(name)})
            gathered |= self.placed("Table 6", rule(row, self.summary(name), self.fastest(CASE), note), others)
        gathered[claim("total")] = gathered[Place("Table 6", "SMWOA", "total")]
        if totals := self.totals(self.summary("SMWOA")):
            before = [self.claims["total-before"].value]
            gathered[claim("reduction", BY_RUNS)] = rules.reduction(self.claims["reduction"].printed, before, totals)
        return gathered

    def _places(self) -> Rulings:
        """Rule on SMWOA's places; ties leave every place open that they share."""
        gathered: Rulings = {}
        for identity, claimed in CLAIMED.items():
            printed, own = ({f: places(means(f)) for f in claimed} for means in (self.printed_means, self.means))
            wrong = [f"{f}: {shown(printed[f])}" for f, place in claimed.items() if not open_to(printed[f], place)]
            text = ", ".join(f"{f}: {shown(span)}" for f, span in own.items())
            if wrong:
                ruling = rules.contradicts(f"the printed means rank SMWOA otherwise ({', '.join(wrong)})", text)
            else:
                agrees = all(open_to(own[f], place) for f, place in claimed.items())
                ruling = rules.holds(agrees, text, "places by our means; ties share all of their places")
            gathered[claim(identity)] = ruling
        first = [f for f in FUNCTIONS[:5] if open_to(places(self.printed_means(f)), 1)]
        gathered[claim("second-on-f4")] = rules.holds(
            first == ["F1", "F2", "F3", "F5"], ", ".join(first), "by the printed means", Basis.PRINT
        )
        return gathered

    def _orders(self) -> Rulings:
        scores = {column: self._score(column) for column in self.tables["Table 3"].columns[1:]}
        text = ", ".join(f"{column} {won}:{lost}" for column, (won, lost) in scores.items())
        best = all(won > lost for won, lost in scores.values())
        told = "functions on which SMWOA is significantly smaller : larger in our runs"
        tests = {name: self.shorter(self.summary("SMWOA"), self.summary(name)) for name in ("SMA", "WOA")}
        medians = ", ".join(f"{n} {np.median(self.totals(self.summary(n)) or [np.inf]):.4f} s" for n in SEARCHES)
        return {
            claim("best-overall"): rules.holds(best, text, told),
            claim("fastest"): in_every(tests, f"medians {medians}"),
        }

    def _formulas(self) -> Rulings:
        """Statements that the printed durations decide."""
        case = load_case(CASE)
        durations = np.array(self.tables["Table 6"].row_values("SMWOA", SEGMENTS))
        shares = judged(case, durations).ratios.max(axis=1)
        text = f"{shares[0]:.3f} of the velocity, {shares[1]:.3f} of the acceleration limit"
        motion = motion_of(case, durations)
        jerk = np.abs(motion(np.linspace(0.0, motion.duration, 4001), 3))
        tops = {j + 1: _tops(jerk[:, j]) for j in range(6)}
        told = ", ".join(f"joint {joint} {count}" for joint, count in tops.items())
        why = "peaks of the jerk above 0.7 of the largest, at the printed durations"
        single = [joint for joint, count in tops.items() if count == 1]
        return {
            claim("gentle-rates"): rules.holds(shares.max() < 1.0, text, "at the printed durations", Basis.FORMULA),
            claim("jerk-cusps"): rules.holds({1, 2, 4, 6} <= set(single), told, why, Basis.FORMULA),
        }

    def panels(self) -> list[Panel]:
        """Convergence of the three algorithms on the arm."""
        marks = {name: self.tables["Table 6"].value(name, "total") for name in SEARCHES}
        return [self.panel(CASE, {name: self.motion(name) for name in SEARCHES}, marks)]

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion."""
        printed = np.array(self.tables["Table 6"].row_values("SMWOA", SEGMENTS))
        return [self.drive(CASE, printed, "SMWOA", self.summary("SMWOA"))]


def places(means: list[float]) -> tuple[int, int]:
    """First and last place of the first of several means that ties leave open."""
    own = means[0]
    return 1 + sum(mean < own for mean in means), sum(mean <= own for mean in means)


def open_to(span: tuple[int, int], place: int) -> bool:
    """Whether a place is among those that ties leave open."""
    return span[0] <= place <= span[1]


def shown(span: tuple[int, int]) -> str:
    """Places as text."""
    return f"{span[0]}" if span[0] == span[1] else f"{span[0]} to {span[1]}, tied"


def _tops(values: Floats) -> int:
    """Number of separate stretches of a sampled course that lie above 0.7 of its greatest value."""
    above = values > 0.7 * values.max()
    return int(above[0]) + int((above[1:] & ~above[:-1]).sum())
