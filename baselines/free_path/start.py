"""Initial point of the interior-point method: widths graded for long moves, states from a stretched cubic spline."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from baselines.free_path.model import Model
from baselines.free_path.pieces import Point
from baselines.free_path.question import FreePathProblem, Integers
from baselines.lapack import solve_tridiagonal
from study.problem import Floats


def graded(model: Model) -> Floats:
    """Shares of the widths in every segment, shape (n_segments, n_moving, K).

    A long move spends most of its time at full speed, so that equal pieces leave too few for speeding up and slowing
    down. The outer pieces are therefore no longer than a move from rest takes for its phases: of full jerk, of full
    acceleration, of full jerk again.
    """
    segments, joints, pieces = model.shape
    equal = model.tau[:, None, None] / pieces * np.ones((segments, joints, 1))
    widths = np.repeat(equal, pieces, axis=2)
    ramps = _ramps(model)
    count = min(ramps.shape[2], (pieces - 1) // 2)
    outer = np.minimum(ramps[:, :, :count], equal)
    widths[:, :, :count], widths[:, :, pieces - count :] = outer, outer[:, :, ::-1]
    rest = model.tau[:, None] - 2 * outer.sum(axis=2)
    widths[:, :, count : pieces - count] = rest[:, :, None] / (pieces - 2 * count)
    return widths / model.tau[:, None, None]


def _ramps(model: Model) -> Floats:
    """Durations of the phases of speeding up, shape (n_segments, n_moving, 3), s; infinite where there is none."""
    v, a, j = model.question.rates[:, :, model.joints]
    with np.errstate(invalid="ignore", divide="ignore"):
        fade = np.where(np.isfinite(j), a / j, np.inf)
        full = np.where(np.isfinite(j), np.maximum(v / a - fade, 0.3 * fade), np.inf)
        single = np.where(np.isfinite(a), v / a, np.inf)
    jerky = model.kinds == 3
    phases = np.where(jerky, np.stack([fade, full, fade]), np.stack([single, np.full_like(v, np.inf), single * np.inf]))
    return np.nan_to_num(phases.transpose(1, 2, 0), nan=np.inf, posinf=np.inf)


def spline_start(model: Model, shares: Floats, durations: Floats | None = None) -> Point:
    """Cubic spline through the waypoints, slowed until it keeps all limits at the nodes.

    Parameters
    ----------
    model : Model
    shares : array of shape (n_segments, n_moving, K)
    durations : array of shape (n_segments,), s, optional
        Before slowing down; from stop to stop by default.
    """
    question, joints = model.question, model.joints
    times = model.tau if durations is None else durations
    velocity = node_velocities(question, times)[:, joints]
    steps = np.diff(question.waypoints[:, joints], axis=0)
    ends = _accelerations(steps, velocity, times)
    factor = _stretch(question, joints, velocity, ends, times)
    return sampled(model, shares, velocity / factor, times * factor)


def swelling(model: Model) -> Floats:
    """Durations of the segments at a speed that swells from rest and ebbs to rest, shape (n_segments,), s.

    The length of the path is measured in units of the speed limits. Along a smooth path in close order this gives a far
    better spline than the durations from stop to stop.
    """
    question, joints = model.question, model.joints
    points = question.waypoints[:, joints]
    v, a, _ = question.rates[:, :, joints]
    usual = np.sqrt(np.where(np.isfinite(a), a, 1.0) * np.maximum(np.ptp(points, axis=0), 1e-9))
    lengths = np.linalg.norm(np.diff(points, axis=0) / np.where(np.isfinite(v), v, usual), axis=1)
    along = np.append(0.0, np.cumsum(np.maximum(lengths, 1e-6 * lengths.max())))
    u = np.linspace(0.0, 1.0, 20001)
    instants = np.interp(along / along[-1], u**3 * (10 - 15 * u + 6 * u**2), u)
    return np.diff(instants) * along[-1]


def node_velocities(question: FreePathProblem, durations: Floats) -> Floats:
    """Velocities at the waypoints of clamped cubic splines from stop to stop, shape (n_waypoints, n_joints)."""
    at_start, at_end = np.nan_to_num(question.start[0]), np.nan_to_num(question.end[0])
    velocity = np.zeros_like(question.waypoints)
    velocity[0], velocity[-1] = at_start, at_end
    stops = np.concatenate([[0], np.flatnonzero((question.stops | (question.dwells > 0))[1:-1]) + 1, [len(durations)]])
    for first, last in pairwise(stops):
        if last - first < 2:
            continue
        part = slice(first, last + 1)
        velocity[part] = _slopes(durations[first:last], question.waypoints[part], velocity[part])
    return velocity


def _slopes(durations: Floats, points: Floats, velocity: Floats) -> Floats:
    """Velocities of the clamped cubic spline through points, given those at both ends, (n_points, n_joints)."""
    before, after = durations[:-1, None], durations[1:, None]
    mean = np.diff(points, axis=0) / durations[:, None]
    right = 3 * (after * mean[:-1] + before * mean[1:])
    right[0] -= after[0] * velocity[0]
    right[-1] -= before[-1] * velocity[-1]
    inner = solve_tridiagonal(after[1:, 0], 2 * (before + after)[:, 0], before[:-1, 0], right)
    return np.concatenate([velocity[:1], inner, velocity[-1:]])


def _accelerations(steps: Floats, velocity: Floats, durations: Floats) -> tuple[Floats, Floats]:
    """Accelerations at both ends of the cubics between nodes, each of shape (n_segments, n_joints)."""
    t = durations[:, None]
    begin = (6 * steps / t - 4 * velocity[:-1] - 2 * velocity[1:]) / t
    finish = (-6 * steps / t + 2 * velocity[:-1] + 4 * velocity[1:]) / t
    return begin, finish


def _stretch(
    question: FreePathProblem, joints: Integers, velocity: Floats, ends: tuple[Floats, Floats], t: Floats
) -> float:
    """Factor that slows the spline down to its limits, at the nodes."""
    v, a, j = question.rates[:, :, joints]
    begin, finish = ends
    fast = np.maximum(np.abs(velocity[:-1]), np.abs(velocity[1:])) / v
    steep = np.maximum(np.abs(begin), np.abs(finish)) / a
    jerk = np.abs(finish - begin) / t[:, None] / j
    return float(max(1.0, fast.max(), np.sqrt(steep.max()), np.cbrt(jerk.max())))


def sampled(model: Model, shares: Floats, velocity: Floats, durations: Floats) -> Point:
    """The point of cubics with given velocities at the waypoints, shape (n_waypoints, n_moving), and durations, s."""
    question, joints = model.question, model.joints
    steps = np.diff(question.waypoints[:, joints], axis=0)
    begin, finish = _accelerations(steps, velocity, durations)
    blend = np.concatenate([begin[:1], (begin[1:] + finish[:-1]) / 2, finish[-1:]])
    states = np.stack([np.zeros_like(velocity), velocity, blend], axis=2)
    orders = model.kinds[:, None] - 1 - np.arange(3)
    nodes = np.take_along_axis(states, np.maximum(orders, 0)[None].repeat(len(states), 0), axis=2) / model.units.T
    nodes = np.where(model.pinned, model.pins, nodes)
    s = np.cumsum(shares, axis=2)[:, :, :-1]
    t = durations[:, None, None]
    v0, a0, jerk = velocity[:-1, :, None], begin[:, :, None], ((finish - begin) / durations[:, None])[:, :, None]
    tables = [
        s * t * (v0 + s * t * (a0 / 2 + s * t * jerk / 6)),
        v0 + s * t * (a0 + s * t * jerk / 2),
        a0 + s * t * jerk,
    ]
    inner = np.choose((model.kinds - 1)[None, :, None], tables) / model.units[0][None, :, None]
    scaled = durations / model.tau
    return Point(scaled, nodes, inner, shares * scaled[:, None, None])
