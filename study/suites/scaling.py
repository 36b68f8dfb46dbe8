"""The suite of growth: random waypoints, so that segments and joints alone change."""

from __future__ import annotations

import numpy as np

from study.problem import JointLimits
from study.suites.drawn import Drawn

SEGMENTS, JOINTS = (3, 5, 9, 19, 49, 99, 199), (1, 2, 4, 10, 14)
USUAL_JOINTS, USUAL_SEGMENTS = 7, 9
INSTANCES = "abc"
VELOCITY, ACCELERATION, JERK, HALF = 1.5, 5.0, 50.0, 1.5
"""Limits of every joint, rad/s, rad/s^2, rad/s^3, and half the span of the waypoints, rad."""

QUICK_SEGMENTS = 49
QUICK = "quick"
"""Tag of the problems of the quick run."""


def problems(seed: int) -> list[Drawn]:
    """Draw the suite: three instances of every number of segments, two of every number of joints, each with and without
    jerk limits on the same waypoints."""
    sizes = [(n, USUAL_JOINTS, letter) for n in SEGMENTS for letter in INSTANCES]
    sizes += [(USUAL_SEGMENTS, n, letter) for n in JOINTS for letter in INSTANCES[:2]]
    return [_problem(seed, *size, jerk) for size in sizes for jerk in (False, True)]


def _problem(seed: int, n_segments: int, n_joints: int, letter: str, jerk: bool) -> Drawn:
    rng = np.random.default_rng([seed, n_segments, n_joints, INSTANCES.index(letter)])
    full = np.full(n_joints, 1.0)
    limits = JointLimits(VELOCITY * full, ACCELERATION * full, JERK * full if jerk else None)  # type: ignore[arg-type]
    quick = n_joints == USUAL_JOINTS and n_segments <= QUICK_SEGMENTS and not jerk
    tags = ("random", "jerk" if jerk else "no jerk", f"{n_joints} joints", f"{n_segments} segments")
    ours = "ours: one limit for all joints, as in the first look at growth"
    return Drawn(
        f"s{n_segments}-j{n_joints}-{letter}{'-jerk' if jerk else ''}",
        f"study/suites/scaling.py, seed {seed}",
        "random waypoints",
        (*tags, QUICK) if quick else tags,
        None,
        ("rad",) * n_joints,
        limits,
        dict.fromkeys(("velocity", "acceleration", "jerk"), ours),
        rng.uniform(-HALF, HALF, (n_segments + 1, n_joints)),
    )
