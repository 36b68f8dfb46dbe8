"""The improvements of the papers' searches: each by itself on the same plain search, and all together.

References
----------
Woodworking paper, Section 2.4; AUBO paper, Eqs. (13)-(15); UR5 paper on SMWOA, Section 3; improved sparrow paper,
Section 4; PUMA560 paper, Section 3.3.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from study.search.chaotic_spso import ChaoticSPSO
from study.search.dynamic_adaptive_pso import DynamicAdaptivePSO
from study.search.golds_pso import GoldSPSO
from study.search.reading import PaperReading
from study.search.smwoa import SMWOA
from study.search.ssa import SSA
from study.search.state import Search

PLAIN, WHOLE = "plain", "all together"


@dataclass(frozen=True)
class Ablation:
    """A paper's search taken apart.

    Attributes
    ----------
    paper : str
        Key of the paper.
    title : str
    plain : str
        The search without its improvements.
    forms : mapping of str to Search
        `plain`, an entry for every improvement by itself, and `all together`.
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
            _WHALES, arctanh_a={"arctanh": True}, fitness_weight={"weighted": True}, oscillation={"oscillating": True}
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
