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
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from baselines.base import Deterministic, where_something_moves
from baselines.path_timing.polyline import Change, Polyline, over
from study.deadline import Deadline
from study.planning import Freedom, Plan, RunSettings, Status
from study.problem import Demand, Floats, Problem
from study.trajectory import Trajectory

FIRST, LAST, SWEEPS = 0.2, 1e-6, 100
"""Change of speeds, as a share of the largest, with which the polish begins and ends, and its sweeps at most."""

TRIES = np.linspace(1.0, 0.0, 17)


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
    cruise = over(np.maximum(room - far[0] - far[1], 0.0), top)
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
    push = over(turn, np.broadcast_to(a, turn.shape))
    jerk = over(push, np.broadcast_to(b, turn.shape))
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
