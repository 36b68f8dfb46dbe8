"""One file, two planners: a rule without any search, and a search of one's own on the study's curves."""

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
