"""The conformance tests find what is wrong, and pass what is right."""

from dataclasses import replace

import numpy as np
import pytest

from study import judge, plan
from study.bounds import LowerBound
from study.curves import curve_named
from study.demands import ARM, refusal
from study.errors import StudyError
from study.formulation import Scaled
from study.planners.segment_times import SegmentTimePlanner
from study.planning import RATE_LIMITS, Freedom, Plan, Planner, RunSettings, Status
from study.problem import Demand, EndCondition, Problem
from study.registry import method_named, method_names, planner_named, planner_names, unavailable_planners
from study.search.random_search import RandomSearch
from study.testing import NonconformingError, check_bound, check_planner, check_search, example_problems, random_problem
from study.testing.stress import problem_number, reference_planners

SLOW = {
    *("any-motion-bound", "bspline-nlp", "certified", "free-path-first", "free-path-nlp"),
    *("quintic-nlp", "ruckig-via", "straight", "topp3-nlp"),
}
"""Planners and bounds too slow for the fast tests."""
QUICK = RunSettings("poly353", seed=3, evaluations=60, population=10, formulation="scaled")


class Good:
    stochastic = False
    about = "equal durations, stretched"
    freedom = Freedom.CURVE
    knows = RATE_LIMITS

    def durations(self, problem, settings):
        return np.ones(problem.n_segments)

    def plan(self, problem, settings):
        curve = curve_named(settings.curve)
        durations = Scaled(problem, curve).durations(self.durations(problem, settings)[None])[0]
        return Plan(Status.FINISHED, motion=curve.motion(problem.waypoints, durations), durations=durations)


def test_a_good_planner_passes():
    check_planner(Good())


class Unseeded(Good):
    def durations(self, problem, settings):
        return np.random.default_rng().uniform(1, 2, problem.n_segments)


class GlobalRandom(Good):
    def durations(self, problem, settings):
        np.random.seed(1)  # noqa: NPY002
        return np.random.uniform(1, 2, problem.n_segments)  # noqa: NPY002


class Hasty(Good):
    def plan(self, problem, settings):
        plan = super().plan(problem, settings)
        return replace(plan, motion=plan.motion.scaled(0.5))


class Spender(Good):
    def plan(self, problem, settings):
        return replace(super().plan(problem, settings), evaluations=settings.evaluations + 1)


class Silent(Good):
    def plan(self, problem, settings):
        return Plan(Status.FAILED)


class Useless(Good):
    def plan(self, problem, settings):
        return Plan(Status.NOT_APPLICABLE, message="I never work")


class Crashing(Good):
    def plan(self, problem, settings):
        return [][1]


class Tuple(Good):
    def plan(self, problem, settings):
        return (1, 2)


class Refusing(Good):
    def plan(self, problem, settings):
        raise StudyError("\n")  # several lines are made one; none are left


class Boaster(Good):
    def plan(self, problem, settings):
        return Plan(Status.FINISHED, message="done")


class Meddler(Good):
    def plan(self, problem, settings):
        problem.waypoints.setflags(write=True)
        problem.waypoints[1] += 1e-9
        return super().plan(problem, settings)


class Unmarked(Good):
    stochastic = "no"


@pytest.mark.parametrize(
    ("planner", "sentence"),
    [
        (Unseeded, "one seed gave two motions"),
        (GlobalRandom, "NumPy's global random state"),
        (Hasty, "its motion is infeasible: "),
        (Spender, "301 evaluations of 300"),
        (Silent, "neither a motion nor a reason"),
        (Useless, "solved none"),
        (Crashing, "it raised IndexError"),
        (Tuple, "it returned a tuple"),
        (Refusing, "not one sentence"),
        (Boaster, "there is no motion"),
        (Meddler, "changed the problem"),
        (Unmarked, "this lacks `stochastic`, True or False"),
    ],
)
def test_what_is_wrong_with_a_planner_is_found(planner, sentence):
    with pytest.raises(NonconformingError, match=sentence):
        check_planner(planner(), example_problems()[:2])


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else [])
        for name in sorted(set(method_names()) - set(unavailable_planners()))
    ],
)
def test_every_installed_planner_and_bound_keeps_its_contract(name):
    method = method_named(name)
    if isinstance(method, Planner):
        four = [problem for problem in example_problems() if problem.n_waypoints == 4]
        check_planner(method, four, QUICK, may_be_infeasible=name == "toppra")
    else:
        check_bound(method)


class Modest:
    about = "nothing takes less than no time"
    freedom = Freedom.FREE
    knows = RATE_LIMITS

    def bound(self, problem, settings):
        return LowerBound(0.0, self.freedom)


class Wrong(Modest):
    def bound(self, problem, settings):
        return LowerBound(1e6, self.freedom)


class Moody(Modest):
    def bound(self, problem, settings):
        return LowerBound(np.random.default_rng().uniform(0.0, 1e-3), self.freedom)


class Bare(Modest):
    def bound(self, problem, settings):
        return 0.0


class Nameless(Modest):
    about = ""


def test_a_bound_that_claims_nothing_passes():
    check_bound(Modest())


@pytest.mark.parametrize(
    ("bound", "sentence"),
    [
        (Wrong, "less than the bound of 1e\\+06 s"),
        (Moody, "it proved two bounds"),
        (Bare, "it answered with a float"),
        (Nameless, "a bound describes itself, and this lacks `about`"),
    ],
)
def test_what_is_wrong_with_a_bound_is_found(bound, sentence):
    with pytest.raises(NonconformingError, match=sentence):
        check_bound(bound(), example_problems()[:2])


@pytest.mark.parametrize("value", [-1.0, np.inf, np.nan])
def test_a_lower_bound_is_a_finite_time(value):
    with pytest.raises(StudyError, match="finite time of at least 0 s"):
        LowerBound(value, Freedom.FREE)


def test_every_search_of_ours_keeps_the_contract():
    searches = {
        type(planner.search).__name__: planner.search
        for name, planner in (
            (name, planner_named(name)) for name in set(planner_names()) - set(unavailable_planners())
        )
        if not name.endswith("-as-printed")  # a printed rule may let particles leave the box
        and isinstance(planner, SegmentTimePlanner)
    }
    assert len(searches) > 10
    for search in searches.values():
        check_search(search)


class Frozen(RandomSearch):
    def ask(self, state, rng):
        return state


class Escaping(RandomSearch):
    def ask(self, state, rng):
        return replace(state, candidates=state.box.upper + np.ones_like(state.candidates))


class Lost(RandomSearch):
    def ask(self, state, rng):
        return replace(state, candidates=np.full_like(state.candidates, np.nan))


class Mutating(RandomSearch):
    def tell(self, state, values, rng):
        state.candidates[:] = state.box.lower
        return super().tell(state, values, rng)


class Forgetful(RandomSearch):
    def tell(self, state, values, rng):
        return replace(super().tell(state, values, rng), incumbent_value=np.inf)


class OwnDice(RandomSearch):
    def ask(self, state, rng):
        return super().ask(state, np.random.default_rng())


@pytest.mark.parametrize(
    ("search", "sentence"),
    [
        (Frozen, "never improved"),
        (Escaping, "outside the box"),
        (Lost, "not finite"),
        (Mutating, "tell changed the state"),
        (Forgetful, "incumbent is not the best"),
        (OwnDice, "different candidates"),
    ],
)
def test_what_is_wrong_with_a_search_is_found(search, sentence):
    with pytest.raises(NonconformingError, match=sentence):
        check_search(search())


def test_random_problems_are_repeatable_and_differ():
    drawn = [random_problem(np.random.default_rng(seed)) for seed in range(200)]
    assert {p.n_joints for p in drawn} == set(range(1, 9))
    assert {p.n_waypoints for p in drawn} >= set(range(2, 26))
    assert max(p.n_waypoints for p in drawn) > 100
    assert {demand for p in drawn for demand in p.demands} >= set(Demand) - ARM - {Demand.DURATION, Demand.CYCLE}
    assert {p.end for p in drawn} == set(EndCondition)
    assert any(not p.moving.all() and np.ptp(p.waypoints, axis=0).all() for p in drawn)
    spans = np.concatenate([np.ptp(p.waypoints, axis=0)[p.moving] for p in drawn])
    assert spans.max() / spans.min() > 1e6
    assert (drawn[0].waypoints == random_problem(np.random.default_rng(0)).waypoints).all()
    assert {int(np.isfinite(p.limits.rates[:, 0]).sum()) for p in drawn} == {1, 2, 3}


def test_problem_names_are_unique():
    names = [problem.name for problem in example_problems()]
    assert len(set(names)) == len(names)
    assert all(isinstance(problem, Problem) for problem in example_problems())


def test_the_examples_make_every_demand():
    assert {demand for problem in example_problems() for demand in problem.demands} == set(Demand)


@pytest.mark.parametrize("name", ["toppra", "casadi-nlp", "golds-pso", "free-path-nlp", "ruckig-via"])
def test_what_a_planner_does_not_know_it_declines_itself_before_it_runs(name):
    planner = planner_named(name)
    unknown = [p for p in example_problems() if refusal(p.planner_demands, planner.knows)]
    assert len(unknown) >= 8
    for problem in unknown:
        plan = planner.plan(problem, QUICK)
        assert plan.status is Status.NOT_APPLICABLE, problem.name
        assert plan.message == refusal(problem.planner_demands, planner.knows)


QUIET = sorted(reference_planners())


@pytest.mark.parametrize("name", [*[pytest.param(n, marks=[pytest.mark.slow] * (n in SLOW)) for n in QUIET], "pso"])
def test_a_motion_out_of_the_range_of_positions_is_never_called_one_that_may_be_driven(name):
    problem = next(p for p in example_problems() if p.n_waypoints == 4)
    lowest, highest = problem.waypoints.min(axis=0), problem.waypoints.max(axis=0)
    tight = replace(problem, limits=replace(problem.limits, lower=lowest, upper=highest))
    planned = plan(tight, name, QUICK)
    inside = planned.result.motion is not None and judge(tight, planned.result.motion).feasible
    assert inside == np.isfinite(planned.duration)
    assert inside or "leaves its range of positions" in planned.reason or "not applicable" in planned.reason


def test_given_starts_leave_room_to_stop():
    narrow, straight = problem_number(7, 91), problem_number(7, 190)
    away = narrow.start.velocity**2 / narrow.limits.rates[1]
    assert (away > 0).any()
    assert (away <= narrow.path.of(narrow.n_joints)).all()
    assert np.abs(straight.start.velocity).max() > 0
    assert plan(straight, "ruckig-stops").feasible
