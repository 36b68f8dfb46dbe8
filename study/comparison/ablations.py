"""The ablations that the papers owe: each improvement switched on by itself, on the same plain search.

References
----------
Woodworking paper, Section 2.4; AUBO paper, Eqs. (13)-(15); UR5 paper on SMWOA, Section 3; improved sparrow paper,
Section 4; PUMA560 paper, Section 3.3.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from study.cases.library import Case
from study.comparison import audit, statistics, tasks
from study.comparison.effort import Effort
from study.comparison.statistics import Interval
from study.comparison.trials import Trial, TrialJob, repeated
from study.search.chaotic_spso import ChaoticSPSO
from study.search.dynamic_adaptive_pso import DynamicAdaptivePSO
from study.search.golds_pso import GoldSPSO
from study.search.reading import PaperReading
from study.search.smwoa import SMWOA
from study.search.ssa import SSA
from study.search.state import Search

PLAIN, WHOLE = "plain", "all together"
FUNCTIONS = ("sphere", "rastrigin")
VIEWS = (tasks.ORIGIN, tasks.SHIFTED)


@dataclass(frozen=True)
class Ablation:
    """A paper's search taken apart.

    Attributes
    ----------
    paper : str
        Key of the paper.
    title : str
    plain : str
        What the search is without its improvements.
    forms : mapping of str to Search
        `plain`, one entry per improvement by itself, and `all together`.
    """

    paper: str
    title: str
    plain: str
    forms: Mapping[str, Search[Any]]

    @property
    def improvements(self) -> list[str]:
        """Names of the improvements."""
        return [name for name in self.forms if name not in (PLAIN, WHOLE)]


def _switched(plain: Any, **improvements: dict[str, Any]) -> dict[str, Search[Any]]:
    """Plain form, each group of changed fields by itself, and all of them together."""
    alone = {name.replace("_", " "): replace(plain, **changes) for name, changes in improvements.items()}
    every = {field: value for changes in improvements.values() for field, value in changes.items()}
    return {PLAIN: plain, **alone, WHOLE: replace(plain, **every)}


_GOLDS = GoldSPSO(circle_start=False, s_curve_inertia=False, golden_sine=False)
_ADAPTIVE = DynamicAdaptivePSO(inertia=(0.5, 0.5), learning=(2.0, 2.0), one_number=False)
_WHALES = SMWOA(arctanh=False, weighted=False, oscillating=False)
_CHAOTIC = ChaoticSPSO(inertia=(0.65, 0.65), chaotic_start=False, asynchronous=False)

ABLATIONS = (
    Ablation(
        "woodworking-golds-pso",
        "GoldS-PSO",
        "simple PSO: no velocities, uniform start, inertia falling in a line",
        _switched(
            _GOLDS,
            circle_map_start={"circle_start": True},
            S_curve_inertia={"s_curve_inertia": True},
            golden_sine={"golden_sine": True},
        ),
    ),
    Ablation(
        "aubo-dynamic-adaptive-pso",
        "dynamic adaptive PSO",
        "PSO with the middle of the paper's ranges held: inertia 0.5, learning factors 2",
        _switched(
            _ADAPTIVE,
            adaptive_inertia={"inertia": (0.9, 0.1)},
            adaptive_learning_factors={"learning": (2.5, 1.5)},
            one_number_per_particle={"one_number": True},
        ),
    ),
    Ablation(
        "ur5-smwoa",
        "SMWOA",
        "WOA",
        _switched(
            _WHALES,
            arctanh_a={"arctanh": True},
            fitness_weight={"weighted": True},
            oscillation={"oscillating": True},
        ),
    ),
    Ablation(
        "ur5-tadf-ssa",
        "TADF-SSA",
        "SSA",
        _switched(
            SSA(),
            Tent_map_start={"start": "tent"},
            step_factor_beta={"adaptive_beta": True},
            step_factor_K={"adaptive_k": True},
        ),
    ),
    Ablation(
        "puma560-chaotic-spso",
        "chaotic SPSO",
        "PSO with the middle of the inertia's range held: 0.65, learning factors 2",
        _switched(
            _CHAOTIC,
            chaotic_start={"chaotic_start": True},
            falling_inertia={"inertia": (0.9, 0.4)},
            asynchronous_learning_factors={"asynchronous": True},
        )
        | {"inertia as printed": replace(_CHAOTIC, reading=PaperReading.AS_PRINTED)},
    ),
)


def ablation_jobs(cases: Sequence[Case], effort: Effort) -> list[TrialJob]:
    """List every form of every paper's search on the paper's own cases, the audit's cases and the functions."""
    audited = set(effort.audited([case.name for case in cases]))
    jobs: list[TrialJob] = []
    for ablation in ABLATIONS:
        chosen = [case for case in cases if case.name in audited or case.paper == ablation.paper]
        for form, search in ablation.forms.items():
            jobs += _form_jobs(f"{ablation.paper}: {form}", search, chosen, effort)
    return jobs


def _form_jobs(name: str, search: Search[Any], cases: Sequence[Case], effort: Effort) -> list[TrialJob]:
    n, population = effort.trial_evaluations, effort.population
    jobs: list[TrialJob] = []
    for case in cases:
        trial = Trial(name, case.name, tasks.AS_IT_IS, 0, n, population, formulation="penalty")
        jobs += repeated(trial, search, effort.trial_seeds, case.problem, case.curve)
    for function in FUNCTIONS:
        for view in VIEWS:
            trial = Trial(name, function, view, 0, population * effort.generations, population, effort.dimensions)
            jobs += repeated(trial, search, effort.trial_seeds)
    return jobs


@dataclass(frozen=True)
class AblationFinding:
    """What one improvement does by itself on one task, against the plain search on paired seeds.

    Attributes
    ----------
    paper, improvement, task, view : str
    trajectory : bool
        Whether the task is a trajectory problem; otherwise a function.
    plain, improved : float
        Median results: total time in s, or error.
    a12 : float
        Probability that a run with the improvement ends lower.
    difference : Interval
        Median of improved minus plain, as a share of the plain median for trajectories, in decades for functions.
    p : float
        Signed rank, adjusted by Holm for the forms of the same paper on the same view of the same task.
    """

    paper: str
    improvement: str
    task: str
    view: str
    trajectory: bool
    plain: float
    improved: float
    a12: float
    difference: Interval
    p: float

    @property
    def effect(self) -> str:
        """`helps`, `harms` or `none`: large by A12, significant, and with an interval that excludes zero."""
        strong = max(self.a12, 1 - self.a12) >= statistics.LARGE and self.p < audit.SIGNIFICANT
        if not (strong and self.difference.excludes_zero):
            return "none"
        return "helps" if self.a12 > 0.5 else "harms"


def ablation_findings(outcomes: audit.Outcomes) -> list[AblationFinding]:
    """Compare every form with the plain one on every task."""
    values = audit.grouped(outcomes)
    found = []
    for ablation in ABLATIONS:
        for form in [*ablation.improvements, WHOLE]:
            for (name, task, formulation, view), plain in values.items():
                improved = values.get((f"{ablation.paper}: {form}", task, formulation, view))
                if name == f"{ablation.paper}: {PLAIN}" and improved is not None:
                    found.append(_finding((ablation.paper, form, task, view), bool(formulation), plain, improved))
    families: dict[tuple[str, str, str], list[AblationFinding]] = {}
    for one in found:
        families.setdefault((one.paper, one.task, one.view), []).append(one)
    return [
        replace(one, p=float(p))
        for family in families.values()
        for one, p in zip(family, statistics.holm([member.p for member in family]), strict=True)
    ]


def _finding(
    what: tuple[str, str, str, str], trajectory: bool, plain: np.ndarray, improved: np.ndarray
) -> AblationFinding:
    if trajectory:
        first, second = improved / np.median(plain), plain / np.median(plain)
    else:  # errors span hundreds of decades
        first, second = (np.log10(np.maximum(values, audit.FLOOR)) for values in (improved, plain))
    return AblationFinding(
        *what,
        trajectory,
        float(np.median(plain)),
        float(np.median(improved)),
        statistics.a12(first, second),
        statistics.median_difference(first, second),
        statistics.signed_rank(first, second),
    )
