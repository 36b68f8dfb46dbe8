"""Waypoints of one's own, from a recording to the problem: columns, places, demands that move along, and what is said of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import Any

import numpy as np

from study.cases.own_demands import tightest
from study.cases.own_file import OwnCase
from study.errors import listed
from study.io.limits import LimitFile
from study.io.one_joint import OneJoint
from study.io.samples import Samples
from study.io.waypoints import Tidied, tidied, unwound, within
from study.problem import Floats, JointLimits, Problem

RECORDED = 20
"""More waypoints than this were recorded, not chosen: with a tolerance, those that say nothing new are left out."""

STILL = 1e-6
"""Span of a recorded joint, in the file's units, below which it stands still."""


def chosen_columns(file: OwnCase, rows: Samples, limits: LimitFile) -> Samples:
    """Columns of a recording that are planned, with a note for each that is not.

    Left out are joints that follow another one, and, unless the case names its joints, those that stand still and have no
    limits in any file. Numbered columns are taken in their order.
    """
    read, owned = (
        limits.joints,
        file.joints or [file.limits.velocity, file.limits.acceleration, file.limits.jerk] != [None] * 3,
    )
    if file.joints or read:
        rows = rows.numbered(file.joints or read)
    notes, left = list[str](), set[str]()
    with np.errstate(over="ignore"):  # too large numbers are refused later, by their place
        spans = np.ptp(rows.positions, axis=0)
    for name, span in zip(rows.names, spans, strict=bool(rows.names)):
        if limits.followers.get(name) in rows.names:
            notes.append(f"not used: column {name!r}, which follows {limits.followers[name]!r}")
        elif read and not owned and name not in read and span <= STILL:
            notes.append(f"not used: column {name!r}, which stands still and has no limits")
        else:
            continue
        left.add(name)
    if left and len(left) < len(rows.names):
        return rows.of([name for name in rows.names if name not in left], "the file").noting(*notes)
    if not rows.names and not file.joints and len(read) == rows.positions.shape[1]:
        return rows.noting(f"the columns were taken in the order of the limits: {', '.join(read)}")
    return rows


def unused_columns(file: OwnCase, rows: Samples, names: Sequence[str]) -> list[str]:
    """Say which columns and that rates of a recording are not used; at the ends rates may be meant."""
    left = [repr(name) for name in rows.names if name not in names]
    notes = [f"not used: column {', '.join(left)}, not among the joints"] if left else []
    if rows.velocities is None and rows.accelerations is None:
        return notes
    moving = rows.velocities is not None and (np.abs(rows.velocities[[0, -1]]) > 1e-6).any()
    hint = "; it begins or ends in motion: for that give 'start' or 'finish'"
    return [
        *notes,
        "times and rates are not used, only positions" + hint * bool(moving and not (file.start or file.finish)),
    ]


def placed(
    file: OwnCase, table: Floats, known: Sequence[OneJoint], bounds: JointLimits, names: Sequence[str]
) -> tuple[Floats, list[str]]:
    """Unwind joints that turn without end, and put waypoints that rounding moved out of a range onto its end."""
    endless = np.array([bool(joint.endless) and file.unwrap for joint in known]) & ~np.isfinite(
        [bounds.lower, bounds.upper]
    ).any(0)
    table, notes = unwound(table, endless, names)
    table, more = within(table, bounds.lower, bounds.upper, names)
    return table, notes + more


def tidied_demands(file: OwnCase, table: Floats, demands: dict[str, Any], where: str) -> tuple[Tidied, dict[str, Any]]:
    """Merge and thin the waypoints, and let the demands at waypoints move with them."""
    asked, n_waypoints = {*demands["stops"], *demands["dwells"]}, len(table)
    tolerance = demands["tolerance"]
    if not asked <= set(range(1, n_waypoints - 1)) or (tolerance is not None and len(tolerance) != n_waypoints):
        order = np.arange(n_waypoints)
        return Tidied(table, order, order), demands  # which the problem refuses by the numbers of the file
    needed = {
        *demands["stops"],
        *demands["dwells"],
        *(k - 1 for part in file.segments for k in (part.first, part.last)),
    }
    radius = tolerance.min(axis=0) if tolerance is not None and len(table) > RECORDED else None
    kept = tidied(table, radius, needed, where)
    inner = range(1, len(kept.kept) - 1)
    moved = {
        "stops": [k for k in (int(kept.place[k]) for k in demands["stops"]) if k in inner],
        "dwells": {int(kept.place[k]): time for k, time in demands["dwells"].items()},
        "tolerance": None if tolerance is None else tolerance[kept.kept],
    }
    return kept, demands | moved


def moved_segments(limits: Mapping[int, JointLimits], kept: Tidied) -> dict[int, JointLimits]:
    """Limits of segments by their new numbers; a segment between merged waypoints has none."""
    result: dict[int, JointLimits] = {}
    for segment, bounds in limits.items():
        place, after = int(kept.place[segment]), int(kept.place[segment + 1])
        if after > place or segment not in kept.kept:
            result[place] = tightest(result.get(place, bounds), bounds)
    return {segment: bounds for segment, bounds in result.items() if segment < len(kept.kept) - 1}


def stepping_ends(file: OwnCase, problem: Problem) -> list[str]:
    """Say that an acceleration that is asked for at an end may be left in an instant by joints without a limit of jerk."""
    asked = [state for state in (file.end, file.start, file.finish) if state is not None]
    smooth = any(state == "smooth" or getattr(state, "acceleration", None) is not None for state in asked)
    free = problem.moving & ~np.isfinite(problem.limits.jerk)
    names = [name for name, loose in zip(problem.joint_names, free, strict=True) if loose]
    if not smooth or not names:
        return []
    return [
        f"the acceleration asked for at an end needs a jerk limit to be felt: without one that of {listed(names)} steps there"
    ]


def unlimited_joints(problem: Problem, read: Mapping[str, OneJoint]) -> list[str]:
    """Name joints that move without a limit of velocity; in their file another name may have been meant."""
    notes = []
    for joint in map(int, np.flatnonzero(problem.moving & ~np.isfinite(problem.limits.velocity))):
        name = problem.joint_names[joint]
        near = (
            get_close_matches(name, set(read) - set(problem.joint_names), n=1, cutoff=0.7) if name not in read else []
        )
        hint = f"; in the files of limits, did you mean {near[0]!r}?" if near else ""
        notes.append(f"joint {name!r} moves but has no limit of velocity{hint}")
    return notes
