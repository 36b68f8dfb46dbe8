"""Line-ups by name: planners with a stated time limit each, and the one that every suite takes by itself."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from study.bounds import is_stochastic
from study.cases.case import Case
from study.cases.suites import PAPERS, Suite
from study.errors import StudyError, unknown
from study.registry import method_named, peer_names, unavailable_planners
from study.runs.lineup import Budget, Spec, make_cells
from study.store.results import Cell
from study.suites.scaling import QUICK

DETERMINISTIC: Mapping[str, float] = {
    "free-path": 10.0,
    "free-path-first": 2.0,
    "ruckig-via": 5.0,
    "ruckig-stops": 1.0,
    "toppra": 2.0,
    "toppra-quick": 1.0,
    "copp": 2.0,
    "topp3-nlp": 4.0,
    "casadi-nlp": 5.0,
    "any-motion-bound": 4.0,
}
"""Planners and bounds of no chance: seconds for one problem."""

OPTIMA: Mapping[str, float] = {"casadi-nlp": 60.0, "free-path": 20.0, "any-motion-bound": 8.0}
"""The deterministic optima that searches are measured against, and the bound."""

SEARCHES: Mapping[str, float] = dict.fromkeys(
    ("pso", "golds-pso", "dynamic-adaptive-pso", "chaotic-spso", "tadf-ssa", "smwoa", "de", "l-shade", "cma-es", "random-search"),
    120.0,
)  # fmt: skip
"""Searches in the scaled formulation, all joints together: seconds for one run, more than 100,000 evaluations of 199 segments take."""

PEER = 10.0
"""Seconds that every peer has for one problem; those that cannot be stopped decline what takes longer."""

QUICK_EVALUATIONS, FULL_EVALUATIONS = (1_000, 10_000), (1_000, 10_000, 100_000)
QUICK_SEEDS, FULL_SEEDS = 3, 10


@dataclass(frozen=True)
class Lineup:
    """Planners of a suite's run.

    Attributes
    ----------
    name, about : str
    limits : mapping of str to float
        Deterministic planners, and the seconds that each has for one problem.
    searches : mapping of str to float
        Searches, and the seconds that each has for one run.
    """

    name: str
    about: str
    limits: Mapping[str, float]
    searches: Mapping[str, float]


LINEUPS = {
    lineup.name: lineup
    for lineup in (
        Lineup("deterministic", "planners of no chance, of every kind of motion, and the bound", DETERMINISTIC, {}),
        Lineup("growth", "the optima of curve and free path, and the searches at growing budgets", OPTIMA, SEARCHES),
    )
}
PEERS = "peers"
USUAL = {"scaling": "growth", "scaling-second": "growth"}
"""Line-up of a suite where it is not the deterministic one; the papers have the default run's."""


def lineup_named(name: str) -> Lineup:
    """Line-up of a name; that of the peers has every one that is registered, installed or not.

    Raises
    ------
    StudyError
        If there is none.
    """
    if name == PEERS:
        return Lineup(
            PEERS, "other packages, each set up as its own users would", dict.fromkeys(peer_names(), PEER), {}
        )
    if name not in LINEUPS:
        raise unknown("line-up", name, (*LINEUPS, PEERS))
    return LINEUPS[name]


def usual_lineup(suite: Suite) -> Lineup:
    """Line-up that a suite takes by itself.

    Raises
    ------
    StudyError
        For the papers, whose run is the default one.
    """
    if suite.name == PAPERS:
        raise StudyError(
            "the suite of the papers is what `study run` takes by itself; leave --suite out, or name a --lineup"
        )
    return LINEUPS[USUAL.get(suite.name, "deterministic")]


def chosen_cases(suite: Suite, quick: bool) -> list[Case]:
    """Cases of a run; a quick one takes those with the tag `quick`, or all where none has it."""
    tagged = [suite.cases[name] for name, problem in suite.problems.items() if QUICK in problem.tags]
    return tagged if quick and tagged else list(suite.cases.values())


def given_lineup(names: Sequence[str], time_limit: float) -> Lineup:
    """Line-up of planners that were asked for, all with the same time limit."""
    chance = {name: is_stochastic(method_named(name)) for name in names}
    limits, searches = ({name: time_limit for name in names if chance[name] is kind} for kind in (False, True))
    return Lineup("given", "planners asked for", limits, searches)


def suite_cells(
    cases: Iterable[Case], lineup: Lineup, quick: bool, seeds: int | None = None, evaluations: int | None = None
) -> list[Cell]:
    """Cells of a run, problem by problem; planners that are not installed are left out.

    Parameters
    ----------
    cases : iterable of Case
    lineup : Lineup
    quick : bool
        Whether the searches have the small budgets and few seeds.
    seeds : int, optional
        Runs of every search.
    evaluations : int, optional
        One budget for all searches.
    """
    broken = unavailable_planners()
    budgets = QUICK_EVALUATIONS if quick else FULL_EVALUATIONS
    seeds = (QUICK_SEEDS if quick else FULL_SEEDS) if seeds is None else seeds
    wanted = [(Spec(name), Budget(1, None, limit)) for name, limit in lineup.limits.items() if name not in broken]
    wanted += [
        (Spec(name, "scaled", "shared"), Budget(seeds, budget, limit))
        for budget in (budgets if evaluations is None else (evaluations,))
        for name, limit in lineup.searches.items()
        if name not in broken
    ]
    return [cell for case in cases for spec, budget in wanted for cell in make_cells([case], [spec], budget)]
