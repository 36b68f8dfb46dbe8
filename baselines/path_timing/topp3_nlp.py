"""Time-optimal path parameterization under velocity, acceleration and jerk limits, as a nonlinear program.

TOPP-RA chooses path acceleration as it likes from gridpoint to gridpoint, so its jerk is infinite. Here the third
derivative of the path parameter is constant in each of K pieces per segment and the durations of the pieces are free,
so s(t) is a cubic spline, the motion a polynomial of degree 9 in every piece, and acceleration is continuous wherever
that of the path's second derivative is. Limits are held at points of every piece, at first evenly spread, then wherever
the last solution peaked; what is still above them after the last round is removed by stretching the motion by its exact
factor.

The path is the clamped one of `toppra` (`baselines.path_timing.path.chord_path`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from baselines.base import Deterministic, where_something_moves
from baselines.ipopt import Ipopt, Solution, alone, ca
from baselines.path_timing.path import Path, chord_path
from study import polynomial
from study.deadline import Deadline
from study.judge import judge
from study.planning import Freedom, Plan, RunSettings, Status
from study.problem import EndCondition, Floats, Problem
from study.trajectory import Trajectory

OPTIONS = {"max_iter": 500, "tol": 1e-8}
POINTS = np.linspace(0.0, 1.0, 5)
SHORTEST = 1e-4
"""Shortest duration of a piece, in the solver's unit of time."""
SOLVE_AT_LEAST = 0.1
"""Wall time of a solve that begins when the deadline is already past, s."""


@dataclass(frozen=True, eq=False)
class _Speeds:
    """A path parameterization by pieces, in the problem's own time.

    Attributes
    ----------
    durations : array of shape (n_pieces,), s
    states : array of shape (n_pieces, 4)
        Path parameter, its speed, its acceleration and its jerk where every piece starts.
    """

    durations: Floats
    states: Floats


def _normalised(path: Path) -> Path:
    """The same path with a mean distance of one between knots, so that units do not change what the solver sees."""
    unit = path.knots[-1] / len(path.cubics)
    return Path(path.knots / unit, path.cubics * unit ** np.arange(4)[:, None])


class PathProgram:
    """Nonlinear program of one path and one number of pieces per segment.

    Parameters
    ----------
    problem : Problem
    path : Path
    pieces : int
        Pieces per segment, K.
    deadline : Deadline
        IPOPT stops when it is reached.
    """

    def __init__(self, problem: Problem, path: Path, pieces: int, deadline: Deadline) -> None:
        self.problem, self.path, self.pieces = problem, path, pieces
        self.segments = np.repeat(np.arange(len(path.cubics)), pieces)
        rest = np.diff(path.knots)
        self.unit = float(self._start_scale() * rest.sum() / len(self.segments))
        self.deadline = deadline

    def _start_scale(self) -> float:
        """Seconds per unit of path at the constant path speed that no limit forbids."""
        motion = Trajectory.from_pieces(np.diff(self.path.knots), self.path.cubics)
        return judge(self.problem, motion).least_scale

    @alone()
    def solve(self, points: list[Floats], guess: Floats | None) -> Solution:
        """Solve with the limits held at given fractions of every piece."""
        n = len(self.segments)
        h, s, w, a, r = (ca.SX.sym(name, n) for name in "hswar")
        after = [
            s + h * (w + h * (a / 2 + h * r / 6)),
            w + h * (a + h * r / 2),
            a + h * r,
        ]
        joined = [
            ca.vertcat(*(end[i] - state[i + 1] for i in range(n - 1)))
            for end, state in zip(after, (s, w, a), strict=True)
        ]
        knots = self.path.knots
        firsts = np.arange(n) % self.pieces == 0
        at_knots = ca.vertcat(
            *(s[int(i)] - knots[self.segments[i]] for i in np.flatnonzero(firsts)), after[0][n - 1] - knots[-1]
        )
        ends = [w[0], a[0], after[1][n - 1], after[2][n - 1]] if self.problem.end is EndCondition.SMOOTH else []
        equal = ca.vertcat(*joined, at_knots, *ends)
        limited = ca.vertcat(*(self._rates(i, points[i], (h[i], s[i], w[i], a[i], r[i])) for i in range(n)))
        x = ca.vertcat(h, s, w, a, r)
        g = ca.vertcat(equal, limited)
        seconds = max(self.deadline.left(), SOLVE_AT_LEAST)
        solver = Ipopt({"x": x, "f": ca.sum1(h), "g": g}, OPTIONS, seconds)
        bound = np.concatenate([np.zeros(equal.shape[0]), np.ones(limited.shape[0])])
        low = np.concatenate([np.full(n, SHORTEST), np.full(n, -np.inf), np.zeros(n), np.full(2 * n, -np.inf)])
        return solver.solve(x0=self._cruise() if guess is None else guess, lbx=low, lbg=-bound, ubg=bound)

    def _rates(self, piece: int, fractions: Floats, state: tuple[Any, ...]) -> Any:
        """Rates over limits of every joint at points of one piece, in the solver's time."""
        h, s, w, a, r = state
        segment = self.segments[piece]
        cubic = self.path.cubics[segment]
        limits = self.problem.limits.rates * self.unit ** np.arange(1, 4)[:, None]
        rows = []
        for u in fractions:
            t = u * h
            speed, push = w + t * (a + t * r / 2), a + t * r
            along = s + t * (w + t * (a / 2 + t * r / 6)) - self.path.knots[segment]
            for joint in np.flatnonzero(np.ptp(self.problem.waypoints, axis=0) > 0):
                _, c1, c2, c3 = cubic[:, joint]
                first, second, third = c1 + along * (2 * c2 + 3 * c3 * along), 2 * c2 + 6 * c3 * along, 6 * c3
                rates = (
                    first * speed,
                    second * speed**2 + first * push,
                    third * speed**3 + 3 * second * speed * push + first * r,
                )
                rows += [rate / limits[k, joint] for k, rate in enumerate(rates) if np.isfinite(limits[k, joint])]
        return ca.vertcat(*rows)

    def _cruise(self) -> Floats:
        """Start at constant path speed."""
        starts = np.concatenate(
            [
                np.linspace(p, q, self.pieces, endpoint=False)
                for p, q in zip(self.path.knots, self.path.knots[1:], strict=False)
            ]
        )
        widths = np.diff(np.append(starts, self.path.knots[-1]))
        speed = self.path.knots[-1] / len(widths)
        return np.concatenate([widths / speed, starts, np.full(len(widths), speed), np.zeros(2 * len(widths))])

    def speeds(self, x: Floats) -> _Speeds:
        """Parameterization of given variables, in the problem's time."""
        h, *states = x.reshape(5, -1)
        return _Speeds(h * self.unit, np.stack(states, axis=1) / self.unit ** np.arange(4))

    def motion(self, speeds: _Speeds) -> Trajectory:
        """Compose path and parameterization: exact, degree 9."""
        states = speeds.states / np.array([1.0, 1.0, 2.0, 6.0])
        states[:, 0] -= self.path.knots[self.segments]
        driven = polynomial.composed(np.moveaxis(self.path.cubics, 1, 2)[self.segments], states[:, None, :])
        return Trajectory.from_pieces(speeds.durations, np.moveaxis(driven, 1, 2), self.pieces)

    def peaks(self, motion: Trajectory, points: list[Floats]) -> list[Floats]:
        """Add to every piece the fractions at which a rate of the motion stands above its limit."""
        widths = np.diff(motion.knots)
        local = np.moveaxis(motion.coefficients, 1, 2) * widths[:, None, None] ** np.arange(motion.degree + 1)
        added: list[list[float]] = [[] for _ in points]
        for order, limit in enumerate(self.problem.limits.rates, start=1):
            local = polynomial.derivative(local)
            lowest, at_lowest, highest, at_highest = polynomial.extrema(local)
            for extreme, at in ((-lowest, at_lowest), (highest, at_highest)):
                for piece, joint in np.argwhere(extreme / widths[:, None] ** order > limit * (1 + 1e-7)):
                    added[piece].append(float(at[piece, joint]))
        return [np.unique(np.concatenate([old, new])) for old, new in zip(points, added, strict=True)]


def _halved(x: Floats) -> Floats:
    """The same parameterization with every piece cut in two."""
    h, s, w, a, r = x.reshape(5, -1)
    t = h / 2
    middle = np.stack([s + t * (w + t * (a / 2 + t * r / 6)), w + t * (a + t * r / 2), a + t * r])
    states = np.stack([np.stack([s, w, a]), middle], axis=2).reshape(3, -1)
    return np.concatenate([np.repeat(t, 2), states.ravel(), np.repeat(r, 2)])


@dataclass(frozen=True)
class Topp3Nlp(Deterministic):
    """Planner `topp3-nlp`: the chord path under velocity, acceleration and jerk limits.

    One piece per segment is solved first; its solution, with every piece cut in two, starts the next, so more pieces
    never give a slower motion.

    Parameters
    ----------
    halvings : int
        How often the pieces are cut in two: 2^halvings pieces of constant path jerk per segment in the end.
    rounds : int
        How often points are added where limits are exceeded, for each number of pieces.
    """

    halvings: int = 1
    rounds: int = 3
    set_up: ClassVar[float] = 0.005
    about: ClassVar[str] = "speed along a given path with a jerk limit, by IPOPT"
    freedom: ClassVar[Freedom] = Freedom.PATH

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Parameterize the path; only the settings' time limit matters."""
        if not np.isfinite(problem.limits.jerk).all():
            return Plan(Status.NOT_APPLICABLE, message="some joint has no jerk limit, so TOPP-RA already answers")
        answers, iterations = self._answers(problem, Deadline.after(settings.time_limit))
        best = min(answers, key=lambda answer: (not answer.feasible, answer.motion.duration))
        status = Status.FINISHED if best.success else Status.NOT_CONVERGED
        message = "" if best.feasible else "IPOPT did not come to a motion that keeps the limits"
        return Plan(status, best.motion, iterations=iterations, message=message, details={"stretch": best.stretch})

    def _answers(self, problem: Problem, deadline: Deadline) -> tuple[list[_Answer], int]:
        """Solve with more and more pieces and points until the deadline; answers, at least one, and iterations."""
        path = _normalised(chord_path(problem.waypoints, problem.limits))
        answers: list[_Answer] = []
        guess, iterations = None, 0
        for halving in range(self.halvings + 1):
            model = PathProgram(problem, path, 2**halving, deadline)
            points = [POINTS] * len(model.segments)
            for _ in range(self.rounds):
                if answers and deadline.passed():
                    return answers, iterations
                solution = model.solve(points, guess)
                guess = solution.x
                iterations += solution.iterations
                answers.append(_stretched(problem, model, guess, solution.success))
                if answers[-1].stretch < 1 + 1e-6:
                    break
                points = model.peaks(model.motion(model.speeds(guess)), points)
            guess = _halved(guess) if guess is not None else None
        return answers, iterations


@dataclass(frozen=True, eq=False)
class _Answer:
    motion: Trajectory
    stretch: float
    success: bool
    feasible: bool


def _stretched(problem: Problem, model: PathProgram, x: Floats, success: bool) -> _Answer:
    motion = model.motion(model.speeds(x))
    stretch = judge(problem, motion).stretch
    slowed = motion.scaled(stretch)
    return _Answer(slowed, stretch, success, judge(problem, slowed).feasible)
