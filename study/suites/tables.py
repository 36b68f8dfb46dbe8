"""Tables of a suite, the same on the page, in the terminal and in Markdown."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import groupby

import numpy as np

from study.analysis.formatting import DASH, bare_seconds, count, percent, plural, wall
from study.analysis.tables import Column, Grid, Record, grid, markdown, records
from study.cases.records import ProblemRecords
from study.cases.suites import Suite
from study.comparison.tables import p_value, probability
from study.comparison.targets import target_name
from study.planning import Freedom
from study.suites.effects import Effect, against, control_of, effects, featured
from study.suites.expense import expense
from study.suites.law import committed_field
from study.suites.measures import BROKEN, TIMES, Field, Score, scores, shifted_mean
from study.suites.runs import Run
from study.suites.targets import TARGETS, Cost, costs


def _share(value: float) -> str:
    return percent(value, signed=False)


def _near(number: int) -> Column[Score]:
    return Column("", f"Near {TIMES[number]:g} s", lambda score: score.within[number], _share)


def _ended(score: Score, reason: str) -> str:
    """Number of failures of a kind; of broken limits with the slowdown that would keep them."""
    cure = f" (slower by {percent(score.excess, signed=False)})" if reason == BROKEN else ""
    return f"{score.failures[reason]} {reason}{cure}"


SCORE_COLUMNS: tuple[Column[Score], ...] = (
    Column("", "Method", lambda score: score.method),
    Column("", "Kind", lambda score: score.kind),
    Column("", "Feasible", lambda score: f"{score.feasible}/{score.runs}"),
    Column("", "Gap", lambda score: score.gap_any, percent),
    Column("", "Own kind", lambda score: score.gap_own, percent),
    *(_near(number) for number in range(len(TIMES))),
    Column("", "Median time", lambda score: score.wall_time, wall),
    Column("", "Failures", lambda score: "\n".join(_ended(score, reason) for reason in score.failures)),
)


def score_grid(ranked: Sequence[Score]) -> Grid:
    """Table of scores; failures count in every number of it."""
    caption = (
        "Every method, the nearest first. Near: share of runs within 1 % of the best known of any kind in so much time."
    )
    return grid(caption, SCORE_COLUMNS, ranked, names=2)


def _to(number: int) -> Column[Cost]:
    return Column("", f"To {target_name(TARGETS[number])}", lambda cost: _cost(cost, number))


def _cost(cost: Cost, number: int) -> str:
    if not cost.reached[number]:
        return "never"
    evaluations = cost.evaluations[number]
    seconds = wall(cost.seconds[number])
    return f"{count(np.ceil(evaluations))} · {seconds}" if evaluations else seconds


COST_COLUMNS: tuple[Column[Cost], ...] = (
    Column("", "Method", lambda cost: cost.method),
    Column("", "Segments", lambda cost: cost.segments),
    Column("", "Reached 1 %", lambda cost: cost.reached[TARGETS.index(0.01)], _share),
    *(_to(number) for number in range(len(TARGETS))),
)


def cost_grid(every: Sequence[Cost]) -> Grid:
    """Expected cost of every method to come near, the cheapest to 1 % first; of all sizes, or a row for each size."""
    sized = any(cost.segments for cost in every)
    columns = COST_COLUMNS if sized else tuple(column for column in COST_COLUMNS if column.head != "Segments")
    unit = "evaluations" if sized else "evaluations per segment"
    ranked = sorted(every, key=lambda cost: (cost.segments, cost.seconds[TARGETS.index(0.01)], cost.method))
    caption = (
        f"Expected {unit} and wall time to come so near to the best known of the method's own kind, all failed runs counted; a planner "
        "without a search has wall time alone."
    )
    return grid(caption, columns, ranked)


COST_FILE: tuple[Column[tuple[Cost, int]], ...] = (
    Column("method", "", lambda row: row[0].method),
    Column("segments", "", lambda row: row[0].segments or None),
    Column("runs", "", lambda row: row[0].runs),
    Column("target", "", lambda row: TARGETS[row[1]]),
    Column("reached", "", lambda row: row[0].reached[row[1]]),
    Column("expected_evaluations", "", lambda row: row[0].evaluations[row[1]] if row[0].segments else None),
    Column("expected_evaluations_per_segment", "", lambda row: row[0].evaluations[row[1]] / (row[0].segments or 1)),
    Column("expected_seconds", "", lambda row: row[0].seconds[row[1]]),
)


def cost_records(every: Sequence[Cost]) -> list[Record]:
    """Costs as rows of a file, one for every target; empty where no run reached it."""
    return records(COST_FILE, [(cost, target) for cost in every for target in range(len(TARGETS))])


EFFECT_COLUMNS: tuple[Column[Effect], ...] = (
    Column("", "Method", lambda effect: effect.method),
    Column("", "Problems", lambda effect: effect.problems),
    Column("", "A12", lambda e: f"{e.a12.estimate:.2f} [{e.a12.lower:.2f}, {e.a12.upper:.2f}]"),
    Column("", "Delta", lambda effect: f"{effect.delta:+.2f}".replace("-", "−")),
    Column("", "Much better", lambda effect: effect.better),
    Column("", "Much worse", lambda effect: effect.worse),
    Column("", "p (Holm)", lambda effect: effect.p, p_value),
)


def effect_grid(every: Sequence[Effect], control: str) -> Grid:
    """Effect sizes against a control."""
    caption = (
        f"Against {control}: probability that a run is shorter (A12, mean over problems, 95 % interval over problems), Cliff's delta, "
        "problems on which A12 is at least 0.71 or at most 0.29, and the signed rank test over problems."
    )
    return grid(caption, EFFECT_COLUMNS, every)


def effect_matrix(every: Sequence[Effect], methods: Sequence[str]) -> Grid:
    """Mean A12 of the method of each row against that of each column."""
    pairs = {(each.method, each.other): each for effect in every for each in (effect, effect.reversed())}

    def cell(row: str, column: str) -> str:
        effect = pairs.get((row, column))
        return DASH if effect is None else probability(effect.a12.estimate) + "*" * effect.significant

    numbers = [f"{k}" for k in range(1, len(methods) + 1)]
    rows = [
        [f"{k}. {row}", *(cell(row, column) for column in methods)] for k, row in zip(numbers, methods, strict=True)
    ]
    caption = (
        "Probability that a run of the row's method is shorter than one of the column's, mean over problems; * where the signed rank "
        "test over problems tells them apart at 5 %, adjusted by Holm for all pairs."
    )
    return Grid(caption, ["Method", *numbers], rows)


def trait_grid(field: Field, name: str, trait: Callable[[Run], str]) -> Grid:
    """Gap of every method by a trait of the problems."""
    values = sorted({trait(run) for run in field.runs})
    rows = []
    for method, runs in field.by_method.items():
        groups = {key: list(group) for key, group in groupby(sorted(runs, key=trait), trait)}
        means = [
            shifted_mean([field.gap(run, own_kind=False) for run in groups[each]]) if each in groups else None
            for each in values
        ]
        rows.append([method, *map(percent, means)])
    return Grid(f"Gap to the best known of any kind, by {name}.", ["Method", *values], rows)


def traits(suite: Suite) -> dict[str, Callable[[Run], str]]:
    """Traits of a run's problem by name."""
    known: dict[str, Callable[[Run], str]] = {
        "joints": lambda run: plural(run.joints, "joint"),
        "limits": lambda run: "jerk too" if run.jerk else "no jerk",
    }
    if suite.problems:
        known |= {
            "task": lambda run: suite.problems[run.problem].tags[0],
            "robot": lambda run: suite.problems[run.problem].robot or "no robot",
        }
    return known


def chosen_traits(suite: Suite) -> dict[str, Callable[[Run], str]]:
    """Traits that problems of a page are chosen by, under the heads of their columns."""
    known = traits(suite)
    named = {name.capitalize(): known[name] for name in ("robot", "task", "limits") if name in known}
    return named | {"Segments": lambda run: str(run.segments), "Joints": lambda run: str(run.joints)}


def best_grid(suite: Suite, field: Field, known: Mapping[str, ProblemRecords]) -> Grid:
    """Best known time of every problem by kind of motion, and the proved bound, with traits to choose problems by."""
    bounds = {name: each.bound or 0.0 for name, each in known.items()}
    for run in field.runs:
        bounds[run.problem] = max(bounds.get(run.problem, 0.0), run.bound if run.kind == "bound" else 0.0)
    named = chosen_traits(suite)
    rows = []
    for name, run in sorted({run.problem: run for run in field.runs}.items()):
        times = [bare_seconds(field.best.get((name, str(kind)))) for kind in Freedom]
        bound, best = bounds.get(name, 0.0), field.best_of_any.get(name)
        above = percent(best / bound - 1.0) if best and bound else percent(None)
        about = [trait(run) for trait in named.values()]
        short = name.removeprefix(f"{suite.name}:")
        rows.append([short, *about, *times, bare_seconds(bound or None), above])
    head = ["Problem", *named, *(f"{kind}, s" for kind in Freedom), "Bound, s", "Above it"]
    caption = "Best known times and the proved bound of any motion."
    return Grid(caption, head, rows, names=len(named) - 1, choices=tuple(named))


def result_grids(field: Field) -> list[Grid]:
    """Tables of scores, of the cost to come near, and of effect sizes against a control."""
    ranked = scores(field)
    shown = featured(field, ranked)
    control = control_of(field, shown)
    tables = [
        score_grid(ranked),
        cost_grid(costs(field)),
        effect_grid(against(effects(field, shown), control), control),
    ]
    return [table for table in tables if table.rows]


def results_in_markdown(suite: Suite) -> str:
    """Write the committed results of a suite as tables with their captions, and what the whole of it costs."""
    field = committed_field(suite)
    parts = [f"{table.caption}\n\n{markdown(table)}" for table in result_grids(field)]
    return "\n\n".join(part for part in (*parts, expense(suite, field)) if part)
