"""Planners that no paper claims: the standard particle swarm and random search."""

from __future__ import annotations

from study.planners.segment_times import SegmentTimePlanner
from study.search.pso import PSO, Flight
from study.search.random_search import RandomSearch

PSO_STANDARD = SegmentTimePlanner(
    PSO(
        inertia=(0.9, 0.4),  # Shi and Eberhart 1998
        cognitive=2.0,  # Kennedy and Eberhart 1995
        social=2.0,
        flight=Flight(clamp=0.2, unit="share", bounds="clip"),  # ours
    )
)

RANDOM_SEARCH = SegmentTimePlanner(RandomSearch())
