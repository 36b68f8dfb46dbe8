"""Planner `free-path`: the shortest motion of its own path, by a structured interior point."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar

import numpy as np

from baselines.free_path.arm_limits import FEW, ROUNDS, within_arm
from baselines.free_path.interior_point import Ending
from baselines.free_path.phases import FEWEST, free_path
from baselines.free_path.question import FreePathProblem, of
from baselines.free_path.reduced import in_tube, lasting
from study.deadline import Deadline
from study.demands import ARM, Demand, refusal
from study.errors import StudyError
from study.judge import judge
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status
from study.problem import Problem, Tube

KNOWN = (
    RATE_LIMITS
    | ARM
    | {
        Demand.POSITION_RANGE,
        Demand.DIRECTIONAL_LIMITS,
        Demand.SEGMENT_LIMITS,
        Demand.MOVING_ENDS,
        Demand.DIFFERENT_ENDS,
        Demand.STOPS,
        Demand.DWELLS,
        Demand.TOLERANCE,
        Demand.TUBE,
        Demand.DURATION,
        Demand.CYCLE,
    }
)

WITHIN = 0.99
"""Part of a tolerance at waypoints that is used where a motion misses it: pieces meet to a few parts in a million of a
move, which may be more than the judge grants a small tolerance."""

LEAST = 1e-4
"""Share of the limits that is given up, at least, where a motion breaks one by a hair and cannot be stretched."""

STATUS = {
    Ending.CONVERGED: Status.FINISHED,
    Ending.LEVEL: Status.FINISHED,
    Ending.LATE: Status.TIMED_OUT,
    Ending.ITERATIONS: Status.NOT_CONVERGED,
    Ending.STUCK: Status.NOT_CONVERGED,
}


@dataclass(frozen=True)
class FreePathPlanner:
    """Planner `free-path`: widths of every joint's own, limits held everywhere, no curve family.

    Parameters
    ----------
    pieces : int, optional
        Pieces per segment and joint, K, at least 3; by default as many as the waypoints need.
    freed : bool
        Whether every joint chooses its widths; where it does not, the motion ends where `freed` would go on.
    """

    pieces: int | None = None
    freed: bool = True
    about: str = "free path in pieces whose widths every joint chooses, optimised by an interior point"
    freedom: ClassVar[Freedom] = Freedom.FREE
    knows: ClassVar[frozenset[Demand]] = KNOWN
    stochastic: ClassVar[bool] = False

    def __post_init__(self) -> None:
        if self.pieces is not None and self.pieces < FEWEST:
            raise StudyError(f"free path: pieces per segment must be at least {FEWEST}, got {self.pieces}")

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Plan within the settings' time limit; the motion so far where that is not enough."""
        if reason := refusal(problem.planner_demands, self.knows):
            return Plan(Status.NOT_APPLICABLE, message=reason)
        deadline = Deadline.after(settings.time_limit)

        def free(problem: Problem) -> Plan:
            plain = partial(self._solved, deadline=deadline)
            return in_tube(problem, plain) if isinstance(problem.path, Tube) else plain(problem)

        def shaped(problem: Problem) -> Plan:
            return within_arm(problem, free, deadline, ROUNDS if self.freed else FEW)

        return shaped(problem) if problem.scalable else lasting(problem, shaped)

    def _solved(self, problem: Problem, deadline: Deadline) -> Plan:
        """Plan on a free path, as fast as the limits allow."""
        question = of(problem)
        if not question.kinds.any():
            return Plan(Status.NOT_APPLICABLE, message="no joint with a limit moves, so there is no shortest time")
        try:
            answer = free_path(question, self.pieces, deadline, self.freed)
            verdict = judge(problem, answer.motion)
            exact = problem.tolerances.any() or not problem.scalable
            if exact and not (verdict.feasible or deadline.passed()):
                answer = free_path(_tighter(problem, verdict.worst_ratio), self.pieces, deadline, self.freed)
                verdict = judge(problem, answer.motion)
        except np.linalg.LinAlgError as error:
            return Plan(Status.FAILED, message=f"interior point: {error}")
        if not verdict.feasible and (exact or STATUS[answer.ending] is not Status.FINISHED):
            said = f"interior point: {answer.ending.value}; {verdict.reasons[0]}"
            return Plan(Status.FAILED, iterations=answer.iterations, message=said)
        return Plan(
            STATUS[answer.ending],
            motion=answer.motion,
            iterations=answer.iterations,
            message=f"interior point: {answer.ending.value}",
            details={"stretch": answer.stretch, "pieces": float(answer.pieces)},
        )


def _tighter(problem: Problem, ratio: float) -> FreePathProblem:
    """The question with a little less room, for an answer that missed by a hair and may not be stretched."""
    question = of(problem, WITHIN)
    share = 1.0 / (1.0 + max(2.0 * (ratio - 1.0), LEAST)) if ratio > 1.0 else 1.0
    return replace(question, lower=share * question.lower, upper=share * question.upper)


FIRST = FreePathPlanner(
    freed=False,
    about="free path in pieces that all joints share out alike: the first phase of `free-path`, and no more",
)
"""Planner `free-path-first`, a third of the work for 0.3 % more time."""
