import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest

from study import registry
from study.bounds import kind_of
from study.cases.library import load_case
from study.demands import Demand
from study.errors import StudyError
from study.planning import RATE_LIMITS, Freedom, undescribed
from study.registry import (
    bound_names,
    method_named,
    method_names,
    peer_names,
    planner_named,
    planner_names,
    planner_version,
    unavailable_planners,
)
from study.runs.lineup import (
    AS_IN_PAPER,
    Budget,
    Spec,
    default_lineup,
    full_lineup,
    make_cells,
    parse_spec,
    parse_specs,
)
from study.runs.selections import HEADLINE_SEARCHES, MODERN_SEARCHES
from study.testing.stress import reference_planners

EXTRAS = {"copp", "cma-es", "cma-es-own-population", *peer_names()}
"""Planners whose packages are extras."""

NAMES = ("COPP", "DIRECT", "Drake", "Ruckig", "TOPP-RA", "Tesseract")
"""With which a description may begin in capitals."""

BROKEN = {"stub-missing", "stub-broken", "stub-number"}


def loadable():
    return [name for name in planner_names() if name not in unavailable_planners()]


def test_every_installed_planner_loads():
    assert {"golds-pso", "random-search", "ruckig-stops"} <= set(planner_names())
    assert set(unavailable_planners()) <= EXTRAS
    for name in loadable():
        assert callable(planner_named(name).plan)
        assert planner_version(name).startswith("time-optimal-study ")


def test_a_strangers_planner_is_found_as_object_class_or_factory(stubs):
    assert planner_version("stub-steady") == "stub-planners 1.0"
    for name in ("stub-steady", "stub-factory", "stub-seeded"):
        assert callable(planner_named(name).plan)


def test_bounds_have_a_group_of_their_own(stubs):
    assert {"any-motion-bound", "stub-half"} <= set(bound_names())
    assert not set(bound_names()) & set(planner_names())
    assert set(method_names()) == {*bound_names(), *planner_names()}
    assert method_named("stub-half") is method_named("stub-half")
    assert method_named("stub-steady") is planner_named("stub-steady")
    assert planner_version("stub-half") == "stub-planners 1.0"
    assert [kind_of(method_named(name)) for name in ("stub-half", "pso", "toppra")] == [
        "bound",
        "search",
        "deterministic",
    ]


def test_what_is_wrong_with_a_bound_is_one_sentence(stubs):
    with pytest.raises(StudyError, match="is not a bound: a bound describes itself, and this lacks a method `bound"):
        method_named("stub-nobody")
    with pytest.raises(StudyError, match="no planner 'stub-hal'; did you mean 'stub-half'"):
        method_named("stub-hal")
    with pytest.raises(StudyError, match="no planner 'any-motion-bond'; did you mean 'any-motion-bound'"):
        parse_spec("any-motion-bond")


def test_a_planner_is_loaded_once(stubs):
    assert planner_named("stub-steady") is planner_named("stub-steady")


def test_stubs_are_gone_without_the_fixture():
    assert not [name for name in planner_names() if name.startswith("stub-")]


@pytest.mark.parametrize(
    ("name", "sentence"),
    [
        ("gold-pso", "no planner 'gold-pso'; did you mean 'golds-pso'? known: "),
        ("stub-missing", "needs the Python package 'a_package_that_nobody_has', which is not installed"),
        ("stub-broken", "could not be loaded from 'stub_planners:NO_SUCH_THING': AttributeError"),
        ("stub-number", "is not a planner: a planner describes itself, and this lacks a method `plan"),
    ],
)
def test_what_is_wrong_with_a_planner_is_one_sentence(stubs, name, sentence):
    with pytest.raises(StudyError) as error:
        planner_named(name)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


def test_specs_attach_options_to_the_name_before_them():
    expected = (Spec("golds-pso", "scaled", "shared"), Spec("pso"), Spec("smwoa", None, "per-joint"))
    assert parse_specs("golds-pso:scaled,shared, pso,smwoa:per-joint") == expected
    assert parse_specs("pso,pso") == (Spec("pso"),)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("pso:fast", "'fast'"),
        ("pso:scaled,penalty", "two kinds of formulation: scaled and penalty"),
        ("nothing-such", "no planner 'nothing-such'"),
    ],
)
def test_wrong_specs_say_what_is_wrong(text, sentence):
    with pytest.raises(StudyError, match=sentence):
        parse_spec(text)


def test_no_planners_at_all_is_an_error():
    with pytest.raises(StudyError, match="no planners to run"):
        parse_specs(" , ")


def test_peers_run_where_they_are_asked_for_and_nowhere_else():
    assert {"drake-gcs", "ruckig-chain", "toppra-default"} <= set(peer_names()) < set(planner_names())
    assert not {spec.planner for spec in full_lineup()} & set(peer_names())
    assert not set(reference_planners()) & set(peer_names())
    assert {cell.planner for cell in make_cells([load_case("woodworking")], [Spec("ruckig-chain")], Budget(1))} == {
        "ruckig-chain"
    }


def test_a_missing_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "pydrake", None)
    monkeypatch.delitem(sys.modules, "baselines.peers.drake_kto", raising=False)
    registry._load.cache_clear()
    with pytest.raises(StudyError, match=r"install it with: pip install 'time-optimal-study\[arms\]'"):
        planner_named("drake-kto")
    registry._load.cache_clear()


def test_default_lineup_has_each_headline_search_twice_and_each_deterministic_planner_and_bound():
    lineup = default_lineup()
    for name in set(HEADLINE_SEARCHES) & set(planner_names()):
        ways = (
            [Spec(name, "scaled", "shared")]
            if name in MODERN_SEARCHES
            else [Spec(name), Spec(name, "scaled", "shared")]
        )
        assert [spec for spec in lineup if spec.planner == name] == ways
    own = set(loadable()) - set(peer_names())
    deterministic = [name for name in own if not planner_named(name).stochastic]
    on_the_curve = [name for name in sorted(deterministic) if planner_named(name).freedom is Freedom.CURVE]
    plain = sorted([*deterministic, *bound_names()])
    expected = [Spec(name) for name in plain] + [Spec(name, None, AS_IN_PAPER) for name in on_the_curve]
    assert [spec for spec in lineup if spec.planner not in HEADLINE_SEARCHES] == expected
    assert set(lineup) < set(full_lineup())
    assert {spec.planner for spec in full_lineup()} == {*own, *bound_names()}


def test_joint_by_joint_runs_once_more_only_where_the_paper_does(tiny_case):
    specs = [Spec("direct"), Spec("direct", synchronisation=AS_IN_PAPER)]
    assert [cell.label for cell in make_cells([tiny_case], specs, Budget(1))] == ["direct", "direct:per-joint"]
    shared = replace(tiny_case, settings=replace(tiny_case.settings, synchronisation="shared"))
    assert [cell.label for cell in make_cells([shared], specs, Budget(1))] == ["direct"]


def test_cells_carry_the_papers_settings_and_a_label_for_what_differs(tiny_case):
    cells = make_cells([tiny_case], parse_specs("pso,pso:scaled,pso:scaled,shared,ruckig-stops"), Budget(2, 500))
    labels = ["pso"] * 2 + ["pso:scaled"] * 2 + ["pso:scaled,shared"] * 2 + ["ruckig-stops"]
    assert [cell.label for cell in cells] == labels
    assert [cell.settings.seed for cell in cells] == [0, 1, 0, 1, 0, 1, 0]
    assert {cell.settings.evaluations for cell in cells[:6]} == {500}
    assert {cell.settings.population for cell in cells[:6]} == {tiny_case.settings.population}
    papers = make_cells([tiny_case], [Spec("pso")], Budget(1, None))[0].settings
    assert papers == make_cells([tiny_case], parse_specs("pso:penalty,per-joint"), Budget(1, None))[0].settings
    assert papers.evaluations == tiny_case.settings.evaluations


def test_cells_that_come_twice_are_kept_once(tiny_case):
    once = make_cells([tiny_case], parse_specs("pso"), Budget(3))
    assert make_cells([tiny_case], parse_specs("pso,pso:penalty"), Budget(3)) == once


def test_the_budget_of_searches_makes_no_other_cell_of_a_planner_that_takes_none(tiny_case):
    small, large = (make_cells([tiny_case], [Spec("ruckig-stops")], Budget(1, n)) for n in (10, 1000))
    assert small == large


@pytest.mark.parametrize("wrong", [{"seeds": 0}, {"evaluations": 0}, {"time_limit": 0.0}])
def test_budgets_are_checked(wrong):
    with pytest.raises(StudyError, match=r"at least 1|positive"):
        Budget(**wrong)


def test_a_planner_describes_itself_in_one_line_each():
    for name in loadable():
        planner = planner_named(name)
        assert planner.about
        assert "\n" not in planner.about
        assert planner.about[0].islower() or planner.about.startswith(NAMES)
        assert undescribed(planner) == ""
    assert planner_named("ssa-as-printed").about.startswith(
        planner_named("ssa").about + "; its formulas exactly as printed"
    )


def test_planners_know_what_they_plan_with():
    assert Demand.JERK not in planner_named("toppra").knows
    assert planner_named("ruckig-stops").knows == frozenset(Demand)
    assert planner_named("straight").knows == frozenset(Demand) - {Demand.MOVING_ENDS, Demand.DURATION, Demand.CYCLE}
    assert planner_named("casadi-nlp").knows == RATE_LIMITS
    freedoms = {planner_named(name).freedom for name in ("casadi-nlp", "toppra", "quintic-nlp")}
    assert freedoms == set(Freedom)


def test_a_planner_that_says_too_little_is_told_what_it_lacks():
    silent = SimpleNamespace(plan=print, about="two\nlines", freedom="free path", knows={Demand.JERK}, stochastic=True)
    assert undescribed(silent) == (
        "a planner describes itself, and this lacks `about`, one line that says how it works and `freedom`, a member of "
        "`study.planning.Freedom` and `knows`, a frozenset of `study.demands.Demand`"
    )
