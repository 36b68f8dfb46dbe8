"""The woodworking paper (GoldS-PSO): benchmark table, durations of every joint, claims."""

from __future__ import annotations

from functools import partial
from itertools import product
from typing import Any, ClassVar

import numpy as np

from study.cases.library import load_case
from study.planners import woodworking as planners
from study.reproduction import convergence, rules
from study.reproduction.duration_rows import Row, rule, size
from study.reproduction.jobs import RecordJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary, judged
from study.reproduction.paper import Drive, Panel, PaperRuns
from study.reproduction.papers import woodworking_benchmarks
from study.reproduction.readings import CITED_LAMBDA
from study.reproduction.sampling import converse, in_every
from study.reproduction.uniformity import denser, more_even, more_uniform
from study.reproduction.verdicts import BY_RUNS, Basis, Outcome, Ruling, Rulings, claim
from study.search.golds_pso import s_curve
from study.search.state import Search

CASE = "woodworking"
SEARCHES: dict[str, Search[Any]] = {
    "PSO": planners.PSO_BASIC.search,
    "Gold-SA": planners.GOLD_SA.search,
    "GoldS-PSO": planners.GOLDS_PSO.search,
}
OTHERS: dict[str, dict[str, Search[Any]]] = {
    "Gold-SA": {"x1, x2 fixed as printed": planners.GOLD_SA_AS_PRINTED.search},
    "GoldS-PSO": {
        "x1, x2 fixed as printed": planners.GOLDS_PSO_AS_PRINTED.search,
        "cited lambda 0.7298": CITED_LAMBDA,
    },
}
"""Readings of the arm's searches beside the stated ones."""

SEGMENTS = ("t1", "t2", "t3")
JOINTS = range(4)


class Woodworking(PaperRuns):
    """The woodworking paper (GoldS-PSO): benchmark table, durations of every joint, claims."""

    key: ClassVar[str] = "woodworking-golds-pso"
    short: ClassVar[str] = "woodworking"
    maps: ClassVar[tuple[str, ...]] = ("uniform", "circle")
    map_numbers: ClassVar[int] = 100  # Figure 6

    def motion(self, algorithm: str, joint: int, reading: str = "") -> MotionJob:
        """Job of one row of Table 5."""
        search = OTHERS[algorithm][reading] if reading else SEARCHES[algorithm]
        return MotionJob(CASE, search, joint, 50, self.effort.generations(300), self.effort.seeds)

    def readings(self, algorithm: str) -> list[str]:
        """Readings that are run beside the stated one."""
        return [*OTHERS.get(algorithm, {})] if self.effort.all_readings else []

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        gathered: list[RecordJob] = [*self.benchmarks.jobs(), OptimumJob(CASE)]
        for algorithm, joint in product(SEARCHES, JOINTS):
            gathered += [self.motion(algorithm, joint, reading) for reading in ("", *self.readings(algorithm))]
        return [*gathered, *(OptimumJob(CASE, joint) for joint in JOINTS)]

    def rulings(self) -> Rulings:
        """Rule on everything that the print alone does not decide."""
        gathered = self.benchmarks.rulings() | self._joints() | self._totals() | self._reductions()
        return (
            gathered
            | self._generations()
            | woodworking_benchmarks.rulings(self.benchmarks)
            | self._orders()
            | self._formulas()
        )

    def summary(self, algorithm: str, joint: int | None = None, reading: str = "") -> Summary | None:
        """Our runs of an algorithm on one joint, or put together as the paper does."""
        joints = JOINTS if joint is None else [joint]
        return self.timed(CASE, [self.motion(algorithm, j, reading) for j in joints], joint)

    def _others(self, algorithm: str, joint: int | None = None) -> dict[str, str]:
        return self.told({name: self.summary(algorithm, joint, name) for name in self.readings(algorithm)})

    def _joints(self) -> Rulings:
        table, case = self.tables["Table 5"], load_case(CASE)
        gathered: Rulings = {}
        for algorithm, joint in product(SEARCHES, JOINTS):
            name = f"{algorithm}, joint {joint + 1}"
            row = Row(table.row(name, SEGMENTS), table[name, "T_total"], case, joint)
            ruled = rule(row, self.summary(algorithm, joint), self.fastest(CASE, joint))
            gathered |= self.placed("Table 5", ruled, self._others(algorithm, joint))
        return gathered

    def _longest(self, algorithm: str) -> Row:
        """Printed durations put together: of every segment the joint that takes longest."""
        table = self.tables["Table 5"]
        cells = [max((table[f"{algorithm}, joint {j + 1}", column] for j in JOINTS), key=size) for column in SEGMENTS]
        return Row(cells, self.claims[f"total-{algorithm.lower()}"].cell, load_case(CASE))

    def _totals(self) -> Rulings:
        gathered: Rulings = {}
        for algorithm in SEARCHES:
            ruled = rule(self._longest(algorithm), self.summary(algorithm), self.fastest(CASE))
            *segments, (cell, total) = ruled
            gathered |= {claim(cell.row): total.beside(self._others(algorithm))}
            if algorithm == "GoldS-PSO":
                gathered |= {claim(name): ruling for name, (_, ruling) in zip(SEGMENTS, segments, strict=True)}
        return gathered

    def _reductions(self) -> Rulings:
        """Reductions of the body and of the abstract by our runs."""
        totals = {name: self.totals(self.summary(name)) for name in SEARCHES}
        before = {"before": [self.claims["total-before"].value], "pso": totals["PSO"], "gold-sa": totals["Gold-SA"]}
        gathered: Rulings = {}
        for (name, start), prefix in product(before.items(), ("", "abstract-")):
            if not start or not totals["GoldS-PSO"]:
                continue
            printed = self.claims[f"{prefix}reduction-{name}"].printed
            ruling = rules.reduction(printed, start, totals["GoldS-PSO"], name != "before")
            gathered[claim(f"{prefix}reduction-{name}", BY_RUNS)] = ruling
        return gathered

    def _generations(self) -> Rulings:
        records = {name: [self.runs[self.motion(name, joint)] for joint in JOINTS] for name in SEARCHES}
        gathered: Rulings = {}
        for algorithm, of in (
            ("GoldS-PSO", convergence.slowest),
            ("Gold-SA", convergence.slowest),
            ("PSO", convergence.fastest),
        ):
            identity = f"generations-{algorithm.lower()}"
            ruling = rules.count(
                self.claims[identity].printed, of(records[algorithm]), convergence.late(records[algorithm])
            )
            gathered |= {claim(identity): ruling.beside(self._other_generations(algorithm))}
        return gathered | self._arrivals()

    def _other_generations(self, algorithm: str) -> dict[str, str]:
        return {
            name: self.steps([self.runs[self.motion(algorithm, joint, name)] for joint in JOINTS])
            for name in self.readings(algorithm)
        }

    def _arrivals(self) -> Rulings:
        """Generations until the last value, which is the optimum 0 on F1 to F3 if the search arrives."""
        arrived = {
            key: self._arrival(*key) for key in product(("Gold-SA", "GoldS-PSO"), ("F1", "F2", "F3", "F6", "F7"))
        }
        three = ("F1", "F2", "F3")
        unimodal = max(arrived["GoldS-PSO", f][0] for f in three)
        lead = float(np.mean([arrived["Gold-SA", f][0] - arrived["GoldS-PSO", f][0] for f in three]))
        cut = [f for f in three if not arrived["Gold-SA", f][1]]
        text = "; ".join(f"{f}: {arrived['GoldS-PSO', f][0]:g} and {arrived['Gold-SA', f][0]:g}" for f in three)
        ahead = rules.holds(lead >= self.claims["benchmark-generations-ahead"].value * 0.95, f"{lead:.1f}", text)
        if cut and not ahead.agrees:
            why = f"at least that: Gold-SA had not arrived at 0 on {', '.join(cut)} in its 1000 generations; {text}"
            ahead = Ruling(Outcome.UNDECIDED, f"≥ {lead:.1f}", why)
        multimodal = max(arrived[key][0] for key in arrived if key[1] in ("F6", "F7"))
        return {
            claim("benchmark-generations-unimodal"): self.until("benchmark-generations-unimodal", unimodal),
            claim("benchmark-generations-multimodal"): self.until("benchmark-generations-multimodal", multimodal),
            claim("benchmark-generations-ahead"): ahead,
        }

    def until(self, identity: str, ours: float) -> Ruling:
        """Compare generations until the last value, which leaves no definition open."""
        agrees = ours <= self.claims[identity].value
        return rules.holds(agrees, f"{ours:g}", "slowest of the medians; the first generation with the last value")

    def _arrival(self, algorithm: str, function: str) -> tuple[float, bool]:
        """Median generation of the last value, and whether most runs end at exactly 0."""
        record = self.benchmarks.record(function, algorithm)
        return float(np.median(record["arrived"])), float(np.median(record["finals"])) == 0.0

    def _orders(self) -> Rulings:
        """Statements about an order of convergence and of times."""
        ours, pso, golden = (partial(self.motion, name) for name in ("GoldS-PSO", "PSO", "Gold-SA"))
        shortest = {
            f"joint {j + 1} against {other}": self.shorter(self.summary("GoldS-PSO", j), self.summary(other, j))
            for j, other in product(JOINTS, ("PSO", "Gold-SA"))
        }
        behind = {f"joint {j + 1}": self.shorter(self.summary("PSO", j), self.summary("Gold-SA", j)) for j in (1, 3)}
        return {
            claim("shortest-joints"): in_every(shortest),
            claim("gold-sa-behind-pso"): in_every(behind),
            claim("faster-than-pso"): self.everywhere(ours, pso, JOINTS),
            claim("level-with-gold-sa"): converse(self.everywhere(ours, golden, JOINTS), "GoldS-PSO before Gold-SA"),
        }

    def _formulas(self) -> Rulings:
        """Statements that the maps, the formulas and the printed durations decide."""
        verdict = judged(load_case(CASE), self._longest("GoldS-PSO").durations)
        velocity, acceleration = verdict.ratios.max(axis=1)[:2]
        shares = f"{velocity:.4f} of the velocity, {acceleration:.4f} of the acceleration limit"
        early, late = (s_curve((0.9, 0.4), at) - s_curve((0.9, 0.4), at + 0.05) for at in (0.0, 0.95))
        smallest = [float(self._longest(name).durations[k]) for k in range(3) for name in SEARCHES]
        least = all(smallest[3 * k + 2] == min(smallest[3 * k : 3 * k + 3]) for k in range(3))
        spreads = {n: [self.claims[f"spread-{p}-{n.lower()}"].value for p in ("12", "34")] for n in SEARCHES}
        stable = all(spreads["GoldS-PSO"][k] == min(s[k] for s in spreads.values()) for k in range(2))
        alone = judged(load_case(CASE), np.array([2.1107, 2.9540, 2.0025]), 0).worst_ratio
        why = (
            f"joint 1 by itself, at its own durations of Table 5, uses {alone:.4f} of its limit; the longest "
            f"segments hide it"
        )
        return {
            claim("circle-uniform"): more_uniform("circle", ["uniform"], (30, 50, 100, 1000), 2),
            claim("circle-even"): more_even("circle", 100),
            claim("circle-denser"): denser("circle", 0.2, 0.6, 100),
            claim("golden-ratio"): rules.exact("0.618033", (5**0.5 - 1) / 2, Basis.FORMULA),
            claim("s-curve"): rules.holds(
                max(early, late) < 0.025,
                f"{early:.4f} and {late:.4f}",
                "fall in the first and the last twentieth; a straight line falls by 0.025",
                Basis.FORMULA,
            ),
            claim("longest-segments"): rules.holds(least, "", "by Table 5", Basis.PRINT),
            claim("better-stability"): rules.holds(
                stable,
                "",
                "by the printed differences; totals of different joints depend on their waypoints, not on the search",
                Basis.PRINT,
            ),
            claim("within-limits"): rules.holds(verdict.feasible, shares, why, Basis.FORMULA),
            claim("near-limits"): rules.holds(max(velocity, acceleration) > 0.9, shares, "at 7.8776 s", Basis.FORMULA),
            claim("smooth-acceleration"): rules.holds(
                True,
                "",
                "3-5-3 polynomials join with equal velocity and acceleration, zero at both ends",
                Basis.FORMULA,
            ),
        }

    def panels(self) -> list[Panel]:
        """Convergence on every joint, the paper's Figure 11."""
        table = self.tables["Table 5"]
        return [
            self.panel(
                CASE,
                {name: self.motion(name, j) for name in SEARCHES},
                {name: table.value(f"{name}, joint {j + 1}", "T_total") for name in SEARCHES},
                j,
            )
            for j in JOINTS
        ]

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion of all joints together."""
        printed = self._longest("GoldS-PSO").durations
        return [self.drive(CASE, printed, "GoldS-PSO", self.summary("GoldS-PSO"), np.full(3, 5.0))]
