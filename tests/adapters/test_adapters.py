import numpy as np
import pytest

from study.adapters import DurationObjective, ioh_callable, mealpy_problem, objective, pymoo_problem, suite
from study.cases.library import case_names
from study.curves import curve_named
from study.errors import StudyError
from study.judge import judge

DEFAULT = case_names(default_only=True)


@pytest.mark.parametrize("formulation", ["scaled", "penalty"])
@pytest.mark.parametrize("name", DEFAULT)
def test_the_best_known_value_is_what_the_objective_gives_there(name, formulation):
    for instance in (0, 1, 7):
        one = objective(name, formulation, instance)
        assert one(one.best_point) == pytest.approx(one.best_known, rel=1e-12 if formulation == "scaled" else 1e-9)
        assert (one.best_point >= one.lower - 1e-12).all()
        assert (one.best_point <= one.upper + 1e-12).all()


@pytest.mark.parametrize("name", DEFAULT)
def test_the_best_known_point_is_a_feasible_motion(name):
    one = objective(name)
    motion = curve_named(one.case.curve).motion(one.case.problem.waypoints, one.durations(one.best_point))
    verdict = judge(one.case.problem, motion)
    assert not [reason for reason in verdict.reasons if "not zero" not in reason]
    assert verdict.worst_ratio == pytest.approx(1.0, abs=1e-6)


def test_problems_of_a_suite_have_their_records_as_best_known_values():
    known = [one for one in suite(instances=1, name="scaling") if one.best_known]
    assert len(known) >= 15
    for one in known[::6]:
        assert one(one.best_point) == pytest.approx(one.best_known, rel=1e-8)


def test_no_neighbour_beats_the_best_known_value():
    for one in suite(instances=2):
        rng = np.random.default_rng(0)
        width = one.upper - one.lower
        near = one.best_point + rng.normal(size=(400, one.n_dimensions)) * 1e-3 * width
        anywhere = one.lower + rng.random((400, one.n_dimensions)) * width
        values = one.values(np.clip(np.vstack([near, anywhere]), one.lower, one.upper))
        assert values.min() >= one.best_known * (1 - 1e-9)


def test_an_instance_is_an_isometry_of_the_same_landscape():
    plain, moved = objective("woodworking"), objective("woodworking", instance=5)
    durations = np.random.default_rng(1).uniform(plain.lower, plain.upper, (50, 3))
    points = moved.point(durations)
    np.testing.assert_allclose(moved.durations(points), durations, rtol=1e-12)
    np.testing.assert_allclose(moved.values(points), plain.values(durations), rtol=1e-12)
    gaps = [np.linalg.norm(one[:, None] - one, axis=2) for one in (points, durations)]
    np.testing.assert_allclose(*gaps, atol=1e-12)
    assert moved.instance.mirrored.any() or moved.instance.shift.any()
    assert (objective("woodworking", instance=5).lower == moved.lower).all()


def test_evaluations_are_counted_point_by_point():
    one = objective("puma560")
    middle = 0.5 * (one.lower + one.upper)
    assert isinstance(one(middle), float)
    assert one(np.tile(middle, (7, 1))).shape == (7,)
    assert one.evaluations == 8
    assert one.best == one(middle)
    one.reset()
    assert (one.evaluations, one.best) == (0, np.inf)


def test_points_that_stand_for_no_motion_are_infinitely_bad():
    one = objective("puma560")
    rows = np.array([[np.nan, 1, 1], [-1, 1, 1], [np.inf, 1, 1], [1, 1, 1]])
    assert np.isinf(one.values(rows)).tolist() == [True, True, True, False]


def test_wrong_shapes_and_names_are_one_sentence():
    with pytest.raises(StudyError, match="points must have 3 coordinates"):
        objective("puma560")(np.ones(4))
    with pytest.raises(StudyError, match="no formulation 'scalled'; did you mean 'scaled'"):
        objective("puma560", "scalled")
    with pytest.raises(StudyError, match="at least 0"):
        objective("puma560", instance=-1)


def test_a_case_without_a_stored_best_has_none(tiny_case):
    one = DurationObjective(tiny_case)
    assert one.best_known is None
    assert one.best_point is None


def test_scipy_takes_it():
    from scipy.optimize import differential_evolution

    one = objective("woodworking", instance=2)
    found = differential_evolution(one, one.bounds, rng=1, maxiter=60)
    assert found.fun == pytest.approx(one.best_known, rel=1e-3)
    assert one.evaluations == found.nfev


def test_cmaes_takes_it():
    cmaes = pytest.importorskip("cmaes")
    one = objective("puma560", instance=1)
    box = np.column_stack([one.lower, one.upper])
    search = cmaes.CMA(mean=box.mean(axis=1), sigma=0.3, bounds=box, seed=1)
    for _ in range(60):
        points = [search.ask() for _ in range(search.population_size)]
        search.tell([(x, one(x)) for x in points])
    assert one.best == pytest.approx(one.best_known, rel=1e-3)
    assert one.evaluations == 60 * search.population_size


@pytest.mark.filterwarnings("ignore")
def test_pymoo_takes_it():
    pytest.importorskip("pymoo")
    from pymoo.algorithms.soo.nonconvex.de import DE
    from pymoo.optimize import minimize

    one = objective("woodworking")
    found = minimize(pymoo_problem(one), DE(pop_size=20), ("n_eval", 2000), seed=1, verbose=False)
    assert float(found.F[0]) == pytest.approx(one.best_known, rel=1e-3)
    assert one.evaluations == 2000


@pytest.mark.filterwarnings("ignore")
def test_mealpy_takes_it():
    mealpy = pytest.importorskip("mealpy")
    one = objective("woodworking")
    best = mealpy.DE.OriginalDE(epoch=80, pop_size=20).solve(mealpy_problem(one), seed=1)
    assert best.target.fitness == pytest.approx(one.best_known, rel=1e-2)
    assert best.target.fitness >= one.best_known * (1 - 1e-12)
    assert one.evaluations >= 80 * 20


def test_nevergrad_takes_it():
    ng = pytest.importorskip("nevergrad")
    one = objective("woodworking", instance=4)
    box = ng.p.Array(init=0.5 * (one.lower + one.upper)).set_bounds(one.lower, one.upper)
    box.random_state.seed(1)
    found = ng.optimizers.TwoPointsDE(box, budget=1200).minimize(one)
    assert one.evaluations == 1200
    assert one(found.value) == pytest.approx(one.best_known, rel=1e-2)


def spend(problem, points):
    """What any algorithm written for IOHexperimenter asks of a problem."""
    for x in points:
        problem(x)
    seen = problem.state.evaluations, problem.state.current_best.y, np.array(problem.state.current_best.x)
    span = np.array(problem.bounds.lb), np.array(problem.bounds.ub)
    known = problem.meta_data.n_variables, problem.meta_data.instance, problem.optimum.y, np.array(problem.optimum.x)
    return *seen, *span, *known


def test_it_answers_as_a_problem_of_iohexperimenter_does():
    ioh = pytest.importorskip("ioh")
    inner = objective("puma560", "scaled", 0)
    theirs = ioh.wrap_problem(
        inner,
        name="puma560",
        dimension=3,
        instance=0,
        optimization_type=ioh.OptimizationType.MIN,
        calculate_objective=lambda instance, dimension: ioh.RealSolution(inner.best_point.tolist(), inner.best_known),
    )
    theirs.bounds.lb, theirs.bounds.ub = inner.lower, inner.upper
    ours = ioh_callable(objective("puma560", "scaled", 0))
    points = np.random.default_rng(2).uniform(inner.lower, inner.upper, (30, 3))
    for mine, other in zip(spend(ours, points), spend(theirs, points), strict=True):
        np.testing.assert_array_equal(mine, other)
    assert inner.evaluations == ours.state.evaluations == 30
    assert ours(points.tolist()[:2]) == theirs(points.tolist()[:2])


def test_it_looks_like_a_problem_of_iohexperimenter():
    problem = ioh_callable(objective("aubo-i5", "scaled", 3))
    x = np.random.default_rng(0).uniform(problem.bounds.lb, problem.bounds.ub)
    value = problem(x)
    assert problem(list(x)) == value
    assert (problem.meta_data.n_variables, problem.meta_data.instance) == (3, 3)
    assert problem.state.evaluations == 2
    assert problem.state.current_best.y == value
    assert (problem.state.current_best.x == x).all()
    assert problem(problem.optimum.x) == pytest.approx(problem.optimum.y)
    problem.reset()
    assert problem.state.evaluations == 0
    with pytest.raises(AttributeError):
        _ = problem.state.nothing
