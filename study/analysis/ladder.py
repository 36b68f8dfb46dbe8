"""The ladder of lost time: from the published result down to the fastest known motion, each step named by its cause."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from study.analysis.featured import Featured
from study.analysis.formatting import plural
from study.analysis.methods import CURVE, FREE_PATH
from study.analysis.rows import Entry, lower_bound
from study.cases.library import Case
from study.cases.papers import paper_of

EXACT = ("certified", "casadi-nlp")
"""Planners that find the optimum of a joint, the one with a proof first."""

SAME = 1e-6
"""Times closer than this share stand on one rung."""

FREE_CAUSE = "path: free between the waypoints"
FIXED_CAUSE = "curve family: the path is given, but the speed along it is not tied to the form of the curve"
CAUSES = {
    "toppra": FIXED_CAUSE,
    "topp3-nlp": FIXED_CAUSE + "; jerk is limited too",
    "copp": FIXED_CAUSE + "; jerk is limited too",
    "quintic-nlp": "curve family: quintic segments with free velocities and accelerations at the waypoints",
    "bspline-nlp": "path: free between the waypoints, on one smooth B-spline of degree 5",
    "free-path": "path: free between the waypoints, every joint changing its jerk or acceleration when it likes",
    "free-path-nlp": "path: free between the waypoints, with several pieces of constant jerk or acceleration per segment",
    "ruckig-stops": "path: free between the waypoints, but the arm stops at each of them",
    "ruckig-via": "path: free between the waypoints, which the arm passes in motion",
}
"""Every cause begins with its kind: optimiser, synchronisation rule, curve family or path."""


@dataclass(frozen=True)
class Rung:
    """One step of the ladder.

    Attributes
    ----------
    name, method : str
    path : str
        A key of `study.analysis.rows.MEANING`; empty for a bound.
    feasible : bool
    seconds : float, s
    change : float, optional, s
        On the case's curve against the rung before; on another path against the deterministic optimum on the curve; of
        a bound against the fastest rung. None on the first.
    cause : str
        What makes the difference.
    """

    name: str
    method: str
    path: str
    feasible: bool
    seconds: float
    change: float | None
    cause: str

    @property
    def relative(self) -> float | None:
        """Change as a share of what it is a change from."""
        return None if self.change is None else self.change / (self.seconds - self.change)


Step = tuple[str, Entry, float | None, str]


def ladder_of(case: Case, entries: Sequence[Entry], best: Featured) -> tuple[Rung, ...]:
    """Climb down from the published result as far as there are results; fewer than two rungs make no ladder."""
    rungs: list[Rung] = []
    for name, entry, seconds, cause in _steps(case, entries, best):
        if seconds is not None and _joins(rungs, entry, seconds):
            rungs[-1] = replace(rungs[-1], method=f"{rungs[-1].method}, {entry.label}", cause=FREE_CAUSE)
        elif seconds is not None:
            change = seconds - _base(rungs, entry.path) if rungs else None
            feasible = entry.row.feasible or name == "Lower bound"
            cause = cause if rungs or entry is best.published else "where the ladder begins"
            rungs.append(
                Rung(name, entry.label.removeprefix("published: "), entry.path, feasible, seconds, change, cause)
            )
    return tuple(rungs) if len(rungs) > 1 else ()


def _joins(rungs: Sequence[Rung], entry: Entry, seconds: float) -> bool:
    """Whether a free path takes the same time as the one before it."""
    above = rungs[-1] if rungs else None
    return (
        above is not None
        and above.path == entry.path == FREE_PATH
        and abs(seconds - above.seconds) <= SAME * above.seconds
    )


def _base(rungs: Sequence[Rung], path: str) -> float:
    """What a new rung is compared with, s."""
    on_curve = [rung.seconds for rung in rungs if rung.path == CURVE]
    if path and on_curve:
        return on_curve[-1]
    return min(rung.seconds for rung in rungs if rung.feasible or rung is rungs[-1])


def _steps(case: Case, entries: Sequence[Entry], best: Featured) -> Iterator[Step]:
    if best.published is not None:
        yield "Published", best.published, best.published.duration, "as the paper prints it"
    yield from _curve_steps(case, entries, best)
    others = [entry for entry in entries if entry.row.kind == "deterministic" and entry.path == FREE_PATH]
    others = [entry for entry in others if entry.row.feasible] + ([best.fixed] if best.fixed is not None else [])
    for entry in sorted(others, key=lambda entry: -(entry.duration or 0.0)):
        cause = CAUSES.get(entry.planner, FREE_CAUSE)
        freer = "Freer curve, " if entry.planner == "quintic-nlp" else ""
        yield (freer + entry.path).capitalize(), entry, entry.duration, cause
    for entry in entries:
        if entry.standing == "bound":
            yield "Lower bound", entry, entry.bound, "proved: no motion through the waypoints is faster"


def _curve_steps(case: Case, entries: Sequence[Entry], best: Featured) -> Iterator[Step]:
    """On the case's curve: its own planner, the best search and the optimum under its rule, then with shared durations."""
    searches = [entry for entry in entries if entry.row.kind == "search" and entry.row.feasible and entry.path == CURVE]
    papers_own = case.planner if paper_of(case.paper) else None
    own = next((entry for entry in searches if entry.label == papers_own), None)
    if own is not None:
        yield from _reproduced(own)
    rule = case.settings.synchronisation
    yield from _best_search(searches, rule, own, "optimiser: another search or another formulation, same rule")
    if rule != "shared":
        yield from _alone(entries)
        cause = "synchronisation rule: all joints share durations from the start"
        yield from _best_search(searches, "shared", own, cause)
    if best.optimiser is not None:
        cause = "optimiser: what the search leaves on the table, on the same curve" + _proof(entries)
        yield "Deterministic optimum, same curve", best.optimiser, best.optimiser.duration, cause


def _reproduced(own: Entry) -> Iterator[Step]:
    runs = plural(own.row.runs, "seed")
    if own.row.feasible_runs < own.row.runs:
        runs = f"the {own.row.feasible_runs} feasible of {runs}"
    cause = "optimiser: our reading of the paper's method, every limit judged exactly"
    yield f"Reproduced, median of {runs}", own, own.row.median, cause
    if own.row.feasible_runs > 1:
        yield f"Reproduced, best of {runs}", own, own.row.best, "optimiser: the luck of the seed"


def _best_search(searches: Sequence[Entry], rule: str, own: Entry | None, cause: str) -> Iterator[Step]:
    entry = min(_under(searches, rule), key=lambda one: one.row.best or 0.0, default=None)
    if entry is not None and entry is not own:
        yield f"Best of all searches and seeds, {rule} durations", entry, entry.row.best, cause


def _alone(entries: Sequence[Entry]) -> Iterator[Step]:
    """The true optimum of every joint alone, put together by the paper's rule; it shows what the rule costs by itself.

    A search that stops short of the joints' optima may end lower here: what is best for each is not best for all.
    """
    plain = [entry for entry in entries if entry.row.kind == "deterministic" and entry.row.feasible and entry.results]
    known = {entry.planner: entry for entry in _under(plain, "per-joint") if entry.path == CURVE}
    entry = next((known[name] for name in EXACT if name in known), None)
    if entry is not None:
        cause = (
            "synchronisation rule: every joint at its own optimum, the longest duration of each segment taken for all"
        )
        yield "True optimum of every joint alone", entry, entry.duration, cause


def _under(entries: Sequence[Entry], rule: str) -> list[Entry]:
    return [entry for entry in entries if entry.results[0].cell.settings.synchronisation == rule]


def _proof(entries: Sequence[Entry]) -> str:
    bound = lower_bound(entries, CURVE)
    return "" if bound is None else f"; proved that no less than {bound:.6g} s is possible on it"
