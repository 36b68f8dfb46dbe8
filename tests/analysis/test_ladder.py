"""The truth that methods are measured against: the ladder of lost time, gaps and bounds, with the references themselves."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from study.analysis.featured import featured
from study.analysis.ladder import ladder_of
from study.analysis.methods import CURVE, FIXED_PATH, FREE_PATH, case_rows
from study.analysis.rows import entries_of, lower_bound
from study.cases.library import load_case
from study.cli import terminal
from study.runs.lineup import AS_IN_PAPER, Budget, Spec, make_cells
from study.runs.runner import Task, execute
from study.store.results import Result

REFERENCES = ("casadi-nlp", "certified", "quintic-nlp", "toppra", "ruckig-via", "free-path-nlp", "any-motion-bound")


def study_of(name: str, *more: Spec, references: tuple[str, ...] = REFERENCES) -> list[Result]:
    case = load_case(name)
    cells = make_cells([case], [*map(Spec, references), *more], Budget(seeds=2, evaluations=600))
    return [execute(Task(cell, case.problem)) for cell in cells]


@pytest.fixture(scope="module")
def woodworking() -> list[Result]:
    searches = [
        Spec("golds-pso"),
        Spec("pso"),
        Spec("pso", "scaled", "shared"),
        Spec("random-search", "scaled", "shared"),
    ]
    return study_of("woodworking", Spec("casadi-nlp", synchronisation=AS_IN_PAPER), *searches)


def test_every_rung_of_the_woodworking_ladder_is_named_by_its_cause(woodworking: list[Result]) -> None:
    """7.8776 published, 8.2639 by the joints' own optima, 7.47562 shared, then freer curves, down to the bound."""
    case = load_case("woodworking")
    entries = entries_of(case, woodworking)
    rungs = ladder_of(case, entries, featured(entries))
    by_method = {name: rung for rung in rungs for name in rung.method.split(", ")}
    shared = next(rung for rung in rungs if rung.name.startswith("Deterministic optimum"))
    order = [
        "GoldS-PSO",
        "casadi-nlp:per-joint",
        shared.method,
        "quintic-nlp",
        "toppra",
        "ruckig-via",
        "any-motion-bound",
    ]
    assert [rung.method for rung in rungs if rung.method in order] == order
    assert by_method["GoldS-PSO"].seconds == pytest.approx(7.8776)
    # the optimum of a joint is flat: within 1e-7 of joint 2's, t3 varies by almost 1e-3, and with it the longest of all
    assert by_method["casadi-nlp:per-joint"].seconds == pytest.approx(8.26392, abs=1e-3)
    assert shared.seconds == pytest.approx(7.47562, abs=1e-5)
    assert by_method["ruckig-via"].seconds < 3.37
    kinds = [by_method[name].cause.split(":")[0] for name in order[1:-1]]
    assert kinds == ["synchronisation rule", "optimiser", "curve family", "curve family", "path"]
    assert by_method["quintic-nlp"].path == by_method["ruckig-via"].path == FREE_PATH
    assert by_method["toppra"].path == FIXED_PATH
    falling = [rung.seconds for rung in rungs if rung.method in order[2:]]
    assert falling == sorted(falling, reverse=True)
    assert [rung.name for rung in rungs][-1] == "Lower bound"


JERK = ("casadi-nlp", "certified", "topp3-nlp", "ruckig-via", "free-path-nlp", "any-motion-bound")


@pytest.mark.parametrize(
    "name", ["woodworking-jerk-matched", "puma560-jerk-matched", "aubo-i5-datasheet", "ur5-bspline"]
)
def test_nothing_feasible_lies_below_a_lower_bound(name: str) -> None:
    """The judge forgives 1e-6 of a limit, which is worth up to as much of the time."""
    searches = [Spec("pso", "scaled", "shared"), Spec("random-search", "scaled", "shared")]
    case, results = load_case(name), study_of(name, *searches, references=JERK)
    entries = entries_of(case, results)
    anything, on_the_curve = lower_bound(entries), lower_bound(entries, CURVE)
    assert anything is not None
    assert on_the_curve is not None
    assert anything < on_the_curve
    feasible = [one for one in results if one.verdict and one.verdict.feasible]
    assert len(feasible) > 5
    paths = {entry.label: entry.path for entry in entries}
    for one in feasible:
        assert one.verdict is not None
        least = on_the_curve if paths[one.cell.label] == CURVE else anything
        assert one.verdict.duration >= least * (1 - 1e-6), one.cell.label
    gaps = [entry.gap_to_bound for entry in entries if entry.row.feasible and entry.row.joint is None]
    assert all(gap is not None and gap >= -1e-6 for gap in gaps)


def test_a_weak_bound_on_the_curve_gives_way_to_that_on_any_motion() -> None:
    """The B-spline's linear programme knows nothing of jerk limits, the bound on any motion does."""
    case = load_case("ur5-bspline-jerk-matched")
    names = ("casadi-nlp", "any-motion-bound")
    entries = entries_of(case, study_of(case.name, references=names))
    own, anything = (next(one.bound for one in entries if one.label == name) for name in names)
    assert own is not None
    assert anything is not None
    assert own < anything == lower_bound(entries, CURVE) == lower_bound(entries)


def test_the_terminal_table_says_path_limits_and_bound(woodworking: list[Result]) -> None:
    case = load_case("woodworking")
    console = Console(width=200, file=io.StringIO())
    console.print(terminal.rows_table(case, case_rows(case, woodworking)))
    text = console.file.getvalue()  # type: ignore[attr-defined]
    assert "(limits: published)" in text
    lines = {words[0]: words[1:] for line in text.splitlines() if len(words := line.replace("│", " ").split()) > 2}
    assert lines["ruckig-via"][0] == "free"
    assert lines["toppra"][0] == "fixed"
    assert lines["casadi-nlp:per-joint"][:2] == ["case's", "curve"]
    assert lines["any-motion-bound"][:2] == ["any", "≥"]
    bound = float(lines["any-motion-bound"][2])
    time, _, _, above, percent = lines["ruckig-via"][1:6]
    assert percent == "%"
    assert float(above) == pytest.approx(100 * (float(time) / bound - 1), abs=0.01)
