"""Exact motion from a point of the nonlinear program: equations closed to rounding, knots of all joints united."""

from __future__ import annotations

import numpy as np

from baselines.free_path.elimination import closing_rows, equations_of, split
from baselines.free_path.model import MIDDLE, SLOPE, Model, U
from baselines.free_path.pieces import U0, U1, X1, Bounds, H, Point, pieces_at, states_at
from baselines.free_path.question import Flags, FreePathProblem, Integers
from study.problem import Floats
from study.tolerances import floors
from study.trajectory import Trajectory

SAME = 1e-9
"""Knots of different joints that are closer than this share of the segment count as one."""


def closed(model: Model, point: Point) -> Point:
    """Change u a little where pieces meet, until every segment ends where the next begins, to rounding.

    With the widths given, both closing equations are linear in u; the change is the smallest one that meets them.
    """
    total = point.widths.sum(axis=2, keepdims=True)
    point = point._replace(widths=np.maximum(point.widths, 0.0) * (point.durations[:, None, None] / total))
    for _ in range(2):
        states, errors = states_at(model, point)
        rows = closing_rows(model, states)[..., 1 : model.pieces]
        inner = point.inner.copy()
        for kind in np.unique(model.kinds):
            group, equations = model.kinds == kind, equations_of(int(kind), free=False)
            if equations:
                inverse, _ = split(rows[:, group][:, :, equations])
                inner[:, group] -= (inverse @ errors[:, group][:, :, equations, None])[..., 0]
        point = point._replace(inner=inner)
    return point


def stretch(model: Model, point: Point) -> float:
    """Factor by which the motion must be slowed down to keep all limits of rates, at least 1."""
    at = pieces_at(model, Bounds(model, True), point)
    u, h, x1 = at.states[U1], at.states[H], at.states[X1] + at.states[H] * at.gradients[MIDDLE, H]
    noise = 1e-12 * (1 + np.abs(u))
    slope = np.where(h > noise, (u - at.states[U0]) / np.maximum(h, noise), 0.0)
    worst = 1.0
    for below, row, value in ((0, SLOPE, slope), (1, U, u), (2, MIDDLE, x1)):
        rates = model.kinds > below
        high, low = model.upper[row][:, rates, None], model.lower[row][:, rates, None]
        share = np.maximum(value[:, rates] / high, value[:, rates] / low).max(axis=(0, 2))
        worst = max(worst, float((np.maximum(share, 0.0) ** (1 / (model.kinds[rates] - below))).max(initial=0.0)))
    return worst


def leaves_range(model: Model, point: Point, margin: float) -> Flags:
    """Mask of joints nearer to an end of their range than a share of their span, by segment; beyond it, if negative.

    Returns
    -------
    bool array of shape (n_segments, n_joints)
    """
    question, joints = model.question, model.joints
    place = _positions(model, point)
    room = margin * np.ptp(question.waypoints[:, joints], axis=0)
    low, high = question.range_lower[:, joints], question.range_upper[:, joints]
    outside = (place.min(axis=2) < low + room) | (place.max(axis=2) > high - room)
    flags = np.zeros((len(model.tau), question.n_joints), dtype=bool)
    flags[:, joints] = outside
    return flags


def _positions(model: Model, point: Point) -> Floats:
    """Inner Bernstein coefficients of position, shape (n_segments, n_moving, ...), rad or m."""
    states, _ = states_at(model, point)
    first, second = model.gains
    x2, x1, u0, _, h = states
    early, late = x2 + second * h * x1 / 3, x2 + 2 * second * h * x1 / 3 + first * second * h * h * u0 / 6
    middle = x1 + first * h * u0 / 2
    kinds = model.kinds[None, :, None]
    ones = [np.where(kinds == 3, c, np.where(kinds == 2, middle, u0)) for c in (early, late)]
    unit = model.units[model.kinds - 1, np.arange(len(model.joints))]
    return model.question.waypoints[:-1, model.joints, None] + np.concatenate(ones, axis=2) * unit[:, None]


def realise(model: Model, point: Point) -> Trajectory:
    """Make the motion of a point whose equations are closed."""
    question = model.question
    widths = point.widths * model.tau[:, None, None]
    durations = point.durations * model.tau
    pieces = np.zeros((*widths.shape[:2], model.pieces, 4))
    states, _ = states_at(model, point)
    x2, x1, u0, u1, _ = (values * unit for values, unit in zip(states, _units(model), strict=True))
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.where(widths > 0, (u1 - u0) / np.where(widths > 0, widths, 1.0), 0.0)
    base = question.waypoints[:-1, model.joints, None]
    for kind, values in ((3, (base + x2, x1, u0 / 2, slope / 6)), (2, (base + x1, u0, slope / 2, 0 * u0))):
        mine = model.kinds == kind
        pieces[:, mine] = np.stack(values, axis=3)[:, mine]
    starts = np.cumsum(widths, axis=2) - widths
    knots = _united(starts.reshape(len(durations), -1), durations)
    coefficients = np.zeros((len(knots[0]), 4, question.n_joints))
    coefficients[:, :, model.joints] = _shifted(pieces, starts, *knots)
    _add_lines(model, point, coefficients, *knots)
    degree = max(int(question.kinds.max()), 1)
    segment, _, width = knots
    segment, width, coefficients = _with_dwells(question, segment, width, coefficients[:, : degree + 1])
    return Trajectory.from_pieces(width, coefficients, np.bincount(segment, minlength=len(durations)))


def _with_dwells(
    question: FreePathProblem, segment: Integers, width: Floats, coefficients: Floats
) -> tuple[Integers, Floats, Floats]:
    """Let all joints stand at the beginning of segments for as long as the question asks."""
    standing = np.flatnonzero(question.dwells[:-1])
    first = np.searchsorted(segment, standing)
    still = coefficients[first]
    still[:, 1:] = 0.0
    return (
        np.insert(segment, first, standing),
        np.insert(width, first, question.dwells[standing]),
        np.insert(coefficients, first, still, axis=0),
    )


def _units(model: Model) -> list[Floats]:
    """Units of y, each of shape (n_moving, 1)."""
    u, x1, x2 = (unit[:, None] for unit in model.units)
    return [x2, x1, u, u, np.ones_like(u)]


def _united(starts: Floats, durations: Floats) -> tuple[Integers, Floats, Floats]:
    """Segment, beginning and width of all pieces between the knots of any joint; arrays of shape (n_pieces,)."""
    order = np.sort(starts, axis=1)
    gap = SAME * durations[:, None]
    keep = np.diff(order, axis=1, prepend=-np.inf) > gap
    keep &= order < durations[:, None] - gap
    order[:, 0], keep[:, 0] = 0.0, True
    segment, _ = np.nonzero(keep)
    begin = order[keep]
    finish = np.append(begin[1:], 0.0)
    last = np.append(segment[1:] != segment[:-1], True)
    return segment, begin, np.where(last, durations[segment], finish) - begin


def _shifted(pieces: Floats, starts: Floats, segment: Integers, begin: Floats, width: Floats) -> Floats:
    """Coefficients of all joints on the united pieces, by Taylor's shift, shape (n_pieces, 4, n_moving)."""
    inside = starts[segment] <= (begin + width / 2)[:, None, None]
    index = np.maximum(inside.sum(axis=2) - 1, 0)[..., None]
    own = np.take_along_axis(pieces[segment], index[..., None], axis=2)[:, :, 0]
    by = begin[:, None] - np.take_along_axis(starts[segment], index, axis=2)[:, :, 0]
    c0, c1, c2, c3 = np.moveaxis(own, 2, 0)
    return np.stack(
        [c0 + by * (c1 + by * (c2 + by * c3)), c1 + by * (2 * c2 + 3 * by * c3), c2 + 3 * by * c3, c3], axis=1
    )


def _add_lines(
    model: Model, point: Point, coefficients: Floats, segment: Integers, begin: Floats, width: Floats
) -> None:
    """Let joints that limit no more than velocity go straight from waypoint to waypoint, and still ones stay."""
    question = model.question
    lines = np.flatnonzero(question.kinds <= 1)
    passed = question.waypoints[:, lines].copy()
    still = np.ptp(passed, axis=0) <= floors(question.waypoints)[lines]
    passed[:, still] = passed[0, still]
    own = model.kinds == 1
    passed[:, np.isin(lines, model.joints)] += point.nodes[:, own, 0] * model.units[0, own]
    speed = np.diff(passed, axis=0) / (point.durations * model.tau)[:, None]
    coefficients[:, 0, lines] = passed[segment] + begin[:, None] * speed[segment]
    coefficients[:, 1, lines] = speed[segment]
