"""Findings as tables for people: heads and cells, every planner with its flag."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup, escape

from study.analysis.formatting import DASH, count, percent, ratio, seconds, wall
from study.comparison.ablations import AblationFinding
from study.comparison.audit import AXES, FunctionFinding, TrajectoryFinding
from study.comparison.claims import Against, Counterpart
from study.comparison.contestants import Contestant, Reference
from study.comparison.differences import Omnibus, Pairing
from study.comparison.performance import Performance
from study.comparison.records import target_name
from study.comparison.runtime import TARGETS
from study.comparison.sentences import p_value
from study.comparison.statistics import Interval
from study.comparison.tasks import SHIFTED
from study.runs.selections import YARDSTICKS

FLAG = "⚑"
Cell = str | Markup


@dataclass(frozen=True)
class Grid:
    """A table: what it shows, its heads, its rows, and how many columns from the left are names."""

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    names: int = 1


def name_of(planner: str, flags: Mapping[str, str]) -> Cell:
    """Name of a planner; flagged with its reason where the audit found one, and marked where it is a trivial opponent."""
    mark = Markup(' <abbr title="{}">{}</abbr>').format(flags[planner], FLAG) if planner in flags else Markup("")
    note = Markup(' <span class="note">trivial</span>') if planner in YARDSTICKS else Markup("")
    return escape(planner) + mark + note


def _evaluations(value: float) -> str:
    return count(value) if np.isfinite(value) else "never"


def _interval(found: Interval | None) -> str:
    if found is None:
        return DASH
    return f"{percent(found.estimate)} ({percent(found.lower)} to {percent(found.upper)})"


def reference_grid(found: Iterable[Reference], flags: Mapping[str, str]) -> Grid:
    """Say what the targets of every case are fractions above."""
    rows = [
        (one.case, seconds(one.value), name_of(one.label, flags), one.curve, "all joints together") for one in found
    ]
    return Grid(
        "The best known of every case: the shortest motion on the paper's curve family, all joints together, that the judge "
        "found feasible. Targets and gaps of both formulations are shares above it.",
        ("Case", "Best known", "Found by", "Curve family", "Formulation level"),
        rows,
        names=5,
    )


def target_grid(case: str, found: Sequence[Performance], flags: Mapping[str, str]) -> Grid:
    """Average running time to every target on one case."""
    rows = [
        (
            name_of(one.contestant.planner, flags),
            f"{one.feasible}/{len(one.contestant.durations)}",
            percent(one.gap),
            *(_evaluations(value) for value in one.evaluations),
            *(wall(value) if np.isfinite(value) else "never" for value in one.seconds),
            wall(float(np.median(one.contestant.wall))),
        )
        for one in found
    ]
    targets = [target_name(target) for target in TARGETS]
    head = (
        "Planner",
        "Feasible",
        "Median gap",
        *(f"to {t}" for t in targets),
        *(f"time to {t}" for t in targets),
        "Wall",
    )
    return Grid(
        f"{case}: average evaluations to every target with restarts, then seconds; best median first.", head, rows
    )


def solver_grid(found: Sequence[Contestant], references: Mapping[str, Reference]) -> Grid:
    """Duration and wall time of the solvers."""
    rows = []
    for one in found:
        base = references.get(one.case)
        gap = percent(one.median / base.value - 1) if base and np.isfinite(one.median) else DASH
        time = seconds(one.median) if np.isfinite(one.median) else "no feasible motion"
        rows.append((one.case, one.planner, time, gap, wall(float(np.median(one.wall)))))
    return Grid(
        "Solvers by wall time and duration. TOPP-RA and Ruckig move on other paths than the paper's curve, so they may be "
        "below the best known on it.",
        ("Case", "Solver", "Duration", "Against the best known", "Wall"),
        rows,
        names=2,
    )


def pairing_grid(case: str, control: str, found: Sequence[Pairing], flags: Mapping[str, str]) -> Grid:
    """Effect sizes and p-values of one case against one control."""
    rows = [
        (
            name_of(one.planner, flags),
            f"{one.a12:.2f}",
            _interval(one.difference),
            p_value(one.signed_rank),
            p_value(one.rank_sum),
        )
        for one in sorted(found, key=lambda one: -one.a12)
    ]
    return Grid(
        f"{case}, against {control}, on paired seeds.",
        ("Planner", "A12", "Median difference (95 %)", "Signed rank p", "Rank sum p"),
        rows,
    )


def rank_grid(found: Omnibus, flags: Mapping[str, str]) -> Grid:
    """Mean ranks and tests against the control."""
    control = found.planners.index(found.control)
    rows = [
        (
            name_of(name, flags),
            f"{found.friedman.mean_ranks[i]:.2f}",
            p_value(float(found.against_control[i])) if i != control else DASH,
            p_value(float(found.nemenyi[i, control])) if i != control else DASH,
        )
        for i, name in enumerate(found.planners)
    ]
    return Grid(
        f"Mean ranks of the medians over {', '.join(found.cases)}.",
        ("Planner", "Mean rank", f"p against {found.control} (Holm)", f"p against {found.control} (Nemenyi)"),
        rows,
    )


def function_grid(found: Sequence[FunctionFinding], flags: Mapping[str, str]) -> Grid:
    """Error ratios of every search."""
    doses = [dose for dose in found[0].doses if dose != SHIFTED] if found else []
    rows = [
        (
            name_of(one.search, flags),
            ratio(one.shifted),
            *(ratio(one.doses[dose]) for dose in doses),
            ratio(one.diagonal),
            ratio(one.rotated) + (f" {AXES}" if one.on_axes else ""),
            *(ratio(value) for value in one.by_function.values()),
        )
        for one in found
    ]
    functions = [f"{name}, shifted" for name in (found[0].by_function if found else ())]
    head = (
        "Search",
        "Shifted / origin",
        *(f"{dose} / origin" for dose in doses),
        "Off / on the diagonal",
        "Rotated / shifted",
        *functions,
    )
    return Grid(
        "Mean error with the optimum moved over mean error with it at home; geometric means over functions, then every "
        "function by itself. Above 10 is the alarm: off the origin by three tenths of the half range, or off the diagonal, it raises "
        f"the flag {FLAG}; smaller doses show how small a move is enough; with the axes turned it sets the mark {AXES}.",
        head,
        rows,
    )


def view_grid(found: Sequence[TrajectoryFinding], flags: Mapping[str, str]) -> Grid:
    """Every search, case and formulation seen in three ways."""
    pairs: dict[tuple[str, str, str], list[TrajectoryFinding]] = {}
    for one in found:
        pairs.setdefault((one.search, one.case, one.formulation), []).append(one)
    rows = [
        (
            name_of(name, flags),
            case,
            formulation,
            seconds(views[0].as_they_are),
            *(seconds(one.seen) for one in views),
            *(f"{one.a12:.2f}" for one in views),
            *(p_value(one.p) for one in views),
        )
        for (name, case, formulation), views in pairs.items()
    ]
    head = (
        "Search", "Case", "Formulation", "As they are", "Reflected", "Centred", "A12 reflected", "A12 centred",
        "p reflected", "p centred",
    )  # fmt: skip
    return Grid(
        "Median best total time with the durations as they are, reflected (lo + hi - t) and in a box centred at zero; A12 is the "
        "probability that a run with them as they are ends shorter; rank sum p, adjusted by Holm for all rows.",
        head,
        rows,
        names=3,
    )


def ablation_grid(title: str, plain: str, found: Sequence[AblationFinding]) -> Grid:
    """Every improvement of one paper on every task."""
    rows = [
        (
            one.improvement,
            one.task if one.trajectory else f"{one.task}, {one.view}",
            seconds(one.plain) if one.trajectory else f"{one.plain:.2g}",
            seconds(one.improved) if one.trajectory else f"{one.improved:.2g}",
            f"{one.a12:.2f}",
            _interval(one.difference) if one.trajectory else _decades(one.difference),
            p_value(one.p),
            one.effect,
        )
        for one in found
    ]
    return Grid(
        f"{title}: each improvement by itself against the plain search ({plain}), on paired seeds; differences in percent of the "
        "plain median for trajectories, in decades of error for functions.",
        ("Improvement", "Task", "Plain", "Improved", "A12", "Median difference (95 %)", "Signed rank p", "Effect"),
        rows,
        names=2,
    )


def _decades(found: Interval) -> str:
    return f"{found.estimate:+.2f} ({found.lower:+.2f} to {found.upper:+.2f})"


def _against(found: Against) -> str:
    return f"{_interval(found.difference)}, A12 {found.a12:.2f}, p {p_value(found.p)}"


def claim_grid(found: Sequence[Counterpart], flags: Mapping[str, str]) -> Grid:
    """Every headline beside its counterparts."""
    rows = [
        (
            one.headline.case,
            f"{one.printed_saving} less than {one.headline.against}",
            {
                True: "feasible",
                False: f"infeasible: {one.published_reason}",
                None: f"not judged: {one.published_reason}",
            }[one.published_feasible],
            name_of(one.planner, flags),
            f"{one.feasible}/{len(one.ours.durations)}",
            f"{one.headline.baseline}: {_against(one.against_baseline)}",
            _against(one.against_random),
            f"ours {percent(one.above_optimum)}, printed {percent(one.printed_above_optimum)}",
            f"{seconds(one.ruckig.median)}, computed in {wall(float(np.median(one.ruckig.wall)))}; the search took "
            f"{wall(float(np.median(one.ours.wall)))}"
            if one.ruckig
            else one.ruckig_reason,
        )
        for one in found
    ]
    head = (
        "Case", "Claim", "Printed", "Search", "Feasible", "Its opponent", "Random search", "The optimum", "Ruckig, stopping",
    )  # fmt: skip
    return Grid(
        "The headline claims beside their honest counterparts: whether the printed motion keeps the limits, then our runs against four. Ours is the median total of the search run the paper's own way at "
        "the budget of this comparison, infeasible motions included, since the paper would have counted them. Its opponent and random search have the same budget and seeds: median difference of the "
        "totals (95 % by bootstrap; less is shorter), A12 the probability that a run of ours is shorter, signed rank p adjusted by "
        "Holm for the claims. The optimum is the best known on the paper's curve with all joints together. Ruckig may choose its "
        "own path and must stop at every waypoint.",
        head,
        rows,
        names=len(head),
    )
