"""Every public function with every kind of wrong argument: one sentence, whatever comes."""

from pathlib import Path

import numpy as np
import pytest

from study import JointLimits, Problem, RunSettings, StudyError, Trajectory, compare, judge, onward, plan, plan_many
from study.adapters import ioh_callable, mealpy_problem, objective, pymoo_problem, suite
from study.cases.library import load_case
from study.curves import curve_named
from study.io.exact import read_exact
from study.io.limits import read_limits
from study.io.recordings import read_samples
from study.parametric import ParametricTrajectory
from study.planning import usual_settings
from study.problem import State, StraightPath, Timing, Tube

POINTS = [[0.0, 0.2], [0.5, -0.1], [0.9, 0.3]]
PROBLEM = Problem("p", POINTS, JointLimits([1, 1], [2, 2]))
PLANNED = plan(PROBLEM, "ruckig-stops")
MOTION = PLANNED.motion
PARAMETRIC = ParametricTrajectory([[0, 1.0]], [[[0.0, 0.0], [1.0, 1.0]]])
DURATION = objective("woodworking")
LIMITS = ("velocity", "acceleration", "jerk", "lower", "upper", "min_velocity", "min_acceleration", "min_jerk")


def show(file):
    """Show a plan in a file, where that is no file that could be written."""
    return None if isinstance(file, str | Path | None) else PLANNED.show(file)


CALLS = {
    "Problem": (
        Problem,
        {"name": "p", "waypoints": POINTS, "limits": PROBLEM.limits}
        | dict.fromkeys(
            ("end", "duration_bounds", "start", "finish", "dwells", "segment_limits", "tolerance", "path", "timing")
        )
        | {"joint_names": (), "stops": []},
    ),
    "JointLimits": (JointLimits, {"velocity": [1, 1]} | dict.fromkeys(LIMITS[1:])),
    "plan": (plan, {"problem": PROBLEM, "planner": "ruckig-stops", "settings": None}),
    "compare": (compare, {"problem": PROBLEM, "planners": ["ruckig-stops"], "settings": None, "seeds": 1}),
    "judge": (judge, {"problem": PROBLEM, "motion": MOTION}),
    "usual_settings": (usual_settings, {"problem": PROBLEM}),
    "RunSettings": (
        RunSettings,
        {
            "curve": "cubic-spline",
            "seed": 0,
            "time_limit": 1.0,
            "evaluations": 10,
            "population": 10,
            "formulation": "scaled",
            "synchronisation": "shared",
        },
    ),
    "Trajectory": (Trajectory, {"knots": [0, 1], "coefficients": [[[0.0], [1.0]]], "waypoint_times": [0, 1]}),
    "ParametricTrajectory": (ParametricTrajectory, {"time": [[0, 1.0]], "position": [[[0.0], [1.0]]]}),
    "Timing": (Timing, {"exactly": None, "at_least": 1.0, "cycle": None}),
    "Tube": (Tube, {"radius": 0.1}),
    "StraightPath": (StraightPath, {"radius": 0.1}),
    "State": (State, {"velocity": [0, 0], "acceleration": None}),
    "at_speed": (PROBLEM.at_speed, {"share": 0.5}),
    "joint": (PROBLEM.joint, {"index": 0}),
    "write": (PLANNED.write, {"path": "a.csv", "rate": None, "points": None, "accept_unbounded_acceleration": False}),
    "points": (PLANNED.points, {"rate": None, "points": None, "accept_unbounded_acceleration": False}),
    "plot": (PLANNED.plot, {"joint": 0}),
    "show": (show, {"file": "a.rrd"}),
    "plan_many": (plan_many, {"problems": [PROBLEM], "planner": "ruckig-stops", "settings": None, "jobs": 1}),
    "onward": (onward, {"problem": PROBLEM, "motion": MOTION, "time": 0.1, "waypoints": [[0.9, 0.4]]}),
    "from_pieces": (
        Trajectory.from_pieces,
        {"durations": [1.0], "coefficients": [[[0.0], [1.0]]], "pieces_per_segment": 1},
    ),
    "limits.joint": (PROBLEM.limits.joint, {"index": 0}),
    "limits.scaled": (PROBLEM.limits.scaled, {"factor": 2.0}),
    "limits.widened": (PROBLEM.limits.widened, {"share": 0.1}),
    "objective": (objective, {"case": "woodworking", "formulation": "scaled", "instance": 0}),
    "objective.points": (DURATION, {"points": np.ones(DURATION.n_dimensions)}),
    "suite": (lambda **given: next(suite(**given)), {"instances": 1, "name": "papers"}),
    "pymoo_problem": (pymoo_problem, {"objective": DURATION}),
    "mealpy_problem": (mealpy_problem, {"objective": DURATION}),
    "ioh_callable": (ioh_callable, {"objective": DURATION}),
    "curve_named": (curve_named, {"name": "cubic-spline"}),
    "read_exact": (read_exact, {"path": "a.exact.json"}),
    "read_samples": (read_samples, {"path": "a.csv"}),
    "read_limits": (lambda path: read_limits(path), {"path": "a.yaml"}),
    "load_case": (load_case, {"name_or_path": "woodworking"}),
    **{
        f"{type(motion).__name__}.{name}": (getattr(motion, name), given)
        for motion in (MOTION, PARAMETRIC)
        for name, given in {
            "__call__": {"t": 0.5, "order": 1},
            "extrema": {"order": 1},
            "scaled": {"factor": 2.0},
            "between": {"start": 0.0, "stop": 0.5},
            "joints": {"indices": [0]},
            "jumps": {"order": 1},
            "mapped": {"matrix": np.eye(2), "offset": [0, 0]},
            "crossings": {"levels": [0.1, 0.1]},
        }.items()
    },
}
JUNK = (
    None, 5, -1, 0, 1.5, float("nan"), float("inf"), True, "", "x", "rest", "\ud800", b"x", [], {}, (), [[]], [None], ["a"], {"a": 1}, {1, 2},
    object(), np.array([]), np.zeros((2, 2, 2)), np.array(["a"]), np.array([None]), np.ones(2) * 1j, 10**400, [1, [2]], PROBLEM, MOTION,
    Problem, len, range(3), np.datetime64("2020-01-01"), np.ma.masked_array([1.0, 2.0], [0, 1]),
    10**5000, [10**5000], 10**20, 1e308, -0.0, "\x1b[2J", {1: 2}, lambda *given: 1, np.zeros((2, 0)), np.array(["a", None], dtype=object), Path("nowhere"),
)  # fmt: skip


@pytest.mark.parametrize("name", CALLS)
def test_a_wrong_argument_is_one_sentence(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call, good = CALLS[name]
    refused = list[str]()
    for argument in good:
        for junk in JUNK:
            try:
                call(**{**good, argument: junk})
            except StudyError as error:
                refused.append(str(error))
    assert len(refused) > len(JUNK) / 2
    assert all(len(sentence.splitlines()) == 1 and "\x1b" not in sentence for sentence in refused)


@pytest.mark.parametrize("iterated", [iter(["ruckig-stops"]), "ruckig-stops", {"ruckig-stops": 1}])
def test_planners_are_a_list_of_names(iterated):
    with pytest.raises(StudyError, match="a list of at least one planner's name"):
        compare(PROBLEM, iterated)
