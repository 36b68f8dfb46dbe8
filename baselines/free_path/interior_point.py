r"""Primal-dual interior point with exact second derivatives for the free-path problem.

    minimise f(x)   subject to   e(x) = 0,   c(x) - s = 0,   s >= 0

Every iteration linearises the conditions of the barrier problem, min f - mu sum log s, eliminates slacks and
multipliers of the rows, and solves what is left by structure. The barrier parameter follows Mehrotra: a first step with
mu = 0 tells how far the complementarity can fall, a second one aims there and corrects for the first one's curvature.

The parameter is held up while the dual error is large, so that the method
does not run along the boundary before it knows where to go.

A filter globalises the steps: each must lower the infeasibility or the barrier function, below all pairs met since the
barrier parameter was set; where the infeasibility is small, it must lower the barrier function as its slope promises.

References
----------
S. Mehrotra, On the implementation of a primal-dual interior point method, SIAM J. Optim. 2(4), 1992.
A. Waechter and L. Biegler, On the implementation of an interior-point filter line-search algorithm, Math. Program. 106,
2006; J. Nocedal, A. Waechter and R. Waltz, Adaptive barrier update strategies, SIAM J. Optim. 19(4), 2009.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np

from baselines.free_path.elimination_engine import code_for
from baselines.free_path.line_search import HALVINGS, LineSearch, Measure
from baselines.free_path.model import Model
from baselines.free_path.newton import Damping, Frame, Gradient, Newton, gradient
from baselines.free_path.pieces import Bounds, Pieces, Point
from baselines.free_path.shared_system import layout_of
from study.deadline import NEVER, Deadline
from study.problem import Floats

PATIENCE = 1e-3
"""Share of the dual error below which the complementarity does not fall while the method centres."""

SMALL = 1e-2
"""Infeasibility per segment and joint below which the barrier function must fall."""

RECENT = 10

NEGLIGIBLE = 1e-8
"""Regularisation that is forgotten in the next iteration."""

TINY = 1e-300


class Ending(Enum):
    """Why the method stopped."""

    CONVERGED = "converged"
    ITERATIONS = "the iterations ran out"
    LEVEL = "the duration no longer changed"
    STUCK = "no step made progress"
    LATE = "the time limit was reached"


@dataclass(frozen=True)
class Goal:
    """Stopping criteria of the interior-point method.

    Attributes
    ----------
    barrier : float
        Complementarity to reach.
    error : float
        What may be left of the optimality conditions and equations.
    closing : float
        What may be left of the equations alone, where that is less.
    iterations : int
    deadline : Deadline
    centring : float
        Share of the complementarity that a step keeps at least.
    level : float
        Relative change of the duration within ten iterations that is enough, once the complementarity is near its goal.
    damping : float
        Least curvature of a block; more slows the last digits, less lets flat directions run away.
    """

    barrier: float = 1e-9
    error: float = 1e-7
    closing: float = np.inf
    iterations: int = 150
    deadline: Deadline = NEVER
    centring: float = 0.0
    level: float = 0.0
    damping: float = 1e-5


class State(NamedTuple):
    """A point with its slacks and multipliers.

    Attributes
    ----------
    point : Point
    slacks, multipliers : arrays, one entry for every row
    equations : array of shape (n_segments, n_moving, 3)
        Multipliers of the closing equations.
    """

    point: Point
    slacks: Floats
    multipliers: Floats
    equations: Floats


@dataclass(frozen=True, eq=False)
class Outcome:
    """Final iterate of the method.

    Attributes
    ----------
    state : State
    ending : Ending
    iterations : int
    history : list of tuples
        Complementarity, infeasibility, dual error, duration, primal step, dual step, for every iteration.
    """

    state: State
    ending: Ending
    iterations: int
    history: list[tuple[float, ...]]


def frame_of(model: Model, free: bool, shares: Floats) -> Frame:
    """Prepare what does not change during a run."""
    bounds = Bounds(model, free)
    rows, elimination = code_for(model)
    return Frame(model, bounds, rows(model, bounds), layout_of(model), free, shares, elimination)


def started(frame: Frame, point: Point, mu: float) -> State:
    """Give a point slacks and multipliers for a barrier parameter."""
    values = frame.rows.at(point).rows
    slacks = np.maximum(values, np.where(frame.rows.active, min(1e-2, 0.1 * np.sqrt(mu)), 1.0))
    return State(point, slacks, frame.rows.weight * mu / slacks, np.zeros((*frame.model.shape[:2], 3)))


def resumed(frame: Frame, state: State, mu: float) -> State:
    """Go on from a state of a run with fixed widths or with free ones, at a barrier parameter."""
    values = frame.rows.at(state.point).rows
    slacks = np.maximum(values, np.where(frame.rows.active, 0.1 * np.sqrt(mu), 1.0))
    usual = frame.rows.weight * mu / slacks
    low = state.multipliers * slacks < 10 * mu
    multipliers = np.where(low, np.maximum(frame.rows.weight * state.multipliers, usual), 10 * usual)
    return State(state.point, slacks, multipliers, state.equations)


def continued(frame: Frame, state: State) -> State:
    """Go on from a state of a run with free widths, where it stands, with fixed widths."""
    slacks = np.where(frame.rows.active, state.slacks, 1.0)
    return State(state.point, slacks, frame.rows.weight * state.multipliers, state.equations)


def solve(frame: Frame, state: State, goal: Goal) -> Outcome:
    """Iterate until the goal is reached; a step that overflows is not taken, and ends the run."""
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        return _iterated(frame, state, goal)


def _iterated(frame: Frame, state: State, goal: Goal) -> Outcome:
    run = Run(frame, state)
    for iteration in range(goal.iterations):
        if run.reached(goal):
            return run.outcome(Ending.CONVERGED, iteration)
        if run.level(goal):
            return run.outcome(Ending.LEVEL, iteration)
        if goal.deadline.passed():
            return run.outcome(Ending.LATE, iteration)
        if not run.advance(goal):
            return run.outcome(Ending.STUCK, iteration)
    return run.outcome(Ending.ITERATIONS, goal.iterations)


class Run:
    """One run: the state, what was evaluated there, and the memory of the globalisation.

    Parameters
    ----------
    frame : Frame
    state : State
    """

    def __init__(self, frame: Frame, state: State) -> None:
        segments, joints, _ = frame.model.shape
        self.frame, self.search = frame, LineSearch(SMALL * segments * joints)
        self.regularisation = 0.0
        self.history: list[tuple[float, ...]] = []
        self._enter(state, frame.rows.at(state.point))

    def _enter(self, state: State, at: Pieces) -> None:
        rows = self.frame.rows
        self.state, self.at = state, at
        self.residual = at.rows - state.slacks
        self.slope: Gradient = gradient(self.frame, at, -state.multipliers, state.equations)
        self.mu = product(state.multipliers, state.slacks) / max(rows.count, 1)
        self.primal = max(float(np.abs(self.residual).max()), float(np.abs(at.errors).max()))
        self.dual = self.slope.size(self.frame.layout)

    def reached(self, goal: Goal) -> bool:
        """Whether the conditions of the optimum hold."""
        close = self.primal <= min(goal.closing, goal.error) and self.dual <= goal.error
        return self.mu <= goal.barrier and close

    def level(self, goal: Goal) -> bool:
        """Whether the duration has stopped changing."""
        if not goal.level or len(self.history) < RECENT or self.mu > 3 * goal.barrier or self.primal > 0.01:
            return False
        now = float(self.frame.model.tau @ self.state.point.durations)
        return abs(now - self.history[-RECENT][3]) <= goal.level * now

    def outcome(self, ending: Ending, iterations: int) -> Outcome:
        """Report."""
        return Outcome(self.state, ending, iterations, self.history)

    def advance(self, goal: Goal) -> bool:
        """Take one step; whether one could be taken."""
        state = self.state
        stiffness = state.multipliers / state.slacks
        damped = Damping(self.regularisation / 3, goal.damping)
        newton = Newton(self.frame, self.at, state.multipliers, stiffness, self.slope.costates, damped)
        if not newton.system.solvable:
            return False
        self.regularisation = newton.regularisation if newton.regularisation > NEGLIGIBLE else 0.0
        target, bend = self._aim(newton, stiffness, goal)
        step = self._direction(newton, stiffness, self.frame.rows.weight * (target - bend))
        return self._take(step, target)

    def _aim(self, newton: Newton, stiffness: Floats, goal: Goal) -> tuple[float, Floats]:
        """Complementarity to aim at, and what the first step leaves of it to second order, an entry for every row."""
        state = self.state
        first = self._direction(newton, stiffness, np.zeros(1))
        primal, dual = self._room(first, 1.0)
        gap = product(state.slacks + primal * first.slacks, state.multipliers + dual * first.multipliers)
        share = max(goal.centring, min(1.0, gap / self.frame.rows.count / self.mu) ** 3)
        target = max(share * self.mu, 0.5 * goal.barrier)
        if goal.centring:
            target = max(target, min(self.mu, PATIENCE * self.dual))
        limit = 10 * target + 0.1 * self.mu
        return target, np.clip(primal * dual * first.slacks * first.multipliers, -limit, limit)

    def _direction(self, newton: Newton, stiffness: Floats, aim: Floats) -> State:
        """Step towards complementarity `aim`, an entry for every row."""
        state, frame = self.state, self.frame
        pulled = aim / state.slacks - stiffness * self.residual
        point, equations = newton.step(gradient(frame, self.at, -pulled, state.equations))
        change = frame.rows.change(self.at, point)
        return State(point, change + self.residual, pulled - stiffness * change - state.multipliers, equations)

    def _room(self, step: State, share: float) -> tuple[float, float]:
        """Longest primal and dual steps that leave slacks, durations and multipliers positive."""
        state, spare = self.state, self.frame.rows.spare
        fall = float((-step.slacks / state.slacks).max())
        shrink = float((-step.point.durations / state.point.durations).max())
        decay = float((-step.multipliers / (state.multipliers + spare)).max(initial=0.0))
        primal = min(1.0, share / max(fall, TINY), 0.5 / max(shrink, TINY))
        return primal, min(1.0, share / max(decay, TINY))

    def _take(self, step: State, target: float) -> bool:
        state, model = self.state, self.frame.model
        primal, dual = self._room(step, max(0.9, 1 - self.mu))
        now = Measure(infeasibility(self.at, self.residual), float(model.weights @ state.point.durations), state.slacks)
        rise = float(model.weights @ step.point.durations)
        self.search.begin(target, now, rise, step.slacks)
        for _ in range(HALVINGS):
            point, slacks = state.point.moved(step.point, primal), state.slacks + primal * step.slacks
            at = self.frame.rows.at(point)
            residual = at.rows - slacks
            reached = Measure(infeasibility(at, residual), float(model.weights @ point.durations), slacks)
            if self.search.accepts(reached, primal):
                break
            primal *= 0.5
        multipliers = state.multipliers + dual * step.multipliers
        self._note(primal, dual)
        before = self.at
        self._enter(State(point, slacks, multipliers, state.equations + dual * step.equations), at)
        if not np.isfinite(self.mu + self.dual + self.primal):
            self._enter(state, before)
            return False
        return self.search.alive

    def _note(self, primal: float, dual: float) -> None:
        duration = float(self.frame.model.tau @ self.state.point.durations)
        self.history.append((self.mu, self.primal, self.dual, duration, primal, dual, self.regularisation))


def product(left: Floats, right: Floats) -> float:
    """Inner product in this thread; BLAS would wake a thread on every processor for it, and let all of them spin."""
    return float(np.einsum("i,i", left, right))


def infeasibility(at: Pieces, residual: Floats) -> float:
    """Sum of what is left of all equations."""
    return float(np.abs(at.errors).sum() + np.abs(residual).sum())
