"""The UR5 paper on the improved sparrow search: arm, helix, convergence of four variants, durations, claims."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from study.cases.library import load_case
from study.planners import sparrow as planners
from study.reproduction import rules
from study.reproduction.duration_rows import Row, rule
from study.reproduction.jobs import MEASURED, Record, RecordJob
from study.reproduction.kinematics_runs import KinematicsJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary, judged
from study.reproduction.paper import Drive, Panel, PaperRuns
from study.reproduction.uniformity import more_uniform
from study.reproduction.verdicts import Outcome, Place, Ruling, Rulings, claim, missing
from study.robots import robot_named
from study.robots.helix import helix_configurations, helix_points
from study.search.state import Search

CASE = "ur5-helix"
SEARCHES: dict[str, Search[Any]] = {
    "SSA": planners.SSA_PLANNER.search,
    "T-SSA": planners.T_SSA.search,
    "ADF-SSA": planners.ADF_SSA.search,
    "TADF-SSA": planners.TADF_SSA.search,
}
AS_PRINTED: dict[str, Search[Any]] = {
    "SSA": planners.SSA_AS_PRINTED.search,
    "T-SSA": planners.T_SSA_AS_PRINTED.search,
    "ADF-SSA": planners.ADF_SSA_AS_PRINTED.search,
    "TADF-SSA": planners.TADF_SSA_AS_PRINTED.search,
}
SEGMENTS = tuple(f"h{k}" for k in range(1, 20))


class Sparrow(PaperRuns):
    """The UR5 paper on the improved sparrow search: arm, helix, convergence of four variants, durations, claims."""

    key: ClassVar[str] = "ur5-tadf-ssa"
    short: ClassVar[str] = "sparrow"
    maps: ClassVar[tuple[str, ...]] = ("uniform", "tent", "perturbed-tent")

    def motion(self, variant: str, printed: bool = False) -> MotionJob:
        """Job of one column of Table 5."""
        search = (AS_PRINTED if printed else SEARCHES)[variant]
        return MotionJob(CASE, search, None, 100, self.effort.generations(80), self.effort.seeds)

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        found: list[RecordJob] = [OptimumJob(CASE), KinematicsJob()]
        found += [self.motion(variant) for variant in SEARCHES]
        return found + [self.motion(variant, True) for variant in AS_PRINTED if self.effort.all_readings]

    def rulings(self) -> Rulings:
        """Rule on everything."""
        found = self._kinematics() | self._convergence() | self._durations()
        return found | self._timing() | self._statements()

    def _kinematics(self) -> Rulings:
        robot = robot_named("ur5e-ssa")
        positions, angles = 1000 * helix_points(), helix_configurations(robot)
        found: Rulings = {}
        for number, values in (("Table 2", positions), ("Table 3", angles)):
            table = self.tables[number]
            for cell in table.cells:
                value = float(values[int(cell.row) - 1, table.columns.index(cell.column)])
                found[Place(number, cell.row, cell.column)] = rules.exact(cell.printed, value, Outcome.CONTRADICTS)
        pitch = positions[1, 2] / 18.0 * 360.0
        found[claim("helix-pitch")] = rules.contradicts(f"Table 2 rises by {pitch:.1f} mm in a turn, 10 mm in a radian")
        return found

    def summary(self, variant: str, printed: bool = False) -> Summary | None:
        """Our feasible runs of a variant."""
        return self.timed(CASE, [self.motion(variant, printed)])

    def _convergence(self) -> Rulings:
        table, known = self.tables["Table 5"], self.claims
        found: Rulings = {}
        for variant in SEARCHES:
            record = self.runs[self.motion(variant)]
            mean = float(np.mean(record["settled"]))
            best = record["settled"][int(np.argmin(record["finals"]))]
            row = "iterations at convergence"
            others = self._printed_reading(variant, "settled")
            found[Place("Table 5", row, variant)] = replace(
                rules.count(table[row, variant].printed, mean), others=others
            )
            row = "fitness at convergence (s)"
            others = self._printed_reading(variant, "finals")
            found[Place("Table 5", row, variant)] = replace(
                _mean_total(table[row, variant].printed, record), others=others
            )
            identity = variant.lower()
            cell = known[f"best-{identity}"].cell
            least, greatest = min(record["finals"]), max(record["finals"])
            found[claim(cell.row)] = rules.duration(
                cell.printed.removesuffix("s"), least, "best seed", (least, greatest)
            )
            found[claim(f"iterations-{identity}")] = rules.count(known[f"iterations-{identity}"].printed, best)
        return found

    def _printed_reading(self, variant: str, key: str) -> dict[str, str]:
        if not self.effort.all_readings:
            return {}
        return {"as printed": f"{np.mean(self.runs[self.motion(variant, True)][key]):.4g}"}

    def _durations(self) -> Rulings:
        table, known, case = self.tables["Table 6"], self.claims, load_case(CASE)
        row = Row(table.row("time", SEGMENTS), None, case)
        fastest = self.fastest(CASE)
        ours = self.summary("TADF-SSA")
        found: Rulings = {Place("Table 6", "time", c.column): r for c, r in rule(row, ours, fastest)}
        total = float(row.durations.sum())
        why = (
            f"called the mean of five runs, it is the sum of the one run in Table 6 ({total:.4f} s), and below the best of ten "
            f"({known['best-tadf-ssa'].value:g} s)"
        )
        found[claim("total")] = rules.contradicts(why, "" if ours is None else f"{ours.total:.4f} s")
        return found | {claim("total-runs"): rules.contradicts(why)}

    def _timing(self) -> Rulings:
        seconds, known = self.runs[KinematicsJob()][MEASURED], self.claims
        saving = {way: 100 * (1 - seconds[f"{way} one"] / seconds[f"{way} eight"]) for way in ("scalar", "vectorised")}
        text = f"{saving['scalar']:.0f} % pose by pose, {saving['vectorised']:.0f} % vectorised"
        agrees = min(saving.values()) >= known["ik-saving"].value
        outcome = Outcome.BETTER if agrees else Outcome.WORSE
        eight, domain = known["ik-time-eight"].value, known["ik-time-domain"].value
        why = (
            f"printed {100 * (1 - domain / eight):.2f} %; one branch of eight saves more when nothing else is computed"
        )
        found: Rulings = {
            claim(name): Ruling(outcome, text, why, False) for name in ("ik-saving", "ik-saving-abstract")
        }
        for name, way in (("ik-time-eight", "eight"), ("ik-time-domain", "one")):
            ours = f"{1e3 * seconds[f'scalar {way}']:.3g} ms pose by pose, {1e3 * seconds[f'vectorised {way}']:.3g} ms vectorised"
            found[claim(name)] = missing(
                "a wall time: the language is not given, and only its ratio can be compared", ours
            )
        return found

    def _statements(self) -> Rulings:
        table = self.tables["Table 6"]
        verdict = judged(load_case(CASE), np.array([table.value("time", column) for column in SEGMENTS]))
        shares = verdict.ratios.max(axis=1)
        text = f"velocity {shares[0]:.3f}, acceleration {shares[1]:.3f}, jerk {shares[2]:.3f} of the limits"
        jerk = ", ".join(f"{share:.2f}" for share in verdict.ratios[2])
        found: Rulings = {
            claim("tent-uniform"): more_uniform("perturbed-tent", ["uniform"]),
            claim("within-limits"): rules.holds(
                verdict.feasible, text, "inside the motion; the ends step in acceleration"
            ),
            claim("jerk-far-below"): rules.contradicts(
                "judged with the durations of Table 6", f"joints 1 to 5 use {jerk} of the limit"
            ),
        }
        for identity, key in (("tadf-shortest", "finals"), ("tadf-first", "settled")):
            own, lost = self.runs[self.motion("TADF-SSA")][key], []
            for other in ("SSA", "T-SSA", "ADF-SSA"):
                if not rules.smaller(own, self.runs[self.motion(other)][key])[0]:
                    lost.append(other)
            why = f"not by the rank-sum test against {', '.join(lost)}" if lost else "by the rank-sum test over seeds"
            found[claim(identity)] = rules.holds(not lost, f"{3 - len(lost)} of 3 comparisons", why)
        smaller, p = rules.smaller(*(self.runs[self.motion(name)]["finals"] for name in ("T-SSA", "SSA")))
        found[claim("tent-alone")] = rules.holds(
            not smaller, f"p = {p:.2g}", "rank-sum test of T-SSA against SSA over seeds"
        )
        return found

    def panels(self) -> list[Panel]:
        """Convergence of the four variants, the paper's Figure 7."""
        return [Panel("total time, s", {name: self.line(self.motion(name)) for name in SEARCHES})]

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion, the paper's Figure 8."""
        table = self.tables["Table 6"]
        printed = np.array([table.value("time", column) for column in SEGMENTS])
        return [self.drive(CASE, printed, "TADF-SSA", self.summary("TADF-SSA"))]


def _mean_total(printed: str, record: Record) -> Ruling:
    finals = record["finals"]
    return rules.duration(printed, float(np.mean(finals)), f"mean of {len(finals)} seeds", (min(finals), max(finals)))
