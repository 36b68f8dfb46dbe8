"""The pipeline of the PUMA560 paper, from boxes to a judged motion."""

import numpy as np
import pytest

from study import StudyError, judge
from study.cases.library import load_case
from study.planners.rrt_spso import GOAL, METHODS, ROBOT, START, attempt
from study.planning import RunSettings
from study.robots import robot_named

SETTINGS = RunSettings("poly353", 0, 400, 20, "penalty", "per-joint")


@pytest.mark.parametrize("method", METHODS)
def test_the_motion_is_judged_and_passes_the_nodes_of_a_free_path(method):
    found = attempt(method, 3, SETTINGS)
    assert judge(found.problem, found.motion).waypoint_error.max() < 1e-9
    poses = robot_named(ROBOT).forward(found.problem.waypoints)
    for node in poses[:, :3, 3]:
        assert np.abs(found.path - node).max(axis=1).min() < 1e-9
    assert poses[0, :3, 3] == pytest.approx(START, abs=1e-9)
    assert poses[-1, :3, 3] == pytest.approx(GOAL, abs=1e-9)
    assert poses[:, :3, :3] == pytest.approx(np.broadcast_to(np.eye(3), (4, 3, 3)), abs=1e-9)
    assert min(found.chord_clearance, found.tool_clearance) >= 0.0


def test_the_ends_are_those_of_the_papers_table_4():
    ends = robot_named(ROBOT).forward(load_case("puma560").problem.waypoints)[[0, -1], :3, 3]
    assert ends == pytest.approx(np.array([START, GOAL]), abs=5e-6)


def test_straight_chords_between_kept_nodes_may_collide_though_the_trees_segments_are_free():
    clearances = [attempt("rrt", seed, SETTINGS).chord_clearance for seed in range(8)]
    assert min(clearances) == 0.0 < max(clearances)


def test_same_seed_same_attempt_and_shortcuts_are_shorter():
    first, again = (attempt("rrt", 1, SETTINGS) for _ in range(2))
    assert first.motion.coefficients.tobytes() == again.motion.coefficients.tobytes()
    assert first.tool_clearance == again.tool_clearance
    assert attempt("rrt with shortcuts", 1, SETTINGS).path_length < first.path_length


def test_unknown_method():
    with pytest.raises(StudyError, match="no pathfinding method 'prm'"):
        attempt("prm", 0, SETTINGS)
