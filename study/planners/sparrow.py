"""The improved sparrow paper's planner, TADF-SSA, and the three searches that it is compared with.

References
----------
Improved sparrow paper, Section 5, Table 5; the shares of producers and scouts and the safety threshold are Section 5's.
"""

from __future__ import annotations

from study.planners.segment_times import SegmentTimePlanner
from study.search.ssa import SSA, Start

SSA_PLANNER = SegmentTimePlanner(SSA(), "sparrow search")
T_SSA = SegmentTimePlanner(SSA(start=Start.TENT, rescaled=True), "sparrow search with a chaotic start")
ADF_SSA = SegmentTimePlanner(SSA(adaptive_beta=True, adaptive_k=True), "sparrow search with adaptive steps")
TADF_SSA = SegmentTimePlanner(
    SSA(start=Start.TENT, rescaled=True, adaptive_beta=True, adaptive_k=True),
    "sparrow search with a chaotic start and adaptive steps, of the improved sparrow paper",
)

SSA_AS_PRINTED = SSA_PLANNER.as_printed()
T_SSA_AS_PRINTED = T_SSA.as_printed(rescaled=False)
ADF_SSA_AS_PRINTED = ADF_SSA.as_printed()
TADF_SSA_AS_PRINTED = TADF_SSA.as_printed(rescaled=False)
