"""Do metaheuristic time-optimal trajectory planners beat plain deterministic ones, and by how much?"""

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from study.api import Comparison, Planned, compare, onward, plan, plan_many
    from study.errors import StudyError
    from study.judge import Verdict, judge
    from study.planning import RunSettings
    from study.problem import EndCondition, JointLimits, Problem
    from study.trajectory import Motion, Trajectory

_HOMES = {
    "Comparison": "study.api",
    "EndCondition": "study.problem",
    "JointLimits": "study.problem",
    "Motion": "study.trajectory",
    "Planned": "study.api",
    "Problem": "study.problem",
    "RunSettings": "study.planning",
    "StudyError": "study.errors",
    "Trajectory": "study.trajectory",
    "Verdict": "study.judge",
    "compare": "study.api",
    "onward": "study.api",
    "plan": "study.api",
    "plan_many": "study.api",
}
"""Modules of the public names; each is imported at its first use, so that the command starts at once."""

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
    "onward",
    "plan",
    "plan_many",
]


def __getattr__(name: str) -> Any:
    """Import a public name from its module at its first use."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(_HOMES[name]), name)
    globals()[name] = value
    return value


class _Package(ModuleType):
    """The package, in which `judge` stays the function although a module has the same name."""

    @property
    def judge(self) -> Any:
        """The function `study.judge.judge`."""
        return import_module("study.judge").judge

    @judge.setter
    def judge(self, module: ModuleType) -> None:
        """Pass over the module that Python puts here when it imports `study.judge`."""


sys.modules[__name__].__class__ = _Package
