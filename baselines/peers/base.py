"""Common part of all peers: they decline beforehand what a package cannot do, and make exact motions of its answers."""

from __future__ import annotations

import time
from importlib.util import find_spec
from typing import Any, ClassVar

import numpy as np

from baselines.base import Deterministic, where_something_moves
from study.io.sampled import joined
from study.io.samples import Samples
from study.planning import Plan, RunSettings, Status
from study.problem import Demand, EndCondition, Floats, Problem
from study.trajectory import Trajectory


def needs(package: str) -> None:
    """Make sure that a package can be imported, without importing it.

    Raises
    ------
    ModuleNotFoundError
        With the package's name.
    """
    if find_spec(package) is None:
        raise ModuleNotFoundError(f"no package {package}", name=package)


class Peer(Deterministic):
    """A planner that asks another package.

    Attributes
    ----------
    jerk : tuple of bool
        Whether it plans with jerk limits, without, or both.
    most : int, optional
        Waypoints up to which its work, which nothing can stop, fits the usual time limits.
    outside : bool
        Whether the package runs in a process of its own, so that processor time of this one says nothing.
    """

    about: str
    knows: ClassVar[frozenset[Demand]] = frozenset()
    jerk: ClassVar[tuple[bool, ...]] = (True, False)
    most: ClassVar[int | None] = None
    outside: ClassVar[bool] = False

    def solve(self, problem: Problem, time_limit: float) -> Any:
        """Ask the package, which is what its user pays for; None where it finds nothing."""
        raise NotImplementedError

    def motion(self, problem: Problem, answer: Any) -> Trajectory:
        """Make an exact motion of the package's answer."""
        raise NotImplementedError

    def declines(self, problem: Problem, time_limit: float) -> str:
        """Say in a sentence why the package is not asked; empty where it is."""
        limited, limits = np.isfinite(problem.limits.rates[2]), problem.limits.rates[:2]
        if not np.isfinite(limits).all():
            return "the package needs finite limits of velocity and acceleration for every joint"
        if limited.any() and not limited.all():
            return "the package limits the jerk of all joints or of none"
        if limited.all() not in self.jerk:
            return "the package knows no limit of jerk" if limited.all() else "the package needs limits of jerk"
        if problem.end is EndCondition.SMOOTH and not limited.all():
            return "the package starts and ends with a step of the acceleration where no jerk is limited"
        if self.most is not None and problem.n_waypoints > self.most:
            return f"nothing stops the package, and it takes too long for more than {self.most} waypoints"
        return ""

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Ask the package; of the settings the time limit matters, as far as the package can be stopped."""
        if reason := self.declines(problem, settings.time_limit):
            return Plan(Status.NOT_APPLICABLE, message=reason)
        started = time.perf_counter()
        try:
            answer = self.solve(problem, settings.time_limit)
            seconds = time.perf_counter() - started
            motion = None if answer is None else self.motion(problem, answer)
        except Exception as error:  # a stranger's package may raise anything
            said = (str(error).strip().splitlines() or [type(error).__name__])[0]
            return Plan(Status.FAILED, message=f"the package stopped: {said}")
        if motion is None:
            return Plan(Status.NOT_CONVERGED, message="the package found no motion in its time")
        return Plan(Status.FINISHED, motion=motion, details={"package_seconds": seconds})


def through_states(
    problem: Problem, times: Any, positions: Any, velocities: Any = None, accelerations: Any = None
) -> Trajectory:
    """Join states at times, arrays of shape (n_times, n_joints), as controllers do; without rates by a spline."""
    read = [None if given is None else np.asarray(given, dtype=float) for given in (times, velocities, accelerations)]
    samples = Samples(np.asarray(positions, dtype=float), times=read[0], velocities=read[1], accelerations=read[2])
    return joined(samples, problem, "the package's answer").trajectory


def through_phases(knots: Floats, at_knots: Floats, at_middles: Floats, steps: bool) -> tuple[Floats, Floats]:
    """Pieces of constant jerk from states where they begin and halfway.

    Parameters
    ----------
    knots : array of shape (n_pieces + 1,), s
    at_knots, at_middles : arrays of shape (n_pieces, 3, n_joints)
        Positions, velocities and accelerations.
    steps : bool
        Whether the acceleration steps at the knots and is constant between them.

    Returns
    -------
    widths : array of shape (n_pieces,), s
    cubics : array of shape (n_pieces, 4, n_joints)
    """
    widths = np.diff(knots)
    jerk = (at_middles[:, 2] - at_knots[:, 2]) / (widths[:, None] / 2)
    cubics = np.stack([at_knots[:, 0], at_knots[:, 1], at_knots[:, 2] / 2, jerk / 6], axis=1)
    if steps:
        cubics[:, 2], cubics[:, 3] = at_middles[:, 2] / 2, 0.0
    return widths, cubics
