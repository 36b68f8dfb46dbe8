"""Planner interface, run settings, plan and evaluation meter."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum, StrEnum
from typing import Protocol, runtime_checkable

import numpy as np

from study.arrays import at_least_zero, of_kind, whole
from study.choices import Choice
from study.problem import Demand, EndCondition, Floats, Problem
from study.supervisor import supervisor
from study.trajectory import Motion

LARGEST = 2**63 - 1
"""Largest whole number that a results file has room for."""


class Status(Enum):
    """End of a planner's work; members read as sentences."""

    FINISHED = "the planner finished"
    NOT_CONVERGED = "the planner stopped before it converged"
    FAILED = "the planner found no motion"
    NOT_APPLICABLE = "the planner does not apply to this problem"
    TIMED_OUT = "the time limit of the cell was reached"


class Formulation(Choice):
    """Form of the objective: the papers' penalty, or every candidate stretched until it is exactly feasible."""

    PENALTY = "penalty"
    SCALED = "scaled"


class Synchronisation(Choice):
    """Rule by which joints share segment durations.

    `per-joint` searches each joint alone and takes the longest duration of every segment; `shared` searches all joints
    together.
    """

    PER_JOINT = "per-joint"
    SHARED = "shared"


@dataclass(frozen=True)
class RunSettings:
    """Settings of one run; a planner takes from them what it needs.

    Attributes
    ----------
    curve : str
        Family for segment-time planners, a name in `study.curves.CURVES`.
    seed : int
    evaluations : int
        Budget of every search: curve evaluations of the joints it moves.
    population : int
    formulation : Formulation
        Or its text, such as "scaled".
    synchronisation : Synchronisation
        Or its text, such as "per-joint".
    time_limit : float, s
        Wall time after which a solver should stop by itself.

    Raises
    ------
    StudyError
        If the budget or the population is empty, an option is unknown, or seed or time limit are no such numbers.
    """

    curve: str
    seed: int = 0
    evaluations: int = 2000
    population: int = 50
    formulation: Formulation = Formulation.PENALTY
    synchronisation: Synchronisation = Synchronisation.SHARED
    time_limit: float = 60.0

    def __post_init__(self) -> None:
        for name in ("curve", "formulation", "synchronisation"):
            of_kind(getattr(self, name), str, f"run settings: {name}")
        object.__setattr__(self, "formulation", Formulation(self.formulation))
        object.__setattr__(self, "synchronisation", Synchronisation(self.synchronisation))
        for name, least in (("evaluations", 1), ("population", 1), ("seed", 0)):
            object.__setattr__(self, name, whole(getattr(self, name), least, f"run settings: {name}", LARGEST))
        object.__setattr__(self, "time_limit", at_least_zero(self.time_limit, "run settings: time_limit"))


@dataclass(frozen=True, eq=False)
class Plan:
    """A planner's answer. It states neither feasibility nor duration: the judge does.

    Attributes
    ----------
    status : Status
    motion : Motion, optional
    durations : array of shape (n_segments,), s, optional
        Where the planner thinks in segment durations.
    evaluations : int
        Curve evaluations of a search; 0 for a deterministic method.
    iterations : int
        Solver iterations or generations.
    history : array of shape (n_records, 2)
        Evaluations so far and best objective value so far, s; under per-joint synchronisation the total time of the
        joints' incumbents put together.
    message : str
        The reason where there is no motion, or a remark.
    details : mapping of str to float
        Numbers worth keeping. Names that end in `_seconds` are wall times: they are kept, but take no part in comparing
        two runs.
    lower_bound : float, s, optional
        Proved time that no motion of the planner's own kind undercuts, where the planner knows one.
    """

    status: Status
    motion: Motion | None = None
    durations: Floats | None = None
    evaluations: int = 0
    iterations: int = 0
    history: Floats = field(default_factory=lambda: np.empty((0, 2)))
    message: str = ""
    details: Mapping[str, float] = field(default_factory=dict)
    lower_bound: float | None = None


class Freedom(StrEnum):
    """Part of the motion that a planner may change; times of different kinds answer different questions."""

    CURVE = "case's curve"
    PATH = "fixed path"
    FREE = "free path"

    @property
    def meaning(self) -> str:
        """One line for the pages."""
        return _FREEDOMS[self]


_FREEDOMS = {
    Freedom.CURVE: "the curve family of the case, its paper's where there is one; a method chooses the segment durations"
    " and nothing else",
    Freedom.PATH: "the geometric path is given; a method chooses the speed along it",
    Freedom.FREE: "any motion through the waypoints; the path between them is the method's own",
}

RATE_LIMITS = frozenset({Demand.VELOCITY, Demand.ACCELERATION, Demand.JERK})
"""Demands that most planners know; a range of positions is then left to the judge."""


def in_time(problem: Problem, plan: Plan) -> Plan:
    """Slow a plan's motion down until its duration is as the problem demands; nothing changes where it demands none.

    Raises
    ------
    StudyError
        If the motion takes longer than it must.
    """
    if plan.motion is None or problem.timing is None or not problem.scalable:
        return plan
    factor = problem.timing.stretch(plan.motion.duration)
    durations = None if plan.durations is None else plan.durations * factor
    return replace(plan, motion=plan.motion.scaled(factor), durations=durations)


@runtime_checkable
class Planner(Protocol):
    """A method that turns a problem into a plan, and describes itself; tables, pages and tests ask the planner alone.

    Class attributes or fields do for the four properties.
    """

    @property
    def about(self) -> str:
        """One line that says how the method works."""

    @property
    def freedom(self) -> Freedom:
        """Part of the motion that it may change; `CURVE` takes a formulation and a synchronisation from the settings."""

    @property
    def knows(self) -> frozenset[Demand]:
        """Demands of a problem that it plans with; `RATE_LIMITS` is the usual set."""

    @property
    def stochastic(self) -> bool:
        """True if the seed matters, so that the runner repeats the planner."""

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Plan a motion; failures come back as a status with a message, not as an exception."""


def undescribed(planner: object) -> str:
    """Say in one sentence which part of the description of a planner is missing or wrong; empty where none is."""
    ways = {"a method `plan(problem, settings)`": not callable(getattr(planner, "plan", None))}
    chance = {"`stochastic`, True or False": not isinstance(getattr(planner, "stochastic", None), bool)}
    return lacking("planner", ways | description(planner) | chance)


def description(method: object) -> dict[str, bool]:
    """Parts of the description that every method has, and whether each is wrong."""
    about, known = getattr(method, "about", None), getattr(method, "knows", None)
    return {
        "`about`, one line that says how it works": not (
            isinstance(about, str) and about.strip() and "\n" not in about
        ),
        "`freedom`, a member of `study.planning.Freedom`": not isinstance(getattr(method, "freedom", None), Freedom),
        "`knows`, a frozenset of `study.demands.Demand`": not (
            isinstance(known, frozenset) and all(isinstance(demand, Demand) for demand in known)
        ),
    }


def lacking(noun: str, wrong: Mapping[str, bool]) -> str:
    """Make one sentence of the parts that are wrong; empty where none is."""
    missing = [part for part, lacks in wrong.items() if lacks]
    return f"a {noun} describes itself, and this lacks {' and '.join(missing)}" if missing else ""


def usual_settings(problem: Problem) -> RunSettings:
    """Settings for a problem of one's own: a curve that fits, all joints together, every candidate made feasible."""
    of_kind(problem, Problem, "problem")
    return RunSettings(curve=usual_curve(problem), formulation=Formulation.SCALED)


def usual_curve(problem: Problem) -> str:
    """Name the curve family that gives the ends the acceleration that the problem demands of them."""
    return "cubic-spline-smooth" if problem.end is EndCondition.SMOOTH else "cubic-spline"


class Meter:
    """Count evaluations exactly, keep the incumbent and the history, and end the budget.

    Parameters
    ----------
    objective : callable (n_candidates, n_dimensions) -> (n_candidates,)
    budget : int
        Evaluations allowed in all.
    """

    def __init__(self, objective: Callable[[Floats], Floats], budget: int) -> None:
        self.objective = objective
        self.budget = budget
        self.evaluations = 0
        self.incumbent: Floats | None = None
        self.incumbent_value = np.inf
        self._history: list[tuple[int, float]] = []
        self._incumbents: list[Floats] = []

    @property
    def exhausted(self) -> bool:
        """True when the budget is spent."""
        return self.evaluations >= self.budget

    @property
    def history(self) -> Floats:
        """Evaluations so far and best value so far after every call, shape (n_calls, 2)."""
        return np.array(self._history, dtype=float).reshape(-1, 2)

    @property
    def incumbents(self) -> Floats:
        """Best candidate so far after every call, shape (n_calls, n_dimensions)."""
        return np.array(self._incumbents)

    def __call__(self, candidates: Floats) -> Floats:
        """Evaluate a population, shape (n_candidates, n_dimensions); what the budget no longer covers is infinite.

        Values that are not numbers count as infinite, so they never become the incumbent.
        """
        left = max(self.budget - self.evaluations, 0)
        if len(candidates) <= left:
            values = np.fmin(self.objective(candidates), np.inf)  # of NaN and infinity, infinity
        else:
            values = np.full(len(candidates), np.inf)
            if not left:
                return values
            np.fmin(self.objective(candidates[:left]), np.inf, out=values[:left])
        best = int(values.argmin())
        self.note(min(len(candidates), left), candidates, best, float(values[best]))
        return values

    def note(self, evaluations: int, candidates: Floats, best: int, value: float) -> None:
        """Count the evaluations of a population, and keep its best candidate where it beats the incumbent."""
        self.evaluations += evaluations
        if value < self.incumbent_value:
            self.incumbent, self.incumbent_value = candidates[best].copy(), value
        self._history.append((self.evaluations, self.incumbent_value))
        self._incumbents.append(candidates[0] if self.incumbent is None else self.incumbent)
        watching = supervisor()
        if watching is not None and watching.on_population is not None:
            watching.on_population(self, candidates)


def single_move(problem: Problem) -> bool:
    """Whether the problem is one move from rest to rest with nothing else to keep, whose optimum has a closed form."""
    smooth = problem.end is EndCondition.SMOOTH or (
        problem.end is EndCondition.REST and Demand.JERK not in problem.demands
    )
    plain = problem.arm is None and problem.n_waypoints == 2
    return plain and smooth and problem.planner_demands <= RATE_LIMITS | {Demand.POSITION_RANGE}
