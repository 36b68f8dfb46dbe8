"""The PUMA560 paper (RRT and chaotic PSO): benchmark table, durations, the whole pipeline over many worlds, claims."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from scipy import stats

from study.cases.library import load_case
from study.cases.published import Cell, Table, claims, parsed, tables
from study.planners.puma import CHAOTIC_SPSO, CHAOTIC_SPSO_AS_PRINTED
from study.reproduction import rules
from study.reproduction.benchmark_table import BenchmarkTable
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
    settings,
)
from study.reproduction.duration_rows import Row, rule
from study.reproduction.effort import Effort
from study.reproduction.genetic_runs import GeneticCell
from study.reproduction.jobs import Job, Runs
from study.reproduction.motion_runs import MotionCell, OptimumCell, Summary, judged, summarised, synchronised
from study.reproduction.papers import collisions
from study.reproduction.verdicts import Outcome, Place, Ruling, claim, missing, used
from study.robots import robot_named

PAPER = "puma560-chaotic-spso"
CASE = "puma560"
TIMES = ("time 1", "time 2", "time 3")
JOINTS = range(6)
USED = (
    "chaos-r", "uniformity-numbers", "uniformity-bins", "alpha", "beta", "switch", "c1-start", "c1-end", "c2-start", "c2-end",
    "benchmark-population", "benchmark-iterations", "benchmark-runs", "space-edge",
)  # fmt: skip
STATEMENTS = (
    Statement(
        "hybrid-uniform",
        "Section 3.3.1",
        "the hybrid map is more uniform than logistic, circle, singer and random numbers",
    ),
    Statement("floor-f2", "Table 2", "F2 takes whole numbers only, so every minimum is whole"),
    Statement("least-deviation-f2", "Section 3.5", "SPSO has the smallest standard deviation on F2"),
    Statement("least-deviation-f4", "Section 3.5", "SPSO has the smallest standard deviation on F4"),
    Statement("least-minimum-f6", "Section 3.5", "SPSO has the smallest minimum on F6"),
    Statement("first-overall", "Section 3.5", "SPSO performs best of the four on F1 to F6"),
    Statement("shortest-method", "Section 4", "RRT-SPSO is faster than the methods that it is compared with"),
    Statement("collision-free", "Section 4", "the optimised motion avoids the obstacles: the tool"),
    Statement("collision-free-arm", "Section 4", "the optimised motion avoids the obstacles: the whole arm"),
    Statement("collision-free-references", "ours", "with shortcuts or RRT-Connect the tool stays clear more often"),
)
ITERATIONS = {
    "f1-iterations": ("F1", ("SPSO",)), "f1-iterations-others": ("F1", ("STOA", "SCA")), "f1-iterations-pso": ("F1", ("PSO",)),
    "f2-iterations": ("F2", ("SPSO",)), "f3-iterations": ("F3", ("SPSO",)), "f3-iterations-pso": ("F3", ("PSO",)),
    "f4-iterations": ("F4", ("SPSO",)), "f5-iterations": ("F5", ("SPSO",)), "f5-iterations-sca": ("F5", ("SCA",)),
    "f5-iterations-stoa": ("F5", ("STOA",)), "f6-iterations": ("F6", ("SPSO",)),
}  # fmt: skip


def motion(joint: int, effort: Effort, printed: bool = False) -> MotionCell:
    """Job of one column of Table 5; population and generations are ours."""
    search = (CHAOTIC_SPSO_AS_PRINTED if printed else CHAOTIC_SPSO).search
    return MotionCell(CASE, search, joint, 30, effort.generations(100), effort.seeds)


def genetic(joint: int, effort: Effort) -> GeneticCell:
    """Job of NSGA-II on one joint that moves."""
    return GeneticCell(CASE, joint, 30, effort.generations(100), min(effort.seeds, 5))


def jobs(effort: Effort) -> list[Job]:
    """All that the paper's page needs."""
    found: list[Job] = [*BenchmarkTable(PAPER, effort).jobs(), OptimumCell(CASE)]
    for joint in JOINTS:
        found += [motion(joint, effort), OptimumCell(CASE, joint), genetic(joint, effort)]
        found += [motion(joint, effort, True)] if effort.all_readings else []
    return found + collisions.jobs(effort)


def statements() -> tuple[Statement, ...]:
    """Claims without a number."""
    return STATEMENTS


def rulings(runs: Runs, effort: Effort) -> Rulings:
    """Rule on everything."""
    found = inputs(PAPER, ["Table 2", "Table 4"]) | settings(PAPER, USED) | _arm()
    found |= BenchmarkTable(PAPER, effort).rulings(runs) | _benchmark_claims(runs, effort)
    found |= _durations(runs, effort) | _totals(runs, effort) | _percentages()
    return found | _statements(runs, effort) | collisions.rulings(runs, effort)


def _arm() -> Rulings:
    """Table 1 against the PUMA560 of the Toolbox, which the experiment calls."""
    table, robot = tables(PAPER)["Table 1"], robot_named("puma560")
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
            found[place] = used("as in the Toolbox's PUMA560") if same else rules.contradicts(why, rules.number6(value))
        else:
            found[place] = _range(cell, waypoints[:, joint])
    return found


def _range(cell: Cell, angles: np.ndarray) -> Ruling:
    ends = [parsed(part) for part in cell.printed.strip("()").split(",")]
    low, high = ends[0], ends[-1]
    if low is None or high is None:
        return missing("the range cannot be read")
    if (angles >= low).all() and (angles <= high).all():
        return used("not imposed; Table 4 keeps it")
    return rules.contradicts(f"Table 4 runs from {angles.min():.4g} to {angles.max():.4g} rad")


def record_of(runs: Runs, effort: Effort, function: str, column: str) -> dict[str, Any]:
    """Our runs of a column's stated reading on a function."""
    table = BenchmarkTable(PAPER, effort)
    return runs[table.cell(function, column, table.readings(column)[0])]


def _benchmark_claims(runs: Runs, effort: Effort) -> Rulings:
    known, table3 = claims(PAPER), tables(PAPER)["Table 3"]
    found: Rulings = {}
    for k in range(1, 7):
        cell = claim_cell(PAPER, f"f{k}-best")
        printed = table3[f"F{k}, min", "SPSO"]
        ours = min(record_of(runs, effort, f"F{k}", "SPSO")["finals"])
        function = (
            BenchmarkTable(PAPER, effort)
            .cell(f"F{k}", "SPSO", BenchmarkTable(PAPER, effort).readings("SPSO")[0])
            .benchmark
        )
        ruling = rules.stochastic(cell.printed, ours, function.minimum or 0.0)
        agrees = rules.close(printed.value or 0.0, cell.printed, cell.value or 0.0)
        found[claim(cell.row)] = (
            ruling if agrees else rules.contradicts(f"Table 3 prints {printed.printed}", ruling.ours)
        )
    for identity, (function_label, columns) in ITERATIONS.items():
        medians = [float(np.median(record_of(runs, effort, function_label, column)["settled"])) for column in columns]
        at_most = "fewer" in known[identity].printed
        text = str(int(known[identity].value))
        found[claim(identity)] = rules.count(text, max(medians), at_most)
    slowest = max(float(np.median(runs[motion(joint, effort)]["settled"])) for joint in JOINTS)
    found[claim("iterations-arm")] = rules.count(known["iterations-arm"].printed, slowest, True)
    return found


def summary(runs: Runs, effort: Effort, joint: int | None = None, printed: bool = False) -> Summary | None:
    """Our runs of one joint, or all put together."""
    case = load_case(CASE)
    if joint is not None:
        return summarised(case, np.array(runs[motion(joint, effort, printed)]["durations"]), joint)
    return summarised(case, synchronised([runs[motion(j, effort, printed)] for j in JOINTS]))


def _durations(runs: Runs, effort: Effort) -> Rulings:
    table, case = tables(PAPER)["Table 5"], load_case(CASE)
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
        fastest = runs[OptimumCell(CASE, joint)]["total"]
        for cell, ruling in rule(row, summary(runs, effort, joint), fastest):
            why = ruling.why + ("; pi rad/s is inferred" if ruling.outcome is Outcome.INFEASIBLE else "")
            found[Place("Table 5", cell.row, column)] = replace(ruling, why=why)
    return found


def _longest(table: Table) -> list[Cell]:
    return [max((table[row, f"joint {j + 1}"] for j in JOINTS), key=lambda cell: cell.value or 0.0) for row in TIMES]


def _totals(runs: Runs, effort: Effort) -> Rulings:
    table6, case = tables(PAPER)["Table 6"], load_case(CASE)
    fastest = runs[OptimumCell(CASE)]["total"]
    row = Row(_longest(tables(PAPER)["Table 5"]), claim_cell(PAPER, "total"), case)
    ours = summary(runs, effort)
    *segments, (_, total) = rule(row, ours, fastest)
    found: Rulings = {claim(f"t{k}"): ruling for k, (_, ruling) in enumerate(segments, start=1)}
    found[claim("total")] = total
    summed = float(row.durations.sum())
    wrong = rules.contradicts(
        f"Table 5's longest segments add up to {summed:.5f} s", "" if ours is None else f"{ours.total:.4f} s"
    )
    unknown = missing("neither the improved RRT nor its path is given")
    for name, ruling in (
        ("initialisation", rules.exact("3", 3.0, Outcome.CONTRADICTS)),
        ("improved RRT", unknown),
        ("RRT-SPSO", wrong),
        ("NSGA-II", _genetic(runs, effort, table6["NSGA-II", "total time"], fastest)),
    ):
        found[Place("Table 6", name, "total time")] = ruling
    return found | {claim("total-irrt"): unknown, claim("total-proposed"): wrong}


def _genetic(runs: Runs, effort: Effort, cell: Cell, fastest: float) -> Ruling:
    records = [runs[genetic(joint, effort)] for joint in JOINTS]
    if not all(record["durations"] for record in records):
        return missing("our row needs pymoo, which is not installed (the extra `peers` brings it)")
    ours = summarised(load_case(CASE), synchronised(records))
    if ours is None:
        return Ruling(Outcome.WORSE, "no feasible run", "objectives and settings are ours", False)
    remark = f"{ours.text}; objectives (total time, largest jerk) and settings are ours; fastest on this curve {fastest:.4f} s"
    return rules.duration(cell.printed, ours.total, remark, (ours.best, ours.totals[-1]))


def _percentages() -> Rulings:
    known = claims(PAPER)
    total, improved = known["total"].value, known["total-irrt"].value
    found: Rulings = {}
    for identity, after in (
        ("reduction-abstract", total), ("reduction-section-4", total), ("reduction-section-4-again", total),
        ("reduction-conclusion", total), ("reduction-irrt", improved),
    ):  # fmt: skip
        found[claim(identity)] = percentage(f"{known[identity].value:g}%", 3.0, after)
    found[claim("saved")] = rules.exact(known["saved"].printed, 3.0 - total, Outcome.CONTRADICTS)
    return found


def _least(table: Table, row: str) -> str:
    """Column of the least printed number in a row."""
    return min(table.columns, key=lambda column: table.value(row, column))


def _statements(runs: Runs, effort: Effort) -> Rulings:
    table3, known = tables(PAPER)["Table 3"], claims(PAPER)
    minima = ", ".join(f"{column} {table3['F2, min', column].printed}" for column in table3.columns)
    broken = rules.contradicts(f"Table 3 prints the minima {minima}: F2 was run without its floor, and so it is by us")
    found: Rulings = {
        claim("floor-f2"): broken,
        claim("hybrid-uniform"): more_uniform("sine-tent-cosine", ["logistic", "circle", "singer", "uniform"]),
    }
    for identity, row, key in (
        ("least-deviation-f2", "F2, std", np.std), ("least-deviation-f4", "F4, std", np.std), ("least-minimum-f6", "F6, min", np.min),
    ):  # fmt: skip
        printed = _least(table3, row)
        values = {column: float(key(record_of(runs, effort, row[:2], column)["finals"])) for column in table3.columns}
        text = ", ".join(f"{column} {value:.3g}" for column, value in values.items())
        best = min(values, key=lambda column: values[column])
        wrong = rules.contradicts(f"Table 3 prints the least for {printed}", text)
        found[claim(identity)] = wrong if printed != "SPSO" else rules.holds(best == "SPSO", text)
    printed_means = [[table3.value(f"F{k}, mean", column) for column in table3.columns] for k in range(1, 7)]
    firsts = [table3.columns[int(np.argmin(row))] for row in printed_means]
    own = [
        [float(np.mean(record_of(runs, effort, f"F{k}", column)["finals"])) for column in table3.columns]
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


MAPS = ("uniform", "logistic", "circle", "singer", "sine-tent-cosine")


def panels(runs: Runs, effort: Effort) -> list[Panel]:
    """Convergence on every joint."""
    return [Panel(f"joint {joint + 1}", {"SPSO": line_of(runs[motion(joint, effort)])}) for joint in JOINTS]


def drives(runs: Runs, effort: Effort) -> list[Drive]:
    """Printed, ours and fastest motion of all joints together, the paper's Figure 10."""
    motions = [("printed", np.array([cell.value for cell in _longest(tables(PAPER)["Table 5"])]))]
    if (ours := summary(runs, effort)) is not None:
        motions.append(("chaotic SPSO, ours", ours.durations))
    return [Drive(CASE, [*motions, ("fastest on this curve", np.array(runs[OptimumCell(CASE)]["durations"]))])]
