"""Limits of torque and of the tool on a free path: rates of segments are tightened until the whole arm keeps them.

Torques and the tool's rates are no limits of one joint, so the interior point does not know them. It is asked again and
again, with other limits of velocity and acceleration on every segment: where the motion before asked too much of the
arm, less, by the factor that the worst instant of the segment needs; where it left room, more. A torque is a part that
positions and velocities ask for and a part that grows with the accelerations, and so is the tool's acceleration. At
first the one limits the velocities of a segment, and what it leaves the accelerations; then, from the start again, both
are slowed down together. The fastest motion, the whole slowed down by what is still missing, is the answer; where no
jerk is limited, its path and the first one's are driven anew, as fast as the arm allows.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from baselines.base import segment_rates
from study.arm import ArmLimits
from study.arm_findings import enclosed
from study.deadline import Deadline
from study.errors import StudyError
from study.planning import Plan, Status
from study.problem import Floats, JointLimits, Problem
from study.slowing import slow_down
from study.tolerances import TOLERANCE
from study.trajectory import Motion

ROUNDS, FEW, SAMPLES = 7, 4, 80
"""Motions planned at most either way, or where it must be quick; instants of every segment that are looked at."""

LEAST, MOST, ROOM, SAFE = 0.25, 1.6, 1e-3, 0.02
"""Factors on the rates of a segment from one round to the next, and the share of the arm's limits that is left free:
more where the motion may not be slowed down at last."""

ENOUGH, PATIENCE = 2e-3, 2
"""Gain in duration that counts, and rounds without one after which no further follows."""

SUDDEN = 1e3
"""Acceleration in units of the velocity limit per second that stands for none."""

ANEW = "driven anew along the path of the interior point"

Solve = Callable[[Problem], Plan]


def within_arm(problem: Problem, solve: Solve, deadline: Deadline, rounds: int = ROUNDS) -> Plan:
    """Plan within limits of the arm.

    Parameters
    ----------
    problem : Problem
    solve : callable
        Plans without them.
    deadline : Deadline
    rounds : int
    """
    plain, limits = replace(problem, arm=None), problem.arm
    if limits is None:
        return solve(plain)
    plain = replace(plain, limits=_reachable(problem.limits, limits, problem.waypoints))
    room = 1 - (ROOM if problem.scalable else SAFE)
    aim = ArmLimits(limits.mechanism, room * limits.torque, room * limits.tool_speed, room * limits.tool_acceleration)
    best, iterations = Plan(Status.FAILED, message="no motion keeps the limits of the arm"), 0
    bases: list[Motion] = []
    for together in (False, True):
        shares, before, idle = np.ones((2, problem.n_segments)), np.inf, 0
        for _ in range(rounds):
            plan = solve(_within(plain, shares))
            iterations += plan.iterations
            if plan.motion is None:
                best = plan if (shares == 1).all() and not together else best
                break
            bases.append(plan.motion)
            kept = _kept(problem, limits, plan, plan.motion)
            best = min(best, kept, key=_duration) if kept.motion is not None or best.motion is not None else kept
            if deadline.passed():
                return replace(best, iterations=iterations)
            tighter = np.minimum(shares * np.clip(_factors(aim, plan.motion, together), LEAST, MOST), 1.0)
            idle = idle + 1 if _duration(kept) > before * (1 - ENOUGH) else 0
            if idle == PATIENCE or np.allclose(tighter, shares, rtol=ENOUGH):
                break
            before, shares = min(before, _duration(kept)), tighter
        if (shares == 1).all():
            break
    if len(bases) > 1 and not deadline.passed():
        from baselines.free_path.along_itself import along_itself  # here: slow to import

        anew = [along_itself(problem, motion) for motion in (bases[0], best.motion or bases[-1])]
        again = [replace(best, status=Status.FINISHED, message=ANEW, motion=motion) for motion in anew if motion]
        best = min(best, *again, key=_duration) if again else best
    return replace(best, iterations=iterations)


def _reachable(rates: JointLimits, limits: ArmLimits, waypoints: Floats) -> JointLimits:
    """Limits of rates with accelerations that torques or the tool bound, where they are not limited themselves.

    A joint reaches what its motor can do at a waypoint, or what brings the tool to its limit, twice over.
    """
    n = len(waypoints)
    missing = ~np.isfinite(rates.rates[1:]).any(axis=0)
    if not (limits.forbids_steps and missing.any()):
        return rates
    arm, acceleration = limits.mechanism, rates.acceleration.copy()
    still = np.zeros_like(waypoints)
    held = arm.torque(waypoints, still, still)
    for joint in np.flatnonzero(missing):
        push = np.tile(np.eye(rates.n_joints)[joint], (n, 1))
        inertia = (arm.torque(waypoints, still, push) - held)[:, joint]
        tool = np.linalg.norm(arm.tool_rates(waypoints, still, push)[1], axis=1)
        with np.errstate(divide="ignore"):
            most = np.minimum(2 * limits.torque[joint] / inertia, limits.tool_acceleration / tool).max()
        acceleration[joint] = min(2 * most, SUDDEN * rates.velocity[joint])
    return replace(rates, acceleration=acceleration)


def _duration(plan: Plan) -> float:
    return np.inf if plan.motion is None else plan.motion.duration


def _kept(problem: Problem, limits: ArmLimits, plan: Plan, motion: Motion) -> Plan:
    """The plan, slowed down to the limits where that is allowed; without a motion where none keeps them."""
    if not problem.scalable:
        over = float(enclosed(limits, motion).highest.max()) - 1
        said = f"the motion asks for {1 + over:.4g} of a limit of the arm"
        return plan if over <= TOLERANCE else replace(plan, status=Status.FAILED, motion=None, message=said)
    try:
        factor = slow_down(limits, motion)
    except StudyError as error:
        return replace(plan, status=Status.FAILED, motion=None, message=str(error))
    details = {**plan.details, "stretch": plan.details.get("stretch", 1.0) * factor}
    return replace(plan, motion=motion.scaled(factor), details=details)


def _within(problem: Problem, shares: Floats) -> Problem:
    """Limits of velocity and acceleration of every segment, times shares of shape (2, n_segments)."""
    if (shares == 1).all():
        return problem
    lowest, highest = segment_rates(problem)
    by_segment = {}
    for segment, (velocity, acceleration) in enumerate(shares.T):
        own = problem.segment_limits.get(segment, problem.limits)
        factors = np.array([velocity, acceleration, 1.0])[:, None]
        up, down = highest[:, segment] * factors, lowest[:, segment] * factors
        by_segment[segment] = JointLimits(up[0], up[1], up[2], own.lower, own.upper, *down)
    return replace(problem, segment_limits=by_segment)


def _factors(limits: ArmLimits, motion: Motion, together: bool) -> Floats:
    """Factors on velocities and accelerations of every segment that its worst instant needs, shape (2, n_segments)."""
    times, inside = motion.waypoint_times, (np.arange(SAMPLES) + 0.5) / SAMPLES
    instants = (times[:-1, None] + np.diff(times)[:, None] * inside).ravel()
    q, velocity, acceleration = (motion(instants, order) for order in range(3))
    arm = limits.mechanism
    held, kept = arm.torque(q, 0 * q, 0 * q), arm.torque(q, velocity, 0 * q)
    dynamic = arm.torque(q, velocity, acceleration) - kept
    speed, turning = arm.tool_rates(q, velocity, 0 * q)
    pushing = arm.tool_rates(q, velocity, acceleration)[1] - turning
    if together:
        dynamic, kept = dynamic + kept - held, held
        pushing, turning = pushing + turning, 0.0 * turning
    with np.errstate(divide="ignore", invalid="ignore"):
        slower = _worst(
            limits.tool_speed / np.linalg.norm(speed, axis=1),
            np.sqrt(limits.tool_acceleration / np.linalg.norm(turning, axis=1)),
            np.sqrt(_room(kept - held, held, limits.torque)),
        )
        less = np.repeat(np.clip(slower, LEAST, 1.0), SAMPLES)[:, None] ** 2
        gentler = _worst(
            _room(dynamic, held + less * (kept - held), limits.torque),
            _reach(pushing, less * turning, limits.tool_acceleration),
        )
    return np.stack([np.minimum(slower, np.sqrt(gentler)) if together else slower, gentler])


def _worst(*factors: Floats) -> Floats:
    """Smallest factor on every segment, shape (n_segments,); what is not a number asks for nothing."""
    given = np.nan_to_num(factors, nan=np.inf, posinf=np.inf)
    return np.asarray(given.min(axis=0).reshape(-1, SAMPLES).min(axis=1))


def _room(part: Floats, base: Floats, bound: Floats) -> Floats:
    """Largest multiple of a part, on top of a base, within symmetric bounds of all joints, shape (n,)."""
    multiples = np.where(part > 0, (bound - base) / part, np.where(part < 0, (-bound - base) / part, np.inf))
    return np.maximum(np.nan_to_num(multiples, nan=np.inf, posinf=np.inf), 0.0).min(axis=1)


def _reach(part: Floats, base: Floats, bound: float) -> Floats:
    """Largest multiple of a vector that, on top of another, is no longer than a bound, shape (n,)."""
    if not np.isfinite(bound):
        return np.full(len(part), np.inf)
    a, b = (part**2).sum(axis=1), (part * base).sum(axis=1)
    room = np.maximum(bound**2 - (base**2).sum(axis=1), 0.0)
    return np.asarray((-b + np.sqrt(b**2 + a * room)) / a)
