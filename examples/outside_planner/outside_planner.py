"""One file, three planners: a rule, a path of one's own, and a search of one's own on the study's curves."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from study.curves import curve_named
from study.formulation import Scaled
from study.planners.segment_times import SegmentTimePlanner
from study.planning import RATE_LIMITS, Freedom, Plan, RunSettings, Status
from study.problem import Demand, Floats, Problem
from study.search.state import Box, State
from study.trajectory import Trajectory


class ChordRule:
    """Segment durations in proportion to the distance, every joint measured in its velocity limit; then just feasible."""

    stochastic: ClassVar[bool] = False  # the seed does not matter
    about: ClassVar[str] = "durations in proportion to the distance, stretched to the limits"
    freedom: ClassVar[Freedom] = Freedom.CURVE  # it chooses segment durations on the case's curve
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS  # stretching keeps velocity, acceleration and jerk

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Take the rule's durations and stretch them until every limit is kept."""
        curve = curve_named(settings.curve)
        rule = np.abs(np.diff(problem.waypoints, axis=0) / problem.limits.velocity).max(axis=1)
        durations = np.maximum(rule, 1e-3 * rule.max()) if rule.any() else np.ones(problem.n_segments)
        durations = Scaled(problem, curve).durations(durations[None])[0]
        motion = curve.motion(problem.waypoints, durations)
        return Plan(Status.FINISHED, motion=motion, durations=durations)


class StopAndGo:
    """One smooth polynomial from waypoint to waypoint, with a stop at each."""

    stochastic: ClassVar[bool] = False
    about: ClassVar[str] = "a smooth step of degree 5 from waypoint to waypoint, with a stop at each"
    freedom: ClassVar[Freedom] = Freedom.FREE  # it chooses the path between the waypoints
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS | {Demand.POSITION_RANGE}  # a step never overshoots

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Take for every segment the shortest time at which every joint keeps its limits."""
        steps = np.diff(problem.waypoints, axis=0)
        peaks = np.array([15 / 8, 10 / np.sqrt(3), 60.0])[:, None, None]  # of a step of 1 in 1 s
        order = np.array([1, 2, 3])[:, None, None]
        durations = ((peaks * np.abs(steps) / problem.limits.rates[:, None]) ** (1 / order)).max(axis=(0, 2))
        if not durations.all():
            return Plan(Status.NOT_APPLICABLE, message="two neighbouring waypoints are equal")
        shape = np.array([10.0, -15.0, 6.0])[:, None] / durations ** np.array([3, 4, 5])[:, None]
        still = np.zeros_like(problem.waypoints[:-1])
        rows = [problem.waypoints[:-1], still, still, *(shape[:, :, None] * steps)]
        return Plan(Status.FINISHED, motion=Trajectory.from_pieces(durations, np.stack(rows, axis=1)))


@dataclass(frozen=True, eq=False)
class StepState(State):
    """What the search remembers besides its incumbent: how far it steps."""

    step: float


@dataclass(frozen=True)
class ShrinkingSteps:
    """Normal steps around the incumbent; they shrink after a generation without progress and grow after one with it."""

    first: float = 0.3
    shrink: float = 0.7
    grow: float = 1.2

    def init(self, box: Box, population: int, generations: int, rng: np.random.Generator) -> StepState:
        """Start anywhere in the box."""
        candidates = box.at(rng.random((population, len(box.lower))))
        return StepState(box, candidates, generations, 0, candidates[0], np.inf, self.first)

    def ask(self, state: StepState, rng: np.random.Generator) -> StepState:
        """Step away from the incumbent."""
        steps = state.step * state.box.width * rng.standard_normal(state.candidates.shape)
        return replace(state, candidates=np.clip(state.incumbent + steps, state.box.lower, state.box.upper))

    def tell(self, state: StepState, values: Floats, rng: np.random.Generator) -> StepState:
        """Take the best and change the step."""
        incumbent, value = state.improved(values)
        factor = self.grow if value < state.incumbent_value else self.shrink
        return replace(
            state,
            incumbent=incumbent,
            incumbent_value=value,
            step=min(state.step * factor, self.first),
            generation=state.generation + 1,
        )


SHRINKING_STEPS = SegmentTimePlanner(ShrinkingSteps())
