"""Recorded waypoints made ready for planning: repeated ones merged, full turns unwound, noise thinned out."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from study.errors import StudyError, plural
from study.problem import Floats
from study.tolerances import floors

MERGED = 1e-9
"""Part of the longest joint's span below which neighbours are the same place."""

ROUNDED = 1e-4
"""Distance beyond a limit that four decimals, rounded or cut off, or two decimals of degrees explain, rad or m."""


@dataclass(frozen=True, eq=False)
class Tidied:
    """Waypoints that are left, and where the others went.

    Attributes
    ----------
    waypoints : array of shape (n_kept, n_joints), rad or m
    kept : int array of shape (n_kept,)
        Index of each among the waypoints as they came.
    place : int array of shape (n_waypoints,)
        Index, among those that are left, of the waypoint that stands for each; of the one before it where it was thinned out.
    notes : tuple of str
    """

    waypoints: Floats
    kept: NDArray[np.int_]
    place: NDArray[np.int_]
    notes: tuple[str, ...] = ()


def tidied(waypoints: Floats, radius: Floats | None, needed: Collection[int], where: str) -> Tidied:
    """Merge equal and nearly equal neighbours, then leave out waypoints close to the straight lines between others.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    radius : array of shape (n_joints,), rad or m, optional
        Distance from those lines within which a waypoint is left out; none is by default.
    needed : collection of int
        Indices of waypoints that stay, because something is asked for there.
    where : str
        How a message begins.

    Raises
    ------
    StudyError
        If fewer than two waypoints are left.
    """
    near = np.maximum(MERGED * float(np.ptp(waypoints, axis=0).max()), floors(waypoints))
    kept, place = [0], [0]
    steps = np.abs(np.diff(waypoints, axis=0))
    apart = np.asarray((steps > near).any(axis=1)).tolist()  # at once: recordings have many rows
    for index in range(1, len(waypoints)):
        if apart[index - 1] if kept[-1] == index - 1 else (np.abs(waypoints[index] - waypoints[kept[-1]]) > near).any():
            kept.append(index)
        place.append(len(kept) - 1)
    notes = _merging(len(waypoints) - len(kept), place)
    if len(kept) < 2:
        raise StudyError(f"{where}: all waypoints are the same place; a motion needs at least two places")
    chosen, places = np.array(kept), np.array(place)
    if radius is not None and (radius > 0).any():
        stay = _thinned(waypoints[chosen], radius, {int(places[index]) for index in needed})
        if not stay.all():
            dropped = int((~stay).sum())
            notes.append(
                f"{dropped} of {len(stay)} waypoints were left out: within the tolerance they lie on the lines between others"
            )
        places, chosen = (np.cumsum(stay) - 1)[places], chosen[stay]
    return Tidied(waypoints[chosen], chosen, places, tuple(notes))


def _merging(count: int, place: Sequence[int]) -> list[str]:
    if not count:
        return []
    first = next(k for k in range(1, len(place)) if place[k] == place[k - 1])
    more = f", and {count - 1} more" if count > 1 else ""
    return [
        f"waypoints {first} and {first + 1} are the same place and were taken as one{more}; "
        "to stand still there, name it under 'stops' or 'dwells'"
    ]


def _thinned(waypoints: Floats, radius: Floats, needed: Collection[int]) -> NDArray[np.bool_]:
    """Mark the waypoints that stay: the fewest that halving finds (Ramer, 1972; Douglas and Peucker, 1973)."""
    unit = waypoints / np.where(radius > 0, radius, np.finfo(float).tiny)
    stay = np.zeros(len(waypoints), dtype=bool)
    ends = sorted({0, len(waypoints) - 1, *needed})
    stay[ends] = True
    parts = list(pairwise(ends))
    while parts:
        first, last = parts.pop()
        if last - first < 2:
            continue
        line = unit[last] - unit[first]
        inner = unit[first + 1 : last] - unit[first]
        share = np.clip(inner @ line / max(float(line @ line), np.finfo(float).tiny), 0.0, 1.0)
        distance = np.abs(inner - share[:, None] * line).max(axis=1)
        if distance.max() > 1.0:
            middle = first + 1 + int(distance.argmax())
            stay[middle] = True
            parts += [(first, middle), (middle, last)]
    return stay


def unwound(waypoints: Floats, endless: NDArray[np.bool_], names: Sequence[str]) -> tuple[Floats, list[str]]:
    """Let joints that turn without end take the short way round from every waypoint to the next.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    endless : array of bool of shape (n_joints,)
    names : sequence of str

    Returns
    -------
    array of shape (n_waypoints, n_joints)
    list of str
        One sentence for each joint that was changed.
    """
    short = np.unwrap(waypoints, axis=0)
    chosen = np.where(endless, short, waypoints)
    changed = np.abs(chosen - waypoints) > 1.0
    notes = [
        f"joint {names[joint]!r} turns without end and takes the short way round before waypoint "
        f"{int(changed[:, joint].argmax()) + 1}; 'unwrap: false' forbids it"
        for joint in map(int, np.flatnonzero(changed.any(axis=0)))
    ]
    return chosen, notes


def within(waypoints: Floats, lower: Floats, upper: Floats, names: Sequence[str]) -> tuple[Floats, list[str]]:
    """Move waypoints that rounding put just beyond a joint's range onto its end.

    Parameters
    ----------
    waypoints : array of shape (n_waypoints, n_joints), rad or m
    lower, upper : arrays of shape (n_joints,), rad or m
    names : sequence of str

    Returns
    -------
    array of shape (n_waypoints, n_joints)
    list of str
        One sentence for each joint that was moved.
    """
    inside = np.clip(waypoints, lower, upper)
    moved = (inside != waypoints) & (np.abs(inside - waypoints) <= ROUNDED)
    notes = [
        f"{plural(int(moved[:, joint].sum()), 'waypoint')} of joint {names[joint]!r} lay up to "
        f"{np.abs(inside - waypoints)[moved[:, joint], joint].max():.1e} beyond the end of its range and were put onto it"
        for joint in map(int, np.flatnonzero(moved.any(axis=0)))
    ]
    return np.where(moved, inside, waypoints), notes
