"""Do metaheuristic time-optimal trajectory planners beat plain deterministic ones, and by how much?"""

from study.api import Comparison, Planned, compare, plan
from study.errors import StudyError
from study.judge import Verdict, judge
from study.planning import RunSettings
from study.problem import EndCondition, JointLimits, Problem
from study.trajectory import Motion, Trajectory

__all__ = [
    "Comparison",
    "EndCondition",
    "JointLimits",
    "Motion",
    "Planned",
    "Problem",
    "RunSettings",
    "StudyError",
    "Trajectory",
    "Verdict",
    "compare",
    "judge",
    "plan",
]
