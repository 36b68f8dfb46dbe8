"""The pipeline of the PUMA560 paper, from boxes to a judged motion."""

import numpy as np
import pytest

from study import StudyError, judge
from study.planners.rrt_spso import METHODS, Scene, attempt
from study.planning import RunSettings
from study.robots import robot_named

SETTINGS = RunSettings("poly353", 0, 400, 20, "penalty", "per-joint")


@pytest.mark.parametrize("method", METHODS)
def test_the_motion_is_judged_and_passes_the_nodes_of_a_free_path(method):
    found = attempt(method, 3, SETTINGS)
    assert judge(found.problem, found.motion).waypoint_error.max() < 1e-9
    tool = robot_named("puma560").forward(found.problem.waypoints)[:, :3, 3]
    nodes = Scene().to_world(tool)
    for node in nodes:
        assert np.abs(found.path - node).max(axis=1).min() < 1e-6
    assert nodes[0] == pytest.approx(0.0, abs=1e-6)
    assert nodes[-1] == pytest.approx(1000.0, abs=1e-6)
    assert found.arm_clearance <= found.waypoint_clearance + 1e-6
    assert found.arm_clearance <= found.tool_clearance


def test_same_seed_same_attempt_and_shortcuts_are_shorter():
    first, again = (attempt("rrt", 1, SETTINGS) for _ in range(2))
    assert first.motion.coefficients.tobytes() == again.motion.coefficients.tobytes()
    assert first.arm_clearance == again.arm_clearance
    assert attempt("rrt with shortcuts", 1, SETTINGS).path_length < first.path_length


def test_unknown_method():
    with pytest.raises(StudyError, match="no pathfinding method 'prm'"):
        attempt("prm", 0, SETTINGS)
