"""Straight lines from waypoint to waypoint and the blends at their corners, for `baselines.path_timing.straight`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from baselines.base import along, segment_rates
from study.errors import StudyError
from study.problem import Floats, Problem, StraightPath

Places = NDArray[np.intp]

SAFE = 1 - 1e-9
"""Part of the room at a corner that a blend may use; the rest is for rounding."""


class Change(NamedTuple):
    """Duration a + b of a change of velocity, s; arrays of one shape."""

    a: Floats
    b: Floats

    @classmethod
    def of(cls, acceleration: Floats, jerk: Floats) -> Change:
        """Fastest change, given the change over the acceleration limit, s, and over the jerk limit, s^2."""
        a = np.maximum(np.sqrt(jerk), acceleration)
        return cls(a, over(jerk, a))

    @property
    def time(self) -> Floats:
        """Duration, s."""
        return self.a + self.b

    @property
    def deviation(self) -> Floats:
        """Distance from the corner in the middle of a blend, over its change of velocity, s."""
        return self.a / 8 + over(self.b**2, 24 * self.a)


def over(dividend: Floats, divisor: Floats) -> Floats:
    """Quotient; zero where the divisor is."""
    return np.divide(dividend, divisor, out=np.zeros_like(dividend), where=divisor > 0)


class Lines(NamedTuple):
    """Lines with scalar limits along them, arrays of one shape: length, speed, acceleration forwards and back, jerk."""

    length: Floats
    speed: Floats
    faster: Floats
    slower: Floats
    jerk: Floats

    def take(self, index: Places) -> Lines:
        """Some of the lines."""
        return Lines(*(part[index] for part in self))

    def ramps(self, first: Floats, top: Floats, last: Floats) -> tuple[Change, Change]:
        """Change from the first speed to the top one, and from there to the last one."""
        up, down = top - first, top - last
        return Change.of(up / self.faster, up / self.jerk), Change.of(down / self.slower, down / self.jerk)

    def covered(self, first: Floats, top: Floats, last: Floats) -> Floats:
        """Distance that both changes need."""
        up, down = self.ramps(first, top, last)
        return 0.5 * ((first + top) * up.time + (top + last) * down.time)

    def suffice(self, room: Floats, first: Floats, last: Floats) -> NDArray[np.bool_]:
        """Whether a distance is long enough to change from one speed to another."""
        slack = 1e-13 * self.length
        return np.asarray(self.covered(first, np.maximum(first, last), last) <= room + slack) & (room >= -slack)

    def top(self, room: Floats, first: Floats, last: Floats, halvings: int) -> Floats:
        """Largest speed for which a distance that suffices does so too."""
        low, high = np.maximum(first, last), np.broadcast_to(self.speed, first.shape)
        low = np.where(self.covered(first, high, last) <= room, high, low)
        for _ in range(halvings):
            middle = 0.5 * (low + high)
            fits = self.covered(first, middle, last) <= room
            low, high = np.where(fits, middle, low), np.where(fits, high, middle)
        return low

    def times(self, room: Floats, first: Floats, last: Floats) -> Floats:
        """Shortest time for a distance between two speeds, s, nearly; infinite where it does not suffice."""
        top = self.top(room, first, last, 25)
        up, down = self.ramps(first, top, last)
        rest = np.maximum(room - self.covered(first, top, last), 0.0)
        return np.where(self.suffice(room, first, last), up.time + down.time + over(rest, top), np.inf)


class Polyline:
    """Straight lines through the waypoints of a problem, with the limits along them and at their corners.

    Speeds have shape (2, ..., n_waypoints): before and behind every waypoint.

    Parameters
    ----------
    problem : Problem

    Raises
    ------
    StudyError
        If no limit holds what moves along a line.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem, n = problem, problem.n_segments
        places = np.arange(n + 1)
        self.before, self.behind = np.maximum(places - 1, 0), np.minimum(places, n - 1)
        self.inner = (places > 0) & (places < n)
        steps = np.diff(problem.waypoints, axis=0)
        length = np.linalg.norm(steps, axis=1)
        self.directions = steps / np.where(length > 0, length, 1.0)[:, None]
        lowest, highest = segment_rates(problem)
        self.lowest = np.maximum(lowest[:, self.before], lowest[:, self.behind])
        self.highest = np.minimum(highest[:, self.before], highest[:, self.behind])
        forwards = [along(self.directions, lowest[k], highest[k]) for k in range(3)]
        back = [along(-self.directions, lowest[k], highest[k]) for k in range(3)]
        self.lines = Lines(length, forwards[0], forwards[1], back[1], np.minimum(forwards[2], back[2]))
        self.lines = self.lines._replace(speed=_bounded(problem, self.lines))
        self.largest = self._largest_speeds()

    def _largest_speeds(self) -> Floats:
        """Limits of the speeds, shape (2, n_waypoints); 0 where the motion stops."""
        problem, low, high = self.problem, self.lowest[0], self.highest[0]
        sides = (self.before, self.behind)
        speeds = np.stack([np.minimum(along(self.directions[s], low, high), self.lines.speed[s]) for s in sides])
        short = np.flatnonzero(self.lines.length == 0)
        walled = [k for k, limits in problem.segment_limits.items() if np.isfinite([limits.lower, limits.upper]).any()]
        corners = [
            *problem.stops,
            *problem.dwells,
            *(c for k in (*short, *walled) for c in (k, k + 1) if self.inner[c]),
        ]
        speeds[:, corners] = 0.0
        for place, state in zip((0, -1), problem.end_states, strict=True):
            if state.velocity is not None:
                speeds[:, place] = 0.0
        return speeds

    def blends(self, corners: Places, speeds: Floats) -> tuple[Change, NDArray[np.bool_]]:
        """Blends at some waypoints and whether they have the room, for speeds of shape (2, n_tries, n_corners)."""
        arriving = self.directions[self.before[corners]] * speeds[0][..., None]
        leaving = self.directions[self.behind[corners]] * speeds[1][..., None]
        low, high, inner = self.lowest[:, corners], self.highest[:, corners], self.inner[corners]
        turn = np.where(inner[:, None], leaving - arriving, 0.0)
        acceleration = 1 / along(turn, low[1], high[1])
        jerk = np.maximum(1 / along(turn, low[2], high[2]), 1 / along(-turn, low[2], high[2]))
        change = Change.of(acceleration, jerk)
        away, granted = self._room(corners, change, arriving, leaving)
        return change, (away <= SAFE * granted).all(axis=-1) | ~inner

    def _room(self, corners: Places, change: Change, arriving: Floats, leaving: Floats) -> tuple[Floats, Floats]:
        """Distance from the corner, of all the blend on a straight path and else of its middle, and what is granted."""
        path, n = self.problem.path, self.problem.n_joints
        if isinstance(path, StraightPath):
            away = 0.5 * change.time[..., None] * np.maximum(np.abs(arriving), np.abs(leaving))
            return np.where(change.time[..., None] > 0, away, 0.0), np.broadcast_to(path.of(n), (len(corners), n))
        granted = self.problem.tolerances[corners]
        granted = granted if path is None else np.minimum(granted, path.of(n))
        return change.deviation[..., None] * np.abs(leaving - arriving), granted

    def times(self, corners: Places, tries: Floats, speeds: Floats, ends: Floats) -> Floats:
        """Time that tries at some waypoints, no two of them neighbours, take there and on the lines next to them, s.

        Parameters
        ----------
        corners : int array of shape (n_corners,)
        tries : array of shape (2, n_tries, n_corners)
        speeds, ends : arrays of shape (2, n_waypoints)
            Speeds of the others, and the distances that their blends take from the lines.
        """
        change, fits = self.blends(corners, tries)
        own = 0.5 * change.time * tries
        left, right, n = corners > 0, corners < self.problem.n_segments, self.problem.n_segments
        before, behind = self.lines.take(self.before[corners]), self.lines.take(self.behind[corners])
        last, after = np.maximum(corners - 1, 0), np.minimum(corners + 1, n)
        there = before.times(before.length - own[0] - ends[1, last], speeds[1, last] + 0 * tries[0], tries[0])
        onwards = behind.times(behind.length - own[1] - ends[0, after], tries[1], speeds[0, after] + 0 * tries[1])
        time = np.where(left, there, 0.0) + np.where(right, onwards, 0.0) + change.time
        return np.where(fits, time, np.inf)


def _bounded(problem: Problem, lines: Lines) -> Floats:
    """Limits of speed, or where there is none a speed that the whole length of the lines does not allow from rest."""
    room, moves = lines.length.sum(), lines.length > 0
    with np.errstate(invalid="ignore", over="ignore"):
        each = np.minimum(np.sqrt(2 * lines.faster * room), (room * np.sqrt(lines.jerk)) ** (2 / 3))
    fastest = np.where(moves & np.isfinite(each), each, 0.0).max()
    speed = np.where(np.isfinite(lines.speed), lines.speed, np.minimum(each, max(fastest, each.min())))
    if not np.isfinite(speed[moves]).all():
        segment = int(np.argmax(~np.isfinite(speed) & moves))
        raise StudyError(f"nothing limits what moves from waypoint {segment + 1} to {segment + 2}")
    return np.where(moves, speed, 1.0)
