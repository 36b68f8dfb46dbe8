"""The ladder of lost time, from the published result down to the fastest known motion, and the time of each cause."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from study.analysis.featured import Featured
from study.analysis.formatting import plural
from study.analysis.methods import Kind, MethodSummary, lower_bound
from study.cases.library import Case
from study.planning import Freedom, Synchronisation

SAME = 1e-6
"""Times closer than this share stand on one rung."""

FREE_CAUSE = "free between the waypoints"
FIXED_CAUSE = "the path is given, but the speed along it is not tied to the form of the curve"
RULE_CAUSE = "every joint at its own optimum, the longest duration of each segment taken for all"


class CauseKind(StrEnum):
    """Kind of change that makes the difference between two rungs."""

    START = "start"
    OPTIMISER = "optimiser"
    RULE = "synchronisation rule"
    CURVE = "curve family"
    PATH = "path"
    PROOF = "proof"


@dataclass(frozen=True)
class Rung:
    """One step of the ladder.

    Attributes
    ----------
    name, method : str
    freedom : Freedom, optional
        None for a bound.
    feasible : bool
    seconds : float, s
    change : float, optional, s
        On the case's curve against the rung before; on another path against the deterministic optimum on the curve; of
        a bound against the fastest rung. None on the first.
    kind : CauseKind
    text : str
        What makes the difference, in words.
    """

    name: str
    method: str
    freedom: Freedom | None
    feasible: bool
    seconds: float
    change: float | None
    kind: CauseKind
    text: str

    @property
    def relative(self) -> float | None:
        """Change as a share of what it is a change from."""
        return None if self.change is None else self.change / (self.seconds - self.change)

    @property
    def cause(self) -> str:
        """Kind and text, as tables show them."""
        return self.text if self.kind in (CauseKind.START, CauseKind.PROOF) else f"{self.kind}: {self.text}"


@dataclass(frozen=True)
class Breakdown:
    """Time gained by each kind of cause on one ladder; negative is less time, None is a kind that it does not have.

    Attributes
    ----------
    first, last : Rung
        Where the ladder begins and ends on the case's curve; the gains on the curve lead from one to the other.
    optimiser, rule : float, optional, s
        Sum over the rungs that change how durations are searched for, and how joints are synchronised.
    fixed, free : float, optional, s
        Largest gain off the curve, against `last`.
    bound : float, optional, s
        Time that no motion through the waypoints undercuts.
    """

    first: Rung
    last: Rung
    optimiser: float | None
    rule: float | None
    fixed: float | None
    free: float | None
    bound: float | None


@dataclass(frozen=True)
class _Step:
    """A rung before it is known what it is compared with."""

    name: str
    method: MethodSummary
    seconds: float | None
    kind: CauseKind
    text: str


def ladder_of(case: Case, methods: Sequence[MethodSummary], best: Featured) -> tuple[Rung, ...]:
    """Climb down from the published result as far as there are results; fewer than two rungs make no ladder."""
    rungs: list[Rung] = []
    for step in _steps(case, methods, best):
        if step.seconds is None:
            continue
        if rungs and _joins(rungs[-1], step.method, step.seconds):
            rungs[-1] = replace(rungs[-1], method=f"{rungs[-1].method}, {step.method.label}", text=FREE_CAUSE)
        else:
            rungs.append(_rung(step, step.seconds, rungs, step.method is best.published))
    return tuple(rungs) if len(rungs) > 1 else ()


def breakdown_of(rungs: Sequence[Rung]) -> Breakdown | None:
    """Sum a ladder up by cause; None without two rungs on the curve."""
    on_curve = [rung for rung in rungs if rung.freedom is Freedom.CURVE]
    if len(on_curve) < 2:
        return None
    return Breakdown(
        first=on_curve[0],
        last=on_curve[-1],
        optimiser=_sum(on_curve[1:], CauseKind.OPTIMISER),
        rule=_sum(on_curve[1:], CauseKind.RULE),
        fixed=_most(rungs, Freedom.PATH),
        free=_most(rungs, Freedom.FREE),
        bound=next((rung.seconds for rung in rungs if rung.kind is CauseKind.PROOF), None),
    )


def _sum(rungs: Sequence[Rung], kind: CauseKind) -> float | None:
    changes = [rung.change or 0.0 for rung in rungs if rung.kind is kind]
    return sum(changes) if changes else None


def _most(rungs: Sequence[Rung], freedom: Freedom) -> float | None:
    changes = [rung.change for rung in rungs if rung.freedom is freedom and rung.feasible and rung.change is not None]
    return min(changes, default=None)


def _rung(step: _Step, seconds: float, above: Sequence[Rung], published: bool) -> Rung:
    starts = not above and not published
    return Rung(
        name=step.name,
        method=step.method.label.removeprefix("published: "),
        freedom=step.method.freedom,
        feasible=step.method.feasible or step.kind is CauseKind.PROOF,
        seconds=seconds,
        change=seconds - _base(above, step.method.freedom) if above else None,
        kind=CauseKind.START if starts else step.kind,
        text="where the ladder begins" if starts else step.text,
    )


def _joins(above: Rung, method: MethodSummary, seconds: float) -> bool:
    """Tell if a free path takes the same time as the rung above it."""
    return above.freedom is method.freedom is Freedom.FREE and abs(seconds - above.seconds) <= SAME * above.seconds


def _base(rungs: Sequence[Rung], freedom: Freedom | None) -> float:
    """Time that a new rung is compared with, s."""
    on_curve = [rung.seconds for rung in rungs if rung.freedom is Freedom.CURVE]
    if freedom is not None and on_curve:
        return on_curve[-1]
    return min(rung.seconds for rung in rungs if rung.feasible or rung is rungs[-1])


def _steps(case: Case, methods: Sequence[MethodSummary], best: Featured) -> Iterator[_Step]:
    if best.published is not None:
        paper = best.published
        yield _Step("Published", paper, paper.duration, CauseKind.START, "as the paper prints it")
    yield from _curve_steps(case, methods, best)
    others = [m for m in methods if m.kind is Kind.DETERMINISTIC and m.freedom is Freedom.FREE and m.feasible]
    others += [best.fixed] if best.fixed is not None else []
    for method in sorted(others, key=lambda method: -(method.duration or 0.0)):
        fixed = method is best.fixed
        kind, text = (CauseKind.CURVE, FIXED_CAUSE) if fixed else (CauseKind.PATH, FREE_CAUSE)
        about = f"; {method.about}" if method.about else ""
        yield _Step(str(method.freedom).capitalize(), method, method.duration, kind, text + about)
    for method in methods:
        if method.kind is Kind.BOUND:
            text = "proved: no motion through the waypoints is faster"
            yield _Step("Lower bound", method, method.bound, CauseKind.PROOF, text)


def _curve_steps(case: Case, methods: Sequence[MethodSummary], best: Featured) -> Iterator[_Step]:
    """On the case's curve: its own planner, the best search and the optimum under its rule, then with shared durations."""
    searches = [m for m in methods if m.kind is Kind.SEARCH and m.feasible and m.freedom is Freedom.CURVE]
    own = best.own if best.own is not None and best.own.feasible else None
    if own is not None:
        yield from _reproduced(own)
    rule, shared = case.settings.synchronisation, Synchronisation.SHARED
    search = _best_under(searches, rule)
    if search is not None and search is not own:
        text = "another search or another formulation, same rule"
        yield _best_search(search, rule, CauseKind.OPTIMISER, text)
    if rule is not shared:
        yield from _alone(methods, best)
        search = _best_under(searches, shared)
        if search is not None and search is not own:
            yield _best_search(search, shared, CauseKind.RULE, "all joints share durations from the start")
    if best.optimiser is not None:
        text = "what the search leaves on the table, on the same curve" + _proof(methods)
        optimiser = best.optimiser
        yield _Step("Deterministic optimum, same curve", optimiser, optimiser.duration, CauseKind.OPTIMISER, text)


def _reproduced(own: MethodSummary) -> Iterator[_Step]:
    runs = plural(own.runs, "seed")
    if own.feasible_runs < own.runs:
        runs = f"the {own.feasible_runs} feasible of {runs}"
    text = "our reading of the paper's method, every limit judged exactly"
    yield _Step(f"Reproduced, median of {runs}", own, own.median, CauseKind.OPTIMISER, text)
    if own.feasible_runs > 1:
        yield _Step(f"Reproduced, best of {runs}", own, own.best, CauseKind.OPTIMISER, "the luck of the seed")


def _best_search(method: MethodSummary, rule: Synchronisation, kind: CauseKind, text: str) -> _Step:
    return _Step(f"Best of all searches and seeds, {rule} durations", method, method.best, kind, text)


def _best_under(searches: Sequence[MethodSummary], rule: Synchronisation) -> MethodSummary | None:
    return min(_under(searches, rule), key=lambda method: method.best or 0.0, default=None)


def _alone(methods: Sequence[MethodSummary], best: Featured) -> Iterator[_Step]:
    """The true optimum of every joint alone, put together by the paper's rule; it shows what the rule costs by itself.

    It is that of the planner which proves the optimum of a joint, or else of the planner that is best on the curve. A search
    that stops short of the joints' optima may end lower here: what is best for each is not best for all.
    """
    plain = [m for m in methods if m.kind is Kind.DETERMINISTIC and m.feasible and m.freedom is Freedom.CURVE]
    optimal = [
        (-(method.results[0].lower_bound or 0.0), method.label, method)
        for method in _under(plain, Synchronisation.PER_JOINT)
        if method.results[0].lower_bound is not None
        or (best.optimiser is not None and method.planner == best.optimiser.planner)
    ]
    if optimal:
        method = min(optimal, key=lambda ranked: ranked[:2])[2]
        yield _Step("True optimum of every joint alone", method, method.duration, CauseKind.RULE, RULE_CAUSE)


def _under(methods: Sequence[MethodSummary], rule: Synchronisation) -> list[MethodSummary]:
    return [method for method in methods if method.results[0].cell.settings.synchronisation is rule]


def _proof(methods: Sequence[MethodSummary]) -> str:
    bound = lower_bound(methods, Freedom.CURVE)
    return "" if bound is None else f"; proved that no less than {bound:.6g} s is possible on it"
