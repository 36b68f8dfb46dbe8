"""Do metaheuristic time-optimal trajectory planners beat plain deterministic ones, and by how much?"""

from study.errors import StudyError
from study.judge import Verdict, judge
from study.problem import EndCondition, JointLimits, Problem
from study.trajectory import Motion, Trajectory

__all__ = ["EndCondition", "JointLimits", "Motion", "Problem", "StudyError", "Trajectory", "Verdict", "judge"]
