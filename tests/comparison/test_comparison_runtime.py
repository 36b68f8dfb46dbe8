import numpy as np
import pytest

from study.comparison import runtime
from study.comparison.contestants import Contestant, Level
from study.comparison.targets import distributions, performance

RUN = np.array([[10.0, np.inf], [20.0, 8.0], [30.0, 5.5], [40.0, 5.0]])
OTHER = np.array([[10.0, 7.0], [20.0, 6.0], [30.0, 6.0], [40.0, 6.0]])


def test_first_hit_by_hand():
    assert runtime.first_hit(RUN, 8.0) == 20
    assert runtime.first_hit(RUN, 7.9) == 30
    assert runtime.first_hit(RUN, 4.9) == np.inf


def test_hits_are_shares_above_the_reference():
    found = runtime.hits([RUN, OTHER], 5.0, (0.6, 0.1, 0.0))
    assert found.tolist() == [[20, 30, 40], [10, np.inf, np.inf]]


def test_average_runtime_by_hand():
    # two failures of 100 and hits at 20 and 40: (100 + 20 + 100 + 40) / 2
    assert runtime.average_runtime([np.inf, 20, np.inf, 40], [100, 100, 100, 100]) == 130
    assert runtime.average_runtime([np.inf], [100]) == np.inf
    assert runtime.average_runtime([3.0], [100]) == 3


def test_average_runtime_is_the_expectation_over_restarts():
    rng = np.random.default_rng(0)
    successes = rng.random(4000) < 0.25
    hits = np.where(successes, 30.0, np.inf)
    # geometric: 3 failures of 50 on average before a success of 30
    assert runtime.average_runtime(hits, np.full(4000, 50.0)) == pytest.approx(3 * 50 + 30, rel=0.08)


def test_ecdf_by_hand():
    assert runtime.ecdf([[1.0, 5.0], [np.inf, 5.0]], [0.5, 1.0, 4.9, 5.0, 1e9]).tolist() == [0, 0.25, 0.25, 0.75, 0.75]


def test_quartiles_by_hand():
    grid = np.array([5.0, 10.0, 25.0, 40.0])
    assert runtime.on_grid(RUN, grid).tolist() == [np.inf, np.inf, 8.0, 5.0]
    low, middle, high = runtime.quartiles([RUN, OTHER, OTHER], grid)
    assert low.tolist() == [np.inf, 7.0, 6.0, 6.0]
    assert middle.tolist() == [np.inf, 7.0, 6.0, 6.0]
    assert high.tolist() == [np.inf, np.inf, 8.0, 6.0]


def contestant(planner, histories, durations, wall):
    return Contestant(
        "case", planner, Level.SCALED, np.array(durations), np.array(durations), tuple(histories),
        np.array([history[-1, 0] for history in histories]), np.array(wall),
    )  # fmt: skip


def test_performance_by_hand():
    found = performance(contestant("a", [RUN, OTHER], [5.0, 6.0], [0.4, 0.8]), 5.0)
    assert found.gap == pytest.approx(0.2)  # the upper of two middle values
    assert found.reached.tolist() == [0.5, 0.5, 0.5, 0.5, 0.5]
    assert found.evaluations.tolist() == [30 + 40, 40 + 40, 80, 80, 80]
    # 30 of 40 evaluations of 0.4 s, and the failed run's 0.8 s
    assert found.seconds[0] == pytest.approx(0.3 + 0.8)


def test_a_deterministic_run_counts_like_the_repeated_ones():
    measured = [
        performance(contestant("search", [OTHER, OTHER], [6.0, 6.0], [1, 1]), 5.0),
        performance(contestant("once", [RUN], [5.0], [1]), 5.0),
    ]
    found = {one.planner: one.shares for one in distributions(measured, {"case": 1})}
    assert found["once"][-1] == 1.0
    assert found["search"][-1] == 0.0
    assert list(found) == ["once", "search"]
