"""Whatever is given in the place of an argument of the public interface, the answer is a value or one sentence."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from study import JointLimits, Problem, RunSettings, Trajectory, compare, judge, onward, plan, plan_many
from study.adapters import ioh_callable, mealpy_problem, objective, pymoo_problem, suite
from study.cases.library import load_case
from study.curves import curve_named
from study.errors import StudyError
from study.io.exact import read_exact
from study.io.limits import read_limits
from study.io.recordings import read_samples
from study.parametric import ParametricTrajectory
from study.rules import State, StraightPath, Timing, Tube
from study.search.state import Box

ODD = (
    10**5000, 10**20, -1, 1.5, 1e308, -0.0, float("nan"), float("inf"), 1 + 2j, None, True, "x", "\x1b[2J", b"x", [1], [10**5000], [["a"]], {}, {1: 2},
    {"a"}, range(3), object(), int, lambda *given: 1, np.array([1, 2]), np.zeros(0), np.zeros((2, 0)), np.datetime64("2020-01-01"),
    np.array(["a", None], dtype=object), Path("nowhere"),
)  # fmt: skip

PROBLEM = Problem("p", [[0, 0], [1, 1], [2, 0.0]], JointLimits([1.0, 1.0], [2.0, 2.0]))
PLANNED = plan(PROBLEM, "toppra-quick")
MOTION = PLANNED.motion
BY_PARAMETER = ParametricTrajectory([[0.0, 1.0]], [[[0.0, 0.0], [1.0, 1.0]]])
DURATION = objective("woodworking")


def changed(make, **usual):
    """A call for every field: the usual arguments with that field given."""
    return {
        f"{make.__name__} {field.name}": (lambda given, name=field.name: make(**{**usual, name: given}))
        for field in fields(make)
    }


CALLS = {
    **changed(Problem, name="p", waypoints=PROBLEM.waypoints, limits=PROBLEM.limits),
    **changed(JointLimits, velocity=[1.0, 1.0]),
    **changed(RunSettings, curve="cubic-spline"),
    **changed(Trajectory, knots=MOTION.knots, coefficients=MOTION.coefficients, waypoint_times=MOTION.waypoint_times),
    **changed(ParametricTrajectory, time=BY_PARAMETER.time, position=BY_PARAMETER.position),
    **changed(State), **changed(Timing), **changed(Tube, radius=0.1), **changed(StraightPath, radius=0.1),
    **changed(Box, lower=np.zeros(2), upper=np.ones(2)),
    "from_pieces durations": lambda given: Trajectory.from_pieces(given, MOTION.coefficients),
    "from_pieces coefficients": lambda given: Trajectory.from_pieces([1.0], given),
    "from_pieces pieces": lambda given: Trajectory.from_pieces([1.0], [[[0.0], [1.0]]], given),
    **{
        f"{type(motion).__name__} {name}": (lambda given, motion=motion, call=call: call(motion, given))
        for motion in (MOTION, BY_PARAMETER)
        for name, call in {
            "time": lambda motion, given: motion(given),
            "order": lambda motion, given: motion(0.1, given),
            "extrema": lambda motion, given: motion.extrema(given),
            "jumps": lambda motion, given: motion.jumps(given),
            "scaled": lambda motion, given: motion.scaled(given),
            "joints": lambda motion, given: motion.joints(given),
            "start": lambda motion, given: motion.between(given, 0.5),
            "stop": lambda motion, given: motion.between(0.1, given),
            "matrix": lambda motion, given: motion.mapped(given, [0, 0]),
            "offset": lambda motion, given: motion.mapped(np.eye(2), given),
            "crossings": lambda motion, given: motion.crossings(given),
        }.items()
    },
    "limits joint": PROBLEM.limits.joint,
    "limits scaled": PROBLEM.limits.scaled,
    "limits widened": PROBLEM.limits.widened,
    "problem joint": PROBLEM.joint,
    "problem speed": PROBLEM.at_speed,
    "plan problem": plan,
    "plan planner": lambda given: plan(PROBLEM, given),
    "plan settings": lambda given: plan(PROBLEM, "toppra-quick", given),
    "plan_many problems": plan_many,
    "plan_many planner": lambda given: plan_many([PROBLEM], given),
    "plan_many jobs": lambda given: plan_many([PROBLEM], "toppra-quick", None, given),
    "compare problem": lambda given: compare(given, ["toppra-quick"]),
    "compare planners": lambda given: compare(PROBLEM, given),
    "compare settings": lambda given: compare(PROBLEM, ["toppra-quick"], given),
    "onward problem": lambda given: onward(given, MOTION, 0.1, [[2, 0.5]]),
    "onward motion": lambda given: onward(PROBLEM, given, 0.1, [[2, 0.5]]),
    "onward time": lambda given: onward(PROBLEM, MOTION, given, [[2, 0.5]]),
    "onward waypoints": lambda given: onward(PROBLEM, MOTION, 0.1, given),
    "judge problem": lambda given: judge(given, MOTION),
    "judge motion": lambda given: judge(PROBLEM, given),
    "points": PLANNED.points,
    "write": PLANNED.write,
    "plot": PLANNED.plot,
    "show": lambda given: given is None or isinstance(given, str | Path) or PLANNED.show(given),
    "objective case": objective,
    "objective formulation": lambda given: objective("woodworking", given),
    "objective instance": lambda given: objective("woodworking", instance=given),
    "objective points": DURATION,
    "suite instances": lambda given: next(suite(given)),
    "suite name": lambda given: next(suite(1, given)),
    "pymoo": pymoo_problem, "mealpy": mealpy_problem, "ioh": ioh_callable,
    "curve": curve_named, "case": load_case,
    "read_exact": read_exact, "read_limits": read_limits, "read_samples": read_samples,
}  # fmt: skip


@pytest.mark.parametrize("name", CALLS)
def test_what_is_odd_is_taken_or_refused_in_one_sentence(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    for given in ODD:
        said = ""
        try:
            CALLS[name](given)
        except StudyError as error:
            said = str(error)
        except Exception as error:
            pytest.fail(f"{name}, a {type(given).__name__}: {type(error).__name__}: {str(error)[:200]}")
        assert not set("\n\x1b") & set(said), (name, given)
