"""CasADi models of the curve families: symbolic rows, the IPOPT solvers built from them, and their numeric side.

Problems are dimensionless. A row of the model is a rate over its limit at a point of a piece, so every row lies in [-1,
1]. The points are parameters; a model is built once for each family and shape and serves every problem and exchange
round.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

from baselines.ipopt import Ipopt, alone, drop
from baselines.segment_times.critical_points import Critical, Slots
from study.problem import Floats, Problem


@dataclass(frozen=True, eq=False)
class Rows:
    """Symbolic side of a model: variables, parameters, the sum of durations and the rows.

    Rows that belong to no slot come first, then those of the slots, order by order. Where the model is proximal its
    last parameters are the variables that the solve starts from.
    """

    x: Any
    p: Any
    total: Any
    g: Any
    proximal: bool = False


class Family(Protocol):
    """One curve family for one shape of problem."""

    @property
    def key(self) -> tuple[Any, ...]:
        """Everything that the model depends on."""

    @property
    def pooled(self) -> bool:
        """Whether a slot serves the peaks of any joint."""

    @property
    def slot_shapes(self) -> dict[int, tuple[int, int, int]]:
        """Shape of the slots of every limited order that needs points."""

    def rows(self) -> Rows:
        """Build the symbolic model."""

    def lift(self, problem: Problem, durations: Floats) -> Floats:
        """Variables of given durations."""

    def durations(self, x: Floats) -> Floats:
        """Durations of given variables."""

    def variable_bounds(self, problem: Problem) -> tuple[Floats, Floats]:
        """Box of the variables, with no duration below the shortest."""

    def row_bounds(self, problem: Problem, slots: dict[int, Slots]) -> tuple[Floats, Floats]:
        """Lower and upper bound of every row; a free slot has none."""

    def parameters(self, problem: Problem, slots: dict[int, Slots]) -> Floats:
        """Values of the parameters."""

    def critical(self, problem: Problem, x: Floats, order: int) -> Critical:
        """Points to offer to the slots of an order."""


OPTIONS = {
    "linear_solver": "mumps",
    "mumps_mem_percent": 100,
    "tol": 1e-10,
    "constr_viol_tol": 1e-10,
    "dual_inf_tol": 1e-6,
    "compl_inf_tol": 1e-8,
    "acceptable_iter": 0,
    "bound_relax_factor": 0.0,
    "max_iter": 300,
    "honor_original_bounds": "no",
}
COLD = {"mu_strategy": "adaptive"}
WARM = {
    "warm_start_init_point": "yes",
    "mu_init": 1e-6,
    "warm_start_bound_push": 1e-8,
    "warm_start_bound_frac": 1e-8,
    "warm_start_slack_bound_push": 1e-8,
    "warm_start_slack_bound_frac": 1e-8,
    "warm_start_mult_bound_push": 1e-8,
}


class Model:
    """IPOPT solvers of one family and shape."""

    @alone()
    def __init__(self, family: Family, time_limit: float) -> None:
        self.rows = family.rows()
        self._time_limit = time_limit
        self._problem = {"x": self.rows.x, "p": self.rows.p, "f": self.rows.total, "g": self.rows.g}

    @cached_property
    def cold(self) -> Ipopt:
        """Solver for a start from durations alone."""
        return self._solver(COLD)

    @cached_property
    def warm(self) -> Ipopt:
        """Solver for a start from a solution with its multipliers."""
        return self._solver(WARM)

    def _solver(self, more: dict[str, Any]) -> Ipopt:
        return Ipopt(self._problem, OPTIONS | more, self._time_limit)

    def __del__(self, drop: Callable[[Any], None] = drop) -> None:
        drop(vars(self).copy())


MOST_MODELS = 8
"""Models that are kept, those used last: one of 200 waypoints takes 30 MB."""

_MODELS: dict[tuple[Any, ...], Model] = {}


@alone()
def model_of(family: Family, time_limit: float) -> Model:
    """Build a family's model, or take the one built before."""
    key = (*family.key, time_limit)
    model = _MODELS.pop(key, None) or Model(family, time_limit)
    _MODELS[key] = model
    if len(_MODELS) > MOST_MODELS:
        del _MODELS[next(iter(_MODELS))]
    return model
