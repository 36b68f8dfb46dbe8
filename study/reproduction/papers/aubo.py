"""The AUBO i5 paper (dynamic adaptive PSO): arm, points, durations of both conditions, claims."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import ClassVar

import numpy as np
from scipy.spatial.transform import Rotation

from study.cases.library import load_case
from study.cases.published import Cell, parsed
from study.planners.aubo import DYNAMIC_ADAPTIVE_PSO, DYNAMIC_ADAPTIVE_PSO_AS_PRINTED
from study.reproduction import rules
from study.reproduction.duration_rows import Row, rule
from study.reproduction.jobs import RecordJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary
from study.reproduction.paper import Drive, Panel, PaperRuns
from study.reproduction.verdicts import Outcome, Place, Ruling, Rulings, claim
from study.robots import robot_named
from study.search.pso import PSO, ClampUnit, VelocityUpdate

CASES = {
    "condition 1": ("aubo-i5", "aubo-i5-radians"),
    "condition 2": ("aubo-i5-condition-2", "aubo-i5-condition-2-radians"),
}
STANDARD_PSO = PSO((0.9, 0.9), 2.0, 2.0, VelocityUpdate(4.0, ClampUnit.ABSOLUTE))
"""The paper's opponent: learning factors 2 and clamp 4 printed, weight constant at the printed start; that one is ours."""

SEARCHES = {
    "adaptive": DYNAMIC_ADAPTIVE_PSO.search,
    "adaptive as printed": DYNAMIC_ADAPTIVE_PSO_AS_PRINTED.search,
    "PSO": STANDARD_PSO,
}
STAGES = ("first stage", "second stage", "third stage")
JOINTS = range(6)


class Aubo(PaperRuns):
    """The AUBO i5 paper (dynamic adaptive PSO): arm, points, durations of both conditions, claims."""

    key: ClassVar[str] = "aubo-dynamic-adaptive-pso"
    short: ClassVar[str] = "aubo"
    maps: ClassVar[tuple[str, ...]] = ()

    def motion(self, case: str, name: str, joint: int) -> MotionJob:
        """Job of one joint."""
        return MotionJob(case, SEARCHES[name], joint, 20, self.effort.generations(50), self.effort.seeds)

    def _names(self, case: str) -> list[str]:
        names = ["adaptive"] + (["adaptive as printed"] if self.effort.all_readings else [])
        return [*names, "PSO"] if case == "aubo-i5" else names

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        found: list[RecordJob] = []
        for case in (name for pair in CASES.values() for name in pair):
            found += [self.motion(case, name, joint) for name in self._names(case) for joint in JOINTS]
            found += [OptimumJob(case)]
        return [
            *found,
            *(OptimumJob("aubo-i5", joint) for joint in JOINTS),
            *(OptimumJob("aubo-i5-radians", joint) for joint in (0, 2)),
        ]

    def rulings(self) -> Rulings:
        """Rule on everything."""
        found = self._poses() | self._durations()
        return found | self._fitness() | self._iterations() | self._statements()

    def summary(self, case: str, name: str) -> Summary | None:
        """Our runs with all joints put together."""
        return self.timed(case, [self.motion(case, name, joint) for joint in JOINTS])

    def _poses(self) -> Rulings:
        """Forward kinematics of Table 2 with Table 1; roll about z, pitch about y, yaw about x of the base."""
        table, angles = self.tables["Table 3"], self.tables["Table 2"]
        found: Rulings = {}
        for row in ("W1", "W2", "initial endpoint"):
            degrees = [0.0 if row not in ("W1", "W2") else angles.value(row, f"theta{j} (deg)") for j in range(1, 7)]
            frame = robot_named("aubo-i5").forward(np.radians(degrees)[None])[0]
            turned = Rotation.from_matrix(frame[:3, :3]).as_euler("zyx", degrees=True)
            for column, value in zip(table.columns, (*(1000 * frame[:3, 3]), *turned), strict=True):
                cell = table[row, column]
                if "deg" in column:
                    value = _nearest_turn(value, cell)
                why = f"Table 1 gives {value:.5g} here"
                found[Place("Table 3", row, column)] = rules.exact(cell.printed, float(value), Outcome.CONTRADICTS, why)
        return found

    def _durations(self) -> Rulings:
        table = self.tables["Table 5"]
        found: Rulings = {}
        for k, (condition, (degrees, radians)) in enumerate(CASES.items(), start=1):
            row = Row(table.row(condition, STAGES), table[condition, "total time"], load_case(degrees))
            fastest = [self.fastest(case) for case in (degrees, radians)]
            note = f" (radian columns {fastest[1]:.4f} s)"
            ruled = rule(row, self.summary(degrees, "adaptive"), fastest[0], note)
            others = self._other_totals(degrees, radians)
            for cell, ruling in ruled:
                shown = others if cell.column == "total time" else {}
                found[Place("Table 5", condition, cell.column)] = replace(
                    ruling, reading="standard, degree columns", others=shown
                )
            found[claim(f"total-{k}")] = found[Place("Table 5", condition, "total time")]
        return found

    def _other_totals(self, degrees: str, radians: str) -> dict[str, str]:
        wanted = {"radian columns": (radians, "adaptive")}
        if self.effort.all_readings:
            wanted |= {
                "as printed": (degrees, "adaptive as printed"),
                "radian columns, as printed": (radians, "adaptive as printed"),
            }
        found = {label: self.summary(case, name) for label, (case, name) in wanted.items()}
        return {label: "no feasible run" if one is None else f"{one.total:.4f} s" for label, one in found.items()}

    def _fitness(self) -> Rulings:
        """Printed ends of Figure 14 against the fastest motions of the joint, in either column."""
        found: Rulings = {}
        for name, joint in product(("pso", "adaptive"), (1, 3)):
            identity = f"fitness-{name}-joint-{joint}"
            cell = self.claims[identity].cell
            text = cell.printed.split()[-1]
            fastest = {case: self.fastest(case, joint - 1) for case in ("aubo-i5", "aubo-i5-radians")}
            least = min(fastest.values())
            ours = " and ".join(f"{value:.4f} s" for value in fastest.values())
            value = parsed(text) or 0.0
            if value + rules.half_unit(text) < least:
                why = "below the fastest motion of this joint at 5 rad/s, in the degree and in the radian column"
                found[claim(identity)] = Ruling(Outcome.INFEASIBLE, ours, why, False)
            else:
                found[claim(identity)] = rules.duration(text, least)
        return found

    def _iterations(self) -> Rulings:
        known = self.claims
        found: Rulings = {}
        for label, name in (("adaptive", "adaptive"), ("pso", "PSO")):
            for joint in (1, 4):
                identity = f"iterations-{label}-joint-{joint}"
                settled = float(np.median(self.runs[self.motion("aubo-i5", name, joint - 1)]["settled"]))
                text = known[identity].printed.replace("10-20", "20")
                found[claim(identity)] = rules.count(text, settled, at_most="-" in known[identity].printed)
        return found

    def _statements(self) -> Rulings:
        found: Rulings = {}
        for identity, key in (("better-than-pso", "finals"), ("faster-than-pso", "settled")):
            tests = {
                joint: rules.smaller(
                    *(self.runs[self.motion("aubo-i5", name, joint)][key] for name in ("adaptive", "PSO"))
                )
                for joint in JOINTS
            }
            won = [str(joint + 1) for joint, (smaller, _) in tests.items() if smaller]
            text = f"joints {', '.join(won) or 'none'} of 1 to 6"
            found[claim(identity)] = rules.holds(len(won) == len(JOINTS), text, "by the rank-sum test over seeds")
        return found

    def panels(self) -> list[Panel]:
        """Convergence on every joint in condition 1, the paper's Figure 14."""
        names = ("adaptive", "PSO")
        return [
            Panel(f"joint {joint + 1}", {name: self.line(self.motion("aubo-i5", name, joint)) for name in names})
            for joint in JOINTS
        ]

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion of both conditions, degree columns."""
        table, found = self.tables["Table 5"], []
        for condition, (case, _) in CASES.items():
            printed = np.array([table.value(condition, stage) for stage in STAGES])
            found.append(self.drive(case, printed, "adaptive PSO", self.summary(case, "adaptive")))
        return found


def _nearest_turn(value: float, cell: Cell) -> float:
    """Same angle, in the turn of the printed one."""
    return value + 360.0 * round(((cell.value or 0.0) - value) / 360.0)
