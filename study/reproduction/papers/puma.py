"""The PUMA560 paper (RRT and chaotic PSO): benchmark table, durations, the whole pipeline over many worlds, claims."""

from __future__ import annotations

from dataclasses import replace
from typing import ClassVar

import numpy as np
from scipy import stats

from study.cases.library import load_case
from study.cases.published import Cell, Table, parsed
from study.planners.puma import CHAOTIC_SPSO, CHAOTIC_SPSO_AS_PRINTED
from study.reproduction import rules
from study.reproduction.duration_rows import Row, rule, size
from study.reproduction.genetic_runs import GeneticJob
from study.reproduction.jobs import RecordJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary, judged, summarised, synchronised
from study.reproduction.paper import Drive, Panel, PaperRuns
from study.reproduction.papers import collisions
from study.reproduction.uniformity import more_uniform
from study.reproduction.verdicts import Outcome, Place, Ruling, Rulings, claim, missing, used
from study.robots import robot_named

CASE = "puma560"
TIMES = ("time 1", "time 2", "time 3")
JOINTS = range(6)
ITERATIONS = {
    "f1-iterations": ("F1", ("SPSO",)), "f1-iterations-others": ("F1", ("STOA", "SCA")), "f1-iterations-pso": ("F1", ("PSO",)),
    "f2-iterations": ("F2", ("SPSO",)), "f3-iterations": ("F3", ("SPSO",)), "f3-iterations-pso": ("F3", ("PSO",)),
    "f4-iterations": ("F4", ("SPSO",)), "f5-iterations": ("F5", ("SPSO",)), "f5-iterations-sca": ("F5", ("SCA",)),
    "f5-iterations-stoa": ("F5", ("STOA",)), "f6-iterations": ("F6", ("SPSO",)),
}  # fmt: skip


class Puma(PaperRuns):
    """The PUMA560 paper (RRT and chaotic PSO): benchmark table, durations, the whole pipeline over many worlds, claims."""

    key: ClassVar[str] = "puma560-chaotic-spso"
    short: ClassVar[str] = "puma"
    maps: ClassVar[tuple[str, ...]] = ("uniform", "logistic", "circle", "singer", "sine-tent-cosine")

    def motion(self, joint: int, printed: bool = False) -> MotionJob:
        """Job of one column of Table 5; population and generations are ours."""
        search = (CHAOTIC_SPSO_AS_PRINTED if printed else CHAOTIC_SPSO).search
        return MotionJob(CASE, search, joint, 30, self.effort.generations(100), self.effort.seeds)

    def genetic(self, joint: int) -> GeneticJob:
        """Job of NSGA-II on one joint that moves."""
        return GeneticJob(CASE, joint, 30, self.effort.generations(100), min(self.effort.seeds, 5))

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        found: list[RecordJob] = [*self.benchmarks.jobs(), OptimumJob(CASE)]
        for joint in JOINTS:
            found += [self.motion(joint), OptimumJob(CASE, joint), self.genetic(joint)]
            found += [self.motion(joint, True)] if self.effort.all_readings else []
        return found + collisions.jobs(self.effort)

    def rulings(self) -> Rulings:
        """Rule on everything."""
        found = self._arm() | self.benchmarks.rulings() | self._benchmark_claims()
        found |= self._durations() | self._totals() | self._statements()
        return found | collisions.rulings(self.runs, self.effort)

    def _arm(self) -> Rulings:
        """Table 1 against the PUMA560 of the Toolbox, which the experiment calls."""
        table, robot = self.tables["Table 1"], robot_named("puma560")
        own = {"a (mm)": 1000 * robot.a, "alpha": robot.alpha, "d (mm)": 1000 * robot.d, "theta": robot.theta}
        waypoints = load_case(CASE).problem.waypoints
        found: Rulings = {}
        for cell in table.cells:
            joint = int(cell.row.split()[1]) - 1
            place = Place("Table 1", cell.row, cell.column)
            if cell.column in own:
                value = float(own[cell.column][joint])
                same = cell.value is not None and np.isclose(cell.value, value, rtol=rules.RELATIVE, atol=1e-9)
                why = f"Section 2.3 calls the Toolbox's PUMA560, which has {value:.5g} here"
                found[place] = (
                    used("as in the Toolbox's PUMA560") if same else rules.contradicts(why, rules.number6(value))
                )
            else:
                found[place] = _range(cell, waypoints[:, joint])
        return found

    def _benchmark_claims(self) -> Rulings:
        known, table3 = self.claims, self.tables["Table 3"]
        found: Rulings = {}
        for k in range(1, 7):
            cell = known[f"f{k}-best"].cell
            printed = table3[f"F{k}, min", "SPSO"]
            ours = min(self.benchmarks.record(f"F{k}", "SPSO")["finals"])
            function = self.benchmarks.stated(f"F{k}", "SPSO").benchmark
            ruling = rules.stochastic(cell.printed, ours, function.minimum or 0.0)
            agrees = rules.close(printed.value or 0.0, cell.printed, cell.value or 0.0)
            found[claim(cell.row)] = (
                ruling if agrees else rules.contradicts(f"Table 3 prints {printed.printed}", ruling.ours)
            )
        for identity, (function_label, columns) in ITERATIONS.items():
            medians = [
                float(np.median(self.benchmarks.record(function_label, column)["settled"])) for column in columns
            ]
            at_most = "fewer" in known[identity].printed
            text = str(int(known[identity].value))
            found[claim(identity)] = rules.count(text, max(medians), at_most)
        slowest = max(float(np.median(self.runs[self.motion(joint)]["settled"])) for joint in JOINTS)
        found[claim("iterations-arm")] = rules.count(known["iterations-arm"].printed, slowest, True)
        return found

    def summary(self, joint: int | None = None, printed: bool = False) -> Summary | None:
        """Our runs of one joint, or all put together."""
        joints = JOINTS if joint is None else [joint]
        return self.timed(CASE, [self.motion(j, printed) for j in joints], joint)

    def _durations(self) -> Rulings:
        table, case = self.tables["Table 5"], load_case(CASE)
        found: Rulings = {}
        start = judged(case, np.ones(3))
        for head in (*TIMES, "total time"):
            found[Place("Table 5", head, "initialisation")] = used(
                f"the start; its motion uses {start.worst_ratio:.4f} of pi rad/s, the limit that we infer"
            )
        for joint in JOINTS:
            column = f"joint {joint + 1}"
            row_cells = [table[row, column] for row in TIMES]
            row = Row(row_cells, table["total time", column], case, joint)
            fastest = self.fastest(CASE, joint)
            for cell, ruling in rule(row, self.summary(joint), fastest):
                why = ruling.why + ("; pi rad/s is inferred" if ruling.outcome is Outcome.INFEASIBLE else "")
                found[Place("Table 5", cell.row, column)] = replace(ruling, why=why)
        return found

    def _totals(self) -> Rulings:
        table6, case = self.tables["Table 6"], load_case(CASE)
        fastest = self.fastest(CASE)
        row = Row(_longest(self.tables["Table 5"]), self.claims["total"].cell, case)
        ours = self.summary()
        *segments, (_, total) = rule(row, ours, fastest)
        found: Rulings = {claim(f"t{k}"): ruling for k, (_, ruling) in enumerate(segments, start=1)}
        found[claim("total")] = total
        genetic = self._genetic(table6["NSGA-II", "total time"], fastest)
        return found | {Place("Table 6", "NSGA-II", "total time"): genetic}

    def _genetic(self, cell: Cell, fastest: float) -> Ruling:
        records = [self.runs[self.genetic(joint)] for joint in JOINTS]
        if not all(record["durations"] for record in records):
            return missing("our row needs pymoo, which is not installed (the extra `peers` brings it)")
        ours = summarised(load_case(CASE), synchronised(records))
        if ours is None:
            return Ruling(Outcome.WORSE, "no feasible run", "objectives and settings are ours", False)
        remark = f"{ours.text}; objectives (total time, largest jerk) and settings are ours; fastest on this curve {fastest:.4f} s"
        return rules.duration(cell.printed, ours.total, remark, (ours.best, ours.totals[-1]))

    def _statements(self) -> Rulings:
        table3, known = self.tables["Table 3"], self.claims
        minima = ", ".join(f"{column} {table3['F2, min', column].printed}" for column in table3.columns)
        broken = rules.contradicts(
            f"Table 3 prints the minima {minima}: F2 was run without its floor, and so it is by us"
        )
        found: Rulings = {
            claim("floor-f2"): broken,
            claim("hybrid-uniform"): more_uniform("sine-tent-cosine", ["logistic", "circle", "singer", "uniform"]),
        }
        for identity, row, key in (
            ("least-deviation-f2", "F2, std", np.std), ("least-deviation-f4", "F4, std", np.std), ("least-minimum-f6", "F6, min", np.min),
        ):  # fmt: skip
            printed = _least(table3, row)
            values = {
                column: float(key(self.benchmarks.record(row[:2], column)["finals"])) for column in table3.columns
            }
            text = ", ".join(f"{column} {value:.3g}" for column, value in values.items())
            best = min(values, key=lambda column: values[column])
            wrong = rules.contradicts(f"Table 3 prints the least for {printed}", text)
            found[claim(identity)] = wrong if printed != "SPSO" else rules.holds(best == "SPSO", text)
        printed_means = [[table3.value(f"F{k}, mean", column) for column in table3.columns] for k in range(1, 7)]
        firsts = [table3.columns[int(np.argmin(row))] for row in printed_means]
        own = [
            [float(np.mean(self.benchmarks.record(f"F{k}", column)["finals"])) for column in table3.columns]
            for k in range(1, 7)
        ]
        ranks = np.array([stats.rankdata(row) for row in own]).mean(axis=0)
        text = ", ".join(f"{column} {rank:.2f}" for column, rank in zip(table3.columns, ranks, strict=True))
        lost = [f"F{k} ({first})" for k, first in enumerate(firsts, start=1) if first != "SPSO"]
        found[claim("first-overall")] = (
            rules.contradicts(f"others have the least printed mean on {', '.join(lost)}", f"mean ranks {text}")
            if lost
            else rules.holds(table3.columns[int(ranks.argmin())] == "SPSO", text)
        )
        found[claim("shortest-method")] = rules.contradicts(
            f"Table 6 prints {known['total-irrt'].value} s for the improved RRT, less than {known['total-proposed'].value} s"
        )
        return found

    def panels(self) -> list[Panel]:
        """Convergence on every joint."""
        return [Panel(f"joint {joint + 1}", {"SPSO": self.line(self.motion(joint))}) for joint in JOINTS]

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion of all joints together, the paper's Figure 10."""
        printed = np.array([cell.value for cell in _longest(self.tables["Table 5"])])
        return [self.drive(CASE, printed, "chaotic SPSO", self.summary())]


def _range(cell: Cell, angles: np.ndarray) -> Ruling:
    ends = [parsed(part) for part in cell.printed.strip("()").split(",")]
    low, high = ends[0], ends[-1]
    if low is None or high is None:
        return missing("the range cannot be read")
    if (angles >= low).all() and (angles <= high).all():
        return used("not imposed; Table 4 keeps it")
    return rules.contradicts(f"Table 4 runs from {angles.min():.4g} to {angles.max():.4g} rad")


def _longest(table: Table) -> list[Cell]:
    return [max((table[row, f"joint {j + 1}"] for j in JOINTS), key=size) for row in TIMES]


def _least(table: Table, row: str) -> str:
    """Column of the least printed number in a row."""
    return min(table.columns, key=lambda column: table.value(row, column))
