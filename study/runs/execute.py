"""The job of a cell: plan, time, judge, and turn whatever goes wrong into a record."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar

from study.bounds import Method
from study.demands import refusal
from study.errors import StudyError, unforeseen
from study.judge import judge
from study.planning import Plan, Planner, RunSettings, Status
from study.problem import Problem
from study.registry import method_named
from study.runs.progress import reporter
from study.slowing import fitted, told
from study.store.codec import cell_digest, check_storable, decode, encode, settings_text
from study.store.kept import Encoded
from study.store.provenance import code_behind
from study.store.results import Cell, Result
from study.store.store import Store
from study.supervisor import supervised, supervisor

if TYPE_CHECKING:  # cases need more packages than planning does
    from study.cases.case import Case


@dataclass(frozen=True, eq=False)
class CellJob:
    """A cell and the problem that it is about, as sent to a worker."""

    cell: Cell
    problem: Problem
    kind: ClassVar[str] = Cell.KIND

    @property
    def subject(self) -> str:
        """Name of the case."""
        return self.cell.case

    @property
    def method(self) -> str:
        """Registry name of the planner."""
        return self.cell.planner

    @property
    def label(self) -> str:
        """Name in tables."""
        return self.cell.label

    @property
    def seed(self) -> int:
        """Seed of the planner."""
        return self.cell.settings.seed

    @property
    def time_limit(self) -> float:
        """Wall time after which the planner should have stopped, s."""
        return self.cell.settings.time_limit

    def settings(self) -> str:
        """Write the run settings without the seed."""
        return settings_text(self.cell.settings)

    def content(self) -> str:
        """Checksum of problem, planner and settings."""
        return cell_digest(self.problem, self.cell)

    def code(self) -> str:
        """Name the code of the planner."""
        return code_behind((self.cell.planner,))

    def encode(self, outcome: Result) -> Encoded:
        """Turn the result into plain data."""
        return encode(outcome)

    def decode(self, encoded: Encoded) -> Result:
        """Turn plain data back into the result."""
        return decode(self.cell, encoded)

    def failed(self, reason: str, wall_time: float, status: Status = Status.FAILED) -> Result:
        """Build the result of a planner that brought no motion."""
        return Result(status, message=" ".join(reason.split()), cell=self.cell, wall_time=wall_time)

    def run(self) -> Result:
        """Plan, time and judge; whatever goes wrong in the planner becomes the result's reason."""
        started = time.perf_counter()
        try:
            method = method_named(self.cell.planner)
            started = time.perf_counter()
            if reason := refusal(self.problem.planner_demands, method.knows):
                return self.failed(reason, 0.0, Status.NOT_APPLICABLE)
            outer = supervisor()
            with supervised(reporter(None if outer is None else outer.tell)) as watch:
                answer = asked(method, self.problem, self.cell.settings)
            wall_time = time.perf_counter() - started
            result = judged(self, answer, wall_time)
            return cut_short(result) if watch.deadline_reached else result
        except StudyError as error:
            reason = str(error)
        except MemoryError:
            reason = "memory ran out"
        except Exception as error:  # a planner may raise anything; it is a record, not a crash
            reason = unforeseen(error)
        return self.failed(reason, time.perf_counter() - started)


def cell_jobs(cells: Iterable[Cell], cases: Mapping[str, Case]) -> list[CellJob]:
    """Put cells together with the problems of their cases."""
    return [CellJob(cell, cases[cell.case].problem) for cell in cells]


def stored_results(store: Store, cells: Iterable[Cell], cases: Mapping[str, Case]) -> list[Result]:
    """Read the results of cells, in the order given; cells without one are left out.

    Raises
    ------
    StudyError
        If one of them is damaged.
    """
    return [result for _, result in store.outcomes(cell_jobs(cells, cases))]


def asked(method: Method, problem: Problem, settings: RunSettings) -> Plan:
    """Ask a planner for its plan, or a bound for what it proves, which has no motion."""
    if isinstance(method, Planner):
        return fitted(problem, method.plan(told(method, problem), settings))
    proved = method.bound(problem, settings)
    return Plan(Status.FINISHED, message=proved.message, details=proved.details, lower_bound=proved.value)


def cut_short(result: Result) -> Result:
    """Say of a result that the clock had a part in it: with more time, or on another machine, it might be another."""
    message = "; ".join(filter(None, (result.message, "a time limit inside the planner was reached")))
    return replace(result, status=Status.TIMED_OUT, message=message)


def judged(job: CellJob, plan: Plan, wall_time: float) -> Result:
    """Build the result of a cell whose planner came back."""
    if plan.motion is not None:
        check_storable(plan.motion)
    verdict = None if plan.motion is None else judge(job.problem, plan.motion)
    return Result(**vars(plan), cell=job.cell, verdict=verdict, wall_time=wall_time)
