"""Every demand that a problem can make, in a case in which it binds: at least two planners meet it, by both judges.

A demand binds if the motion planned without it breaks it; one that grants something binds if the motion that uses it breaks
the problem without it.
"""

from dataclasses import replace

import numpy as np
import pytest

from study import EndCondition, JointLimits, Problem, judge
from study.arm import ArmLimits
from study.demands import Demand, refusal
from study.planning import usual_settings
from study.problem import State, StraightPath, Timing, Tube
from study.registry import planner_named
from study.runs.execute import asked
from study.testing.sampler import sampled
from study.testing.second_judge import Answer, second_judge
from tests.helpers.arms import two_links

POINTS = np.array([[0.0, 0.1], [0.5, 0.5], [0.2, 0.9], [0.9, 0.4], [1.0, 1.0]])
LIMITS = JointLimits([1.5, 1.2], [5.0, 4.0], [50.0, 40.0])
FREE, REST, SMOOTH = EndCondition.FREE, EndCondition.REST, EndCondition.SMOOTH
TWO_LINKS = two_links()
MOVING = State([0.3, -0.2])


def walk(limits=LIMITS, **demands):
    return Problem("walk", POINTS, limits, **demands)


def bounds(**changes):
    return walk(replace(LIMITS, **changes))


LOW, HIGH = POINTS.min(axis=0), POINTS.max(axis=0)
ANY, STOPS, LINES = "free-path", "ruckig-stops", "straight"
TABLE = {
    "highest velocity": (bounds(velocity=[0.4] * 2, min_velocity=[-1.5] * 2), walk(), (ANY, STOPS, LINES)),
    "lowest velocity": (bounds(min_velocity=[-0.4] * 2), walk(), (ANY, STOPS, LINES)),
    "highest acceleration": (bounds(acceleration=[1.0] * 2, min_acceleration=[-5.0] * 2), walk(), (ANY, STOPS, LINES)),
    "lowest acceleration": (bounds(min_acceleration=[-1.0] * 2), walk(), (ANY, STOPS, LINES)),
    "highest jerk": (bounds(jerk=[9.0] * 2, min_jerk=[-50.0] * 2), walk(), (ANY, STOPS, LINES)),
    "lowest jerk": (bounds(min_jerk=[-9.0] * 2), walk(), (ANY, STOPS, LINES)),
    "directions without a limit of jerk": (
        bounds(jerk=None, min_velocity=[-0.4] * 2, min_acceleration=[-2.0] * 2),
        walk(),
        (ANY, STOPS, LINES, "toppra"),
    ),
    "no limit of jerk": (walk(replace(LIMITS, jerk=None)), walk(), (ANY, STOPS, LINES, "casadi-nlp", "toppra")),
    "lowest position": (bounds(lower=LOW), walk(start=MOVING, finish=SMOOTH), (ANY, STOPS, LINES)),
    "highest position": (bounds(upper=HIGH), walk(), (ANY, STOPS, LINES)),
    "start velocity given": (walk(start=MOVING), walk(), (ANY, STOPS)),
    "end velocity given": (walk(finish=MOVING), walk(), (ANY, STOPS)),
    "start velocity free": (walk(start=FREE), walk(), (ANY, LINES)),
    "end velocity free": (walk(finish=FREE), walk(), (ANY, LINES)),
    "both ends free": (walk(end=FREE), walk(), (ANY, LINES, "free-path-nlp")),
    "at rest": (walk(end=REST), walk(end=FREE), (ANY, STOPS, "free-path-nlp")),
    "start acceleration given": (walk(start=State([0.3, -0.2], [2.0, 1.0])), walk(start=MOVING), (ANY, STOPS)),
    "start acceleration free": (walk(end=REST), walk(end=SMOOTH), (ANY, STOPS, "free-path-nlp")),
    "smooth": (walk(end=SMOOTH), walk(end=REST), (ANY, STOPS, LINES, "casadi-nlp", "free-path-nlp")),
    "smooth at one end": (walk(start=SMOOTH, finish=REST), walk(end=REST), (ANY, STOPS, LINES)),
    "stop": (walk(stops=[2]), walk(), (ANY, STOPS, LINES)),
    "dwell": (walk(dwells={2: 0.3}), walk(stops=[2]), (ANY, STOPS, LINES)),
    "rates on a segment": (walk(segment_limits={2: JointLimits([0.5] * 2)}), walk(), (ANY, STOPS, LINES)),
    "positions on a segment": (
        walk(segment_limits={2: JointLimits([9.0] * 2, lower=[0.2, 0.0], upper=[2.0, 0.9])}), walk(), (ANY, STOPS)),
    "tolerance": (walk(tolerance=0.02), walk(), (ANY, LINES)),
    "tolerance at a waypoint": (walk(tolerance=[0, 0.02, 0, 0, 0]), walk(), (ANY, LINES)),
    "tolerance of a joint": (walk(tolerance=np.tile([0.02, 0.01], (5, 1))), walk(tolerance=0.01), (ANY, LINES)),
    "straight path": (walk(path=StraightPath()), walk(), (LINES, STOPS)),
    # its second planner is the closed form of `tests/baselines/path_timing/test_straight.py`
    "straight path, corners cut": (walk(path=StraightPath(0.05)), walk(path=StraightPath()), (LINES,)),
    "straight but for corners": (walk(path=StraightPath([0.05, 0.02])), walk(), (LINES, STOPS)),
    "tube": (walk(path=Tube(0.02)), walk(), (ANY, LINES, STOPS)),
    "torque": (walk(arm=ArmLimits(TWO_LINKS, [40.0, 9.5])), walk(), (ANY, STOPS, LINES, "casadi-nlp")),
    "tool speed": (walk(arm=ArmLimits(TWO_LINKS, tool_speed=0.25)), walk(), (ANY, STOPS, LINES, "casadi-nlp")),
    "tool acceleration": (walk(arm=ArmLimits(TWO_LINKS, tool_acceleration=1.0)), walk(), (ANY, STOPS, LINES)),
    "torque and tool without a limit of jerk": (
        walk(replace(LIMITS, jerk=None), arm=ArmLimits(TWO_LINKS, [40.0, 9.5], 0.6)), walk(), ("toppra", ANY, STOPS)),
    "duration": (walk(timing=Timing(exactly=4.0)), walk(), (ANY, STOPS, LINES, "casadi-nlp", "free-path-nlp")),
    "least duration": (walk(timing=Timing(at_least=4.0)), walk(), (ANY, STOPS, LINES, "casadi-nlp")),
    "cycles": (walk(timing=Timing(cycle=0.05)), walk(), (ANY, STOPS, LINES, "casadi-nlp")),
    "duration between moving ends": (walk(start=MOVING, timing=Timing(exactly=4.0)), walk(start=MOVING), (ANY, STOPS)),
    "speed": (walk().at_speed(0.5), walk(), (ANY, STOPS, LINES, "casadi-nlp", "free-path-nlp")),
}  # fmt: skip


def planned(problem, name):
    planner = planner_named(name)
    assert refusal(problem.planner_demands, planner.knows) == ""
    plan = asked(planner, problem, replace(usual_settings(problem), time_limit=20.0))
    assert plan.motion is not None, plan.message
    return plan.motion


@pytest.mark.parametrize("row", TABLE)
def test_every_demand_binds_and_is_met(row):
    problem, without, planners = TABLE[row]
    motions = {name: planned(problem, name) for name in planners}
    for name, motion in motions.items():
        assert judge(problem, motion).reasons == (), name
        assert second_judge(problem, motion).answer is Answer.FEASIBLE, name
        assert sampled(problem, motion).confirmed, name
    plain = planned(without, planners[0] if without.path else ANY)
    broken = [judge(problem, plain).reasons, judge(without, motions[planners[0]]).reasons]
    assert any(broken), "the demand makes no difference"


def test_the_table_has_every_demand():
    assert {demand for problem, _, _ in TABLE.values() for demand in problem.demands} == set(Demand)
