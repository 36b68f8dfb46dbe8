"""The AUBO i5 paper (dynamic adaptive PSO): arm, points, durations of both conditions, claims."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from itertools import product
from typing import Any, ClassVar

import numpy as np
from scipy.spatial.transform import Rotation

from study.cases.library import load_case
from study.cases.printed import Cell
from study.planners.aubo import (
    DYNAMIC_ADAPTIVE_PSO,
    DYNAMIC_ADAPTIVE_PSO_AS_PRINTED,
    DYNAMIC_ADAPTIVE_PSO_FALLING,
)
from study.reproduction import convergence, rules
from study.reproduction.duration_rows import Row, rule
from study.reproduction.jobs import RecordJob
from study.reproduction.motion_runs import MotionJob, OptimumJob, Summary, judged
from study.reproduction.paper import Drive, Panel, PaperRuns
from study.reproduction.sampling import compared, in_every
from study.reproduction.verdicts import BY_RUNS, Basis, Outcome, Place, Ruling, Rulings, claim
from study.robots import robot_named
from study.search.pso import PSO, ClampUnit, VelocityUpdate
from study.search.state import Search

CASES = {
    "condition 1": ("aubo-i5", "aubo-i5-radians"),
    "condition 2": ("aubo-i5-condition-2", "aubo-i5-condition-2-radians"),
}
STANDARD_PSO = PSO((0.9, 0.9), 2.0, 2.0, VelocityUpdate(4.0, ClampUnit.ABSOLUTE))
"""The paper's opponent: learning factors 2 and clamp 4 printed, weight constant at the printed start; that one is ours."""

STATED = "Eqs. (13), (14) as printed, start inside the box"
FALLING = "weights falling"
LETTER = "as printed, start outside the box"
SEARCHES: dict[str, Search[Any]] = {
    STATED: DYNAMIC_ADAPTIVE_PSO.search,
    FALLING: DYNAMIC_ADAPTIVE_PSO_FALLING.search,
    LETTER: DYNAMIC_ADAPTIVE_PSO_AS_PRINTED.search,
    "PSO": STANDARD_PSO,
}
"""Readings of the adaptive search, the stated one mending only what cannot run, and its opponent."""

STAGES = ("first stage", "second stage", "third stage")
JOINTS = range(6)


class Aubo(PaperRuns):
    """The AUBO i5 paper (dynamic adaptive PSO): arm, points, durations of both conditions, claims."""

    key: ClassVar[str] = "aubo-dynamic-adaptive-pso"
    short: ClassVar[str] = "aubo"

    def motion(self, case: str, name: str, joint: int) -> MotionJob:
        """Job of one joint."""
        return MotionJob(case, SEARCHES[name], joint, 20, self.effort.generations(50), self.effort.seeds)

    def readings(self) -> list[str]:
        """Readings of the adaptive search that are run, the stated one first."""
        return [STATED, FALLING, LETTER] if self.effort.all_readings else [STATED]

    def jobs(self) -> list[RecordJob]:
        """All that the paper's page needs."""
        gathered: list[RecordJob] = []
        for case in (name for pair in CASES.values() for name in pair):
            gathered += [self.motion(case, name, joint) for name in self.readings() for joint in JOINTS]
            gathered += [OptimumJob(case)]
        gathered += [self.motion("aubo-i5", "PSO", joint) for joint in JOINTS]
        gathered += [self.motion("aubo-i5-radians", "PSO", joint) for joint in (0, 2)]
        gathered += [OptimumJob("aubo-i5", joint) for joint in JOINTS]
        return [*gathered, *(OptimumJob("aubo-i5-radians", joint) for joint in (0, 2))]

    def rulings(self) -> Rulings:
        """Rule on everything that the print alone does not decide."""
        gathered = self._poses() | self._durations() | self._fitness() | self._iterations()
        return gathered | self._orders() | self._formulas()

    def summary(self, case: str, name: str) -> Summary | None:
        """Our runs with all joints put together."""
        return self.timed(case, [self.motion(case, name, joint) for joint in JOINTS])

    def _poses(self) -> Rulings:
        """Forward kinematics of Table 2 with Table 1; roll about z, pitch about y, yaw about x of the base."""
        table, angles = self.tables["Table 3"], self.tables["Table 2"]
        gathered: Rulings = {}
        for row in ("W1", "W2", "initial endpoint"):
            degrees = [0.0 if row not in ("W1", "W2") else angles.value(row, f"theta{j} (deg)") for j in range(1, 7)]
            frame = robot_named("aubo-i5").forward(np.radians(degrees)[None])[0]
            turned = Rotation.from_matrix(frame[:3, :3]).as_euler("zyx", degrees=True)
            for column, value in zip(table.columns, (*(1000 * frame[:3, 3]), *turned), strict=True):
                cell = table[row, column]
                meant = _nearest_turn(value, cell) if "deg" in column else float(value)
                ruling = rules.exact(cell.printed, meant, Basis.FORMULA, f"Table 1 gives {meant:.5g} here")
                gathered[Place("Table 3", row, column)] = ruling
        return gathered

    def _durations(self) -> Rulings:
        table = self.tables["Table 5"]
        gathered: Rulings = {}
        for k, (condition, (degrees, radians)) in enumerate(CASES.items(), start=1):
            row = Row(table.row(condition, STAGES), table[condition, "total time"], load_case(degrees))
            note = f" (radian columns {self.fastest(radians):.4f} s)"
            ruled = rule(row, self.summary(degrees, STATED), self.fastest(degrees), note)
            gathered |= self.placed("Table 5", ruled, self._other_totals(degrees, radians))
            gathered[claim(f"total-{k}")] = gathered[Place("Table 5", condition, "total time")]
            if totals := self.totals(self.summary(degrees, STATED)):
                printed = self.claims[f"reduction-{k}"].printed
                gathered[claim(f"reduction-{k}", BY_RUNS)] = rules.reduction(printed, [6.0], totals)
        return {place: replace(ruling, reading=f"{STATED}; degree columns") for place, ruling in gathered.items()}

    def _other_totals(self, degrees: str, radians: str) -> dict[str, str]:
        wanted = {f"{name}, degree columns": (degrees, name) for name in self.readings()[1:]}
        wanted |= {f"{name}, radian columns": (radians, name) for name in self.readings()}
        return self.told({label: self.summary(case, name) for label, (case, name) in wanted.items()})

    def _fitness(self) -> Rulings:
        """Printed ends of Figure 14 against our runs and the fastest motions of the joint, in either column."""
        gathered: Rulings = {}
        for name, joint in product(("pso", "adaptive"), (1, 3)):
            identity = f"fitness-{name}-joint-{joint}"
            cell, search = self.claims[identity].cell, STATED if name == "adaptive" else "PSO"
            cases = {"degrees": "aubo-i5", "radians": "aubo-i5-radians"}
            least = {unit: self.fastest(case, joint - 1) for unit, case in cases.items()}
            ours = {
                u: float(np.median(self.runs[self.motion(c, search, joint - 1)]["finals"])) for u, c in cases.items()
            }
            text = ", ".join(f"{value:.4f} s ({unit})" for unit, value in ours.items())
            bounds = ", ".join(f"{value:.4f} s ({unit})" for unit, value in least.items())
            why = (
                f"read off a figure and called `{cell.printed}`, so 5 % are allowed; fastest motion of this "
                f"joint {bounds}"
            )
            if any(rules.close(cell.value or 0.0, cell.printed, value) for value in ours.values()):
                gathered[claim(identity)] = Ruling(Outcome.REPRODUCED, text, why, True)
            else:
                reason = f"below the fastest motion of this joint at 5 rad/s by more than 5 %; {why}"
                gathered[claim(identity)] = Ruling(Outcome.INFEASIBLE, text, reason, False, basis=Basis.FORMULA)
        return gathered

    def _iterations(self) -> Rulings:
        gathered: Rulings = {}
        for (label, name), joint in product((("adaptive", STATED), ("pso", "PSO")), (1, 4)):
            identity = f"iterations-{label}-joint-{joint}"
            record = self.runs[self.motion("aubo-i5", name, joint - 1)]
            ruling = rules.count(self.claims[identity].printed, convergence.levels(record), convergence.late([record]))
            others = self.readings()[1:] if label == "adaptive" else []
            beside = {other: self.steps([self.runs[self.motion("aubo-i5", other, joint - 1)]]) for other in others}
            gathered[claim(identity)] = replace(ruling, reading=name, others=beside)
        return gathered

    def _orders(self) -> Rulings:
        ruled = {name: self._order(name) for name in self.readings()}
        return {
            place: replace(stated, reading=STATED, others={
                name: f"{gathered[place].outcome}, {gathered[place].ours}" for name, gathered in ruled.items() if name != STATED
            })
            for place, stated in ruled[STATED].items()
        }  # fmt: skip

    def _order(self, name: str) -> Rulings:
        """Statements about the order of one reading and standard PSO."""
        own, opponent = (partial(self.motion, "aubo-i5", search) for search in (name, "PSO"))
        ends = {
            f"joint {j + 1}": compared(self.runs[own(j)]["finals"], self.runs[opponent(j)]["finals"]) for j in JOINTS
        }
        return {
            claim("better-than-pso"): in_every(ends),
            claim("faster-than-pso"): self.everywhere(own, opponent, JOINTS, most=True),
            claim("lower-throughout"): self._throughout(name),
        }

    def _throughout(self, name: str) -> Ruling:
        """Rule on whether the median best value lies below the opponent's in every generation, joint by joint."""
        higher = {}
        for joint in JOINTS:
            own, other = (np.array(self.runs[self.motion("aubo-i5", n, joint)]["curve"]) for n in (name, "PSO"))
            higher[joint + 1] = float((own > other * (1 + 1e-9)).mean())
        won = [str(joint) for joint, share in higher.items() if share == 0.0]
        worst = max(higher, key=lambda joint: higher[joint])
        why = (
            f"medians of {self.effort.seeds} runs; on joint {worst} it is higher in {100 * higher[worst]:.0f} "
            f"% of the generations"
        )
        return rules.holds(len(won) == len(JOINTS), f"joints {', '.join(won) or 'none'} of 1 to 6", why)

    def _formulas(self) -> Rulings:
        """Statements that the printed points and durations decide."""
        points, table = self.tables["Table 4"], self.tables["Table 5"]
        ways = {"W1": ("K1", "K2"), "W2": ("L1", "L2")}
        cells = [
            (f"{row} theta{j}", points.value(row, f"theta{j} (deg)"), share * points.value(end, f"theta{j} (deg)"))
            for end, rows in ways.items()
            for row, share in zip(rows, (1 / 3, 2 / 3), strict=True)
            for j in range(1, 7)
        ]
        wrong = [name for name, printed, third in cells if abs(printed - third) > 1.0]
        shares = {c: judged(load_case(case), self._printed(c)).worst_ratio for c, (case, _) in CASES.items()}
        text = ", ".join(f"{condition} {share:.5f}" for condition, share in shares.items())
        thirds = rules.contradicts(
            f"{len(wrong)} of {len(cells)} cells of Table 4 are more than 1 deg from a third of the target, "
            f"such as {wrong[0]}"
        )
        less = all(float(value) < 2.0 for condition in CASES for value in table.row_values(condition, STAGES))
        return {
            claim("thirds"): thirds,
            claim("zero-coefficients"): rules.holds(
                True, "", "every joint starts at 0 at rest, Eq. (7)", Basis.FORMULA
            ),
            claim("no-jumps"): rules.holds(
                True, "", "3-5-3 polynomials join with equal acceleration, zero at both ends", Basis.FORMULA
            ),
            claim("all-stages-shorter"): rules.holds(less, "", "Table 5 against 2 s each", Basis.PRINT),
            claim("within-velocity"): self._velocity(shares, text),
        }

    def _velocity(self, shares: dict[str, float], text: str) -> Ruling:
        longer = judged(load_case("aubo-i5-condition-2"), self._printed("condition 2") + 0.005).worst_ratio
        why = f"shares of 5 rad/s; condition 2 keeps it with half a unit more in every duration ({longer:.5f})"
        return rules.holds(max(shares.values()) <= 1.0 + 1e-6, text, why, Basis.FORMULA)

    def _printed(self, condition: str) -> np.ndarray:
        return np.array(self.tables["Table 5"].row_values(condition, STAGES))

    def panels(self) -> list[Panel]:
        """Convergence on every joint in condition 1, the paper's Figure 14."""
        names = {"adaptive PSO": STATED, "standard PSO": "PSO"}
        marks = {0: (3.3, 3.4), 2: (1.5, 1.6)}
        return [
            self.panel(
                "aubo-i5",
                {label: self.motion("aubo-i5", name, j) for label, name in names.items()},
                dict(zip(names, marks.get(j, ()), strict=False)),
                j,
            )
            for j in JOINTS
        ]

    def drives(self) -> list[Drive]:
        """Printed, ours and fastest motion of both conditions, degree columns."""
        return [
            self.drive(case, self._printed(condition), "adaptive PSO", self.summary(case, STATED), np.full(3, 2.0))
            for condition, (case, _) in CASES.items()
        ]


def _nearest_turn(value: float, cell: Cell) -> float:
    """Same angle, in the turn of the printed one."""
    return float(value) + 360.0 * round(((cell.value or 0.0) - value) / 360.0)
