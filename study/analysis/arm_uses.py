"""Demands of a motion on the whole arm, in words: torques, and the tool's speed and acceleration, against their limits."""

from __future__ import annotations

import numpy as np

from study.demands import Demand
from study.judge import Verdict
from study.problem import Problem


def arm_uses(problem: Problem, verdict: Verdict) -> dict[str, str]:
    """Largest use of every limit of the arm, by its name; nothing where the arm is not limited.

    Parameters
    ----------
    problem : Problem
    verdict : Verdict
    """
    if problem.arm is None:
        return {}
    lowest, highest = verdict.arm_shares
    said = {}
    if Demand.TORQUE in problem.arm.demands:
        joint = int(np.argmax(highest[:-2]))
        limit = problem.arm.torque[joint]
        said["torque"] = (
            f"{problem.joint_names[joint]}: {_share(lowest[joint], highest[joint])} of its {limit:g} N m or N"
        )
        said["torque"] += f", at {verdict.arm_times[joint]:.4g} s"
    tool = (("tool speed", problem.arm.tool_speed, "m/s"), ("tool acceleration", problem.arm.tool_acceleration, "m/s²"))
    for place, (name, limit, unit) in enumerate(tool, start=-2):
        if np.isfinite(limit):
            use = f"{lowest[place] * limit:.4g} {unit}, {_share(lowest[place], highest[place])} of its limit"
            said[name] = f"{use}, at {verdict.arm_times[place]:.4g} s"
    return said


def _share(low: float, high: float) -> str:
    """Share in percent that is proved not to be exceeded, and whether it could be much less."""
    at_least = "" if high <= low * 1.002 else f" (at least {100 * low:.2f} %)"
    return f"at most {100 * high:.2f} %{at_least}"
