"""The woodworking paper (GoldS-PSO): benchmark table, durations of every joint, claims."""

from __future__ import annotations

from itertools import product
from typing import ClassVar

import numpy as np

from study.cases.library import load_case
from study.planners import woodworking as planners
from study.reproduction import rules
from study.reproduction.duration_rows import Row, rule, size
from study.reproduction.jobs import RecordJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary
from study.reproduction.paper import Drive, Panel, PaperRuns
from study.reproduction.uniformity import more_uniform
from study.reproduction.verdicts import Place, Ruling, Rulings, claim

CASE = "woodworking"
SEARCHES = {
    "PSO": planners.PSO_BASIC.search,
    "Gold-SA": planners.GOLD_SA.search,
    "GoldS-PSO": planners.GOLDS_PSO.search,
}
SEGMENTS = ("t1", "t2", "t3")
JOINTS = range(4)


class Woodworking(PaperRuns):
    """The woodworking paper (GoldS-PSO): benchmark table, durations of every joint, claims."""

    key: ClassVar[str] = "woodworking-golds-pso"
    short: ClassVar[str] = "woodworking"
    maps: ClassVar[tuple[str, ...]] = ("uniform", "circle")

    def motion(self, algorithm: str, joint: int) -> MotionJob:
        """Job of one row of Table 5."""
        return MotionJob(CASE, SEARCHES[algorithm], joint, 50, self.effort.generations(300), self.effort.seeds)

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        found: list[RecordJob] = [*self.benchmarks.jobs()]
        found += [self.motion(algorithm, joint) for algorithm, joint in product(SEARCHES, JOINTS)]
        return [*found, *(OptimumJob(CASE, joint) for joint in JOINTS), OptimumJob(CASE)]

    def rulings(self) -> Rulings:
        """Rule on everything."""
        found = self.benchmarks.rulings() | self._joints() | self._totals()
        return found | self._generations() | self._statements()

    def summary(self, algorithm: str, joint: int | None = None) -> Summary | None:
        """Our runs of an algorithm on one joint, or put together as the paper does."""
        joints = JOINTS if joint is None else [joint]
        return self.timed(CASE, [self.motion(algorithm, j) for j in joints], joint)

    def _joints(self) -> Rulings:
        table, case = self.tables["Table 5"], load_case(CASE)
        found: Rulings = {}
        for algorithm, joint in product(SEARCHES, JOINTS):
            name = f"{algorithm}, joint {joint + 1}"
            row = Row(table.row(name, SEGMENTS), table[name, "T_total"], case, joint)
            fastest = self.fastest(CASE, joint)
            ours = self.summary(algorithm, joint)
            for cell, ruling in rule(row, ours, fastest):
                found[Place("Table 5", cell.row, cell.column)] = ruling
        return found

    def _totals(self) -> Rulings:
        found: Rulings = {}
        fastest = self.fastest(CASE)
        for algorithm in SEARCHES:
            ours = self.summary(algorithm)
            *segments, (cell, total) = rule(self._longest(algorithm), ours, fastest)
            found[claim(cell.row)] = total
            if algorithm == "GoldS-PSO":
                found |= {claim(name): ruling for name, (_, ruling) in zip(SEGMENTS, segments, strict=True)}
        return found

    def _longest(self, algorithm: str) -> Row:
        """Printed durations put together: of every segment the joint that takes longest."""
        table = self.tables["Table 5"]
        cells = [max((table[f"{algorithm}, joint {j + 1}", column] for j in JOINTS), key=size) for column in SEGMENTS]
        return Row(cells, self.claims[f"total-{algorithm.lower()}"].cell, load_case(CASE))

    def _generations(self) -> Rulings:
        known = self.claims
        medians = {
            algorithm: [float(np.median(self.runs[self.motion(algorithm, joint)]["settled"])) for joint in JOINTS]
            for algorithm in SEARCHES
        }
        slow = min(medians["PSO"])
        found: Rulings = {
            claim("generations-golds-pso"): rules.count(
                known["generations-golds-pso"].printed, max(medians["GoldS-PSO"]), True
            ),
            claim("generations-gold-sa"): rules.count(
                known["generations-gold-sa"].printed, max(medians["Gold-SA"]), True
            ),
            claim("generations-pso"): rules.holds(
                slow >= 120 / rules.COUNT_FACTOR, f"{slow:.4g}", "fewest over the joints, medians over seeds"
            ),
        }
        reached = {
            (algorithm, function): self._reaches(algorithm, function)
            for algorithm in ("Gold-SA", "GoldS-PSO")
            for function in ("F1", "F2", "F3", "F6", "F7")
        }
        unimodal = max(reached["GoldS-PSO", f] for f in ("F1", "F2", "F3"))
        ahead = float(np.mean([reached["Gold-SA", f] - reached["GoldS-PSO", f] for f in ("F1", "F2", "F3")]))
        multimodal = max(generation for (_, f), generation in reached.items() if f in ("F6", "F7"))
        for identity, value, at_most in (
            ("benchmark-generations-unimodal", unimodal, True),
            ("benchmark-generations-multimodal", multimodal, True),
        ):
            found[claim(identity)] = rules.count(known[identity].printed, value, at_most)
        led = self.claims["benchmark-generations-ahead"].value
        found[claim("benchmark-generations-ahead")] = rules.holds(
            ahead >= led / rules.COUNT_FACTOR, f"{ahead:.4g}", "a lead, so fewer is worse; means over F1 to F3"
        )
        return found

    def _reaches(self, algorithm: str, function: str) -> int:
        """First shown generation at which the median run is at its last value."""
        record = self.benchmarks.record(function, algorithm)
        curve = np.array(record["curve"])
        return int(record["generations"][int(np.argmax(curve <= curve[-1]))])

    def _statements(self) -> Rulings:
        table = self.benchmarks

        def finals(algorithm: str, function: str) -> list[float]:
            return list(table.record(function, algorithm)["finals"])

        lost = [
            f"{function} against {other}"
            for function, other in product(table.functions, ("PSO", "CFPSO", "SPSO"))
            if not rules.smaller(finals("GoldS-PSO", function), finals(other, function))[0]
        ]
        worst = max(max(finals("GoldS-PSO", function)) for function in ("F1", "F2", "F3"))
        medians = "; ".join(
            f"medians on {f}: " + ", ".join(f"{a} {np.median(finals(a, f)):.2g}" for a in ("GoldS-PSO", "Gold-SA"))
            for f in ("F4", "F5")
        )
        golden = {f: rules.smaller(finals("GoldS-PSO", f), finals("Gold-SA", f)) for f in ("F4", "F5")}
        found: Rulings = {
            claim("circle-uniform"): more_uniform("circle", ["uniform"]),
            claim("best-of-swarms"): rules.holds(
                not lost,
                f"{24 - len(lost)} of 24 comparisons",
                f"not by the rank-sum test: {', '.join(lost)}" if lost else "",
            ),
            claim("exact-zero"): rules.holds(worst == 0.0, f"largest of all runs {worst:.3g}"),
            claim("beats-gold-sa"): rules.holds(
                all(smaller for smaller, _ in golden.values()),
                ", ".join(f"{f}: p = {p:.2g}" for f, (_, p) in golden.items()),
                f"smaller by the rank-sum test on {', '.join(f for f, (smaller, _) in golden.items() if smaller) or 'neither'}; {medians}",
            ),
        }
        return found | {claim("shortest-joints"): self._shortest()}

    def _shortest(self) -> Ruling:
        lost = []
        for joint, other in product(JOINTS, ("PSO", "Gold-SA")):
            own, theirs = (self.summary(name, joint) for name in ("GoldS-PSO", other))
            if own is None or (theirs is not None and not rules.smaller(own.totals, theirs.totals)[0]):
                lost.append(f"joint {joint + 1} against {other}")
        return rules.holds(
            not lost,
            f"{8 - len(lost)} of 8 comparisons",
            f"not by the rank-sum test: {', '.join(lost)}" if lost else "",
        )

    def panels(self) -> list[Panel]:
        """Convergence on every joint, the paper's Figure 11."""
        return [
            Panel(f"joint {joint + 1}", {name: self.line(self.motion(name, joint)) for name in SEARCHES})
            for joint in JOINTS
        ]

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion of all joints together."""
        return [self.drive(CASE, self._longest("GoldS-PSO").durations, "GoldS-PSO", self.summary("GoldS-PSO"))]
