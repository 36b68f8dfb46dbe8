"""Planners of the PUMA560 paper's table of searches and planners of no paper: plain, modern and SciPy's searches.

References
----------
PUMA560 paper, Table 3 (STOA, SCA). The others stand in no paper: the standard particle swarm, random search, CMA-ES,
L-SHADE, SciPy's L-BFGS-B, differential evolution and DIRECT, and the centre of the box, which any search must beat.
"""

from __future__ import annotations

import contextlib
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Protocol

import numpy as np
from scipy import optimize

from study.deadline import NEVER, Deadline
from study.planners.segment_times import SegmentTimePlanner, plan_segment_times
from study.planning import RATE_LIMITS, Formulation, Freedom, Meter, Plan, RunSettings, Status, Synchronisation
from study.problem import Demand, Floats, Problem
from study.search.bounds import BoundsRule
from study.search.cma_es import CMAES
from study.search.lshade import LSHADE
from study.search.pso import PSO, ClampUnit, VelocityUpdate
from study.search.random_search import RandomSearch
from study.search.sca import SCA
from study.search.state import Box
from study.search.stoa import STOA

HOPELESS = 1e9
"""Stands for infinite values where differences are taken, s."""


class Minimiser(Protocol):
    """Optimiser that runs its own loop on a meter's budget in a box."""

    def minimise(self, meter: Meter, box: Box, population: int, rng: np.random.Generator) -> None:
        """Evaluate candidates until the budget is spent or there is nothing left to do; the meter keeps the result."""


@dataclass(frozen=True)
class MinimiserPlanner:
    """Segment-time planner with an optimiser that runs its own loop.

    Parameters
    ----------
    minimiser : Minimiser
    about : str
        One line that says how it works.
    formulation : Formulation, optional
        Formulation that the optimiser needs, whatever the settings ask for; None takes that of the settings.
    """

    minimiser: Minimiser
    about: str
    formulation: Formulation | None = None
    freedom: ClassVar[Freedom] = Freedom.CURVE
    knows: ClassVar[frozenset[Demand]] = RATE_LIMITS
    stochastic: ClassVar[bool] = True

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Search all joints together, or each alone, as `SegmentTimePlanner` does."""
        taken = replace(settings, formulation=self.formulation or settings.formulation)
        plan = plan_segment_times(self.minimiser.minimise, problem, taken)
        if taken == settings or plan.message:
            return plan
        return replace(plan, message=f"always takes the {taken.formulation} formulation")


@dataclass(frozen=True)
class DeterministicMinimiserPlanner(MinimiserPlanner):
    """Segment-time planner with an optimiser that draws no random numbers."""

    stochastic: ClassVar[bool] = False


@dataclass(frozen=True)
class DirectPlanner(DeterministicMinimiserPlanner):
    """Segment-time planner with DIRECT, which needs long for an evaluation in many dimensions and so keeps the time limit."""

    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Divide within the settings' budget and time limit."""
        deadline = Deadline.after(settings.time_limit)
        plan = MinimiserPlanner(Direct(deadline), self.about, self.formulation).plan(problem, settings)
        budget = settings.evaluations * (
            problem.n_joints if settings.synchronisation is Synchronisation.PER_JOINT else 1
        )
        cut = plan.status is Status.FINISHED and plan.evaluations < budget and not deadline.left()
        return replace(plan, status=Status.TIMED_OUT) if cut else plan


class _SpentError(Exception):
    """Signal that the budget is spent; ends a loop that is not ours."""


def _spend(meter: Meter, candidates: Floats) -> Floats:
    values = meter(candidates)
    if meter.exhausted:
        raise _SpentError
    return values


@dataclass(frozen=True)
class LBFGSB:
    """SciPy's L-BFGS-B in the logarithms of the durations, with finite differences and restarts.

    The first start is equal durations; then it starts by turns near the incumbent, to get off a kink, and anywhere.
    All finite differences of a point are evaluated, and counted, with it in one call.

    Attributes
    ----------
    step : float
        Finite difference in the logarithm of a duration; ours.
    jitter : float
        Standard deviation of the logarithms around the incumbent at a restart; ours.
    smallest_share : float
        Smallest duration as a share of the largest where the box itself begins at 0; ours.
    restarts : bool
        Whether to start again; otherwise one descent from equal durations is all, and no random number is drawn.
    """

    step: float = 1e-7
    jitter: float = 0.1
    smallest_share: float = 1e-6
    restarts: bool = True

    def minimise(self, meter: Meter, box: Box, population: int, rng: np.random.Generator) -> None:
        """Descend, and start again until the budget is spent if restarts are wanted."""
        lower, upper = np.log(np.maximum(box.lower, self.smallest_share * box.upper)), np.log(box.upper)
        identity = np.eye(len(lower))

        def value_and_gradient(logs: Floats) -> tuple[float, Floats]:
            steps = np.where(logs + self.step > upper, -self.step, self.step)
            values = _spend(meter, np.exp(np.vstack([logs, logs + identity * steps])))
            values = np.minimum(values, HOPELESS)
            return float(values[0]), (values[1:] - values[0]) / steps

        start, near = 0.5 * (lower + upper), True
        with contextlib.suppress(_SpentError):
            while True:
                bounds = optimize.Bounds(lower, upper)
                optimize.minimize(value_and_gradient, start, jac=True, method="L-BFGS-B", bounds=bounds)
                if not self.restarts:
                    return
                start = lower + rng.random(len(lower)) * (upper - lower)
                if near and meter.incumbent is not None:
                    start = np.log(meter.incumbent) + self.jitter * rng.standard_normal(len(lower))
                start, near = np.clip(start, lower, upper), not near


@dataclass(frozen=True)
class ScipyDE:
    """SciPy's differential evolution with SciPy's settings, without the final polish; restarts when converged.

    Attributes
    ----------
    smallest_population : int
        SciPy asks for five members.
    """

    smallest_population: int = 5

    def minimise(self, meter: Meter, box: Box, population: int, rng: np.random.Generator) -> None:
        """Evolve until the budget is spent."""
        size = max(self.smallest_population, population)

        def values(columns: Any) -> Any:  # the stubs do not know the vectorised form
            return _spend(meter, columns.T)

        with contextlib.suppress(_SpentError):
            while True:
                optimize.differential_evolution(
                    values,
                    optimize.Bounds(box.lower, box.upper),
                    init=box.at(rng.random((size, len(box.lower)))),
                    maxiter=meter.budget,
                    polish=False,
                    updating="deferred",
                    vectorized=True,
                    rng=rng,
                )


@dataclass(frozen=True)
class Direct:
    """SciPy's DIRECT: divide the box into ever smaller rectangles, without random numbers, one evaluation at a time.

    Attributes
    ----------
    deadline : Deadline
        Never, by default.
    """

    deadline: Deadline = NEVER

    def minimise(self, meter: Meter, box: Box, population: int, rng: np.random.Generator) -> None:
        """Divide until the budget is spent or it is too late."""

        def value(x: Floats) -> float:
            duration = float(_spend(meter, x[None])[0])
            if self.deadline.passed():
                raise _SpentError
            return duration

        with contextlib.suppress(_SpentError):
            optimize.direct(
                value,
                optimize.Bounds(box.lower, box.upper),
                maxfun=meter.budget + 1,
                maxiter=meter.budget + 1,
                vol_tol=0.0,
                len_tol=0.0,
            )


@dataclass(frozen=True)
class Centre:
    """Centre of the box, equal durations, and nothing else."""

    def minimise(self, meter: Meter, box: Box, population: int, rng: np.random.Generator) -> None:
        """Evaluate one candidate."""
        meter(box.at(np.full(len(box.lower), 0.5))[None])


PSO_STANDARD = SegmentTimePlanner(
    PSO(
        inertia=(0.9, 0.4),  # Shi and Eberhart 1998
        cognitive=2.0,  # Kennedy and Eberhart 1995
        social=2.0,
        velocity=VelocityUpdate(clamp=0.2, unit=ClampUnit.SHARE, bounds=BoundsRule.CLIP),  # ours
    ),
    "the standard particle swarm",
)
RANDOM_SEARCH = SegmentTimePlanner(RandomSearch(), "durations drawn blindly, the best kept; what any search must beat")
STOA_PLANNER = SegmentTimePlanner(STOA(), "sooty tern search")
SCA_PLANNER = SegmentTimePlanner(SCA(), "sine cosine search")
CMA_ES = SegmentTimePlanner(CMAES(), "covariance matrix adaptation, the usual strong evolution strategy")
CMA_ES_OWN_POPULATION = SegmentTimePlanner(
    CMAES(own_population=True), "covariance matrix adaptation with its own population size, 4 + floor(3 ln n)"
)
L_SHADE = SegmentTimePlanner(
    LSHADE(), "differential evolution that adapts its parameters and shrinks its population (L-SHADE)"
)
L_SHADE_OWN_POPULATION = SegmentTimePlanner(
    LSHADE(own_population=True),
    "differential evolution as l-shade, with its own first population size, 18 for each segment",
)
LBFGSB_PLANNER = MinimiserPlanner(
    LBFGSB(),
    "gradient descent (L-BFGS-B of SciPy), started again and again until the budget is spent",
    formulation=Formulation.SCALED,  # the penalty form jumps: no gradient to follow
)
LBFGSB_ONCE = DeterministicMinimiserPlanner(
    LBFGSB(restarts=False),
    "gradient descent (L-BFGS-B of SciPy), once, from equal durations",
    formulation=Formulation.SCALED,
)
SCIPY_DE = MinimiserPlanner(ScipyDE(), "differential evolution of SciPy")
DIRECT = DirectPlanner(Direct(), "DIRECT of SciPy: divides the box of durations, draws no random number")
CENTRE = DeterministicMinimiserPlanner(
    Centre(),
    "no search at all: the middle of the box of durations, stretched to the limits",
    formulation=Formulation.SCALED,
)
