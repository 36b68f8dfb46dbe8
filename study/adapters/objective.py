"""Counted objective: a case as a box-constrained minimisation problem in segment durations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike

from study.arrays import of_kind, whole
from study.cases.library import Case, load_case
from study.cases.records import ProblemRecords, records_of
from study.cases.suite_file import filed_suites
from study.cases.suites import PAPERS, suite_named
from study.curves import curve_named
from study.datafiles import Strict, checked, data_folder, read_yaml
from study.errors import StudyError
from study.formulation import objective_of
from study.io.arrays_file import floats
from study.planning import Formulation, Freedom
from study.problem import Floats


@dataclass(frozen=True, eq=False)
class Instance:
    """Instance of an objective: some coordinates reflected in the middle of the box, then the box shifted.

    The landscape stays the same up to an isometry, so the best value does too, but a search that favours the origin,
    the axes' directions or the middle of the box no longer gains by it.

    Attributes
    ----------
    number : int
        0 leaves everything in place; any other number is the seed of its reflection and shift.
    mirrored : bool array of shape (n_dimensions,)
    shift : array of shape (n_dimensions,), s
    """

    number: int
    mirrored: np.ndarray
    shift: Floats

    @classmethod
    def of(cls, number: int, lower: Floats, upper: Floats) -> Instance:
        """Draw an instance for a box."""
        if whole(number, 0, "the number of an instance") == 0:
            return cls(0, np.zeros(len(lower), dtype=bool), np.zeros(len(lower)))
        rng = np.random.default_rng([number, len(lower)])
        return cls(number, rng.random(len(lower)) < 0.5, rng.uniform(-1.0, 1.0, len(lower)) * (upper - lower))


class DurationObjective:
    """Total time as a function of the segment durations of a case, to be minimised.

    Call it with one point of shape (n_dimensions,) for a float, or with a population of shape (n_points, n_dimensions)
    for an array. Every point counts as one evaluation. Infinity stands for values that are not numbers.

    Attributes
    ----------
    case : Case
    formulation : Formulation
        `scaled`: the candidate's durations are stretched or shortened until they are just feasible; `penalty`: total
        time plus a penalty where a limit is broken.
    instance : Instance
    lower, upper : arrays of shape (n_dimensions,), s
    best_known : float, optional, s
        Lowest value known, by the deterministic optimiser of the study; None where none is stored.
    best_point : array of shape (n_dimensions,), optional
        A point of the box that has it.
    evaluations : int
        Points evaluated so far.
    best : float, s
        Lowest value seen so far.
    """

    def __init__(self, case: Case, formulation: Formulation | str = Formulation.SCALED, instance: int = 0) -> None:
        self.case, self.formulation = of_kind(case, Case, "case"), Formulation(of_kind(formulation, str, "formulation"))
        problem = case.problem
        self._value = objective_of(self.formulation, problem, curve_named(case.curve))
        self._low, self._high = (np.full(problem.n_segments, bound) for bound in problem.duration_bounds)
        self.instance = Instance.of(instance, self._low, self._high)
        self.lower, self.upper = self._low + self.instance.shift, self._high + self.instance.shift
        known = _best_known().get(case.name, {}).get(self.formulation) or _record(case, self.formulation)
        self.best_known = None if known is None else known.value
        self.best_point = None if known is None else self.point(np.array(known.durations))
        self.reset()

    @property
    def name(self) -> str:
        """Case, formulation and instance."""
        return f"{self.case.name}, {self.formulation}, instance {self.instance.number}"

    @property
    def n_dimensions(self) -> int:
        """Number of segment durations."""
        return len(self.lower)

    @property
    def bounds(self) -> list[tuple[float, float]]:
        """Pairs (lower, upper), as SciPy takes them."""
        return list(zip(self.lower.tolist(), self.upper.tolist(), strict=True))

    def reset(self) -> None:
        """Forget all evaluations."""
        self.evaluations, self.best = 0, np.inf

    def durations(self, points: ArrayLike) -> Floats:
        """Durations that points of this instance stand for, s, of the same shape."""
        inside = _numbers(points) - self.instance.shift
        return np.where(self.instance.mirrored, self._low + self._high - inside, inside)

    def point(self, durations: ArrayLike) -> Floats:
        """Points of this instance that stand for durations: the inverse of `durations`."""
        given = _numbers(durations)
        return np.where(self.instance.mirrored, self._low + self._high - given, given) + self.instance.shift

    def __call__(self, points: ArrayLike) -> float | Floats:
        """Evaluate one point or a population."""
        array = _numbers(points)
        rows = np.atleast_2d(array)
        if array.ndim not in (1, 2) or rows.shape[1] != self.n_dimensions:
            raise StudyError(f"{self.name}: points must have {self.n_dimensions} coordinates, got shape {array.shape}")
        values = self.values(rows)
        return float(values[0]) if array.ndim == 1 else values

    def values(self, rows: Floats) -> Floats:
        """Evaluate a population of shape (n_points, n_dimensions); values of shape (n_points,)."""
        durations = self.durations(rows)
        usable = np.isfinite(durations).all(axis=1) & (durations > 0).all(axis=1)
        values = np.full(len(rows), np.inf)
        if usable.any():
            raw = self._value(durations[usable])
            values[usable] = np.where(np.isnan(raw), np.inf, raw)
        self.evaluations += len(rows)
        self.best = min(self.best, float(values.min(initial=np.inf)))
        return values


def objective(
    case: str | Case, formulation: Formulation | str = Formulation.SCALED, instance: int = 0
) -> DurationObjective:
    """Objective of a case.

    Parameters
    ----------
    case : str or Case
        A name, the path of a file, or a case.
    formulation : Formulation or str
        `scaled` or `penalty`.
    instance : int

    Raises
    ------
    StudyError
        If there is no such case or formulation.
    """
    return DurationObjective(load_case(case) if isinstance(case, str) else case, formulation, instance)


def _numbers(values: ArrayLike) -> Floats:
    """Take coordinates, NaN among them: searches come to such points, and their value is infinite."""
    try:
        return floats(values)
    except (TypeError, ValueError, OverflowError) as error:
        raise StudyError(f"points must be made of numbers: {error}") from None


def suite(instances: int = 3, name: str = PAPERS) -> Iterator[DurationObjective]:
    """Go through the problems of a suite and the first instances; of the papers' cases both formulations, else `scaled`."""
    whole(instances, 1, "the number of instances")
    for case in suite_named(name).cases.values():
        for formulation in Formulation if name == PAPERS else (Formulation.SCALED,):
            for instance in range(instances):
                yield objective(case, formulation, instance)


class _Known(Strict):
    value: float
    durations: list[float]


class _File(Strict):
    method: str
    cases: dict[str, dict[str, _Known]]


@cache
def _best_known() -> dict[str, dict[str, _Known]]:
    path = data_folder() / "best_known.yaml"
    return checked(_File, read_yaml(path), f"file {path.name!r}").cases


def _record(case: Case, formulation: Formulation) -> _Known | None:
    """Best known durations of a suite's problem; None where there are none, and for the penalty, which stretches nothing."""
    suite = case.name.partition(":")[0]
    if formulation is not Formulation.SCALED or suite not in filed_suites():
        return None
    best = records_of(suite_named(suite)).get(case.name, ProblemRecords()).best.get(Freedom.CURVE)
    return None if best is None or best.durations is None else _Known(value=best.duration, durations=best.durations)
