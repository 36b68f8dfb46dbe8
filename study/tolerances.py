"""Every tolerance of the judge and the planners, in one place: a relative part and an absolute floor.

A rate may exceed its limit by one part in a million. A position may be off by one part in a million of the joint's span over
the waypoints, but the floor is granted in any case: a nanometre or a nanoradian, plus what rounding does to large positions.
A joint whose waypoints span no more than the floor is still: it carries no intended motion, only noise.
"""

from __future__ import annotations

import numpy as np

from study.arrays import Floats

TOLERANCE = 1e-6
"""Largest relative excess over a limit that still counts as rounding."""

ENCLOSED = 1e-3
"""Relative width to which the largest torques and rates of the tool are enclosed; whether they keep a limit is settled by
`TOLERANCE` all the same."""

FLOOR = 1e-9
"""Distance below which a position does not count, rad or m."""

ROUNDING = 1e-13
"""Part of a joint's largest position that rounding may add to the floor."""


def floors(waypoints: Floats) -> Floats:
    """Smallest distance that counts, shape (n_joints,), rad or m, for waypoints of shape (n_waypoints, n_joints)."""
    return FLOOR + ROUNDING * np.abs(waypoints).max(axis=0)
