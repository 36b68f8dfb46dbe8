"""Parts of the report: formatting, sentences, ladder, rows, figures."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from study.analysis import formatting
from study.analysis.case_summary import CaseSummary, on_curve, summarise_case
from study.analysis.featured import featured, group_of
from study.analysis.ladder import CauseKind, breakdown_of
from study.analysis.methods import Kind, Standing
from study.analysis.sentences import answer, case_answer
from study.cases.library import Case, case_names, load_case
from study.cases.papers import paper_of
from study.curves import CURVES
from study.judge import judge
from study.planning import Freedom, Status
from study.problem import JointLimits, Problem
from study.report.bars import headline
from study.report.convergence import _on_grid, convergence_of
from study.report.figures import convergence, profile
from study.report.plot_style import THEME, Convergence, HeadlineRow, Mark, Series, spaced_ticks, themed
from study.runs.execute import CellJob
from study.runs.lineup import Budget, Spec, make_cells
from study.store.results import Result
from tests.helpers.summaries import method_of, picked, run_of


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
    assert formatting.percent(value) == text


def test_a_small_excess_over_a_limit_is_never_rounded_away() -> None:
    assert formatting.share(1.00001) == "1.000010"
    assert formatting.share(1.0) == "1.0000"
    assert formatting.share(0.99999) == "1.0000"
    assert formatting.share(1.0711) == "1.0711"


def test_wall_times_and_counts() -> None:
    assert (formatting.wall(0.0188), formatting.wall(2.5), formatting.wall(123.4)) == ("18.8 ms", "2.5 s", "123 s")
    assert formatting.count(15000) == "15\u202f000"
    assert formatting.listed(["a", "b", "c"]) == "a, b and c"
    assert formatting.change(-0.4) == "−0.4000 s"
    assert formatting.change(1e-6) == "0 s"


@pytest.mark.parametrize(
    ("median", "best", "lead", "verdict"),
    [
        (10.2, 10.1, "No:", "behind in 1 of 1 case"),
        (10.0, 10.0, "No:", "level in 1 of 1 case"),
        (10.2, 9.9, "Yes:", "ahead in 1 of 1 case"),
    ],
)
def test_the_first_sentence_says_who_wins(median: float, best: float, lead: str, verdict: str) -> None:
    (first, *_) = answer([picked(method_of(Kind.SEARCH, median, best=best), method_of(Kind.DETERMINISTIC, 10.0))])
    assert first.startswith(lead)
    assert verdict in first


def test_the_first_sentence_counts_cases() -> None:
    plain = method_of(Kind.DETERMINISTIC, 10.0)
    cases = [picked(method_of(Kind.SEARCH, t), plain) for t in (10.5, 12.0, 10.0, 9.0)]
    first = answer(cases)[0]
    assert first.startswith("Sometimes:")
    assert "ahead in 1, level in 1 and behind in 2 of 4 cases" in first
    assert "from 10.0\u00a0% less to 20.0\u00a0% more time" in first


def test_the_third_sentence_blames_the_curve_only_where_it_costs_more_than_the_search() -> None:
    search, plain = method_of(Kind.SEARCH, 10.5), method_of(Kind.DETERMINISTIC, 10.0)
    blamed = answer([picked(search, plain, free=method_of(Kind.DETERMINISTIC, 6.0, Freedom.FREE))])[-1]
    assert blamed.startswith("What costs time is the curve, not the search: against")
    assert "40.0\u00a0% less time with the path between the waypoints free (1 case)" in blamed
    spared = answer([picked(search, plain, free=method_of(Kind.DETERMINISTIC, 9.9, Freedom.FREE))])[-1]
    assert spared.startswith("As for the curve, against the optimum")
    both = [picked(search, plain, free=method_of(Kind.DETERMINISTIC, time, Freedom.FREE)) for time in (6.0, 9.9)]
    assert answer(both)[-1].startswith("What costs time in 1 of 2 cases is the curve, not the search: against")


def test_the_papers_budget_is_said_where_it_is_another() -> None:
    best = picked(method_of(Kind.SEARCH, 10.1), method_of(Kind.DETERMINISTIC, 10.0))
    assert "the paper's own budget is 15\u202f000" in case_answer(best, [15000])[1]
    assert "the papers' own budget is 2\u202f000 to 15\u202f000" in answer([best, best], [2000, 15000])[1]
    assert "budget" not in answer([best], [2000])[1]
    assert "budget" not in answer([best])[1]


def test_the_answer_of_one_case_names_methods_and_times() -> None:
    search, plain = (
        method_of(Kind.SEARCH, 10.1, best=9.9, label="swarm"),
        method_of(Kind.DETERMINISTIC, 10.0, label="plain"),
    )
    best = picked(search, plain, fixed=method_of(Kind.DETERMINISTIC, 8.0, Freedom.PATH, label="along"))
    first, _, last = case_answer(best)
    assert first.startswith(
        "Yes: against a plain deterministic optimiser on the same curve, the best of the papers' searches (`swarm`) takes "
        "10.1000\u00a0s and the deterministic `plain`"
    )
    assert "1.00\u00a0% more time (median over 3 seeds; its best seed 1.00\u00a0% less time)" in first
    assert (
        last
        == "Against the optimum on the curve, along a fixed path `along` takes 20.0\u00a0% less time (8.0000\u00a0s)."
    )
    assert case_answer(picked(None, None)) == ()


def test_the_papers_own_their_best_and_modern_searches_are_said_apart() -> None:
    plain = method_of(Kind.DETERMINISTIC, 10.0)
    own, search = (method_of(Kind.SEARCH, time, evaluations=500) for time in (12.0, 11.0))
    modern = method_of(Kind.SEARCH, 10.0, wall_time=2.0)
    first, second, third, cost, *_ = answer([picked(search, plain, modern=modern, own=own)])
    assert first.startswith("No, but a modern metaheuristic is level: against")
    assert "the best modern search is level in 1 of 1 case; it takes the same time to within 0.01\u00a0%" in first
    assert second.startswith(
        "The best of the papers' searches is behind in 1 of 1 case; it takes 10.0\u00a0% more time"
    )
    assert third.startswith("The paper's own method is behind in 1 of 1 case; it takes 20.0\u00a0% more time")
    assert "500 to 2\u202f000 curve evaluations" in cost
    assert "the best modern search in 2\u00a0s" in cost
    behind = picked(search, plain, modern=method_of(Kind.SEARCH, 10.1), own=own)
    assert answer([picked(search, plain, modern=modern), behind])[0].startswith("No: against")


def test_the_paper_s_own_method_is_not_said_twice() -> None:
    swarm = method_of(Kind.SEARCH, 11.0)
    sentences = answer([picked(swarm, method_of(Kind.DETERMINISTIC, 10.0), own=swarm)])
    assert sum("11.0" in text or "10.0" in text for text in sentences) == 1


def test_how_far_the_choice_of_the_best_flatters_it_is_told() -> None:
    lucky = method_of(Kind.SEARCH, 10.0, best=9.0, label="a")  # 9, 10, 11 s of the seeds 0, 1, 2
    steady = method_of(Kind.SEARCH, 10.2, label="b")
    best = featured([lucky, steady, method_of(Kind.DETERMINISTIC, 8.0)])
    assert best.search is lucky
    # the even seeds choose `a` (median 10), which the odd one times at 10 s; the odd seed chooses `a` too: 9 and 11 s
    assert best.flattery == pytest.approx(0.0)
    other = method_of(Kind.SEARCH, 9.9, best=9.9, label="c")
    unlucky = replace(other, results=(*other.results[:1], run_of("c", 30.0, 1), run_of("c", 9.0, 2)))
    # the even seeds choose `c` (9.45), timed at 30 s; the odd seed chooses `a`, timed at 9 and 11 s: median 11 of 9.9
    assert featured([unlucky, lucky]).flattery == pytest.approx(11.0 / 9.9 - 1)
    assert "at most 11.1\u00a0%" in answer([featured([unlucky, lucky, method_of(Kind.DETERMINISTIC, 8.0)])])[-1]
    assert featured([replace(lucky, results=lucky.results[:1])]).flattery is None


def test_searches_of_no_paper_stand_apart() -> None:
    evolution, swarm = method_of(Kind.SEARCH, 1.0, label="cma-es:scaled"), method_of(Kind.SEARCH, 2.0, label="pso")
    best = featured([evolution, swarm], own="pso")
    assert (best.modern, best.search, best.own) == (evolution, swarm, swarm)
    floor, plain = method_of(Kind.SEARCH, 3.0, label="random-search"), method_of(Kind.DETERMINISTIC, 1.0)
    groups = [group_of(method, best.own) for method in (evolution, swarm, method_of(Kind.SEARCH, 1.0), floor, plain)]
    assert groups == [
        "modern search",
        "the paper's own method",
        "papers' search",
        "trivial or local search",
        plain.kind,
    ]


def test_one_seed_has_no_median() -> None:
    search = method_of(Kind.SEARCH, 10.1)
    best = picked(replace(search, results=search.results[:1]), method_of(Kind.DETERMINISTIC, 10.0))
    assert answer([best])[0].endswith("1.00\u00a0% more time (one seed).")
    assert case_answer(best)[0].endswith("1.00\u00a0% more time (one seed).")


def test_without_a_pair_to_compare_there_is_no_sentence() -> None:
    assert answer([picked(None, method_of(Kind.DETERMINISTIC, 10.0)), picked(None, None)]) == ()


@pytest.fixture(scope="module")
def wood() -> CaseSummary:
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
    return summarise_case(case, [CellJob(cell, case.problem).run() for cell in cells])


def runs_of(summary: CaseSummary) -> list[Result]:
    return [run for method in summary.methods if method.kind is not Kind.PUBLISHED for run in method.results]


def bound_run() -> Result:
    made = run_of("bound", None, lower_bound=3.0, evaluations=0)
    return replace(made, cell=replace(made.cell, case="woodworking"))


def test_every_method_is_labelled_with_its_freedom(wood: CaseSummary) -> None:
    paths = {method.label: method.freedom for method in wood.methods}
    assert paths["direct"] == paths["pso:scaled,shared"] == Freedom.CURVE
    assert paths["toppra"] == Freedom.PATH
    assert paths["ruckig-stops"] == Freedom.FREE


def test_gaps_compare_like_with_like(wood: CaseSummary) -> None:
    for freedom in Freedom:
        kin = [m.behind_same_kind for m in wood.methods if m.freedom is freedom and m.behind_same_kind is not None]
        assert min(kin) >= 0
    assert {method.label: method.behind_same_kind for method in wood.methods}["ruckig-stops"] == 0.0
    fastest = min(method.best for method in wood.methods if method.best and method.joint is None)
    for method in wood.methods:
        assert (method.gap is None) == (method.median is None or method.joint is not None)
        assert method.gap is None or method.gap == pytest.approx(method.median / fastest - 1)


def test_whether_a_motion_keeps_the_curve_is_measured(wood: CaseSummary) -> None:
    case = wood.case
    kept = {m.label: on_curve(case.problem, case.curve, m.motion) for m in wood.whole if m.motion}
    assert kept["direct"]
    assert kept["published: GoldS-PSO"]
    assert not kept["toppra"]
    assert not kept["ruckig-stops"]


def test_a_strangers_planner_off_the_curve_counts_as_free_path(wood: CaseSummary) -> None:
    borrowed = next(method.results[0] for method in wood.methods if method.label == "ruckig-stops")
    renamed = replace(borrowed, cell=replace(borrowed.cell, planner="stranger", label="stranger"))
    (stranger,) = [method for method in summarise_case(wood.case, [renamed]).methods if method.label == "stranger"]
    assert stranger.freedom is Freedom.FREE
    assert stranger.about == ""


def test_the_featured_are_the_best_of_their_kind(wood: CaseSummary) -> None:
    best = wood.best
    assert best.optimiser is not None
    assert best.optimiser.label == "direct"
    assert best.published is not None
    assert best.published.label == "published: GoldS-PSO"
    assert best.free is not None
    assert best.free.label == "ruckig-stops"


def test_local_descent_is_no_metaheuristic() -> None:
    descent = method_of(Kind.SEARCH, 1.0, label="lbfgsb")
    swarm = method_of(Kind.SEARCH, 2.0, label="swarm")
    assert featured([descent, swarm]).search is swarm


def test_level_optimisers_are_told_apart_by_their_computing() -> None:
    slow, quick = method_of(Kind.DETERMINISTIC, 5.0), method_of(Kind.DETERMINISTIC, 5.00001, evaluations=10)
    assert featured([slow, quick]).optimiser is quick
    hasty = method_of(Kind.DETERMINISTIC, 5.0, label="z", wall_time=1e-6)
    for wall in (1e-9, 1.0):  # which of two is named must not differ from run to run
        first = method_of(Kind.DETERMINISTIC, 5.0, label="a", wall_time=wall)
        assert featured([hasty, first]).optimiser is first


def test_the_ladder_of_woodworking(wood: CaseSummary) -> None:
    rungs = wood.rungs
    assert rungs[0].seconds == pytest.approx(7.8776)
    assert rungs[0].change is None
    by_method = {rung.method: rung for rung in rungs}
    optimum = by_method["direct"]
    assert optimum.seconds == pytest.approx(7.47562, abs=2e-3)
    for method in ("toppra", "ruckig-stops"):
        assert by_method[method].change == pytest.approx(by_method[method].seconds - optimum.seconds)
        assert by_method[method].freedom in (Freedom.PATH, Freedom.FREE)
    on_the_curve = [rung for rung in rungs if rung.freedom is Freedom.CURVE]
    for above, below in pairwise(on_the_curve):
        assert below.change == pytest.approx(below.seconds - above.seconds)
        assert below.relative == pytest.approx(below.seconds / above.seconds - 1)


def test_causes_lead_from_the_first_result_to_the_optimum(wood: CaseSummary) -> None:
    rungs = wood.rungs
    causes = breakdown_of(rungs)
    assert causes is not None
    assert causes.first.seconds + (causes.optimiser or 0.0) + (causes.rule or 0.0) == pytest.approx(causes.last.seconds)
    assert causes.fixed == next(rung.change for rung in rungs if rung.method == "toppra")
    assert causes.free == next(rung.change for rung in rungs if rung.method == "ruckig-stops")
    assert causes.bound is None
    assert breakdown_of(rungs[:1]) is None


def test_time_is_summed_by_kind_and_not_by_what_a_sentence_begins_with(wood: CaseSummary) -> None:
    renamed = [replace(rung, text="another sentence") for rung in wood.rungs]
    assert breakdown_of(renamed).optimiser == breakdown_of(wood.rungs).optimiser  # type: ignore[union-attr]
    relabelled = [replace(rung, kind=CauseKind.PATH) for rung in wood.rungs]
    assert breakdown_of(relabelled).optimiser is None  # type: ignore[union-attr]


def test_backticks_become_code_and_nothing_else_does() -> None:
    assert formatting.coded("`a<b>` & `c`") == "<code>a&lt;b&gt;</code> &amp; <code>c</code>"


def test_a_lower_bound_ends_the_ladder(wood: CaseSummary) -> None:
    last = summarise_case(wood.case, [*runs_of(wood), bound_run()]).rungs[-1]
    assert (last.name, last.seconds, last.method) == ("Lower bound", 3.0, "bound")
    assert last.change is not None
    assert last.change < 0


def test_no_ladder_of_one_rung(tiny_case: Case) -> None:
    alone = replace(tiny_case, published=tiny_case.published[:1])
    assert summarise_case(alone, []).rungs == ()


def test_penalised_candidates_do_not_converge(wood: CaseSummary) -> None:
    case = wood.case
    result = next(method for method in wood.methods if method.label == "golds-pso").results[0]
    ceiling = case.problem.n_segments * case.problem.duration_bounds[1]
    fake = replace(result, history=np.array([[50, ceiling + 3.0], [100, 9.0], [150, 8.0]]))
    np.testing.assert_array_equal(_on_grid(case, fake, np.array([10, 50, 99, 100, 400.0])), [np.inf] * 3 + [9.0, 8.0])
    part = convergence_of(wood, {"wide": 720.0})
    assert part is not None
    assert part.legend[0] == (wood.slots[case.planner], case.planner)


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
    best = summarise_case(tiny_case, []).best.published
    assert best is not None
    assert best.duration == pytest.approx(0.3)
    assert not best.feasible
    assert best.motion is not None
    assert not judge(tiny_case.problem, best.motion).feasible


def test_a_bound_is_neither_feasible_nor_infeasible(wood: CaseSummary) -> None:
    bound = bound_run()
    refused = replace(bound, cell=replace(bound.cell, label="refused"), status=Status.NOT_APPLICABLE, lower_bound=None)
    methods = {m.label: m for m in summarise_case(wood.case, [*runs_of(wood), bound, refused]).methods}
    assert (methods["bound"].standing, methods["bound"].kind) == (Standing.BOUND, Kind.BOUND)
    assert methods["refused"].standing is Standing.INAPPLICABLE
    assert methods["direct"].above_bound == pytest.approx(methods["direct"].median / 3.0 - 1.0)
    assert all(method.above_bound is None for method in wood.methods)


def test_without_acceleration_limits_a_free_path_is_no_opponent() -> None:
    search, plain, free = (
        method_of(Kind.SEARCH, 10.5),
        method_of(Kind.DETERMINISTIC, 10.0),
        method_of(Kind.DETERMINISTIC, 3.0, Freedom.FREE),
    )
    fair = picked(search, plain, free=method_of(Kind.DETERMINISTIC, 8.0, Freedom.FREE))
    unfair = replace(picked(search, plain, free=free), velocity_only=True)
    last = answer([fair, unfair])[-1]
    assert "20.0\u00a0% less time with the path between the waypoints free (1 case; 1 case without" in last
    assert last.endswith("without acceleration limits not counted).")


def test_level_free_paths_share_a_rung(wood: CaseSummary) -> None:
    stops = next(method.results[0] for method in wood.methods if method.label == "ruckig-stops")
    twin = replace(stops, cell=replace(stops.cell, label="twin", planner="twin"))
    rungs = summarise_case(wood.case, [*runs_of(wood), twin]).rungs
    assert "ruckig-stops, twin" in [rung.method for rung in rungs]
