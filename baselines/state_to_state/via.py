"""Optimised via states with Ruckig's minimum-time moves between them.

Each move takes as long as its slowest joint, so the total time is a sum of maxima, which has kinks: a step that helps
one joint alone rarely helps. The search therefore solves a linear program for all via states at once: minimise the sum
of the moves' times under linear models of every joint's own minimum time, in a box that shrinks when the true total
does not follow. It starts from stopping everywhere, from the slopes between waypoints, and from the states in which the
motion of the free-path program passes the waypoints. That motion is itself among the answers: it holds all limits where
Ruckig, told to take longer than a joint needs, may exceed a velocity limit by up to 1 %, and where a joint that hardly
moves may be unable to arrive in its neighbours' time.

References
----------
J. Hald, K. Madsen, Combined LP and quasi-Newton methods for minimax optimization, Mathematical Programming 20, 1981:
the first of the two stages.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Any, ClassVar, NamedTuple

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from baselines.base import Deterministic, where_something_moves
from baselines.free_path.nlp import free_path, surplus
from baselines.state_to_state.moves import chain, in_own_time, stop_everywhere
from baselines.state_to_state.via_times import Model, Timing, ViaStates
from study.deadline import Deadline
from study.judge import judge
from study.planning import Plan, RunSettings, Status
from study.problem import Floats, Problem
from study.trajectory import Trajectory

FIRST_RADIUS, LAST_RADIUS = 0.3, 1e-7
SLOWER = (1.0, 1.0001, 1.001, 1.01)
GAIN = 1e-9
"""Relative gain that the linear model must promise for the search to go on."""


def improve(timing: Timing, x: Floats, deadline: Deadline, rounds: int) -> tuple[Floats, float, int]:
    """Lower the total time from one start by linear programs in a shrinking box.

    Parameters
    ----------
    timing : Timing
    x : array of shape (2, n_waypoints, n_joints)
        Variables at the waypoints.
    deadline : Deadline
    rounds : int
        Linear programs at most.

    Returns
    -------
    x : array of shape (2, n_waypoints, n_joints)
    total : float, s
    rounds : int
    """
    times, own = timing.moves(x)
    if not np.isfinite(times).all():
        return x, np.inf, 0
    model, radius, done = timing.model(x, times, own), FIRST_RADIUS, 0
    while done < rounds and radius > LAST_RADIUS and not deadline.passed():
        trial, promised = linear_step(timing.via, x, model, radius)
        gain = model.times.sum() - promised
        if gain <= GAIN * model.times.sum():
            break
        done += 1
        times, own = timing.moves(trial)
        kept = (model.times.sum() - times.sum()) / gain
        radius *= 2.0 if kept > 0.7 else 1.0 if kept > 0.2 else 0.35
        if kept > 1e-4:
            x, model = trial, timing.model(trial, times, own)
    return x, float(model.times.sum()), done


def linear_step(via: ViaStates, x: Floats, model: Model, radius: float) -> tuple[Floats, float]:
    """Minimise the sum of the moves' times, each at least every joint's linear model of its own time.

    Returns
    -------
    x : array of shape (2, n_waypoints, n_joints)
        New variables, within the radius.
    total : float, s
        Promised by the model; infinite where the linear program fails.
    """
    n_free, n_segments = int(via.free.sum()), len(model.times)
    start = x[via.free]
    bound = np.broadcast_to(via.bound[:, None], x.shape)[via.free]
    low, high = np.maximum(-radius, -bound - start), np.minimum(radius, bound - start)
    matrix, right = _rows(via, model)
    cost = np.append(np.zeros(n_free), np.ones(n_segments))
    bounds = [*zip(low.tolist(), high.tolist(), strict=True), *[(0.0, np.inf)] * n_segments]
    solved = linprog(cost, A_ub=matrix, b_ub=right, bounds=bounds, method="highs")
    if solved.x is None or solved.fun is None:
        return x, np.inf
    trial = x.copy()
    trial[via.free] += solved.x[:n_free]
    return trial, float(solved.fun)


def _rows(via: ViaStates, model: Model) -> tuple[Any, Floats]:
    """Rows slope . step - T <= -time, for every joint of every move and for every blocked move."""
    n_segments, n_joints = model.own.shape
    n_free = int(via.free.sum())
    column = np.full(via.free.shape, -1)
    column[via.free] = np.arange(n_free)
    row = np.arange(model.own.size).reshape(model.own.shape)
    parts = [(row.ravel(), n_free + np.repeat(np.arange(n_segments), n_joints), -np.ones(model.own.size))]
    for side, rate in np.ndindex(2, 2):
        here = column[rate, side : side + n_segments]
        parts.append((row[here >= 0], here[here >= 0], model.slopes[side, rate][here >= 0]))
    for k, (i, slope) in enumerate(model.blocked):
        here = column[:, i : i + 2]
        chosen = np.append(here[here >= 0], n_free + i)
        parts.append((np.full(len(chosen), model.own.size + k), chosen, np.append(slope[here >= 0], -1.0)))
    rows, columns, values = (np.concatenate(part) for part in zip(*parts, strict=True))
    right = -np.append(model.own.ravel(), [model.times[i] for i, _ in model.blocked])
    return sparse.csr_array((values, (rows, columns)), shape=(len(right), n_free + n_segments)), right


class Via(NamedTuple):
    """Answer of `ruckig_via`.

    Attributes
    ----------
    motion : Trajectory
        Never slower than stopping at every waypoint.
    rounds : int
        Linear programs in all.
    remark : str
        Empty where Ruckig's own moves are the fastest motion and keep all limits as they are.
    """

    motion: Trajectory
    rounds: int
    remark: str


class Source(Enum):
    """Origin of a motion; members read as remarks."""

    MOVES = ""
    STRETCHED = "Ruckig's moves exceeded a limit and are slowed down to keep it"
    FREE_PATH = "the free-path program's motion is faster than Ruckig's moves"


def slopes(problem: Problem) -> Floats:
    """Velocities at the waypoints that follow the slopes, shape (n_waypoints, n_joints); 0 where a joint turns."""
    stops = stop_everywhere(problem)
    durations = np.maximum(np.diff(stops.waypoint_times), 1e-9 * stops.duration)
    means = np.diff(problem.waypoints, axis=0) / durations[:, None]
    left, right = means[:-1], means[1:]
    gentle = np.zeros_like(problem.waypoints)
    gentle[1:-1] = np.where(left * right > 0, np.sign(left) * np.minimum(np.abs(left), np.abs(right)), 0.0)
    return gentle


def as_passed(timing: Timing, motion: Trajectory) -> Floats:
    """Variables with which a motion passes the waypoints, or passes them a little slower.

    Where the motion saturates two joints at once, one of them may be able to arrive at that instant but not a rounding
    error later; a slightly slower pass has room.
    """
    slower = [motion.scaled(factor) for factor in SLOWER]
    passes = [timing.via.variables(m(m.waypoint_times, 1), m(m.waypoint_times, 2)) for m in slower]
    return min(passes, key=lambda x: timing.moves(x)[0].sum())


def ruckig_via(problem: Problem, rounds: int = 200, pieces: int = 8, time_limit: float = 60.0) -> Via:
    """Pass the waypoints as fast as optimised via states and Ruckig's moves between them allow.

    The free-path program gives one of the starts; its own motion is returned where it is the faster one.

    Parameters
    ----------
    problem : Problem
    rounds : int
        Linear programs from each start.
    pieces : int
        Pieces per segment of the free-path program.
    time_limit : float, s

    Raises
    ------
    StudyError
        If no joint moves, or Ruckig finds no move from stop to stop.
    """
    scaled, units = in_own_time(problem)
    via, deadline = ViaStates.of(scaled), Deadline.after(time_limit)
    motions = [(stop_everywhere(scaled), Source.MOVES)]
    if not via.free.any():
        return Via(units.motion(motions[0][0]), 0, "")
    timing, rest = Timing(via), np.zeros_like(scaled.waypoints)
    starts, free = [via.variables(rest, rest), via.variables(slopes(scaled), rest)], None
    if not deadline.passed() and surplus(scaled, pieces) >= 0:
        free = free_path(scaled, pieces, deadline.within(time_limit / 2)).motion
        starts.append(as_passed(timing, free))
        motions.append((free, Source.FREE_PATH))
    improved = [improve(timing, start, deadline, rounds) for start in starts]
    motions += [(chain(scaled, via.states(x)), Source.MOVES) for x, total, _ in improved if np.isfinite(total)]
    motion, source = _fastest(scaled, motions)
    return Via(units.motion(motion), sum(done for *_, done in improved), source.value)


def _fastest(problem: Problem, motions: list[tuple[Trajectory, Source]]) -> tuple[Trajectory, Source]:
    """Fastest motion that the judge passes; Ruckig's moves may have to be slowed down by up to 1 % to pass."""
    candidates = []
    for motion, source in motions:
        verdict = judge(problem, motion)
        candidates.append((not verdict.feasible, motion.duration, motion, source))
        if not verdict.feasible and verdict.stretch > 1:
            slower = motion.scaled(verdict.stretch)
            candidates.append((not judge(problem, slower).feasible, slower.duration, slower, Source.STRETCHED))
    return min(candidates, key=lambda candidate: candidate[:2])[2:]


@dataclass(frozen=True)
class RuckigVia(Deterministic):
    """Planner `ruckig-via`: Ruckig through the waypoints, via states optimised offline.

    Parameters
    ----------
    rounds : int
        Linear programs from each start.
    pieces : int
        Pieces per segment of the free-path NLP that gives one of the starts.
    """

    rounds: int = 200
    pieces: int = 8
    set_up: ClassVar[float] = 0.005
    about: ClassVar[str] = "Ruckig through the waypoints without stopping, the states there optimised"

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Optimise within the settings' time limit."""
        motion, rounds, remark = ruckig_via(problem, self.rounds, self.pieces, settings.time_limit)
        return Plan(Status.FINISHED, motion=motion, iterations=rounds, message=remark)
