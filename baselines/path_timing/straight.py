r"""Straight lines from waypoint to waypoint, their corners cut by blends; every limit is held exactly, jerk included.

On a line the motion is q_k + u_k s(t). At a corner the velocity changes by one scalar profile,

    q'(t) = p u_{k-1} (1 - g(t)) + c u_k g(t),

where g rises from 0 to 1 in a time a + b: its slope grows for a time b, stays at 1 / a for a - b and falls for b. So
jerk is constant in three pieces, and a change of velocity dv needs the acceleration dv / a and the jerk dv / (a b). The
blend begins (a + b) p / 2 before the corner and ends (a + b) c / 2 behind it. In its middle, where it is farthest from
the lines, it is dv (a / 8 + b^2 / (24 a)) away from the corner. A change of speed on a line has the same shape.

Only the speeds p and c at every corner are left to choose. A backward and a forward pass, as in the timing of a fixed
path, find large ones for which the lines are long enough; then every second corner at a time tries a little more and
less, and a stop, from there and from stops everywhere.

References
----------
L. Biagiotti, C. Melchiorri, Trajectory Planning for Automatic Machines and Robots, Springer 2008, sections 3.4 and 5.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from baselines.base import Deterministic, along, segment_rates, where_something_moves
from study.deadline import Deadline
from study.errors import StudyError
from study.planning import Freedom, Plan, RunSettings, Status
from study.problem import Demand, Floats, Problem, StraightPath
from study.trajectory import Trajectory

Places = NDArray[np.intp]

SAFE = 1 - 1e-9
"""Part of the room at a corner that a blend may use; the rest is for rounding."""

FIRST, LAST, SWEEPS = 0.2, 1e-6, 100
"""Change of speeds, as a share of the largest, with which the polish begins and ends, and its sweeps at most."""

TRIES = np.linspace(1.0, 0.0, 17)


class Change(NamedTuple):
    """Duration a + b of a change of velocity, s; arrays of one shape."""

    a: Floats
    b: Floats

    @classmethod
    def of(cls, acceleration: Floats, jerk: Floats) -> Change:
        """Fastest change, given the change over the acceleration limit, s, and over the jerk limit, s^2."""
        a = np.maximum(np.sqrt(jerk), acceleration)
        return cls(a, _over(jerk, a))

    @property
    def time(self) -> Floats:
        """Duration, s."""
        return self.a + self.b

    @property
    def deviation(self) -> Floats:
        """Distance from the corner in the middle of a blend, over its change of velocity, s."""
        return self.a / 8 + _over(self.b**2, 24 * self.a)


def _over(dividend: Floats, divisor: Floats) -> Floats:
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
        return np.where(self.suffice(room, first, last), up.time + down.time + _over(rest, top), np.inf)


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


def passed(line: Polyline) -> Floats:
    """Choose speeds, shape (2, n_waypoints), for which blends have room, and in two passes lines suffice."""
    n, places = line.problem.n_segments, np.arange(line.problem.n_waypoints)
    halves = [0.5 * line.lines.length[side] for side in (line.before, line.behind)]

    def alone(shares: Floats) -> NDArray[np.bool_]:
        speeds = line.largest[:, None] * shares
        change, fits = line.blends(places, speeds)
        own = 0.5 * change.time * speeds
        return fits & (own[0] <= halves[0]) & (own[1] <= halves[1])

    shares = _largest_shares(alone, np.ones(n + 1))
    for segments, moved in ((reversed(range(n)), 0), (range(n), 1)):
        for segment in segments:
            _shorten(line, shares, segment, moved)
    return line.largest * shares


def _shorten(line: Polyline, shares: Floats, segment: int, moved: int) -> None:
    """Lower the speeds at one end of a line, 0 or 1, until the line suffices."""
    pair = np.array([segment, segment + 1])
    lines = line.lines.take(np.array([segment]))

    def suffices(tries: Floats) -> NDArray[np.bool_]:
        both = np.broadcast_to(shares[pair], (len(tries), 2)).copy()
        both[:, moved] = tries[:, 0]
        speeds = line.largest[:, pair][:, None] * both
        change, _ = line.blends(pair, speeds)
        room = lines.length - 0.5 * (change.time[:, 0] * speeds[1, :, 0] + change.time[:, 1] * speeds[0, :, 1])
        return lines.suffice(room, speeds[1, :, 0], speeds[0, :, 1])[:, None]

    speeds = line.largest[(1, 0), pair] * shares[pair]
    if speeds[moved] > speeds[1 - moved] and not suffices(shares[pair[moved], None, None]).all():
        shares[pair[moved]] = _largest_shares(suffices, shares[pair[moved], None])[0]


def _largest_shares(fit: Callable[[Floats], NDArray[np.bool_]], most: Floats) -> Floats:
    """Largest shares, up to `most`, that fit, shape (n,), by narrowing; zero always does. `fit` takes (n_tries, n)."""
    low, high, columns = np.zeros_like(most), most, np.arange(len(most))
    for _ in range(6):
        tries = low + (high - low) * TRIES[:, None]
        fits = fit(tries)
        fits[-1] = True
        first = fits.argmax(axis=0)
        low, high = tries[first, columns], tries[np.maximum(first - 1, 0), columns]
    return low


def polished(line: Polyline, speeds: Floats, deadline: Deadline) -> Floats:
    """Try a little more and a little less at every second waypoint at a time, on both sides, as long as it helps."""
    moves = np.array(np.meshgrid(*[[0.0, 1.0, -1.0]] * 2)).reshape(2, 9, 1)
    groups = [np.arange(first, line.problem.n_waypoints, 2) for first in (0, 1)]
    groups = [group[line.largest[:, group].any(axis=0)] for group in groups]
    speeds, size, sweeps = speeds.copy(), FIRST, 0
    while size > LAST and sweeps < SWEEPS and not deadline.passed():
        before, sweeps = speeds.copy(), sweeps + 1
        for group in groups:
            change, _ = line.blends(np.arange(line.problem.n_waypoints), speeds[:, None])
            most = line.largest[:, None, group]
            tries = np.clip(speeds[:, None, group] + size * moves * most, 0.0, most)
            tries = np.concatenate([tries, 0.0 * most], axis=1)  # a stop, which may be shorter than a slow blend
            times = line.times(group, tries, speeds, 0.5 * change.time[0] * speeds)
            best = np.where(times.min(axis=0) < times[0] * (1 - 1e-12), times.argmin(axis=0), 0)
            speeds[:, group] = tries[:, best, np.arange(len(group))]
        size *= 1.0 if (speeds != before).any() else 0.4
    return speeds


def motion_of(line: Polyline, speeds: Floats) -> Trajectory:
    """Drive along the lines and through the blends with given speeds at the corners, shape (2, n_waypoints)."""
    problem, lines, u = line.problem, line.lines, line.directions
    places = np.arange(problem.n_waypoints)
    change, _ = line.blends(places, speeds[:, None])
    blend = Change(*(part[0] for part in change))
    cut = 0.5 * blend.time * speeds
    room = np.maximum(lines.length - cut[1, :-1] - cut[0, 1:], 0.0)
    first, last = speeds[1, :-1], speeds[0, 1:]
    top = lines.top(room, first, last, 60)
    up, down = lines.ramps(first, top, last)
    far = [0.5 * (first + top) * up.time, 0.5 * (top + last) * down.time]
    cruise = _over(np.maximum(room - far[0] - far[1], 0.0), top)
    start, stop = (problem.waypoints[:-1] + u * cut[1, :-1, None]), (problem.waypoints[1:] - u * cut[0, 1:, None])
    dwell = np.array([problem.dwells.get(int(k), 0.0) for k in places])
    zero, still = np.zeros_like(u), np.zeros_like(cruise)
    arriving, leaving = u * last[:, None], np.concatenate([u[1:] * first[1:, None], zero[:1]])
    turn = np.where(line.inner[1:, None], leaving - arriving, 0.0)
    parts = [
        (start, u * first[:, None], u * (top - first)[:, None], up),
        (start + u * far[0][:, None], u * top[:, None], zero, Change(cruise, still)),
        (stop - u * far[1][:, None], u * top[:, None], u * (last - top)[:, None], down),
        (stop, arriving, turn, Change(blend.a[1:], blend.b[1:])),
        (problem.waypoints[1:], zero, zero, Change(dwell[1:], still)),
    ]
    stacks = [np.stack(each, axis=1) for each in zip(*(part[:3] for part in parts), strict=True)]
    a, b = (np.stack([part[3][k] for part in parts], axis=1) for k in (0, 1))
    spent = np.concatenate([[0.0], np.cumsum((a + b).sum(axis=1))])
    passed_at = spent - np.append(0.0, dwell[1:] + 0.5 * blend.time[1:])
    position, velocity, turns = (part.reshape(-1, problem.n_joints) for part in stacks)
    return _joined(position, velocity, turns, Change(a.ravel(), b.ravel()), passed_at)


def _joined(position: Floats, velocity: Floats, turn: Floats, change: Change, passed_at: Floats) -> Trajectory:
    """Join changes of velocity, each in three pieces of constant jerk, arrays of shape (n_changes, n_joints)."""
    a, b = change.a[:, None], change.b[:, None]
    push = _over(turn, np.broadcast_to(a, turn.shape))
    jerk = _over(push, np.broadcast_to(b, turn.shape))
    end, after = position + (velocity + turn / 2) * (a + b), velocity + turn
    late = (end - after * b + push * b**2 / 6, after - push * b / 2, push / 2, -jerk / 6)
    early = (position, velocity, 0 * push, jerk / 6)
    middle = (position + velocity * b + push * b**2 / 6, velocity + push * b / 2, push / 2, 0 * jerk)
    pieces = np.stack([np.stack(part, axis=1) for part in (early, middle, late)], axis=1)
    widths = np.concatenate([b, a - b, b], axis=1).ravel()
    used = widths > 1e-13 * widths.sum()
    knots = np.append(0.0, np.cumsum(widths[used]))
    times = np.clip(passed_at * (knots[-1] / passed_at[-1]), 0.0, knots[-1])
    times[-1] = knots[-1]
    return Trajectory(knots, pieces.reshape(-1, 4, position.shape[1])[used], times)


@dataclass(frozen=True)
class Straight(Deterministic):
    """Planner `straight`: from waypoint to waypoint on straight lines, through corners within what is granted there."""

    about: ClassVar[str] = "straight lines with blends at the corners, of constant jerk in pieces"
    freedom: ClassVar[Freedom] = Freedom.PATH
    knows: ClassVar[frozenset[Demand]] = frozenset(Demand) - {Demand.MOVING_ENDS, Demand.DURATION, Demand.CYCLE}

    @where_something_moves
    def plan(self, problem: Problem, settings: RunSettings) -> Plan:
        """Choose the speeds at the corners; of the settings the time limit matters."""
        line = Polyline(problem)
        deadline, starts = Deadline.after(settings.time_limit), (passed(line), np.zeros_like(line.largest))
        speeds = [polished(line, start, deadline) for start in starts]
        motion = min((motion_of(line, each) for each in speeds), key=lambda each: each.duration)
        return Plan(Status.FINISHED, motion=motion)
