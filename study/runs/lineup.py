"""Planner specifications, the default line-up, and the cells made of them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from study.bounds import is_stochastic
from study.cases.library import Case
from study.errors import StudyError, unknown
from study.planning import Formulation, Freedom, RunSettings, Synchronisation
from study.registry import method_named, method_names, peer_names, unavailable_planners
from study.runs.selections import HEADLINE_SEARCHES, MODERN_SEARCHES
from study.store.results import Cell

OPTIONS = (*Formulation, *Synchronisation)
AS_IN_PAPER = "as in the paper"
"""Synchronisation of a specification that takes that of the case's own paper; it has no name on the command line."""

QUICK_EVALUATIONS = 2000
QUICK_SEEDS = 3
FULL_SEEDS = 30
TIME_LIMIT = 60.0


@dataclass(frozen=True)
class Spec:
    """A planner and how it is to be run; None leaves an option to the case's own paper.

    Attributes
    ----------
    planner : str
        Registry name.
    formulation : str, optional
        `penalty` or `scaled`.
    synchronisation : str, optional
        `per-joint`, `shared` or `AS_IN_PAPER`.
    """

    planner: str
    formulation: str | None = None
    synchronisation: str | None = None


@dataclass(frozen=True)
class Budget:
    """Budget of every cell: seeds, evaluations and time.

    Attributes
    ----------
    seeds : int
        Runs of every search; deterministic planners run once.
    evaluations : int, optional
        Curve evaluations of every search; None takes the budget of the case's own paper.
    time_limit : float, s
        Wall time after which a cell is interrupted.
    """

    seeds: int = QUICK_SEEDS
    evaluations: int | None = QUICK_EVALUATIONS
    time_limit: float = TIME_LIMIT

    def __post_init__(self) -> None:
        if self.seeds < 1:
            raise StudyError(f"the number of seeds must be at least 1, got {self.seeds}")
        if self.evaluations is not None and self.evaluations < 1:
            raise StudyError(f"the number of evaluations must be at least 1, got {self.evaluations}")
        if not self.time_limit > 0:
            raise StudyError(f"the time limit must be positive, got {self.time_limit:g} s")


def parse_spec(text: str) -> Spec:
    """Read `NAME[:OPTION[,OPTION]]`, such as `golds-pso:scaled,shared`.

    Raises
    ------
    StudyError
        If the planner is not installed or an option is unknown or contradicts another.
    """
    name, _, tail = text.strip().partition(":")
    method_named(name)
    chosen: dict[str, str] = {}
    for option in filter(None, (part.strip() for part in tail.split(","))):
        if option not in OPTIONS:
            raise unknown(f"planner option in {text!r}:", option, OPTIONS)
        kind = "formulation" if option in tuple(Formulation) else "synchronisation"
        if kind in chosen:
            raise StudyError(f"planner {text!r} asks for two kinds of {kind}: {chosen[kind]} and {option}; keep one")
        chosen[kind] = option
    return Spec(name, **chosen)


def parse_specs(text: str) -> tuple[Spec, ...]:
    """Read specifications separated by commas; an option belongs to the name before it.

    Raises
    ------
    StudyError
        If there is none, or one of them is wrong.
    """
    parts: list[str] = []
    for part in filter(None, (part.strip() for part in text.split(","))):
        if parts and part in OPTIONS:
            parts[-1] += f",{part}" if ":" in parts[-1] else f":{part}"
        else:
            parts.append(part)
    if not parts:
        raise StudyError("no planners to run; name some with --planners, see `study list`")
    return tuple(dict.fromkeys(parse_spec(part) for part in parts))


def default_lineup(names: Iterable[str] | None = None) -> tuple[Spec, ...]:
    """Every headline search as the papers run it and once more `scaled,shared`, every deterministic planner, and every bound.

    Modern references run `scaled,shared` alone: the papers' penalty and their rule for the joints are not theirs.

    Deterministic planners share durations between the joints; those on the paper's curve run once more joint by joint where
    the paper does, so that the price of that rule can be told from the price of the search.

    Planners that cannot be loaded are left out; `unavailable_planners` names them. So are other packages' own, the peers.

    Parameters
    ----------
    names : iterable of str, optional
        Searches to take; the headline ones that are installed by default.
    """
    installed = _available()
    searches = [name for name in (HEADLINE_SEARCHES if names is None else names) if name in installed]
    papers_way = [Spec(name) for name in searches if name not in MODERN_SEARCHES]
    scaled = [Spec(name, "scaled", "shared") for name in searches if method_named(name).freedom is Freedom.CURVE]
    plain = [name for name in installed if not is_stochastic(method_named(name))]
    rule = [Spec(name, synchronisation=AS_IN_PAPER) for name in plain if method_named(name).freedom is Freedom.CURVE]
    return (*papers_way, *scaled, *(Spec(name) for name in plain), *rule)


def full_lineup() -> tuple[Spec, ...]:
    """Every installed planner but the peers in the ways of the default line-up."""
    return default_lineup([name for name in _available() if is_stochastic(method_named(name))])


def _available() -> list[str]:
    without = {*unavailable_planners(), *peer_names()}
    return [name for name in method_names() if name not in without]


def make_cells(cases: Iterable[Case], specs: Sequence[Spec], budget: Budget) -> list[Cell]:
    """Cross cases, planners and seeds; what comes twice is kept once.

    Parameters
    ----------
    cases : iterable of Case
    specs : sequence of Spec
    budget : Budget
    """
    cells = [cell for case in cases for spec in specs for cell in _cells(case, spec, budget)]
    return list(dict.fromkeys(cells))


def _cells(case: Case, spec: Spec, budget: Budget) -> list[Cell]:
    method = method_named(spec.planner)
    stochastic = is_stochastic(method)
    own = replace(case.settings, curve=case.curve, seed=0, time_limit=budget.time_limit)
    if budget.evaluations is not None:
        own = replace(own, evaluations=budget.evaluations)
    if not stochastic:  # takes the plain problem unless told otherwise
        own = replace(own, formulation=Formulation.SCALED, synchronisation=Synchronisation.SHARED)
    if method.freedom is not Freedom.CURVE:  # takes no budget either, so that no budget makes it another cell
        own = RunSettings(curve=case.curve, formulation=Formulation.SCALED, time_limit=budget.time_limit)
    rule = case.settings.synchronisation if spec.synchronisation == AS_IN_PAPER else spec.synchronisation
    settings = replace(
        own,
        formulation=Formulation(spec.formulation or own.formulation),
        synchronisation=Synchronisation(rule or own.synchronisation),
    )
    seeds = range(budget.seeds) if stochastic else range(1)
    label = _label(spec.planner, settings, own)
    return [Cell(case.name, spec.planner, label, replace(settings, seed=seed)) for seed in seeds]


def _label(name: str, settings: RunSettings, own: RunSettings) -> str:
    pairs = [(settings.formulation, own.formulation), (settings.synchronisation, own.synchronisation)]
    different = [chosen for chosen, usual in pairs if chosen != usual]
    return f"{name}:{','.join(different)}" if different else name
