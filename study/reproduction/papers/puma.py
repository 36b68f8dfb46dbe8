"""The PUMA560 paper (RRT and chaotic PSO): arm, benchmark table, durations, the pipeline over many worlds, claims."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from study.cases.library import Case, load_case
from study.cases.printed import Cell, Table, parsed
from study.planners.puma import CHAOTIC_SPSO, CHAOTIC_SPSO_AS_PRINTED
from study.planners.rrt_spso import ROBOT
from study.reproduction import convergence, rules
from study.reproduction.duration_rows import Row, rule, ruling_of, size
from study.reproduction.genetic_runs import GeneticJob
from study.reproduction.jobs import RecordJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary, judged, motion_of, summarised, synchronised
from study.reproduction.paper import Drive, Panel, PaperRuns
from study.reproduction.papers import collisions, puma_orders
from study.reproduction.sampling import Statistic
from study.reproduction.uniformity import lyapunov, more_uniform
from study.reproduction.verdicts import BY_RUNS, Basis, Outcome, Place, Ruling, Rulings, claim, missing, used
from study.robots import robot_named

CASE = "puma560"
TIMES = ("time 1", "time 2", "time 3")
JOINTS = range(6)
AS_PRINTED = "inertia as printed"
ITERATIONS = {
    "f1-iterations": ("F1", ("SPSO",)), "f1-iterations-others": ("F1", ("STOA", "SCA")), "f1-iterations-pso": ("F1", ("PSO",)),
    "f2-iterations": ("F2", ("SPSO",)), "f3-iterations": ("F3", ("SPSO",)), "f3-iterations-pso": ("F3", ("PSO",)),
    "f4-iterations": ("F4", ("SPSO",)), "f5-iterations": ("F5", ("SPSO",)), "f5-iterations-sca": ("F5", ("SCA",)),
    "f5-iterations-stoa": ("F5", ("STOA",)), "f6-iterations": ("F6", ("SPSO",)),
}  # fmt: skip
ROUND = (
    "with these lengths and alpha1 = +pi/2 Table 4 starts at (100, 100, 10) mm, ends at (100, -70, "
    "10) mm and keeps its orientation"
)


class Puma(PaperRuns):
    """The PUMA560 paper (RRT and chaotic PSO): arm, benchmark table, durations, the pipeline over many worlds, claims."""

    key: ClassVar[str] = "puma560-chaotic-spso"
    short: ClassVar[str] = "puma"
    maps: ClassVar[tuple[str, ...]] = ("uniform", "logistic", "circle", "singer", "sine-tent-cosine")

    def motion(self, joint: int, printed: bool = False) -> MotionJob:
        """Job of one column of Table 5; population and generations are ours."""
        search = (CHAOTIC_SPSO_AS_PRINTED if printed else CHAOTIC_SPSO).search
        return MotionJob(CASE, search, joint, 30, self.effort.generations(100), self.effort.seeds)

    def genetic(self, joint: int) -> GeneticJob:
        """Job of NSGA-II on one joint."""
        return GeneticJob(CASE, joint, 30, self.effort.generations(100), min(self.effort.seeds, 5))

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        gathered: list[RecordJob] = [*self.benchmarks.jobs(), OptimumJob(CASE)]
        for joint in JOINTS:
            gathered += [self.motion(joint), OptimumJob(CASE, joint), self.genetic(joint)]
            gathered += [self.motion(joint, True)] if self.effort.all_readings else []
        return gathered + collisions.jobs(self.effort)

    def rulings(self) -> Rulings:
        """Rule on everything that the print alone does not decide."""
        gathered = self._arm() | self.benchmarks.rulings() | self._benchmark_claims() | self._iterations()
        gathered |= self._durations() | self._totals() | self._formulas()
        return (
            gathered
            | puma_orders.rulings(self.tables["Table 3"], self.benchmarks)
            | collisions.rulings(self.runs, self.effort)
        )

    def _arm(self) -> Rulings:
        """Table 1, checked by the kinematics of Table 4."""
        table, waypoints = self.tables["Table 1"], load_case(CASE).problem.waypoints
        gathered: Rulings = {}
        for cell in table.cells:
            place = Place("Table 1", cell.row, cell.column)
            if cell.column == "joint range":
                gathered[place] = _range(cell, waypoints[:, int(cell.row.split()[1]) - 1])
            elif cell.column == "theta":
                gathered[place] = used(
                    "read as the pose of Figure 2: as offsets these angles would turn the tool from point to point"
                )
            elif (cell.row, cell.column) == ("joint 1", "alpha"):
                gathered[place] = _twist(waypoints)
            else:
                gathered[place] = Ruling(Outcome.CONSISTENT, cell.printed, ROUND, True, basis=Basis.FORMULA)
        return gathered

    def _benchmark_claims(self) -> Rulings:
        table3 = self.tables["Table 3"]
        gathered: Rulings = {}
        for k in range(1, 7):
            stated, printed = self.claims[f"f{k}-best"], table3[f"F{k}, min", "SPSO"]
            finals = self.benchmarks.record(f"F{k}", "SPSO")["finals"]
            least = self.benchmarks.stated(f"F{k}", "SPSO").benchmark.minimum or 0.0
            ruling = self.fitted(rules.stochastic(stated.printed, finals, Statistic.BEST, 30, least))
            same = rules.close(printed.value or 0.0, stated.printed, stated.value)
            gathered[claim(stated.id)] = (
                ruling if same else rules.contradicts(f"Table 3 prints {printed.printed}", ruling.ours)
            )
        return gathered

    def _iterations(self) -> Rulings:
        gathered: Rulings = {}
        for identity, (function, columns) in ITERATIONS.items():
            records = [self.benchmarks.record(function, column) for column in columns]
            gathered[claim(identity)] = self.fitted(
                rules.count(self.claims[identity].printed, convergence.slowest(records), convergence.late(records))
            )
        records = [self.runs[self.motion(joint)] for joint in JOINTS]
        printed = f"within {self.claims['iterations-arm'].printed}"
        ruling = rules.count(printed, convergence.slowest(records), convergence.late(records))
        others = (
            {AS_PRINTED: self.steps([self.runs[self.motion(j, True)] for j in JOINTS])}
            if self.effort.all_readings
            else {}
        )
        return gathered | {claim("iterations-arm"): ruling.beside(others)}

    def summary(self, joint: int | None = None, printed: bool = False) -> Summary | None:
        """Our runs of one joint, or all put together."""
        joints = JOINTS if joint is None else [joint]
        return self.timed(CASE, [self.motion(j, printed) for j in joints], joint)

    def _others(self, joint: int | None = None) -> dict[str, str]:
        return self.told({AS_PRINTED: self.summary(joint, True)}) if self.effort.all_readings else {}

    def _durations(self) -> Rulings:
        table, case = self.tables["Table 5"], load_case(CASE)
        start = judged(case, np.ones(3))
        why = f"the start; its motion uses {start.worst_ratio:.4f} of pi rad/s, the limit that we infer"
        gathered: Rulings = {Place("Table 5", head, "initialisation"): used(why) for head in (*TIMES, "total time")}
        for joint in JOINTS:
            column = f"joint {joint + 1}"
            row = Row([table[head, column] for head in TIMES], table["total time", column], case, joint, inferred=True)
            gathered |= self.placed(
                "Table 5", rule(row, self.summary(joint), self.fastest(CASE, joint)), self._others(joint)
            )
        return gathered

    def _totals(self) -> Rulings:
        row = Row(_longest(self.tables["Table 5"]), self.claims["total"].cell, load_case(CASE), inferred=True)
        ours, fastest = self.summary(), self.fastest(CASE)
        *segments, (_, total) = rule(row, ours, fastest)
        gathered: Rulings = {claim(f"t{k}"): ruling for k, (_, ruling) in enumerate(segments, start=1)}
        gathered |= {claim("total"): total.beside(self._others())}
        gathered[Place("Table 6", "NSGA-II", "total time")] = self._genetic(fastest)
        for identity in (
            "reduction-abstract",
            "reduction-section-4",
            "reduction-section-4-again",
            "reduction-conclusion",
        ):
            if totals := self.totals(ours):
                gathered[claim(identity, BY_RUNS)] = rules.reduction(self.claims[identity].printed, [3.0], totals)
        return gathered

    def _genetic(self, fastest: float) -> Ruling:
        records = [self.runs[self.genetic(joint)] for joint in JOINTS]
        why = (
            "the paper's is an improved NSGA-II on a path put in by hand; its objectives, settings and path "
            "are not given"
        )
        if not all(record["durations"] for record in records):
            return missing(f"{why}; ours needs pymoo, which is not installed (the extra `peers` brings it)")
        ours = summarised(load_case(CASE), synchronised(records))
        return missing(why, ruling_of("2.38035", ours, f"fastest on this curve {fastest:.4f} s").ours)

    def _formulas(self) -> Rulings:
        """Statements that the maps, the printed durations and the printed totals decide."""
        table5, table6 = self.tables["Table 5"], self.tables["Table 6"]
        longer = [
            f"{row} of {column} {table5[row, column].printed}"
            for row in TIMES
            for column in table5.columns[1:]
            if table5.value(row, column) > 1.0
        ]
        totals = table5.row_values("total time", table5.columns[1:])
        total, printed = self.claims["total"].value, table6.value("RRT-SPSO", "total time")
        genetic = table6.value("NSGA-II", "total time")
        improved = table6.value("improved RRT", "total time")
        low, high = (tuple(lyapunov(r) for r in span) for span in ((0.05, 0.2, 0.35, 0.49), (0.81, 0.9, 1.0)))
        text = (
            f"Lyapunov exponent {min(low):.2f} to {max(low):.2f} for r from 0.05 to 0.49, {min(high):.2f} to "
            f"{max(high):.2f} above 0.8"
        )
        slower = f"Section 4's own total {total} s is longer than {genetic} s"
        return {
            claim("hybrid-uniform"): more_uniform("sine-tent-cosine", ["logistic", "circle", "singer", "uniform"]),
            claim("chaos-low-r"): rules.holds(max(low) <= 0, text, "positive is chaotic", Basis.FORMULA),
            claim("chaos-high-r"): rules.holds(
                min(high) > 0, text, "positive is chaotic, and it is so for every r", Basis.FORMULA
            ),
            claim("all-times-shorter"): rules.contradicts(f"Table 5 prints {', '.join(longer)} s for 1 s before"),
            claim("joints-more-even"): rules.contradicts(
                f"before optimisation every joint takes 3 s, after it Table 5 prints {min(totals):g} to "
                f"{max(totals):g} s"
            ),
            claim("smoother"): self._smoothness(),
            claim("slower-than-irrt"): rules.holds(
                improved < printed, f"{improved} s against {printed} s", "Table 6", Basis.PRINT
            ),
            claim("beats-nsga"): rules.contradicts(f"by Table 6 {printed} s against {genetic} s; but {slower}"),
        }

    def _smoothness(self) -> Ruling:
        """Peaks before and after optimisation; both motions are 3-5-3 polynomials."""
        case = load_case(CASE)
        after = np.array([cell.value for cell in _longest(self.tables["Table 5"])])
        (_, a0, j0), (_, a1, j1) = (peaks.max(axis=1) for peaks in (_peaks(case, np.ones(3)), _peaks(case, after)))
        text = f"largest acceleration {a0:.1f} to {a1:.1f} rad/s2, largest jerk {j0:.0f} to {j1:.0f} rad/s3"
        return rules.holds(
            a1 < a0 and j1 < j0, text, "both motions are 3-5-3 polynomials; at 1 s each and at 2.41665 s", Basis.FORMULA
        )

    def panels(self) -> list[Panel]:
        """Convergence on every joint."""
        table = self.tables["Table 5"]
        return [
            self.panel(CASE, {"SPSO": self.motion(j)}, {"SPSO": table.value("total time", f"joint {j + 1}")}, j)
            for j in JOINTS
        ]

    def drives(self) -> list[Drive]:
        """Motion before, printed, ours and fastest, of all joints together: the paper's Figure 10."""
        printed = np.array([cell.value for cell in _longest(self.tables["Table 5"])])
        return [self.drive(CASE, printed, "chaotic SPSO", self.summary(), np.ones(3))]


def _peaks(case: Case, durations: np.ndarray) -> np.ndarray:
    """Largest velocity, acceleration and jerk of every joint, shape (3, n_joints)."""
    motion = motion_of(case, durations)
    return np.array(
        [np.maximum(np.abs(motion.extrema(k).lowest), np.abs(motion.extrema(k).highest)) for k in (1, 2, 3)]
    )


def _twist(waypoints: np.ndarray) -> Ruling:
    """Rule on alpha1: with its printed sign the orientation changes and no end is round."""
    robot = robot_named(ROBOT)
    ends = 1000 * robot.forward(waypoints)[[0, -1], :3, 3]
    text = " and ".join(f"({x:.2f}, {y:.2f}, {z:.2f})" for x, y, z in ends)
    why = f"with +pi/2 Table 4 runs between {text} mm with constant orientation; with the printed -pi/2 no end is round"
    return rules.contradicts(why, "pi/2", Basis.FORMULA)


def _range(cell: Cell, angles: np.ndarray) -> Ruling:
    ends = [parsed(part) for part in cell.printed.strip("()").split(",")]
    low, high = ends[0], ends[-1]
    if low is None or high is None or low == high:
        return missing("0 is no range")
    if (angles >= low).all() and (angles <= high).all():
        return Ruling(Outcome.CONSISTENT, why="Table 4 keeps it", agrees=True, basis=Basis.PRINT)
    return rules.contradicts(f"Table 4 runs from {angles.min():.4g} to {angles.max():.4g} rad")


def _longest(table: Table) -> list[Cell]:
    return [max((table[row, f"joint {j + 1}"] for j in JOINTS), key=size) for row in TIMES]
