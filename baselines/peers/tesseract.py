"""Tesseract's time parameterizations, TOTG and ISP, in a process of their own; the extra `tesseract`.

The package brings a C++ runtime of its own, which cannot be loaded after an older one that SciPy has loaded. Its
answer is one state at each waypoint: position, velocity, acceleration and time. ISP's are joined by quintics, as
controllers do, which gives its own cubics. TOTG times lines with corners cut by at most `path_tolerance`, set to
0.001 rad from 0.1, but answers with the waypoints themselves, so that its rates belong to another path; a spline
through positions and times is taken.

References
----------
T. Kunz, M. Stilman, Time-optimal trajectory generation for path following with bounded acceleration and velocity, RSS
2012.
"""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from baselines.peers.arm_text import names_of, urdf
from baselines.peers.base import Peer, needs, through_states
from study.planning import Freedom
from study.problem import Problem
from study.trajectory import Trajectory

needs("tesseract_robotics")

SCRIPT = Path(__file__).with_name("tesseract_process.py")
START = 20.0
"""Time that the process is given to load the package, besides the planner's own, s."""


@dataclass(frozen=True)
class Tesseract(Peer):
    """Planners `tesseract-totg` and `tesseract-isp`.

    Parameters
    ----------
    method : str
        TOTG or ISP.
    about : str
    rates : int
        How many rates of its states count besides positions and times.
    """

    method: str
    about: str
    rates: int
    freedom: ClassVar[Freedom] = Freedom.PATH
    outside: ClassVar[bool] = True
    jerk: ClassVar[tuple[bool, ...]] = (False,)

    def solve(self, problem: Problem, time_limit: float) -> Any:
        """Ask the process for times, positions, velocities and accelerations."""
        question = {
            "method": self.method,
            "names": names_of(problem),
            "urdf": urdf(problem),
            "waypoints": problem.waypoints.tolist(),
            "velocity": problem.limits.velocity.tolist(),
            "acceleration": problem.limits.acceleration.tolist(),
        }
        ended = subprocess.run(  # noqa: S603
            [sys.executable, "-P", str(SCRIPT)],
            input=json.dumps(question),
            capture_output=True,
            text=True,
            timeout=time_limit + START,
            check=False,
        )
        if ended.returncode:
            raise RuntimeError((ended.stderr.strip().splitlines() or ["no reason given"])[-1])
        return json.loads(ended.stdout.splitlines()[-1])

    def motion(self, problem: Problem, answer: Any) -> Trajectory:
        """Join the states."""
        return through_states(problem, *answer[: 2 + self.rates])


TOTG = Tesseract("TOTG", "Tesseract's time-optimal trajectory generation along lines with blended corners", rates=0)
ISP = Tesseract("ISP", "Tesseract's iterative spline parameterization", rates=2)
