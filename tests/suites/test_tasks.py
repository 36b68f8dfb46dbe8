"""Tasks of real arms: inside the ranges, repeatable, and the tool where the task says."""

import numpy as np
import pytest

from study.errors import StudyError
from study.robots.arms import arm_named
from study.robots.reach import followed
from study.suites.tasks import BENCH, BENCH_ARMS, arm_problems, dense, seam


def test_the_bench_has_every_task_of_every_arm_and_a_seed_repeats():
    problems, again = list(arm_problems(3)), list(arm_problems(3))
    assert len({problem.name for problem in problems}) == len(problems) == 33
    assert [problem.n_waypoints for problem in problems[:11]] == [2, 7, 7, 10, 10, 20, 20, 50, 50, 200, 200]
    for problem, same in zip(problems, again, strict=True):
        np.testing.assert_array_equal(problem.waypoints, same.waypoints)
        assert np.isfinite(problem.limits.jerk).all() != problem.name.endswith("-va")
        assert np.isfinite([problem.limits.lower, problem.limits.upper]).all()
    assert not np.array_equal(
        problems[3].waypoints, next(p for p in arm_problems(4) if p.name == problems[3].name).waypoints
    )


@pytest.mark.parametrize("name", BENCH_ARMS)
def test_the_tool_keeps_its_orientation_on_a_seam(name):
    arm = arm_named(name)
    poses = arm.robot.forward(seam(np.random.default_rng(0), arm, 1.0))
    np.testing.assert_allclose(poses[:, :3, :3], np.broadcast_to(poses[0, :3, :3], (20, 3, 3)), atol=1e-9)
    np.testing.assert_allclose(poses[:, 2, 3], poses[0, 2, 3], atol=1e-9)
    assert len(BENCH) == 7


def test_a_place_out_of_reach_is_refused():
    arm = arm_named("ur5e")
    with pytest.raises(StudyError, match="cannot reach"):
        followed(arm.robot, arm.home, np.array([[3.0, 0.0, 0.0]]))


def test_dense_paths_come_in_any_number_of_points():
    rows = [dense(np.random.default_rng(0), arm_named("fr3"), 1.0, n) for n in (51, 101)]
    np.testing.assert_allclose(rows[1][::2], rows[0], atol=5e-3)
