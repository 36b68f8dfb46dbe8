"""Clearance of a moving arm to obstacles and to itself, proved between samples too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from study.cases.library import Case
from study.cautions import unbounded_joints
from study.judge import Verdict
from study.pathfinding.world import World, arm_clearance, segment_distances
from study.problem import Floats, Problem
from study.robots import Robot, robot_named
from study.trajectory import Motion

INSTANTS = 200
"""Evenly spaced instants that are looked at first, besides the knots; where nothing is proved between two, more follow."""

MILLIMETRE = 1e-3
"""The smallest distance is proved to this, m."""

FINEST = 1e-5
"""A motion that comes nearer than this, m, without touching is not proved to be clear."""


AT_REST = 1e-6
"""Speed below which a joint stands still, rad/s or m/s."""

MOST = 100_000
"""Instants after which what is proved so far must do."""


@dataclass(frozen=True)
class Nearest:
    """The smallest distance between the arm and what it must not touch.

    Attributes
    ----------
    distance : float, m
        Smallest distance at any instant looked at; negative where they touch.
    time : float, s
    proved : float, m
        No distance at any instant between is smaller.
    whom : str
    """

    distance: float
    time: float
    proved: float
    whom: str = "all obstacles"

    @property
    def clear(self) -> bool:
        """Whether it is proved that nothing is touched at any instant."""
        return self.proved > 0

    @property
    def sentence(self) -> str:
        """For people."""
        if self.distance < 0:
            hit = "an obstacle" if self.whom == "all obstacles" else self.whom
            return f"the arm hits {hit} at {self.time:.3f} s, {-self.distance:.4g} m deep"
        if not self.clear:
            return f"the arm comes within {self.distance:.4g} m of {self.whom} at {self.time:.3f} s, too near to prove it clear"
        return (
            f"the arm stays {self.distance:.4g} m away from {self.whom}, nearest at {self.time:.3f} s, "
            f"proved to be more than {self.proved:.4g} m at every instant"
        )


def may_be_driven(verdict: Verdict, nearest: Nearest | None) -> bool:
    """Whether a motion is within its limits and, where there is anything to touch, proved to be clear.

    Parameters
    ----------
    verdict : Verdict
    nearest : Nearest, optional
        From `nearest`, of the same motion.
    """
    return verdict.feasible and (nearest is None or nearest.clear)


DRIVEN = {True: "may be driven", False: "must not be driven"}
"""Words that terminal, report and recording share."""

UNFOLLOWED = "within its limits, but no arm can follow it"
"""Words for a motion within its limits whose speed steps, as it may where a joint has no acceleration limit."""


def said_of(problem: Problem, verdict: Verdict, good: bool) -> str:
    """Say whether a motion may be driven, once the judge and the obstacles have spoken.

    Parameters
    ----------
    problem : Problem
    verdict : Verdict
    good : bool
        As `may_be_driven` says.
    """
    loose = unbounded_joints(problem)
    given = [np.zeros(problem.n_joints) if end.velocity is None else end.velocity for end in problem.end_states]
    steps = verdict.continuity < 1 or bool((np.abs(verdict.end_velocity - given)[:, loose] > AT_REST).any())
    return UNFOLLOWED if good and loose.any() and steps else DRIVEN[good]


def driving(case: Case, motion: Motion, verdict: Verdict) -> str:
    """Say of a motion whether it may be driven and, where the case has anything to touch, how near it comes."""
    clearance = nearest(case, motion)
    return said_of(case.problem, verdict, may_be_driven(verdict, clearance)) + (
        f": {clearance.sentence}" if clearance else ""
    )


def nearest(case: Case, motion: Motion) -> Nearest | None:
    """Find how near the arm comes to obstacles, and to itself where the case asks for it; None where it asks for neither.

    The links are capsules from joint to joint with the case's radius. No point of the arm is faster than the joints' peak
    speeds times their reach, and so between two instants nothing comes nearer than that speed allows. Instants are added
    until the smallest distance is proved to a millimetre, and its sign, if it can be.

    Parameters
    ----------
    case : Case
    motion : Motion
    """
    if case.robot is None or not (len(case.obstacles) or case.self_collision):
        return None
    robot = robot_named(case.robot, tuple(case.problem.joint_names))
    speed = _fastest(robot, case, motion)
    answers = []
    if len(case.obstacles):
        world = world_of(case)
        answers.append(
            _closest(lambda places: arm_clearance(world, places, case.arm_radius), robot, case, motion, speed)
        )
    if case.self_collision:
        alone = _closest(lambda places: _apart(places, case.arm_radius), robot, case, motion, 2 * speed)
        answers.append(Nearest(alone.distance, alone.time, alone.proved, "itself"))
    return min(answers, key=lambda answer: answer.proved, default=None)


def world_of(case: Case) -> World:
    """The case's obstacles with room around them."""
    return World(case.obstacles.min(axis=(0, 1)) - 1.0, case.obstacles.max(axis=(0, 1)) + 1.0, case.obstacles)


def _fastest(robot: Robot, case: Case, motion: Motion) -> float:
    """Bound on the speed of every point of the arm, m/s: each joint's peak speed times the length of all that it moves."""
    places = robot.frames(np.zeros((1, robot.n_joints)))[0, :, :3, 3]
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=1)
    moving = np.setdiff1d(np.arange(robot.n_joints), list(case.fixed_joints))
    farthest = np.zeros(robot.n_joints)
    farthest[moving] = motion.extrema().peak
    farthest[list(case.fixed_joints)] = np.abs(list(case.fixed_joints.values()))
    lengths = lengths + np.where(robot.prismatic, farthest, 0.0)
    reach = np.where(robot.prismatic, 1.0, np.cumsum(lengths[::-1])[::-1])
    return float(motion.extrema(1).peak @ reach[moving])


def _closest(distances: Callable[[Floats], Floats], robot: Robot, case: Case, motion: Motion, speed: float) -> Nearest:
    """Refine instants until nothing between two of them can be nearer than is known, to a millimetre."""
    times = np.unique(np.concatenate([np.linspace(0.0, motion.duration, INSTANTS), motion.knots]))

    def measured(at: Floats) -> Floats:
        return distances(robot.frames(case.robot_configuration(motion(at)))[:, :, :3, 3])

    known = measured(times)
    while True:
        best = float(known.min())
        between = 0.5 * (known[1:] + known[:-1] - speed * np.diff(times))
        proved = min(best, float(between.min()))
        slack = min(MILLIMETRE, max(0.5 * best, FINEST) if best > 0 else MILLIMETRE)
        open_ = np.flatnonzero(between < best - slack)
        if not len(open_) or len(times) > MOST:
            return Nearest(best, float(times[known.argmin()]), proved)
        halves = 0.5 * (times[open_] + times[open_ + 1])
        times = np.insert(times, open_ + 1, halves)
        known = np.insert(known, open_ + 1, measured(halves))


def _apart(places: Floats, radius: float) -> Floats:
    """Smallest distance between links of the arm that are not neighbours, at every instant, shape (n_times,)."""
    lengths = np.linalg.norm(np.diff(places[0], axis=0), axis=1)
    links = np.flatnonzero(lengths > 0)
    pairs = [(first, second) for first in links for second in links if lengths[first + 1 : second].sum() > 2 * radius]
    if not pairs:
        return np.full(len(places), np.inf)
    first, second = np.array(pairs).T
    axes = [places[:, index] for index in (first, first + 1, second, second + 1)]
    flat = segment_distances(*(axis.reshape(-1, 3) for axis in axes))
    return flat.reshape(len(places), -1).min(axis=1) - 2 * radius
