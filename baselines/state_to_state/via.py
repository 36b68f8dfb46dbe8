"""Ruckig through the waypoints: how the joints pass each waypoint is optimised offline, Ruckig does every move between.

Each move takes as long as its slowest joint, so the total time is a sum of maxima, which has kinks: a step that helps one
joint alone rarely helps. The search therefore solves a linear program for all choices at once: minimise the sum of the
moves' times under linear models of every joint's own minimum time, in a box that shrinks when the true total does not
follow. It starts from stopping everywhere, from the slopes between waypoints, and from the way in which the free-path NLP
passes the waypoints; between the same states Ruckig is never slower than the NLP.

References
----------
J. Hald, K. Madsen, Combined LP and quasi-Newton methods for minimax optimization, Mathematical Programming 20, 1981: the
first of the two stages.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from scipy import sparse
from scipy.optimize import linprog

from baselines.free_path.nlp import free_path
from baselines.state_to_state.moves import at_rest, chain, in_own_time
from baselines.state_to_state.via_times import Model, Passing, Timing
from study.deadline import noted
from study.errors import StudyError
from study.judge import judge
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status
from study.problem import Demand, Floats, Problem
from study.trajectory import Trajectory

FIRST_RADIUS, LAST_RADIUS = 0.3, 1e-7
SLOWER = (1.0, 1.0001, 1.001, 1.01)
GAIN = 1e-9
"""Relative gain that the linear model must promise for the search to go on."""


def improve(timing: Timing, x: Floats, deadline: float, rounds: int) -> tuple[Floats, float, int]:
    """Lower the total time from one start by linear programs in a shrinking box.

    Parameters
    ----------
    timing : Timing
    x : array of shape (2, n_waypoints, n_joints)
        Choices at the waypoints.
    deadline : float, s
        On the clock of `time.monotonic`.
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
    while done < rounds and radius > LAST_RADIUS and not noted(time.monotonic() >= deadline):
        trial, promised = linear_step(timing.passing, x, model, radius)
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


def linear_step(passing: Passing, x: Floats, model: Model, radius: float) -> tuple[Floats, float]:
    """Minimise the sum of the moves' times, each at least every joint's linear model of its own time.

    Returns
    -------
    x : array of shape (2, n_waypoints, n_joints)
        New choices, within the radius.
    total : float, s
        What the model promises; infinite where the linear program fails.
    """
    n_free, n_segments = int(passing.free.sum()), len(model.times)
    start = x[passing.free]
    reach = np.broadcast_to(passing.reach[:, None], x.shape)[passing.free]
    low, high = np.maximum(-radius, -reach - start), np.minimum(radius, reach - start)
    matrix, right = _rows(passing, model)
    cost = np.append(np.zeros(n_free), np.ones(n_segments))
    bounds = [*zip(low.tolist(), high.tolist(), strict=True), *[(0.0, np.inf)] * n_segments]
    solved = linprog(cost, A_ub=matrix, b_ub=right, bounds=bounds, method="highs")
    if solved.x is None or solved.fun is None:
        return x, np.inf
    trial = x.copy()
    trial[passing.free] += solved.x[:n_free]
    return trial, float(solved.fun)


def _rows(passing: Passing, model: Model) -> tuple[Any, Floats]:
    """Rows slope . step - T <= -time, for every joint of every move and for every blocked move."""
    n_segments, n_joints = model.own.shape
    n_free = int(passing.free.sum())
    column = np.full(passing.free.shape, -1)
    column[passing.free] = np.arange(n_free)
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


def starts(timing: Timing, pieces: int, time_limit: float, deadline: float) -> Iterator[Floats]:
    """Choices to start from: stop everywhere, follow the slopes, pass as the free-path NLP does or a little slower.

    Where the NLP saturates two joints at once, one of them may be able to arrive at that instant but not a rounding error
    later; a slightly slower pass has room. After the deadline, on the clock of `time.monotonic`, the NLP is not asked.
    """
    passing = timing.passing
    problem = passing.problem
    nothing = np.zeros_like(problem.waypoints)
    yield passing.choices(nothing, nothing)
    stops = chain(problem, [at_rest(row) for row in problem.waypoints])
    durations = np.maximum(np.diff(stops.waypoint_times), 1e-9 * stops.duration)
    slopes = np.diff(problem.waypoints, axis=0) / durations[:, None]
    left, right = slopes[:-1], slopes[1:]
    gentle = nothing.copy()
    gentle[1:-1] = np.where(left * right > 0, np.sign(left) * np.minimum(np.abs(left), np.abs(right)), 0.0)
    yield passing.choices(gentle, nothing)
    if noted(time.monotonic() >= deadline):
        return
    fast = free_path(problem, pieces, time_limit, deadline).motion
    slower = [fast.scaled(factor) for factor in SLOWER]
    passes = [passing.choices(m(m.waypoint_times, 1), m(m.waypoint_times, 2)) for m in slower]
    yield min(passes, key=lambda x: timing.moves(x)[0].sum())


def ruckig_via(
    problem: Problem, rounds: int = 200, pieces: int = 8, time_limit: float = 60.0
) -> tuple[Trajectory, int]:
    """Pass the waypoints as fast as optimised via states and Ruckig's moves between them allow.

    Parameters
    ----------
    problem : Problem
    rounds : int
        Linear programs from each start.
    pieces : int
        Pieces per segment of the free-path NLP that gives one of the starts.
    time_limit : float, s

    Returns
    -------
    trajectory : Trajectory
        Never slower than stopping at every waypoint.
    rounds : int
        Linear programs in all.

    Raises
    ------
    StudyError
        If no joint moves, or Ruckig finds no move from stop to stop.
    """
    problem, unit = in_own_time(problem)
    found = [chain(problem, [at_rest(row) for row in problem.waypoints])]
    passing, done = Passing.of(problem), 0
    if not passing.free.any():
        return found[0].scaled(unit), 0
    timing, deadline = Timing(passing), time.monotonic() + time_limit
    for start in starts(timing, pieces, time_limit / 2, deadline):
        x, total, count = improve(timing, start, deadline, rounds)
        done += count
        if np.isfinite(total):
            found.append(chain(problem, passing.states(x)))
    best = min(found, key=lambda motion: (not judge(problem, motion).feasible, motion.duration))
    return best.scaled(unit), done


@dataclass(frozen=True)
class RuckigVia:
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
    about: ClassVar[str] = "Ruckig through the waypoints without stopping, the states there optimised"
    freedom: ClassVar[Freedom] = Freedom.FREE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS
    stochastic: ClassVar[bool] = False

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Optimise within the settings' time limit."""
        if not np.ptp(problem.waypoints, axis=0).any():
            return Plan(Status.NOT_APPLICABLE, message="all waypoints are equal, so there is nothing to move")
        try:
            motion, done = ruckig_via(problem, self.rounds, self.pieces, settings.time_limit)
        except StudyError as error:
            return Plan(Status.FAILED, message=str(error))
        return Plan(Status.FINISHED, motion=motion, iterations=done)
