"""The woodworking paper (GoldS-PSO): benchmark table, durations of every joint, claims."""

from __future__ import annotations

from itertools import product

import numpy as np

from study.cases.library import load_case
from study.cases.published import claims, tables
from study.planners import woodworking as planners
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
    optima,
    percentage,
    row_of,
    settings,
)
from study.reproduction.duration_rows import Row, rule
from study.reproduction.effort import Effort
from study.reproduction.jobs import Job, Runs
from study.reproduction.motion_runs import MotionCell, OptimumCell, Summary, summarised, synchronised
from study.reproduction.verdicts import Outcome, Place, Ruling, claim
from study.testfunctions import benchmarks_of

PAPER = "woodworking-golds-pso"
CASE = "woodworking"
SEARCHES = {
    "PSO": planners.PSO_BASIC.search,
    "Gold-SA": planners.GOLD_SA.search,
    "GoldS-PSO": planners.GOLDS_PSO.search,
}
SEGMENTS = ("t1", "t2", "t3")
JOINTS = range(4)

USED = (
    "link-d3", "link-d4", "benchmark-population", "benchmark-iterations", "benchmark-runs", "population", "iterations",
    "velocity-linear", "acceleration-linear", "velocity-angular", "acceleration-angular", "box-lower", "box-upper", "total-before",
)  # fmt: skip

STATEMENTS = (
    Statement("circle-uniform", "Section 2.4.1", "the circle map spreads the start more evenly than random numbers"),
    Statement("best-of-swarms", "Section 2.5", "GoldS-PSO is better than the other swarms on all eight functions"),
    Statement("exact-zero", "Section 2.5", "GoldS-PSO reaches mean and deviation zero on F1 to F3"),
    Statement("beats-gold-sa", "Section 2.5", "GoldS-PSO is more accurate than Gold-SA on F4 and F5"),
    Statement("shortest-joints", "Section 3.2", "GoldS-PSO finds the shortest total for every joint"),
)


def motion(algorithm: str, joint: int, effort: Effort) -> MotionCell:
    """Job of one row of Table 5."""
    return MotionCell(CASE, SEARCHES[algorithm], joint, 50, effort.generations(300), effort.seeds)


def jobs(effort: Effort) -> list[Job]:
    """All that the paper's page needs."""
    found: list[Job] = [*BenchmarkTable(PAPER, effort).jobs()]
    found += [motion(algorithm, joint, effort) for algorithm, joint in product(SEARCHES, JOINTS)]
    return [*found, *(OptimumCell(CASE, joint) for joint in JOINTS), OptimumCell(CASE)]


def statements() -> tuple[Statement, ...]:
    """Claims without a number."""
    return STATEMENTS


def rulings(runs: Runs, effort: Effort) -> Rulings:
    """Rule on everything."""
    table2 = tables(PAPER)["Table 2"]
    found = inputs(PAPER, ["Table 1", "Table 2", "Table 4"]) | settings(PAPER, USED)
    found |= optima(table2, {f.label: f.minimum for f in benchmarks_of(PAPER, "as-printed")})
    found |= BenchmarkTable(PAPER, effort).rulings(runs)
    found |= _joints(runs, effort) | _totals(runs, effort) | _percentages(runs, effort)
    return found | _generations(runs, effort) | _statements(runs, effort)


def summary(algorithm: str, runs: Runs, effort: Effort, joint: int | None = None) -> Summary | None:
    """Our runs of an algorithm on one joint, or put together as the paper does."""
    case = load_case(CASE)
    if joint is not None:
        return summarised(case, np.array(runs[motion(algorithm, joint, effort)]["durations"]), joint)
    return summarised(case, synchronised([runs[motion(algorithm, j, effort)] for j in JOINTS]))


def _joints(runs: Runs, effort: Effort) -> Rulings:
    table, case = tables(PAPER)["Table 5"], load_case(CASE)
    found: Rulings = {}
    for algorithm, joint in product(SEARCHES, JOINTS):
        name = f"{algorithm}, joint {joint + 1}"
        row = Row(row_of(table, name, SEGMENTS), table[name, "T_total"], case, joint)
        fastest = runs[OptimumCell(CASE, joint)]["total"]
        ours = summary(algorithm, runs, effort, joint)
        for cell, ruling in rule(row, ours, fastest):
            found[Place("Table 5", cell.row, cell.column)] = ruling
    return found


def _longest(algorithm: str) -> Row:
    """Printed durations put together: of every segment the joint that takes longest."""
    table = tables(PAPER)["Table 5"]
    cells = [
        max((table[f"{algorithm}, joint {j + 1}", column] for j in JOINTS), key=lambda cell: cell.value or 0.0)
        for column in SEGMENTS
    ]
    return Row(cells, claim_cell(PAPER, f"total-{algorithm.lower()}"), load_case(CASE))


def _totals(runs: Runs, effort: Effort) -> Rulings:
    found: Rulings = {}
    fastest = runs[OptimumCell(CASE)]["total"]
    for algorithm in SEARCHES:
        ours = summary(algorithm, runs, effort)
        *segments, (cell, total) = rule(_longest(algorithm), ours, fastest)
        found[claim(cell.row)] = total
        if algorithm == "GoldS-PSO":
            found |= {claim(name): ruling for name, (_, ruling) in zip(SEGMENTS, segments, strict=True)}
    printed = claims(PAPER)["total-golds-pso"].value
    found[claim("total-conclusions")] = rules.contradicts(f"Section 3.2 prints {printed} s for the same total")
    return found


def _percentages(runs: Runs, effort: Effort) -> Rulings:
    known, table = claims(PAPER), tables(PAPER)["Table 5"]
    after = known["total-golds-pso"].value
    found: Rulings = {}
    own = summary("GoldS-PSO", runs, effort)
    for name, base in (("before", "total-before"), ("pso", "total-pso"), ("gold-sa", "total-gold-sa")):
        before = known[base].value
        ours = ""
        other = None if name == "before" else summary({"pso": "PSO", "gold-sa": "Gold-SA"}[name], runs, effort)
        start = before if name == "before" else other and other.total
        if own and start:
            ours = f"{100 * (start - own.total) / start:.3g} %"
        for identity in (f"reduction-{name}", f"abstract-reduction-{name}"):
            found[claim(identity)] = percentage(known[identity].printed, before, after, ours)
    for k, column in enumerate(SEGMENTS):
        cut = 5.0 - float(_longest("GoldS-PSO").durations[k])
        found[claim(f"saved-{column}")] = rules.exact(known[f"saved-{column}"].printed, cut, Outcome.CONTRADICTS)
    for algorithm, (first, second) in product(SEARCHES, ((1, 2), (3, 4))):
        identity = f"spread-{first}{second}-{algorithm.lower()}"
        sums = [sum(table.value(f"{algorithm}, joint {j}", column) for column in SEGMENTS) for j in (first, second)]
        why = f"the printed segments of the two joints add up to {sums[0]:.4f} and {sums[1]:.4f} s"
        found[claim(identity)] = rules.exact(known[identity].printed, abs(sums[0] - sums[1]), Outcome.CONTRADICTS, why)
    return found


def _generations(runs: Runs, effort: Effort) -> Rulings:
    known = claims(PAPER)
    medians = {
        algorithm: [float(np.median(runs[motion(algorithm, joint, effort)]["settled"])) for joint in JOINTS]
        for algorithm in SEARCHES
    }
    slow = min(medians["PSO"])
    found: Rulings = {
        claim("generations-golds-pso"): rules.count(
            known["generations-golds-pso"].printed, max(medians["GoldS-PSO"]), True
        ),
        claim("generations-gold-sa"): rules.count(known["generations-gold-sa"].printed, max(medians["Gold-SA"]), True),
        claim("generations-pso"): rules.holds(
            slow >= 120 / rules.COUNT_FACTOR, f"{slow:.4g}", "fewest over the joints, medians over seeds"
        ),
    }
    reached = {
        (algorithm, function): _reaches(algorithm, function, runs, effort)
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
    led = claims(PAPER)["benchmark-generations-ahead"].value
    found[claim("benchmark-generations-ahead")] = rules.holds(
        ahead >= led / rules.COUNT_FACTOR, f"{ahead:.4g}", "a lead, so fewer is worse; means over F1 to F3"
    )
    return found


def _reaches(algorithm: str, function: str, runs: Runs, effort: Effort) -> int:
    """First shown generation at which the median run is at its last value."""
    table = BenchmarkTable(PAPER, effort)
    record = runs[table.cell(function, algorithm, table.readings(algorithm)[0])]
    curve = np.array(record["curve"])
    return int(record["generations"][int(np.argmax(curve <= curve[-1]))])


def _statements(runs: Runs, effort: Effort) -> Rulings:
    table = BenchmarkTable(PAPER, effort)

    def finals(algorithm: str, function: str) -> list[float]:
        return list(runs[table.cell(function, algorithm, table.readings(algorithm)[0])]["finals"])

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
    return found | {claim("shortest-joints"): _shortest(runs, effort)}


def _shortest(runs: Runs, effort: Effort) -> Ruling:
    lost = []
    for joint, other in product(JOINTS, ("PSO", "Gold-SA")):
        own, theirs = (summary(name, runs, effort, joint) for name in ("GoldS-PSO", other))
        if own is None or (theirs is not None and not rules.smaller(own.totals, theirs.totals)[0]):
            lost.append(f"joint {joint + 1} against {other}")
    return rules.holds(
        not lost, f"{8 - len(lost)} of 8 comparisons", f"not by the rank-sum test: {', '.join(lost)}" if lost else ""
    )


MAPS = ("uniform", "circle")


def panels(runs: Runs, effort: Effort) -> list[Panel]:
    """Convergence on every joint, the paper's Figure 11."""
    return [
        Panel(f"joint {joint + 1}", {name: line_of(runs[motion(name, joint, effort)]) for name in SEARCHES})
        for joint in JOINTS
    ]


def drives(runs: Runs, effort: Effort) -> list[Drive]:
    """Printed, ours and fastest motion of all joints together."""
    motions = [("printed", _longest("GoldS-PSO").durations)]
    if (ours := summary("GoldS-PSO", runs, effort)) is not None:
        motions.append(("GoldS-PSO, ours", ours.durations))
    return [Drive(CASE, [*motions, ("fastest on this curve", np.array(runs[OptimumCell(CASE)]["durations"]))])]
