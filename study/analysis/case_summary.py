"""Summary of a case, computed once per run and handed to terminal, report, recording and README."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from study.analysis.featured import Featured, featured
from study.analysis.ladder import Rung, ladder_of
from study.analysis.methods import Kind, MethodSummary, summaries_of
from study.analysis.published import Printed
from study.cases.library import Case
from study.store.results import Result


@dataclass(frozen=True, eq=False)
class CaseSummary:
    """A case and all that is known of its methods.

    Attributes
    ----------
    case : Case
    methods : tuple of MethodSummary
        Feasible ones by median duration, then the infeasible ones, then single joints.
    """

    case: Case
    methods: tuple[MethodSummary, ...]

    @property
    def whole(self) -> tuple[MethodSummary, ...]:
        """Methods that move the whole arm, without what a paper prints of single joints."""
        return tuple(method for method in self.methods if method.joint is None)

    @property
    def ran(self) -> bool:
        """Whether any planner has run on the case; a stopped run may not have come to it."""
        return any(method.kind is not Kind.PUBLISHED for method in self.methods)

    @cached_property
    def best(self) -> Featured:
        """Best method of every role."""
        return featured(self.methods, self.case.velocity_only)

    @cached_property
    def rungs(self) -> tuple[Rung, ...]:
        """The ladder of lost time; empty where there is too little for one."""
        return ladder_of(self.case, self.methods, self.best)


def summarise(cases: Mapping[str, Case], results: Iterable[Result]) -> tuple[CaseSummary, ...]:
    """Summarise every case, in the order given.

    Parameters
    ----------
    cases : mapping of str to Case
    results : iterable of Result
    """
    results = tuple(results)
    return tuple(summarise_case(case, results) for case in cases.values())


def summarise_case(case: Case, results: Iterable[Result], printed: Sequence[Printed] | None = None) -> CaseSummary:
    """Summarise one case; `printed` are its judged published motions, where they are known already."""
    return CaseSummary(case, summaries_of(case, results, printed))
