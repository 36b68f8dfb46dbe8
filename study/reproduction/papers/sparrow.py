"""The UR5 paper on the improved sparrow search: arm, helix, convergence of four variants, durations, claims."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from study.cases.library import load_case
from study.cases.published import claims, tables
from study.planners import sparrow as planners
from study.reproduction import rules
from study.reproduction.common import (
    Drive,
    Panel,
    Rulings,
    Statement,
    claim_cell,
    inputs,
    line_of,
    more_uniform,
    percentage,
    row_of,
    settings,
)
from study.reproduction.duration_rows import Row, rule
from study.reproduction.effort import Effort
from study.reproduction.jobs import Job, Record, Runs
from study.reproduction.kinematics_runs import InverseTiming
from study.reproduction.motion_runs import MotionCell, OptimumCell, Summary, judged, summarised
from study.reproduction.verdicts import Outcome, Place, Ruling, claim, missing
from study.robots import robot_named
from study.robots.helix import helix_configurations, helix_points
from study.search.state import Search

PAPER = "ur5-tadf-ssa"
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
USED = (
    "uniformity-numbers", "uniformity-bins", "helix-radius", "helix-x", "helix-y", "iterations", "population", "producers",
    "scouts", "safety", "runs", "total-before",
)  # fmt: skip
STATEMENTS = (
    Statement("tent-uniform", "Initial population", "the improved tent map is more uniform than random numbers"),
    Statement("within-limits", "Experiments", "velocity, acceleration and jerk stay below their limits"),
    Statement("jerk-far-below", "Experiments", "the jerk of every joint is much smaller than its limit"),
    Statement("tadf-shortest", "Table 5", "TADF-SSA ends lower than the other three"),
    Statement("tadf-first", "Table 5", "TADF-SSA converges earlier than the other three"),
    Statement("tent-alone", "Experiments", "the tent map alone does not improve the search"),
)


def motion(variant: str, effort: Effort, printed: bool = False) -> MotionCell:
    """Job of one column of Table 5."""
    search = (AS_PRINTED if printed else SEARCHES)[variant]
    return MotionCell(CASE, search, None, 100, effort.generations(80), effort.seeds)


def jobs(effort: Effort) -> list[Job]:
    """All that the paper's page needs."""
    found: list[Job] = [OptimumCell(CASE), InverseTiming()]
    found += [motion(variant, effort) for variant in SEARCHES]
    return found + [motion(variant, effort, True) for variant in AS_PRINTED if effort.all_readings]


def statements() -> tuple[Statement, ...]:
    """Claims without a number."""
    return STATEMENTS


def rulings(runs: Runs, effort: Effort) -> Rulings:
    """Rule on everything."""
    found = inputs(PAPER, ["Table 1", "Table 4"]) | settings(PAPER, USED) | _kinematics()
    found |= _convergence(runs, effort) | _durations(runs, effort) | _timing(runs)
    return found | _statements(runs, effort)


def _kinematics() -> Rulings:
    robot = robot_named("ur5e-ssa")
    positions, angles = 1000 * helix_points(), helix_configurations(robot)
    found: Rulings = {}
    for number, values in (("Table 2", positions), ("Table 3", angles)):
        table = tables(PAPER)[number]
        for cell in table.cells:
            value = float(values[int(cell.row) - 1, table.columns.index(cell.column)])
            found[Place(number, cell.row, cell.column)] = rules.exact(cell.printed, value, Outcome.CONTRADICTS)
    pitch = positions[1, 2] / 18.0 * 360.0
    found[claim("helix-pitch")] = rules.contradicts(f"Table 2 rises by {pitch:.1f} mm in a turn, 10 mm in a radian")
    return found


def summary(variant: str, runs: Runs, effort: Effort, printed: bool = False) -> Summary | None:
    """Our feasible runs of a variant."""
    return summarised(load_case(CASE), np.array(runs[motion(variant, effort, printed)]["durations"]))


def _convergence(runs: Runs, effort: Effort) -> Rulings:
    table, known = tables(PAPER)["Table 5"], claims(PAPER)
    found: Rulings = {}
    for variant in SEARCHES:
        record = runs[motion(variant, effort)]
        mean = float(np.mean(record["settled"]))
        best = record["settled"][int(np.argmin(record["finals"]))]
        row = "iterations at convergence"
        others = _printed_reading(variant, runs, effort, "settled")
        found[Place("Table 5", row, variant)] = replace(rules.count(table[row, variant].printed, mean), others=others)
        row = "fitness at convergence (s)"
        others = _printed_reading(variant, runs, effort, "finals")
        found[Place("Table 5", row, variant)] = replace(_mean_total(table[row, variant].printed, record), others=others)
        identity = variant.lower()
        cell = claim_cell(PAPER, f"best-{identity}")
        least, greatest = min(record["finals"]), max(record["finals"])
        found[claim(cell.row)] = rules.duration(cell.printed.removesuffix("s"), least, "best seed", (least, greatest))
        found[claim(f"iterations-{identity}")] = rules.count(known[f"iterations-{identity}"].printed, best)
    return found


def _mean_total(printed: str, record: Record) -> Ruling:
    finals = record["finals"]
    return rules.duration(printed, float(np.mean(finals)), f"mean of {len(finals)} seeds", (min(finals), max(finals)))


def _printed_reading(variant: str, runs: Runs, effort: Effort, key: str) -> dict[str, str]:
    if not effort.all_readings:
        return {}
    return {"as printed": f"{np.mean(runs[motion(variant, effort, True)][key]):.4g}"}


def _durations(runs: Runs, effort: Effort) -> Rulings:
    table, known, case = tables(PAPER)["Table 6"], claims(PAPER), load_case(CASE)
    row = Row(row_of(table, "time", SEGMENTS), None, case)
    fastest = runs[OptimumCell(CASE)]["total"]
    ours = summary("TADF-SSA", runs, effort)
    found: Rulings = {Place("Table 6", "time", c.column): r for c, r in rule(row, ours, fastest)}
    total = float(row.durations.sum())
    why = (
        f"called the mean of five runs, it is the sum of the one run in Table 6 ({total:.4f} s), and below the best of ten "
        f"({known['best-tadf-ssa'].value:g} s)"
    )
    found[claim("total")] = rules.contradicts(why, "" if ours is None else f"{ours.total:.4f} s")
    found[claim("total-runs")] = rules.contradicts(why)
    found[claim("reduction")] = percentage(
        known["reduction"].printed, known["total-before"].value, known["total"].value
    )
    return found


def _timing(runs: Runs) -> Rulings:
    seconds, known = runs[InverseTiming()], claims(PAPER)
    saving = {way: 100 * (1 - seconds[f"{way} one"] / seconds[f"{way} eight"]) for way in ("scalar", "vectorised")}
    text = f"{saving['scalar']:.0f} % pose by pose, {saving['vectorised']:.0f} % vectorised"
    printed = percentage("39.76%", known["ik-time-eight"].value, known["ik-time-domain"].value)
    agrees = min(saving.values()) >= known["ik-saving"].value
    outcome = Outcome.BETTER if agrees else Outcome.WORSE
    why = f"{printed.why}; one branch of eight saves more when nothing else is computed"
    found: Rulings = {claim(name): Ruling(outcome, text, why, False) for name in ("ik-saving", "ik-saving-abstract")}
    for name, way in (("ik-time-eight", "eight"), ("ik-time-domain", "one")):
        ours = f"{1e3 * seconds[f'scalar {way}']:.3g} ms pose by pose, {1e3 * seconds[f'vectorised {way}']:.3g} ms vectorised"
        found[claim(name)] = missing("a wall time: the language is not given, and only its ratio can be compared", ours)
    return found


def _statements(runs: Runs, effort: Effort) -> Rulings:
    table = tables(PAPER)["Table 6"]
    verdict = judged(load_case(CASE), np.array([table.value("time", column) for column in SEGMENTS]))
    shares = verdict.ratios.max(axis=1)
    text = f"velocity {shares[0]:.3f}, acceleration {shares[1]:.3f}, jerk {shares[2]:.3f} of the limits"
    jerk = ", ".join(f"{share:.2f}" for share in verdict.ratios[2])
    found: Rulings = {
        claim("tent-uniform"): more_uniform("perturbed-tent", ["uniform"]),
        claim("within-limits"): rules.holds(verdict.feasible, text, "inside the motion; the ends step in acceleration"),
        claim("jerk-far-below"): rules.contradicts(
            "judged with the durations of Table 6", f"joints 1 to 5 use {jerk} of the limit"
        ),
    }
    for identity, key in (("tadf-shortest", "finals"), ("tadf-first", "settled")):
        own, lost = runs[motion("TADF-SSA", effort)][key], []
        for other in ("SSA", "T-SSA", "ADF-SSA"):
            if not rules.smaller(own, runs[motion(other, effort)][key])[0]:
                lost.append(other)
        why = f"not by the rank-sum test against {', '.join(lost)}" if lost else "by the rank-sum test over seeds"
        found[claim(identity)] = rules.holds(not lost, f"{3 - len(lost)} of 3 comparisons", why)
    smaller, p = rules.smaller(*(runs[motion(name, effort)]["finals"] for name in ("T-SSA", "SSA")))
    found[claim("tent-alone")] = rules.holds(
        not smaller, f"p = {p:.2g}", "rank-sum test of T-SSA against SSA over seeds"
    )
    return found


MAPS = ("uniform", "tent", "perturbed-tent")


def panels(runs: Runs, effort: Effort) -> list[Panel]:
    """Convergence of the four variants, the paper's Figure 7."""
    return [Panel("total time, s", {name: line_of(runs[motion(name, effort)]) for name in SEARCHES})]


def drives(runs: Runs, effort: Effort) -> list[Drive]:
    """Printed, ours and fastest motion, the paper's Figure 8."""
    table = tables(PAPER)["Table 6"]
    motions = [("printed", np.array([table.value("time", column) for column in SEGMENTS]))]
    if (ours := summary("TADF-SSA", runs, effort)) is not None:
        motions.append(("TADF-SSA, ours", ours.durations))
    return [Drive(CASE, [*motions, ("fastest on this curve", np.array(runs[OptimumCell(CASE)]["durations"]))])]
