"""Both formulations, the settings and the planner that every paper's method is."""

import numpy as np
import pytest

from study import EndCondition, JointLimits, Problem, StudyError, judge
from study.curves import CURVES
from study.formulation import Penalty, Scaled, objective_of, stretch
from study.planners.segment_times import SegmentTimePlanner
from study.planning import Formulation, Meter, RunSettings, Status, Synchronisation
from study.problem import State
from study.search.loop import minimise
from study.search.pso import PSO
from study.search.state import Box

BINDING = {
    "velocity": {"velocity": [1.0, 1.0], "acceleration": [1e4, 1e4], "jerk": [1e6, 1e6]},
    "acceleration": {"velocity": [1e3, 1e3], "acceleration": [1.0, 1.0], "jerk": [1e6, 1e6]},
    "jerk": {"velocity": [1e3, 1e3], "acceleration": [1e3, 1e3], "jerk": [1.0, 1.0]},
}


def problem(kind="velocity", n_waypoints=4):
    points = np.random.default_rng(0).normal(size=(n_waypoints, 2))
    return Problem("p", points, JointLimits(**BINDING[kind]), EndCondition.REST, (0.05, 20.0))


@pytest.mark.parametrize("kind", BINDING)
@pytest.mark.parametrize("name", CURVES)
def test_stretched_candidates_touch_exactly_the_binding_limit(name, kind):
    case, curve = problem(kind), CURVES[name]
    durations = np.random.default_rng(1).uniform(0.9, 1.1, size=(30, 3))
    factors = stretch(case, curve, durations)
    for factor, h in zip(factors, durations, strict=True):
        verdict = judge(case, curve.motion(case.waypoints, h * factor))
        order = list(BINDING).index(kind)
        assert verdict.ratios[order].max() == pytest.approx(1.0, rel=1e-9)
        assert verdict.worst_ratio == verdict.ratios[order].max()


def test_scaled_is_invariant_to_a_common_factor_and_honours_the_shortest_duration():
    case = problem()
    scaled = Scaled(case, CURVES["poly353"])
    h = np.array([[0.3, 0.4, 0.5]])
    assert scaled(h * 7) == pytest.approx(scaled(h))
    crawl = Scaled(Problem("p", case.waypoints, JointLimits([1e9, 1e9]), duration_bounds=(0.5, 9.0)), CURVES["poly353"])
    assert crawl.durations(h)[0] == pytest.approx([0.5, 0.5 * 4 / 3, 0.5 * 5 / 3])


def test_penalty_never_ranks_infeasible_above_feasible():
    case, curve = problem(), CURVES["poly353"]
    durations = np.random.default_rng(2).uniform(*case.duration_bounds, size=(500, 3))
    values, feasible = Penalty(case, curve)(durations), stretch(case, curve, durations) <= 1
    assert feasible.any()
    assert not feasible.all()
    assert values[feasible].max() < values[~feasible].min()
    assert values[feasible] == pytest.approx(durations[feasible].sum(axis=1))
    assert Penalty(case, curve).durations(durations) is durations


def test_unknown_names_get_a_hint():
    with pytest.raises(StudyError, match="no formulation 'scale'; did you mean 'scaled'"):
        objective_of("scale", problem(), CURVES["poly353"])
    with pytest.raises(StudyError, match="no synchronisation 'alone'"):
        RunSettings("poly353", synchronisation="alone")
    with pytest.raises(StudyError, match="at least 1"):
        RunSettings("poly353", evaluations=0)


@pytest.mark.parametrize("formulation", ["penalty", "scaled"])
@pytest.mark.parametrize("synchronisation", ["shared", "per-joint"])
def test_the_same_seed_gives_the_same_bytes(formulation, synchronisation):
    settings = RunSettings("poly353", 5, 330, 30, formulation, synchronisation)
    first, second = (SegmentTimePlanner(PSO()).plan(problem(), settings) for _ in range(2))
    assert first.durations.tobytes() == second.durations.tobytes()
    assert first.history.tobytes() == second.history.tobytes()
    assert first.status is Status.FINISHED
    n_searches = 1 if synchronisation == "shared" else 2
    assert first.evaluations == 330 * n_searches
    assert first.history[-1, 0] == first.evaluations
    other = SegmentTimePlanner(PSO()).plan(problem(), RunSettings("poly353", 6, 330, 30, formulation, synchronisation))
    assert other.durations.tobytes() != first.durations.tobytes()


def test_per_joint_takes_the_longest_duration_of_every_segment():
    case = problem()
    settings = RunSettings("poly353", 1, 900, 30, "scaled", "per-joint")
    plan = SegmentTimePlanner(PSO()).plan(case, settings)
    assert plan.history[-1, 1] == pytest.approx(plan.durations.sum())
    streams = np.random.SeedSequence(1).spawn(2)
    alone = []
    for j, stream in enumerate(streams):
        objective = Scaled(case.joint(j), CURVES["poly353"])
        meter = Meter(objective, 900)
        minimise(PSO(), meter, Box(np.full(3, 0.05), np.full(3, 20.0)), 30, np.random.default_rng(stream))
        alone.append(objective.durations(meter.incumbents[-1:])[0])
    assert plan.durations == pytest.approx(np.max(alone, axis=0))


def test_shared_history_ends_at_the_judged_duration():
    settings = RunSettings("cubic-spline", 0, 500, 25, "scaled", "shared")
    case = problem("jerk", 6)
    plan = SegmentTimePlanner(PSO()).plan(case, settings)
    verdict = judge(case, plan.motion)
    assert verdict.feasible
    assert verdict.duration == pytest.approx(plan.history[-1, 1])
    assert (np.diff(plan.history[:, 1]) <= 0).all()


def test_settings_take_options_by_their_text_and_keep_them_as_enumerations():
    settings = RunSettings("poly353", formulation="scaled", synchronisation="per-joint")
    assert settings == RunSettings("poly353", formulation=Formulation.SCALED, synchronisation=Synchronisation.PER_JOINT)
    assert settings.formulation is Formulation.SCALED
    assert f"{settings.formulation}, {settings.synchronisation}" == "scaled, per-joint"


def test_a_motion_with_a_moving_end_cannot_be_scaled():
    moving = Problem("p", [[0.0], [1.0]], JointLimits([2.0], [9.0]), start=State([0.5]))
    with pytest.raises(StudyError, match="cannot be stretched in time; use the formulation 'penalty'"):
        Scaled(moving, CURVES["cubic-spline"])
