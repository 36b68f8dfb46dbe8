"""Search of the AUBO i5 paper (dynamic adaptive PSO, 2024) with its constants.

References
----------
AUBO paper, Section 4.
"""

from __future__ import annotations

from dataclasses import replace

from study.planners.segment_times import SegmentTimePlanner
from study.search.bounds import BoundsRule
from study.search.dynamic_adaptive_pso import DynamicAdaptivePSO
from study.search.pso import ClampUnit, VelocityUpdate
from study.search.reading import PaperReading

_SEARCH = DynamicAdaptivePSO(
    inertia=(0.9, 0.1),  # Section 4.3: w_max, w_min
    learning=(2.5, 1.5),  # Section 4.3: c_max, c_min
    one_number=True,  # eq. (15): rand(Pop, 1)
    velocity=VelocityUpdate(
        clamp=4.0, unit=ClampUnit.ABSOLUTE, bounds=BoundsRule.CLIP
    ),  # Section 4.3: velocities in [-4, 4]; bounds rule ours
)

_ABOUT = "particle swarm whose weights change with the generation, of the AUBO paper"

DYNAMIC_ADAPTIVE_PSO = SegmentTimePlanner(replace(_SEARCH, reading=PaperReading.AS_PRINTED), _ABOUT)
DYNAMIC_ADAPTIVE_PSO_FALLING = SegmentTimePlanner(_SEARCH, _ABOUT + ", with weights that fall as the text says")
DYNAMIC_ADAPTIVE_PSO_AS_PRINTED = DYNAMIC_ADAPTIVE_PSO.as_printed(start_inside=False)
