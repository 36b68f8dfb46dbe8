"""What the report is put together from: wording, sentences, ladder, rows, figures."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from study.analysis.causes import causes_of
from study.analysis.glossary import glossary
from study.analysis.rows import Entry, entries_of, on_curve

from study.analysis import formatting as wording
from study.analysis.featured import Featured, featured
from study.analysis.ladder import ladder_of
from study.analysis.methods import CURVE, FIXED_PATH, FREE_PATH, Row
from study.analysis.sentences import answer, case_answer
from study.cases.library import Case, case_names, load_case
from study.cases.papers import paper_of
from study.curves import CURVES
from study.judge import judge
from study.planning import RunSettings, Status
from study.problem import JointLimits, Problem
from study.report.convergence import _on_grid, convergence_of
from study.report.figures import convergence, headline, profile
from study.report.plot_style import THEME, Convergence, HeadlineRow, Mark, Series, spaced_ticks, themed
from study.runs.lineup import Budget, Spec, default_lineup, make_cells
from study.runs.runner import Task, execute
from study.store.results import Cell, Result


def entry(kind: str, median: float, path: str = CURVE, best: float | None = None, label: str = "x") -> Entry:
    best = median if best is None else best
    row = Row("c", label, kind, path, 3, 3, best, median, 0.0, 1.0, 2000, 0.5, "")
    return Entry(row, path, 1, 0.0, ())


def picked(
    search: Entry | None, optimiser: Entry | None, free: Entry | None = None, fixed: Entry | None = None
) -> Featured:
    return Featured(search, optimiser, free, fixed, None)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0 %"),
        (1e-5, "≈ 0 %"),
        (-1e-5, "≈ 0 %"),
        (0.0512, "+5.12 %"),
        (-0.5351, "−53.5 %"),
        (None, "–"),
        (4.365, "+436.5 %"),
    ],
)
def test_percent(value: float | None, text: str) -> None:
    assert wording.percent(value) == text


def test_a_small_excess_over_a_limit_is_never_rounded_away() -> None:
    assert wording.share(1.00001) == "1.000010"
    assert wording.share(1.0) == "1.0000"
    assert wording.share(0.99999) == "1.0000"
    assert wording.share(1.0711) == "1.0711"


def test_wall_times_and_counts() -> None:
    assert (wording.wall(0.0188), wording.wall(2.5), wording.wall(123.4)) == ("18.8 ms", "2.5 s", "123 s")
    assert wording.count(15000) == "15\u202f000"
    assert wording.listed(["a", "b", "c"]) == "a, b and c"
    assert wording.change(-0.4) == "−0.4000 s"
    assert wording.change(1e-6) == "0 s"


@pytest.mark.parametrize(
    ("median", "best", "lead", "verdict"),
    [
        (10.2, 10.1, "No:", "behind in 1 of 1 case"),
        (10.0, 10.0, "No:", "level in 1 of 1 case"),
        (10.2, 9.9, "Yes:", "ahead in 1 of 1 case"),
    ],
)
def test_the_first_sentence_says_who_wins(median: float, best: float, lead: str, verdict: str) -> None:
    (first, *_) = answer([picked(entry("search", median, best=best), entry("deterministic", 10.0))])
    assert first.startswith(lead)
    assert verdict in first


def test_the_first_sentence_counts_cases() -> None:
    plain = entry("deterministic", 10.0)
    cases = [picked(entry("search", t), plain) for t in (10.5, 12.0, 10.0, 9.0)]
    first = answer(cases)[0]
    assert first.startswith("Sometimes:")
    assert "ahead in 1, level in 1 and behind in 2 of 4 cases" in first
    assert "from 10.0\u00a0% less to 20.0\u00a0% more time" in first


def test_the_third_sentence_blames_the_curve_only_where_it_costs_more_than_the_search() -> None:
    search, plain = entry("search", 10.5), entry("deterministic", 10.0)
    blamed = answer([picked(search, plain, free=entry("deterministic", 6.0, FREE_PATH))])[-1]
    assert blamed.startswith("What costs time is the curve, not the search: against")
    assert "40.0\u00a0% less time with the path between the waypoints free (1 case)" in blamed
    spared = answer([picked(search, plain, free=entry("deterministic", 9.9, FREE_PATH))])[-1]
    assert spared.startswith("As for the curve, against the optimum")
    both = [picked(search, plain, free=entry("deterministic", time, FREE_PATH)) for time in (6.0, 9.9)]
    assert answer(both)[-1].startswith("What costs time in 1 of 2 cases is the curve, not the search: against")


def test_the_papers_budget_is_said_where_it_is_another() -> None:
    best = picked(entry("search", 10.1), entry("deterministic", 10.0))
    assert "the paper's own budget is 15\u202f000" in case_answer(best, [15000])[1]
    assert "the papers' own budget is 2\u202f000 to 15\u202f000" in answer([best, best], [2000, 15000])[1]
    assert "budget" not in answer([best], [2000])[1]
    assert "budget" not in answer([best])[1]


def test_the_answer_of_one_case_names_methods_and_times() -> None:
    search, plain = entry("search", 10.1, best=9.9, label="swarm"), entry("deterministic", 10.0, label="plain")
    best = picked(search, plain, fixed=entry("deterministic", 8.0, FIXED_PATH, label="along"))
    first, _, last = case_answer(best)
    assert first.startswith(
        "Yes: on the same curve the best metaheuristic (`swarm`) takes 10.1000\u00a0s and the deterministic `plain`"
    )
    assert "1.00\u00a0% more time (median over 3 seeds; its best seed 1.00\u00a0% less time)" in first
    assert (
        last
        == "Against the optimum on the curve, along a fixed path `along` takes 20.0\u00a0% less time (8.0000\u00a0s)."
    )
    assert case_answer(picked(None, None)) == ()


def test_one_seed_has_no_median() -> None:
    search = entry("search", 10.1)
    best = picked(replace(search, row=replace(search.row, runs=1, feasible_runs=1)), entry("deterministic", 10.0))
    assert answer([best])[0].endswith("1.00\u00a0% more time (one seed).")
    assert case_answer(best)[0].endswith("1.00\u00a0% more time (one seed).")


def test_without_a_pair_to_compare_there_is_no_sentence() -> None:
    assert answer([picked(None, entry("deterministic", 10.0)), picked(None, None)]) == ()


@pytest.fixture(scope="module")
def wood() -> tuple[Case, tuple[Entry, ...]]:
    case = load_case("woodworking")
    specs = [
        Spec("golds-pso"),
        Spec("pso", "scaled", "shared"),
        Spec("centre"),
        Spec("direct"),
        Spec("ruckig-stops"),
        Spec("toppra"),
    ]
    cells = make_cells([case], specs, Budget(seeds=3, evaluations=600))
    return case, entries_of(case, [execute(Task(cell, case.problem)) for cell in cells])


def test_every_method_is_labelled_with_its_freedom(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    paths = {one.label: one.path for one in wood[1]}
    assert paths["direct"] == paths["pso:scaled,shared"] == CURVE
    assert paths["toppra"] == FIXED_PATH
    assert paths["ruckig-stops"] == FREE_PATH


def test_gaps_compare_like_with_like(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    for path in (CURVE, FIXED_PATH, FREE_PATH):
        gaps = [one.gap for one in wood[1] if one.path == path and one.gap is not None]
        assert min(gaps) >= 0
    assert {one.label: one.gap for one in wood[1]}["ruckig-stops"] == 0.0


def test_whether_a_motion_keeps_the_curve_is_measured(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    case, entries = wood
    kept = {
        one.label: on_curve(case.problem, case.curve, one.motion)
        for one in entries
        if one.motion and one.row.joint is None
    }
    assert kept["direct"]
    assert kept["published: GoldS-PSO"]
    assert not kept["toppra"]
    assert not kept["ruckig-stops"]


def test_a_strangers_planner_off_the_curve_counts_as_free_path(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    case, entries = wood
    borrowed = next(one.results[0] for one in entries if one.label == "ruckig-stops")
    renamed = replace(borrowed, cell=replace(borrowed.cell, planner="stranger", label="stranger"))
    (found,) = [one for one in entries_of(case, [renamed]) if one.label == "stranger"]
    assert found.path == FREE_PATH


def test_the_featured_are_the_best_of_their_kind(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    best = featured(wood[1])
    assert best.optimiser is not None
    assert best.optimiser.label == "direct"
    assert best.published is not None
    assert best.published.label == "published: GoldS-PSO"
    assert best.free is not None
    assert best.free.label == "ruckig-stops"


def test_local_descent_is_no_metaheuristic() -> None:
    descent = entry("search", 1.0, label="lbfgsb")
    cell = Cell("c", "lbfgsb", "lbfgsb", RunSettings("poly353"))
    result = Result(cell, Status.FINISHED, "", None, None, None, 1, 1, np.empty((0, 2)), {}, 0.1)
    descent = replace(descent, row=replace(descent.row, representative=result))
    swarm = entry("search", 2.0, label="swarm")
    assert featured([descent, swarm]).search is swarm


def test_level_optimisers_are_told_apart_by_their_computing() -> None:
    slow, quick = entry("deterministic", 5.0), entry("deterministic", 5.00001)
    quick = replace(quick, row=replace(quick.row, evaluations=10))
    assert featured([slow, quick]).optimiser is quick
    hasty = replace(slow, row=replace(slow.row, wall_time=1e-6, label="z"))
    for wall in (1e-9, 1.0):  # which of two is named must not differ from run to run
        first = replace(slow, row=replace(slow.row, wall_time=wall, label="a"))
        assert featured([hasty, first]).optimiser is first


def test_the_ladder_of_woodworking(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    case, entries = wood
    rungs = ladder_of(case, entries, featured(entries))
    assert rungs[0].seconds == pytest.approx(7.8776)
    assert rungs[0].change is None
    by_method = {rung.method: rung for rung in rungs}
    optimum = by_method["direct"]
    assert optimum.seconds == pytest.approx(7.47562, abs=2e-3)
    for method in ("toppra", "ruckig-stops"):
        assert by_method[method].change == pytest.approx(by_method[method].seconds - optimum.seconds)
        assert by_method[method].path in (FIXED_PATH, FREE_PATH)
    on_the_curve = [rung for rung in rungs if rung.path == CURVE]
    for above, below in pairwise(on_the_curve):
        assert below.change == pytest.approx(below.seconds - above.seconds)
        assert below.relative == pytest.approx(below.seconds / above.seconds - 1)


def test_causes_lead_from_the_first_result_to_the_optimum(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    case, entries = wood
    rungs = ladder_of(case, entries, featured(entries))
    causes = causes_of(rungs)
    assert causes is not None
    assert causes.first.seconds + (causes.optimiser or 0.0) + (causes.rule or 0.0) == pytest.approx(causes.last.seconds)
    assert causes.fixed == next(rung.change for rung in rungs if rung.method == "toppra")
    assert causes.free == next(rung.change for rung in rungs if rung.method == "ruckig-stops")
    assert causes.bound is None
    assert causes_of(rungs[:1]) is None


def test_every_planner_of_the_default_line_up_is_explained() -> None:
    names = {spec.planner for spec in default_lineup()}
    assert set(glossary(names)) == names
    assert "exactly as printed" in glossary(["ssa-as-printed"])["ssa-as-printed"]
    assert glossary(["a stranger's"]) == {}


def test_backticks_become_code_and_nothing_else_does() -> None:
    assert wording.coded("`a<b>` & `c`") == "<code>a&lt;b&gt;</code> &amp; <code>c</code>"


def test_a_lower_bound_ends_the_ladder(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    case, entries = wood
    cell = Cell(case.name, "bound", "bound", RunSettings("poly353"))
    bound = Result(cell, Status.FINISHED, "", None, None, None, 0, 0, np.empty((0, 2)), {"lower_bound": 3.0}, 0.1)
    results = [one for entry in entries for one in entry.results]
    with_bound = entries_of(case, [*results, bound])
    last = ladder_of(case, with_bound, featured(with_bound))[-1]
    assert (last.name, last.seconds, last.method) == ("Lower bound", 3.0, "bound")
    assert last.change is not None
    assert last.change < 0


def test_no_ladder_of_one_rung(tiny_case: Case) -> None:
    alone = replace(tiny_case, published=tiny_case.published[:1])
    entries = entries_of(alone, [])
    assert ladder_of(alone, entries, featured(entries)) == ()


def test_penalised_candidates_do_not_converge(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    case, entries = wood
    result = next(one for one in entries if one.label == "golds-pso").results[0]
    ceiling = case.problem.n_segments * case.problem.duration_bounds[1]
    fake = replace(result, history=np.array([[50, ceiling + 3.0], [100, 9.0], [150, 8.0]]))
    np.testing.assert_array_equal(_on_grid(case, fake, np.array([10, 50, 99, 100, 400.0])), [np.inf] * 3 + [9.0, 8.0])
    part = convergence_of(case, entries, featured(entries), {"wide": 720.0})
    assert part is not None
    assert part.legend[0] == (0, case.planner)


def test_figures_are_whole_svg_with_their_colours_left_to_the_page(tiny_problem: Problem) -> None:
    named = replace(
        tiny_problem, joint_names=('<&"$x$', "b"), limits=JointLimits(np.array([9.0, 9.0]), np.array([2.0, 1.5]))
    )
    moving = CURVES["poly353"].motion(named.waypoints, np.array([1.5, 1.0, 1.5]))
    pictures = [
        profile("p", named, 0, "rad", [Series('<&"$x$', 0, moving)]),
        headline("h", [HeadlineRow("<&$x$", (Mark(0, 1.2, True, 1.1), Mark(2, 0.5, False)))], "<&", 400.0),
        convergence(
            "c",
            [Convergence("<&", 0, *np.array([[1, 10, 100], [9, 5, 2], [8, 4, 1.5], [9, 6, 3.0]]))],
            ("<", 1.8),
            400.0,
        ),
    ]
    for picture in pictures:
        root = ET.fromstring(str(picture))
        assert root.find("{http://www.w3.org/2000/svg}title") is not None
        ids = [one.attrib["id"] for one in root.iter() if "id" in one.attrib]
        assert len(ids) == len(set(ids))
        assert not any(colour in str(picture) for colour in THEME)
        assert "var(--ink)" in picture
        assert "mathdefault" not in picture


def test_themed_keeps_ids_apart() -> None:
    raw = '<?xml version="1.0"?><svg viewBox="0 0 9 9"><g id="a"/><path id="unused"/><use xlink:href="#a" clip-path="url(#a)"/></svg>'
    first, second = (themed(raw, key, "t", "d") for key in ("x", "y"))
    assert 'id="x-a"' in first
    assert 'href="#x-a"' in first
    assert "url(#y-a)" in second
    assert "unused" not in first


def test_ticks_keep_their_distance() -> None:
    narrow, wide = (spaced_ticks((0.2, 12.0), width) for width in (370.0, 1040.0))
    assert 1.0 in narrow
    assert len(narrow) < len(wide)
    assert np.diff(np.log(narrow)).min() > 52 / 370 * np.log(60)


def test_every_papers_question_and_ledger() -> None:
    paper = paper_of("woodworking-golds-pso")
    assert paper is not None
    assert paper.doi == "10.3390/app131810482"
    assert len(paper.ledger) > 10
    assert paper_of("somebody's own") is None


def test_all_default_cases_have_a_paper() -> None:
    assert all(paper_of(load_case(name).paper) for name in case_names(default_only=True))


def test_an_infeasible_featured_row_is_marked(tiny_case: Case) -> None:
    entries = entries_of(tiny_case, [])
    best = featured(entries).published
    assert best is not None
    assert best.duration == pytest.approx(0.3)
    assert not best.row.feasible
    assert best.motion is not None
    assert not judge(tiny_case.problem, best.motion).feasible


def test_a_bound_is_neither_feasible_nor_infeasible(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    case, entries = wood
    cell = Cell(case.name, "bound", "bound", RunSettings("poly353"))
    bound = Result(cell, Status.FINISHED, "", None, None, None, 0, 0, np.empty((0, 2)), {"lower_bound": 3.0}, 0.1)
    refused = replace(bound, cell=replace(cell, label="refused"), status=Status.NOT_APPLICABLE, details={})
    results = [one for entry in entries for one in entry.results]
    standing = {one.label: one for one in entries_of(case, [*results, bound, refused])}
    assert standing["bound"].standing == "bound"
    assert standing["refused"].standing == "inapplicable"
    assert standing["direct"].gap_to_bound == pytest.approx(standing["direct"].row.median / 3.0 - 1.0)
    assert all(one.gap_to_bound is None for one in entries)


def test_without_acceleration_limits_a_free_path_is_no_opponent() -> None:
    search, plain, free = entry("search", 10.5), entry("deterministic", 10.0), entry("deterministic", 3.0, FREE_PATH)
    fair = picked(search, plain, free=entry("deterministic", 8.0, FREE_PATH))
    unfair = replace(picked(search, plain, free=free), velocity_only=True)
    last = answer([fair, unfair])[-1]
    assert "20.0\u00a0% less time with the path between the waypoints free (1 case; 1 case without" in last
    assert last.endswith("without acceleration limits not counted).")


def test_level_free_paths_share_a_rung(wood: tuple[Case, tuple[Entry, ...]]) -> None:
    case, entries = wood
    stops = next(one.results[0] for one in entries if one.label == "ruckig-stops")
    twin = replace(stops, cell=replace(stops.cell, label="twin", planner="twin"))
    both = entries_of(case, [*(one for entry in entries for one in entry.results), twin])
    methods = [rung.method for rung in ladder_of(case, both, featured(both))]
    assert "ruckig-stops, twin" in methods
