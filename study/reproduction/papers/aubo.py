"""The AUBO i5 paper (dynamic adaptive PSO): arm, points, durations of both conditions, claims."""

from __future__ import annotations

from itertools import product

import numpy as np
from scipy.spatial.transform import Rotation

from study.cases.library import load_case
from study.cases.published import Cell, Table, claims, parsed, tables
from study.planners.aubo import DYNAMIC_ADAPTIVE_PSO, DYNAMIC_ADAPTIVE_PSO_AS_PRINTED
from study.reproduction import rules
from study.reproduction.common import (
    Drive,
    Panel,
    Rulings,
    Statement,
    claim_cell,
    conversion,
    inputs,
    line_of,
    percentage,
    row_of,
    settings,
)
from study.reproduction.duration_rows import Row, rule
from study.reproduction.effort import Effort
from study.reproduction.jobs import Job, Runs
from study.reproduction.motion_runs import MotionCell, OptimumCell, Summary, summarised, synchronised
from study.reproduction.verdicts import Outcome, Place, Ruling, claim, used
from study.robots import robot_named
from study.search.pso import PSO, ClampUnit, VelocityUpdate

PAPER = "aubo-dynamic-adaptive-pso"
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
USED = (
    "segment-before", "population", "iterations", "c-initial", "c-min", "c-max", "w-max", "w-min", "box-upper", "clamp", "velocity",
)  # fmt: skip
STATEMENTS = (
    Statement("better-than-pso", "Section 4.3", "adaptive PSO ends lower than standard PSO on every joint"),
    Statement("faster-than-pso", "Section 4.3", "adaptive PSO converges earlier than standard PSO on every joint"),
)


def motion(case: str, name: str, joint: int, effort: Effort) -> MotionCell:
    """Job of one joint."""
    return MotionCell(case, SEARCHES[name], joint, 20, effort.generations(50), effort.seeds)


def _names(case: str, effort: Effort) -> list[str]:
    names = ["adaptive"] + (["adaptive as printed"] if effort.all_readings else [])
    return [*names, "PSO"] if case == "aubo-i5" else names


def jobs(effort: Effort) -> list[Job]:
    """All that the paper's page needs."""
    found: list[Job] = []
    for case in (name for pair in CASES.values() for name in pair):
        found += [motion(case, name, joint, effort) for name in _names(case, effort) for joint in JOINTS]
        found += [OptimumCell(case)]
    return [
        *found,
        *(OptimumCell("aubo-i5", joint) for joint in JOINTS),
        *(OptimumCell("aubo-i5-radians", joint) for joint in (0, 2)),
    ]


def statements() -> tuple[Statement, ...]:
    """Claims without a number."""
    return STATEMENTS


def rulings(runs: Runs, effort: Effort) -> Rulings:
    """Rule on everything."""
    found = inputs(PAPER, ["Table 1"]) | settings(PAPER, USED)
    found[claim("box-lower")] = used("0 s has no curve; ours is 0.1 s, which excludes no synchronised motion")
    for number in ("Table 2", "Table 4"):
        found |= _angles(tables(PAPER)[number])
    found |= _poses() | _durations(runs, effort) | _reductions()
    return found | _fitness(runs) | _iterations(runs, effort) | _statements(runs, effort)


def _angles(table: Table) -> Rulings:
    """Degrees are inputs; radians are checked against them."""
    found: Rulings = {}
    for cell in table.cells:
        place = Place(table.number, cell.row, cell.column)
        if cell.column.endswith("(deg)"):
            found[place] = used()
        else:
            degrees = table.value(cell.row, cell.column.replace("(rad)", "(deg)"))
            found[place] = conversion(cell.printed, float(np.radians(degrees)), f"{degrees:g} deg")
    return found


def _poses() -> Rulings:
    """Forward kinematics of Table 2 with Table 1; roll about z, pitch about y, yaw about x of the base."""
    table, angles = tables(PAPER)["Table 3"], tables(PAPER)["Table 2"]
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


def _nearest_turn(value: float, cell: Cell) -> float:
    """Same angle, in the turn of the printed one."""
    return value + 360.0 * round(((cell.value or 0.0) - value) / 360.0)


def summary(case: str, name: str, runs: Runs, effort: Effort) -> Summary | None:
    """Our runs with all joints put together."""
    per_joint = [runs[motion(case, name, joint, effort)] for joint in JOINTS]
    return summarised(load_case(case), synchronised(per_joint))


def _durations(runs: Runs, effort: Effort) -> Rulings:
    table = tables(PAPER)["Table 5"]
    found: Rulings = {
        claim("total-before"): rules.exact(claims(PAPER)["total-before"].printed, 6.0, Outcome.CONTRADICTS)
    }
    for k, (condition, (degrees, radians)) in enumerate(CASES.items(), start=1):
        row = Row(row_of(table, condition, STAGES), table[condition, "total time"], load_case(degrees))
        fastest = [runs[OptimumCell(case)]["total"] for case in (degrees, radians)]
        note = f" (radian columns {fastest[1]:.4f} s)"
        ruled = rule(row, summary(degrees, "adaptive", runs, effort), fastest[0], note)
        others = _other_totals(degrees, radians, runs, effort)
        for cell, ruling in ruled:
            shown = others if cell.column == "total time" else {}
            found[Place("Table 5", condition, cell.column)] = _with(ruling, shown)
        found[claim(f"total-{k}")] = found[Place("Table 5", condition, "total time")]
    return found


def _other_totals(degrees: str, radians: str, runs: Runs, effort: Effort) -> dict[str, str]:
    wanted = {"radian columns": (radians, "adaptive")}
    if effort.all_readings:
        wanted |= {
            "as printed": (degrees, "adaptive as printed"),
            "radian columns, as printed": (radians, "adaptive as printed"),
        }
    found = {label: summary(case, name, runs, effort) for label, (case, name) in wanted.items()}
    return {label: "no feasible run" if one is None else f"{one.total:.4f} s" for label, one in found.items()}


def _with(ruling: Ruling, others: dict[str, str]) -> Ruling:
    return Ruling(ruling.outcome, ruling.ours, ruling.why, ruling.agrees, "standard, degree columns", others)


def _reductions() -> Rulings:
    table, known = tables(PAPER)["Table 5"], claims(PAPER)
    found: Rulings = {}
    for k, condition in enumerate(CASES, start=1):
        for column in table.columns:
            before = 6.0 if column == "total time" else 2.0
            after = table.value(condition, column)
            cell = table[f"{condition}, improvement", column]
            found[Place("Table 5", cell.row, column)] = percentage(cell.printed, before, after)
        found[claim(f"reduction-{k}")] = percentage(
            known[f"reduction-{k}"].printed, 6.0, table.value(condition, "total time")
        )
    return found


def _fitness(runs: Runs) -> Rulings:
    """Printed ends of Figure 14 against the fastest motions of the joint, in either column."""
    found: Rulings = {}
    for name, joint in product(("pso", "adaptive"), (1, 3)):
        identity = f"fitness-{name}-joint-{joint}"
        cell = claim_cell(PAPER, identity)
        text = cell.printed.split()[-1]
        fastest = {case: runs[OptimumCell(case, joint - 1)]["total"] for case in ("aubo-i5", "aubo-i5-radians")}
        least = min(fastest.values())
        ours = " and ".join(f"{value:.4f} s" for value in fastest.values())
        value = parsed(text) or 0.0
        if value + rules.half_unit(text) < least:
            why = "below the fastest motion of this joint at 5 rad/s, in the degree and in the radian column"
            found[claim(identity)] = Ruling(Outcome.INFEASIBLE, ours, why, False)
        else:
            found[claim(identity)] = rules.duration(text, least)
    return found


def _iterations(runs: Runs, effort: Effort) -> Rulings:
    known = claims(PAPER)
    found: Rulings = {}
    for label, name in (("adaptive", "adaptive"), ("pso", "PSO")):
        for joint in (1, 4):
            identity = f"iterations-{label}-joint-{joint}"
            settled = float(np.median(runs[motion("aubo-i5", name, joint - 1, effort)]["settled"]))
            text = known[identity].printed.replace("10-20", "20")
            found[claim(identity)] = rules.count(text, settled, at_most="-" in known[identity].printed)
    return found


def _statements(runs: Runs, effort: Effort) -> Rulings:
    found: Rulings = {}
    for identity, key in (("better-than-pso", "finals"), ("faster-than-pso", "settled")):
        tests = {
            joint: rules.smaller(*(runs[motion("aubo-i5", name, joint, effort)][key] for name in ("adaptive", "PSO")))
            for joint in JOINTS
        }
        won = [str(joint + 1) for joint, (smaller, _) in tests.items() if smaller]
        text = f"joints {', '.join(won) or 'none'} of 1 to 6"
        found[claim(identity)] = rules.holds(len(won) == len(JOINTS), text, "by the rank-sum test over seeds")
    return found


MAPS: tuple[str, ...] = ()


def panels(runs: Runs, effort: Effort) -> list[Panel]:
    """Convergence on every joint in condition 1, the paper's Figure 14."""
    names = ("adaptive", "PSO")
    return [
        Panel(f"joint {joint + 1}", {name: line_of(runs[motion("aubo-i5", name, joint, effort)]) for name in names})
        for joint in JOINTS
    ]


def drives(runs: Runs, effort: Effort) -> list[Drive]:
    """Printed, ours and fastest motion of both conditions, degree columns."""
    table, found = tables(PAPER)["Table 5"], []
    for condition, (case, _) in CASES.items():
        motions = [("printed", np.array([table.value(condition, stage) for stage in STAGES]))]
        if (ours := summary(case, "adaptive", runs, effort)) is not None:
            motions.append(("adaptive PSO, ours", ours.durations))
        found.append(Drive(case, [*motions, ("fastest on this curve", np.array(runs[OptimumCell(case)]["durations"]))]))
    return found
