"""Searches of the woodworking paper (GoldS-PSO, 2023) with its constants; what it does not print is marked ours.

References
----------
Woodworking paper, Sections 2.3 to 2.5 and 3.2.
"""

from __future__ import annotations

import numpy as np

from study.planners.segment_times import SegmentTimePlanner
from study.search.bounds import BoundsRule
from study.search.cfpso import CFPSO
from study.search.gold_sa import GoldSA
from study.search.golds_pso import GoldSPSO
from study.search.pso import PSO, ClampUnit, VelocityUpdate
from study.search.simple_pso import SimplePSO

_GOLDS_PSO = GoldSPSO(
    inertia=(0.9, 0.4),  # ours: eq. (24) names w_max and w_min, no values
    cognitive=2.0,  # ours
    social=2.0,  # ours
    acceleration=0.5,  # ours: lambda of eq. (30)
    bounds=BoundsRule.CLIP,  # Section 2.4.3, Step 5
)
_GOLD_SA = GoldSA(interval=(-np.pi, np.pi), bounds=BoundsRule.CLIP)  # Section 2.4.3: initial a and b

GOLDS_PSO = SegmentTimePlanner(
    _GOLDS_PSO, "particle swarm without velocities, with a golden sine step, of the woodworking paper"
)
GOLDS_PSO_AS_PRINTED = GOLDS_PSO.as_printed()
GOLD_SA = SegmentTimePlanner(_GOLD_SA, "golden sine search")
GOLD_SA_AS_PRINTED = GOLD_SA.as_printed()

PSO_BASIC = SegmentTimePlanner(
    PSO(
        inertia=(1.0, 1.0),  # Section 2.3: the basic PSO has w = 1
        cognitive=1.49445,  # ours: not printed, explains Table 3
        social=1.49445,
        velocity=VelocityUpdate(
            clamp=3.0, unit=ClampUnit.ABSOLUTE, bounds=BoundsRule.CLIP
        ),  # clamp ours (explains Table 3), box from Section 3.2
    ),
    "particle swarm with constant weights, as the woodworking paper describes the basic one",
)
CF_PSO = SegmentTimePlanner(
    CFPSO(
        cognitive=2.05,  # Clerc and Kennedy 2002
        social=2.05,
        velocity=VelocityUpdate(
            clamp=0.5, unit=ClampUnit.SHARE, bounds=BoundsRule.CLIP
        ),  # Eberhart and Shi 2000; bounds rule ours
    ),
    "particle swarm with a constriction factor",
)
SIMPLE_PSO = SegmentTimePlanner(
    SimplePSO(
        inertia=(0.9, 0.4), cognitive=2.0, social=2.0, bounds=BoundsRule.CLIP
    ),  # eq. (22); values after Hu and Li 2007
    "particle swarm without velocities",
)
