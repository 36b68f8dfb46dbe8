"""Search of the PUMA560 paper (RRT and chaotic PSO, 2024) with its constants; what it does not print is marked ours.

References
----------
PUMA560 paper, Section 3.3.
"""

from __future__ import annotations

from study.planners.segment_times import SegmentTimePlanner
from study.search.bounds import BoundsRule
from study.search.chaotic_spso import ChaoticSPSO
from study.search.pso import ClampUnit, VelocityUpdate

_SEARCH = ChaoticSPSO(
    inertia=(0.9, 0.4),  # ours: Section 3.3.2 names w_max and w_min, no values
    exponents=(3.0, 5.0),  # Section 3.3.2: alpha, beta
    stage=0.6,  # Section 3.3.2
    cognitive=(2.5, 0.5),  # Section 3.3.2: c1 start, end
    social=(0.5, 2.5),  # Section 3.3.2: c2 start, end
    velocity=VelocityUpdate(clamp=0.2, unit=ClampUnit.SHARE, bounds=BoundsRule.CLIP),  # ours
)

CHAOTIC_SPSO = SegmentTimePlanner(
    _SEARCH, "particle swarm with a chaotic start and weights that change in two stages, of the PUMA560 paper"
)
CHAOTIC_SPSO_AS_PRINTED = CHAOTIC_SPSO.as_printed()
