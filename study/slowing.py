"""Any planner under limits of the arm: its motion is slowed down as a whole until torque and tool keep their limits.

In a motion k times as slow the tool's speed is 1/k and its acceleration 1/k^2 of what it was; so is the part of a torque
that moves masses, but gravity and dry friction stay. Where they alone ask for too much, no speed helps.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from study.arm import ArmLimits
from study.arm_findings import enclosed
from study.errors import StudyError, listed
from study.planning import Plan, Planner, in_time
from study.problem import Floats, Problem
from study.tolerances import TOLERANCE
from study.trajectory import Motion

SAMPLES, TRIES = 4000, 12
"""Instants at which the factor is estimated, at least; times that a proof is tried with a little more."""

ROOM, SLOWEST = 2e-5, 1e4


SLOWED = "slowed"
"""Name of the factor among a plan's details."""


def told(planner: Planner, problem: Problem) -> Problem:
    """Problem as a planner hears it: without limits of the arm, where it does not know all of them."""
    return problem if problem.arm is None or problem.arm.demands <= planner.knows else replace(problem, arm=None)


def fitted(problem: Problem, plan: Plan) -> Plan:
    """Slow a plan's motion down to what the problem demands and a slower run can give: limits of the arm, a duration.

    Raises
    ------
    StudyError
        If no slower run keeps the limits of the arm, or the motion takes longer than it must.
    """
    return in_time(problem, within_arm(problem, plan))


def within_arm(problem: Problem, plan: Plan) -> Plan:
    """Slow a plan's motion down until it keeps the limits of the arm; nothing changes where it does, or has moving ends."""
    if plan.motion is None or problem.arm is None or not problem.scalable:
        return plan
    factor = slow_down(problem.arm, plan.motion)
    if factor == 1:
        return plan
    return replace(
        plan,
        motion=plan.motion.scaled(factor),
        durations=None if plan.durations is None else plan.durations * factor,
        message="; ".join(filter(None, (plan.message, slowed_said(problem, factor)))),
        details={**plan.details, SLOWED: factor},
    )


def slowed_said(problem: Problem, factor: float | None) -> str:
    """Say that a motion was slowed down, and for which limits; empty where it was not."""
    if problem.arm is None or factor is None:
        return ""
    return f"the whole motion is slowed down by {factor:.4g} to keep {listed(sorted(problem.arm.demands))}"


def slow_down(arm: ArmLimits, motion: Motion) -> float:
    """Factor, at least 1, after which a motion is proved to keep the limits of its arm, nearly the smallest.

    Raises
    ------
    StudyError
        If no factor does.
    """
    enclosure = enclosed(arm, motion)
    if enclosure.highest.max() <= 1 + TOLERANCE:
        return 1.0
    if not np.isfinite(enclosure.highest).all():
        raise StudyError(
            "the motion's torques and tool speed cannot be bounded, so it is not slowed down to limits of them"
        )
    speed, acceleration = enclosure.lowest[-2:]
    factor = max(1.0, float(speed), float(np.sqrt(acceleration)), _for_torque(arm, motion)) * (1 + ROOM)
    for _ in range(TRIES):
        over = float(enclosed(arm, motion.scaled(factor)).highest.max()) - 1
        if over <= TOLERANCE:
            return factor
        factor *= 1 + max(over, ROOM)
    raise StudyError("no slower run of the motion is proved to keep the limits of the arm")


def _for_torque(arm: ArmLimits, motion: Motion) -> float:
    """Smallest factor at which sampled torques keep their limits."""
    if not np.isfinite(arm.torque).any():
        return 1.0
    per_piece = max(3, -(-SAMPLES // len(motion.knots)))
    inside = (np.arange(per_piece) + 0.5) / per_piece
    instants = (motion.knots[:-1, None] + np.diff(motion.knots)[:, None] * inside).ravel()
    q, velocity, acceleration = (motion(instants, order) for order in range(3))

    turning, standing = arm.mechanism.viscous * velocity, arm.mechanism.torque(q, 0 * q, 0 * q)
    standing += arm.mechanism.coulomb * np.sign(velocity)
    moving = arm.mechanism.torque(q, velocity, acceleration) - turning - standing

    def share(factor: float) -> Floats:
        return np.abs(standing + turning / factor + moving / factor**2) / arm.torque

    at_last = share(SLOWEST)
    if at_last.max() > 1:
        row, joint = np.unravel_index(at_last.argmax(), at_last.shape)
        raise StudyError(
            f"however slowly it runs, the motion needs {at_last[row, joint]:.4g} of the torque limit of joint {joint + 1} against "
            f"gravity and friction at {instants[row] / motion.duration:.0%} of its time; slowing down does not help"
        )
    low, high = 1.0, SLOWEST
    if share(low).max() <= 1:
        return low
    while high / low > 1 + ROOM / 4:
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if share(middle).max() <= 1 else (middle, high)
    return high
