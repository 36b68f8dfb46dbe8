"""roboplan's time parameterization: TOPP-RA along a cubic spline, sampled every 4 ms; the extra `roboplan`.

Its usual mode, Hermite, stops at every waypoint; Cubic goes on without a stop. LinearBlend cuts corners on purpose
and is left out. What the samples say is joined by quintics, as controllers do.
"""

from __future__ import annotations

import importlib
import tempfile
from pathlib import Path
from typing import Any, ClassVar

import yaml

from baselines.peers.arm_text import names_of, urdf
from baselines.peers.base import Peer, needs, through_states
from study.planning import Freedom
from study.problem import Problem
from study.trajectory import Trajectory

needs("roboplan")

CYCLE = 0.004
"""Time between samples, s."""


class RoboPlan(Peer):
    """Planner `roboplan-cubic`."""

    about = "roboplan's TOPP-RA along a cubic spline, sampled every 4 ms"
    freedom: ClassVar[Freedom] = Freedom.PATH
    jerk: ClassVar[tuple[bool, ...]] = (False,)

    def solve(self, problem: Problem, time_limit: float) -> Any:
        """Build the scene and sample its trajectory."""
        core, toppra = importlib.import_module("roboplan.core"), importlib.import_module("roboplan.toppra")
        names = names_of(problem)
        scene = core.Scene("arm", core.loadUrdfSceneDescriptionFromXml(urdf(problem)))
        rates = zip(problem.limits.velocity.tolist(), problem.limits.acceleration.tolist(), strict=True)
        limits = {
            name: {"max_velocity": [v], "max_acceleration": [a]} for name, (v, a) in zip(names, rates, strict=True)
        }
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "limits.yaml"
            file.write_text(yaml.safe_dump({"joint_limits": limits}))
            scene.importJointLimitsFromConfig(core.loadJointLimitsConfig(str(file)))
        scene.addGroup("arm", names)
        path = core.JointPath()
        path.joint_names, path.positions = names, list(problem.waypoints)
        options = toppra.TOPPRAOptions(dt=CYCLE, mode=toppra.SplineFittingMode.Cubic)
        return toppra.PathParameterizerTOPPRA(scene, "arm").generate(path, options)

    def motion(self, problem: Problem, answer: Any) -> Trajectory:
        """Join the samples."""
        return through_states(problem, answer.times, answer.positions, answer.velocities, answer.accelerations)
