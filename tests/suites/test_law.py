"""The law of growth on runs that follow a known one, and the page that tells it."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import spearmanr

from study.cases.records import known_times
from study.cases.suites import suite_named
from study.errors import StudyError
from study.suites.growth import growing, growths
from study.suites.law import committed_law, largest_budget, law_grid, paragraph
from study.suites.measures import Field, best_in
from study.suites.page import _other_laws, write_page
from study.suites.runs import Run, read_runs, runs_file

BASE = Run(
    "scaling:x", 3, 7, False, "casadi-nlp", "case's curve", 0, 0, "FINISHED", True, 1.0, 1.0, 2.0, 0.0, ""
)  # fmt: skip
SIZES = (3, 9, 19, 49)


@pytest.fixture(scope="module")
def field():
    """Three problems of every size; `pso` is 0.001 (n / 3)^1.5 behind, `de` finds the optimum, `worse` fails at the last size."""
    names = {n: [f"scaling:s{n}-j7-{letter}" for letter in "abc"] for n in SIZES}
    runs = []
    for n, problems in names.items():
        for problem in problems:
            runs.append(replace(BASE, problem=problem, segments=n))
            for seed in range(3):
                search = replace(BASE, problem=problem, segments=n, evaluations=1000, seed=seed)
                runs.append(replace(search, planner="pso", duration=1.0 + 1e-3 * (n / 3) ** 1.5))
                runs.append(replace(search, planner="de"))
                runs.append(replace(search, planner="worse", feasible=n < SIZES[-1], duration=1.02))
    return Field(tuple(runs), best_in(runs))


def test_exponent_and_marks_are_those_of_the_law(field):
    grown = {each.planner: each for each in growths(field)}
    pso = grown["pso"]
    assert pso.exponent.estimate == pytest.approx(1.5, abs=1e-9)
    assert (pso.exponent.lower, pso.exponent.upper) == pytest.approx((1.5, 1.5), abs=1e-9)
    assert pso.passes[0.01] == pytest.approx(3 * 10 ** (2 / 3), rel=1e-6)
    assert pso.passes[0.1] is None
    assert grown["de"].exponent is None
    assert [point.gap.estimate for point in grown["de"].points] == [0.0] * 4


def test_growth_with_joints_and_with_jerk_limits_is_told_apart(field):
    cut = [
        replace(BASE, problem=f"scaling:s9-j{joints}-a", segments=9, joints=joints, planner="pso", evaluations=1000, seed=seed,
                duration=1.0 + 1e-3 * joints)
        for joints in (1, 2, 4)
        for seed in range(3)
    ]  # fmt: skip
    jerky = [replace(run, problem=f"{run.problem}-jerk", jerk=True) for run in field.runs]
    whole = Field(
        (*field.runs, *cut, *jerky), dict.fromkeys({(r.problem, r.kind) for r in [*field.runs, *cut, *jerky]}, 1.0)
    )
    assert {run.joints for run in growing(whole, "joints")} == {1, 2, 4, 7}
    pso = next(each for each in growths(whole, "joints") if each.planner == "pso")
    assert [point.size for point in pso.points] == [1, 2, 4, 7]
    assert pso.points[0].gap.estimate == pytest.approx(1e-3)
    assert law_grid(whole, 1000, "joints").head[1:5] == ["1 joint", "2 joints", "4 joints", "7 joints"]
    assert {each.planner for each in growths(whole, "segments", jerk=True)} == {"pso", "de", "worse"}
    titles = [section.title for section in _other_laws(whole, 1000)]
    assert titles == ["By segments, with jerk limits", "By joints, without jerk limits"]


def test_failures_are_infinitely_far_behind_and_counted(field):
    last = {each.planner: each for each in growths(field)}["worse"].points[-1]
    assert (last.failed, last.runs, last.gap.estimate) == (9, 9, np.inf)
    assert "9 of 108 runs brought no feasible motion" in paragraph(field, 1000)


def test_the_paragraph_and_the_table_tell_the_numbers(field):
    text = paragraph(field, 1000)
    assert "7 joints" in text
    assert "the median gap of 3 searches" in text
    assert "to the power of 1.5 to" in text
    rows = {row[0]: row for row in law_grid(field, 1000).rows}
    assert rows["pso"][-3:] == ["14", "–", "1.5 [1.5, 1.5]"]
    assert rows["de"][1:5] == ["0 %"] * 4
    assert paragraph(Field((BASE,), best_in([BASE])), 1000) == ""
    assert largest_budget(Field((BASE,), best_in([BASE]))) == 0


def test_the_page_has_figure_scores_ranks_and_failures(field, tmp_path):
    suite = suite_named("scaling")
    page = write_page(
        suite, replace(field), {}, [("woodworking", 3, 1e-3, "golds-pso")], tmp_path / "suite", {"a": "b"}
    )
    text = page.read_text()
    assert suite.checksum in text
    assert text.count("<svg") >= 3
    sections = (
        "Cost to come near",
        "Cost by size",
        "Data profiles over evaluations",
        "Targets reached",
        "Effect sizes",
    )
    for said in ("How far methods fall behind", "Scores", "Ranks", "Failures", "woodworking", "worse", *sections):
        assert said in text
    chosen = re.findall(r"data-choose[^>]*>([^<]+)<", text)
    assert chosen == ["Robot", "Task", "Limits", "Segments", "Joints"]
    assert not re.search(r"https?://(?!www.w3.org)", text)
    for name in ("runs", "costs", "effects"):
        assert (tmp_path / "suite" / f"{name}.parquet").is_file()


def test_a_run_of_bounds_alone_has_a_page_too(tmp_path):
    bound = replace(
        BASE, problem="scaling:s3-j7-a", planner="any-motion-bound", kind="bound", feasible=False, bound=0.9
    )
    page = write_page(suite_named("scaling"), Field((bound,), best_in([bound])), {}, [], tmp_path / "suite", {"a": "b"})
    assert "only bounds" in page.read_text()


def test_a_suite_without_committed_searches_has_no_law():
    with pytest.raises(StudyError, match="no committed"):
        committed_law(suite_named("hard"))


@pytest.mark.parametrize("name", ["scaling", "scaling-second"])
def test_the_committed_law_holds(name):
    suite = suite_named(name)
    assert {run.problem for run in read_runs(runs_file(suite))} <= suite.cases.keys()
    assert "segments" in committed_law(suite)


def test_the_law_holds_on_the_second_seed():
    """At the last size the searches stand in nearly the same order, with nearly the same gaps."""
    grown = [_last_gaps(name) for name in ("scaling", "scaling-second")]
    for budget in (1000, 10_000, 100_000):
        last = [{name: gap for (evaluations, name), gap in each.items() if evaluations == budget} for each in grown]
        assert last[0].keys() == last[1].keys()
        pairs = np.array([[gaps[name] for name in sorted(gaps)] for gaps in last])
        assert spearmanr(*pairs).statistic > 0.8
        assert np.exp(np.abs(np.log(pairs[0] / pairs[1]))).max() < 2.0


def _last_gaps(name):
    suite = suite_named(name)
    runs = read_runs(runs_file(suite))
    field = Field(tuple(runs), best_in(runs, known_times(suite)))
    return {(each.evaluations, each.planner): each.points[-1].gap.estimate for each in growths(field)}
