"""The UR5 paper on the improved sparrow search: arm, helix, convergence of four variants, durations, claims."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from study.cases.library import load_case
from study.planners import sparrow as planners
from study.reproduction import convergence, rules
from study.reproduction.duration_rows import Row, rule
from study.reproduction.jobs import MEASURED, Record, RecordJob
from study.reproduction.kinematics_runs import KinematicsJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary, judged
from study.reproduction.paper import Drive, Panel, PaperRuns, at_any_share
from study.reproduction.sampling import Comparison, Statistic, compared, converse, in_every
from study.reproduction.uniformity import more_uniform
from study.reproduction.verdicts import BY_RUNS, IN_PRINT, Basis, Place, Ruling, Rulings, claim, missing
from study.robots import robot_named
from study.robots.helix import helix_configurations, helix_points
from study.search.ssa import SSA, Start
from study.search.state import Search

CASE = "ur5-helix"
SEARCHES: dict[str, Search[Any]] = {
    "SSA": planners.SSA_PLANNER.search,
    "T-SSA": planners.T_SSA.search,
    "ADF-SSA": planners.ADF_SSA.search,
    "TADF-SSA": planners.TADF_SSA.search,
}
OTHERS: dict[str, dict[str, Search[Any]]] = {
    "SSA": {"as printed": planners.SSA_AS_PRINTED.search},
    "T-SSA": {"start not rescaled": SSA(start=Start.TENT), "as printed": planners.T_SSA_AS_PRINTED.search},
    "ADF-SSA": {"as printed": planners.ADF_SSA_AS_PRINTED.search},
    "TADF-SSA": {
        "start not rescaled": SSA(start=Start.TENT, adaptive_beta=True, adaptive_k=True),
        "as printed": planners.TADF_SSA_AS_PRINTED.search,
    },
}
SEGMENTS = tuple(f"h{k}" for k in range(1, 20))
TEN = 10
"""Runs behind Table 5 and Figure 7."""


class Sparrow(PaperRuns):
    """The UR5 paper on the improved sparrow search: arm, helix, convergence of four variants, durations, claims."""

    key: ClassVar[str] = "ur5-tadf-ssa"
    short: ClassVar[str] = "sparrow"
    maps: ClassVar[tuple[str, ...]] = ("uniform", "tent", "perturbed-tent")

    def motion(self, variant: str, reading: str = "") -> MotionJob:
        """Job of one column of Table 5."""
        search = OTHERS[variant][reading] if reading else SEARCHES[variant]
        return MotionJob(CASE, search, None, 100, self.effort.generations(80), self.effort.seeds)

    def readings(self, variant: str) -> list[str]:
        """Readings that are run beside the stated one."""
        return [*OTHERS[variant]] if self.effort.all_readings else []

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        gathered: list[RecordJob] = [OptimumJob(CASE), KinematicsJob()]
        return gathered + [self.motion(name, reading) for name in SEARCHES for reading in ("", *self.readings(name))]

    def rulings(self) -> Rulings:
        """Rule on everything that the print alone does not decide."""
        gathered = self._kinematics() | self._convergence() | self._durations() | self._timing()
        return gathered | self._orders() | self._stability() | self._formulas()

    def record(self, variant: str, reading: str = "") -> Record:
        """Our runs of a variant."""
        return self.runs[self.motion(variant, reading)]

    def summary(self, variant: str) -> Summary | None:
        """Our feasible runs of a variant."""
        return self.timed(CASE, [self.motion(variant)])

    def _kinematics(self) -> Rulings:
        """Points of the helix, and the joint angles on the branch and with the orientation that Table 3 shows."""
        values = {"Table 2": 1000 * helix_points(), "Table 3": helix_configurations(robot_named("ur5e-ssa"))}
        gathered: Rulings = {}
        for number, computed in values.items():
            table = self.tables[number]
            for cell in table.cells:
                value = float(computed[int(cell.row) - 1, table.columns.index(cell.column)])
                gathered[Place(number, cell.row, cell.column)] = rules.exact(cell.printed, value, Basis.FORMULA)
        pitch = values["Table 2"][1, 2] / 18.0 * 360.0
        why = f"Table 2 rises by {pitch:.1f} mm in a turn, 10 mm in a radian"
        return gathered | {claim("helix-pitch"): rules.contradicts(why)}

    def _convergence(self) -> Rulings:
        table = self.tables["Table 5"]
        gathered: Rulings = {}
        for variant in SEARCHES:
            record, late = self.record(variant), convergence.late([self.record(variant)])
            steps, seconds = table["iterations at convergence", variant], table["fitness at convergence (s)", variant]
            means = convergence.levels(record, lambda counts: float(np.mean(counts)))
            best = int(np.argmin(record["finals"]))
            remark = f"means and bests of {TEN} runs, drawn from our {self.effort.seeds}"
            total = rules.duration(seconds.printed, record["finals"], remark, Statistic.MEAN, TEN)
            counted = rules.count(steps.printed, means, late)
            gathered |= {Place("Table 5", steps.row, variant): counted.beside(self._beside(variant, "steps"))}
            gathered |= {Place("Table 5", seconds.row, variant): total.beside(self._beside(variant, "finals"))}
            figure = self.claims[f"best-{variant.lower()}"]
            least = rules.duration(figure.printed.removesuffix("s"), record["finals"], remark, Statistic.BEST, TEN)
            gathered[claim(figure.id)] = least
            own = {level: float(counts[best]) for level, counts in record["settled"].items()}
            figure = self.claims[f"iterations-{variant.lower()}"]
            gathered[claim(figure.id)] = rules.count(figure.printed, own, late)
        return gathered

    def _beside(self, variant: str, what: str) -> dict[str, str]:
        gathered = {}
        for name in self.readings(variant):
            record = self.record(variant, name)
            means = convergence.levels(record, lambda counts: float(np.mean(counts)))
            text = " / ".join(f"{steps:.1f}" for steps in means.values())
            gathered[name] = text if what == "steps" else f"{np.mean(record['finals']):.4f} s"
        return gathered

    def _durations(self) -> Rulings:
        table, case = self.tables["Table 6"], load_case(CASE)
        row = Row(table.row("time", SEGMENTS), None, case)
        ours = self.summary("TADF-SSA")
        gathered = self.placed("Table 6", rule(row, ours, self.fastest(CASE)), {})
        total = float(row.durations.sum())
        why = (
            f"called the mean of five runs, it is the sum of the one run in Table 6 ({total:.4f} s), and below "
            f"the best of ten "
            f"({self.claims['best-tadf-ssa'].value:g} s)"
        )
        gathered[claim("total-runs")] = rules.contradicts(why)
        gathered[claim("total", IN_PRINT)] = rules.contradicts(why)
        if totals := self.totals(ours):
            remark = f"mean of five; fastest on this curve {self.fastest(CASE):.4f} s"
            compared_with = rules.duration("8.6618", totals, remark, Statistic.MEAN, 5)
            gathered[claim("total", BY_RUNS)] = compared_with
            printed = self.claims["reduction"].printed
            gathered[claim("reduction", BY_RUNS)] = rules.reduction(
                printed, [self.claims["total-before"].value], totals
            )
        return gathered

    def _timing(self) -> Rulings:
        """Computing times per pose; the paper's are for all sample points in one calculation."""
        seconds = self.runs[KinematicsJob()][MEASURED]
        saving = {way: 100 * (1 - seconds[f"{way} one"] / seconds[f"{way} eight"]) for way in ("scalar", "vectorised")}
        text = f"{saving['scalar']:.0f} % pose by pose, {saving['vectorised']:.0f} % vectorised"
        eight, domain = self.claims["ik-time-eight"].value, self.claims["ik-time-domain"].value
        reason = (
            "how much is saved depends on what the eight solutions share, and no code is given; ours "
            "shares nothing between them"
        )
        share, sum_of = 100 * (1 - domain / eight), f"100 ({eight:g} - {domain:g}) / {eight:g}"
        gathered: Rulings = {}
        for name, printed in (("ik-saving", "39.76%"), ("ik-saving-abstract", "40%")):
            gathered[claim(name, BY_RUNS)] = missing(reason, text)
            gathered[claim(name, IN_PRINT)] = rules.exact(printed, share, Basis.PRINT, sum_of)
        for name, way in (("ik-time-eight", "eight"), ("ik-time-domain", "one")):
            ours = (
                f"{1e3 * seconds[f'scalar {way}']:.3g} ms a pose, one by one; "
                f"{1e3 * seconds[f'vectorised {way}']:.3g} ms a pose, vectorised"
            )
            reason = "a wall time in Matlab 2019b for all points in one calculation; how many points is not said"
            gathered[claim(name)] = missing(reason, ours)
        return gathered

    def _orders(self) -> Rulings:
        """Statements about an order between the variants."""

        def finals(variant: str) -> list[float]:
            return list(self.record(variant)["finals"])

        others = ("SSA", "T-SSA", "ADF-SSA")
        first = self.before("TADF-SSA", others)
        tent = in_every({"SSA": compared(finals("T-SSA"), finals("SSA"))}, "T-SSA ends lower than SSA")
        return {
            claim("tadf-shortest"): in_every({o: compared(finals("TADF-SSA"), finals(o)) for o in others}),
            claim("tadf-first"): self._with_printed(first, others),
            claim("adf-improves"): in_every({"SSA": compared(finals("ADF-SSA"), finals("SSA"))}, "final values"),
            claim("tent-alone"): converse(tent, "printed 12.14 s against 10.87 s, 12 % slower"),
        }

    def before(self, variant: str, others: tuple[str, ...], reading: str = "") -> Ruling:
        """Rule on whether a variant converges before others, at the share of the descent at which it does most often."""

        def tests(level: str) -> dict[str, Comparison]:
            own = self.record(variant, reading)["settled"][level]
            return {other: compared(own, self.record(other, reading)["settled"][level]) for other in others}

        return at_any_share(tests)[0]

    def _with_printed(self, ruling: Ruling, others: tuple[str, ...]) -> Ruling:
        if not self.effort.all_readings:
            return ruling
        printed = self.before("TADF-SSA", others, "as printed")
        return replace(ruling, others={"as printed": f"{printed.outcome}: {printed.ours}; {printed.why}"})

    def _stability(self) -> Rulings:
        """Distance of the mean of ten runs from their best, printed and ours."""
        table = self.tables["Table 5"]
        printed = [
            table.value("fitness at convergence (s)", v) - self.claims[f"best-{v.lower()}"].value for v in SEARCHES
        ]
        ours = [float(np.std(self.record(v)["finals"], ddof=1)) for v in SEARCHES]
        text = (
            f"printed mean minus best {min(printed):.2f} to {max(printed):.2f} s; ours scatter by "
            f"{min(ours):.2f} to {max(ours):.2f} s"
        )
        why = (
            "ten runs whose mean lies so near their best scatter by a few hundredths of a second; ours "
            "scatter several times more, "
            "which is the strongest doubt about Table 5"
        )
        return {claim("runs-stable"): rules.holds(min(ours) < 2 * max(printed), text, why)}

    def _formulas(self) -> Rulings:
        """Statements that formulas and the printed durations decide."""
        durations = np.array(self.tables["Table 6"].row_values("time", SEGMENTS))
        verdict = judged(load_case(CASE), durations)
        shares = verdict.ratios.max(axis=1)
        text = f"velocity {shares[0]:.3f}, acceleration {shares[1]:.3f}, jerk {shares[2]:.3f} of the limits"
        jerk = ", ".join(f"{share:.2f}" for share in verdict.ratios[2])
        progress = np.linspace(0.0, 1.0, 1001)
        step = progress * np.exp(np.sin(np.pi * progress))  # eq. (19), K_min and K_max aside
        peak = int(step.argmax())
        falls = (
            f"greatest {step[peak]:.3f} / K_max at {progress[peak]:.2f} of the run, {step[-1]:.3f} / K_max at its end"
        )
        still = {cell.printed for cell in self.tables["Table 3"].cells if cell.column == "theta6"}
        error = float(np.abs(verdict.waypoint_error).max())
        return {
            claim("tent-uniform"): more_uniform("perturbed-tent", ["uniform"]),
            claim("within-limits"): rules.holds(
                verdict.feasible, text, "inside the motion; the ends step in acceleration", Basis.FORMULA
            ),
            claim("jerk-far-below"): rules.contradicts(
                f"judged with the durations of Table 6, joints 1 to 5 use {jerk} of the limit", basis=Basis.FORMULA
            ),
            claim("k-falls"): rules.holds(step[-1] < 0.5 * step[peak], falls, "Eq. (19) with K_min = 0", Basis.FORMULA),
            claim("joint-6-still"): rules.holds(
                len(still) == 1, "", "theta6 is the same in every printed row of Table 3", Basis.PRINT
            ),
            claim("passes-points"): rules.holds(
                error < 1e-9, f"largest error {error:.1g} rad", "the spline interpolates its points", Basis.FORMULA
            ),
        }

    def panels(self) -> list[Panel]:
        """Convergence of the four variants, the paper's Figure 7."""
        marks = {name: self.claims[f"best-{name.lower()}"].value for name in SEARCHES}
        return [self.panel(CASE, {name: self.motion(name) for name in SEARCHES}, marks)]

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion, the paper's Figure 8."""
        printed = np.array(self.tables["Table 6"].row_values("time", SEGMENTS))
        return [self.drive(CASE, printed, "TADF-SSA", self.summary("TADF-SSA"))]
