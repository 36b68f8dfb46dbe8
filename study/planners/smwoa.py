"""The UR5 paper's planner, SMWOA, and the searches that it is compared with.

References
----------
UR5 paper on SMWOA, Sections 2-4 and Tables 3 and 6.
"""

from __future__ import annotations

import math

from study.planners.segment_times import SegmentTimePlanner
from study.search.de import DE
from study.search.gsa import GSA
from study.search.sma import SMA
from study.search.smwoa import SMWOA
from study.search.woa import WOA

SMWOA_PLANNER = SegmentTimePlanner(SMWOA(), "whale search with parts of slime mould search, of the UR5 paper")
# The exact zeros and the 1e-33 for Rosenbrock's function of Table 3 are out of reach of Eqs. (12)-(15) alone.
SMWOA_WITH_BRANCHES = SegmentTimePlanner(
    SMWOA(restart_share=0.03, shrinking=True),
    SMWOA_PLANNER.about + ", with two more branches of slime mould search that the paper's text does not have",
)
SMWOA_AS_PRINTED = SMWOA_PLANNER.as_printed(log_base=math.e)
WOA_PLANNER = SegmentTimePlanner(WOA(), "whale search")
SMA_PLANNER = SegmentTimePlanner(SMA(), "slime mould search")
SMA_AS_PRINTED = SMA_PLANNER.as_printed(log_base=math.e)
GSA_PLANNER = SegmentTimePlanner(GSA(), "gravitational search")
DE_PLANNER = SegmentTimePlanner(DE(), "differential evolution")
