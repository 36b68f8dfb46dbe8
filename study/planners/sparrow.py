"""The improved sparrow paper's planner, TADF-SSA, and the three searches that it is compared with.

References
----------
Improved sparrow paper, Section 5, Table 5; the shares of producers and scouts and the safety threshold are Section 5's.
"""

from __future__ import annotations

from study.planners.segment_times import SegmentTimePlanner
from study.search.ssa import SSA

SSA_PLANNER = SegmentTimePlanner(SSA())
T_SSA = SegmentTimePlanner(SSA(start="tent"))
ADF_SSA = SegmentTimePlanner(SSA(adaptive_beta=True, adaptive_k=True))
TADF_SSA = SegmentTimePlanner(SSA(start="tent", adaptive_beta=True, adaptive_k=True))

SSA_AS_PRINTED = SegmentTimePlanner(SSA(reading="as-printed"))
T_SSA_AS_PRINTED = SegmentTimePlanner(SSA(reading="as-printed", start="tent"))
ADF_SSA_AS_PRINTED = SegmentTimePlanner(SSA(reading="as-printed", adaptive_beta=True, adaptive_k=True))
TADF_SSA_AS_PRINTED = SegmentTimePlanner(SSA(reading="as-printed", start="tent", adaptive_beta=True, adaptive_k=True))
