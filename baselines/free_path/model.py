r"""The nonlinear program behind the free path, in numbers of order one.

Segment i takes T_i. In it every joint j has K pieces of its own, of widths h_1 .. h_K with sum T_i, and a chain of
three quantities in which each is the integral of the one before:

    u   linear in every piece, continuous            the highest quantity that must not jump
    x1  the integral of u
    x2  the integral of x1

With a jerk limit u is acceleration, x1 velocity and x2 position; with an acceleration limit only u is velocity and x1
position; with a velocity limit only u is position. So one chain serves all kinds of joints, and the slope of u is what
the highest limit holds.

Units: time in tau_i (the stop-to-stop time of the segment), u and x1 in what the limits allow within a usual segment. A
piece then maps (x2, x1, u0, u1, h) to

    x1' = x1 + c1 h (u0 + u1) / 2,     x2' = x2 + c2 (h x1 + c1 h^2 (2 u0 + u1) / 6),

with c1, c2 of order one where the segment is a usual one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from baselines.closed_forms import rest_to_rest_time
from baselines.free_path.question import Flags, FreePathProblem, Integers
from study.problem import Floats

ROOM = 2e-7
"""Share of a joint's span by which its range of positions is widened, less than counts as leaving the range: a waypoint
on the very end of the range then leaves the interior-point method an interior."""

U, SLOPE, MIDDLE, WIDTH, EARLY, LATE = range(6)
"""Quantities that have bounds on a piece; the last two only where a range of positions is held under a jerk limit."""


@dataclass(frozen=True, eq=False)
class Model:
    """Coefficients and bounds of the nonlinear program, for the joints that move and have a limit.

    Attributes
    ----------
    question : FreePathProblem
    joints : int array of shape (n_moving,)
        Which joints of the question.
    kinds : int array of shape (n_moving,)
    pieces : int
    tau : array of shape (n_segments,), s
        Units of time.
    units : array of shape (3, n_moving)
        Units of u, x1 and x2, in those of the question.
    ahead : array of shape (n_segments, n_moving, 3)
        What to add to a node's state to express it as the end of the segment before: the step in position.
    lower, upper : arrays of shape (n_quantities, n_segments, n_moving)
    held : bool array of shape (n_segments, n_moving)
        Where the range of positions counts.
    pinned : bool array of shape (n_waypoints, n_moving, 3)
    pins : array of shape (n_waypoints, n_moving, 3)
        Values there.
    node_lower, node_upper : arrays of shape (n_waypoints, n_moving, 3)
    """

    question: FreePathProblem
    joints: Integers
    kinds: Integers
    pieces: int
    tau: Floats
    units: Floats
    ahead: Floats
    lower: Floats
    upper: Floats
    held: Flags
    pinned: Flags
    pins: Floats
    node_lower: Floats
    node_upper: Floats

    @property
    def shape(self) -> tuple[int, int, int]:
        """Segments, joints and pieces."""
        return len(self.tau), len(self.joints), self.pieces

    @cached_property
    def weights(self) -> Floats:
        """Weights of the segments' durations in the objective, shape (n_segments,)."""
        return self.tau / self.tau.mean()

    @cached_property
    def gains(self) -> tuple[Floats, Floats]:
        """The coefficients c1 and c2, each of shape (n_segments, n_moving, 1)."""
        u, x1, x2 = self.units
        gain = self.tau[:, None]
        first = np.where(self.kinds > 1, gain * u / x1, 0.0)
        second = np.where(self.kinds > 2, gain * x1 / x2, 0.0)
        return first[:, :, None], second[:, :, None]

    @cached_property
    def summing(self) -> Floats:
        """Matrix that sums along the pieces, faster than a running sum where the rows are short."""
        return np.triu(np.ones((self.pieces, self.pieces)))

    @cached_property
    def closures(self) -> Floats:
        """Scales of the equations that close x1 and x2 on a segment, shape (n_segments, n_moving, 2)."""
        first, second = self.gains
        return np.concatenate(
            [np.where(self.kinds[:, None] == 2, first, 1.0), np.where(self.kinds[:, None] == 3, second, 1.0)], axis=2
        )

    @cached_property
    def width_counts(self) -> bool:
        """Whether widths need a bound of their own even if they are shares of the duration."""
        return not (np.isfinite(self.lower[SLOPE]) & np.isfinite(self.upper[SLOPE])).all()


def model_of(question: FreePathProblem, pieces: int, held: Flags | None = None) -> Model:
    """Choose units and collect bounds.

    Parameters
    ----------
    question : FreePathProblem
        At least one joint moves and has a limit.
    pieces : int
        At least 3.
    held : bool array of shape (n_segments, n_joints), optional
        Where the range of positions counts; nowhere by default.
    """
    kinds = question.kinds
    joints = np.flatnonzero(kinds)
    kinds = kinds[joints]
    tau = usual_durations(question)
    units = _units(question.rates[:, :, joints].min(axis=1), kinds, float(tau.mean()))
    ahead = np.zeros((len(tau), len(joints), 3))
    place = np.arange(len(joints))
    ahead[:, place, kinds - 1] = np.diff(question.waypoints[:, joints], axis=0) / units[kinds - 1, place]
    held = np.zeros((len(tau), question.n_joints), dtype=bool) if held is None else held
    lower, upper = _piece_bounds(question, joints, tau, units, held)
    pinned, pins = _pins(question, joints, units)
    node_lower, node_upper = _node_bounds(question, joints, units)
    return Model(
        question,
        joints,
        kinds,
        pieces,
        tau,
        units,
        ahead,
        lower,
        upper,
        held[:, joints],
        pinned,
        pins,
        node_lower,
        node_upper,
    )


def usual_durations(question: FreePathProblem) -> Floats:
    """Duration of every segment from stop to stop, shape (n_segments,), s; a segment of no length gets a little."""
    steps = np.diff(question.waypoints, axis=0)
    joints = np.flatnonzero(question.kinds)
    times = np.stack([rest_to_rest_time(steps[:, j], question.rates[:, :, j]) for j in joints]).max(axis=0)
    return np.maximum(times, 1e-3 * times.max())


def _units(rates: Floats, kinds: Integers, tau: float) -> Floats:
    """Units of u, x1 and x2: what the limits allow within a time tau, shape (3, n_moving)."""
    joint = np.arange(len(kinds))
    table = np.concatenate([np.full((1, len(kinds)), np.inf), rates])
    unit, units = table[kinds, joint], []
    for below in (1, 2, 3):
        unit = np.minimum(unit * tau, table[np.maximum(kinds - below, 0), joint])
        units.append(np.where(kinds >= below, unit, 1.0))
    return np.stack(units)


def _piece_bounds(
    question: FreePathProblem, joints: Integers, tau: Floats, units: Floats, held: Flags
) -> tuple[Floats, Floats]:
    """Bounds of all quantities on the pieces, each of shape (n_quantities, n_segments, n_moving)."""
    kinds, joint = question.kinds[joints], np.arange(len(joints))
    sides = []
    for sign, rates, span in (
        (-1, question.lower, question.range_lower),
        (1, question.upper, question.range_upper),
    ):
        room = sign * ROOM * np.ptp(question.waypoints, axis=0)
        place = np.where(held, span + room - question.waypoints[:-1], sign * np.inf)
        table = np.concatenate([np.full((2, *place.shape), sign * np.inf), place[None], rates])[:, :, joints]
        slope, u, x1, x2 = (table[kinds + 2 - below, :, joint].T for below in range(4))
        slope = slope * tau[:, None] / units[0]
        width = np.full_like(slope, np.inf if sign > 0 else 0.0)
        early = x2 / units[2]
        sides.append(np.stack([u / units[0], slope, x1 / units[1], width, early, early]))
    return sides[0], sides[1]


def _orders(kinds: Integers) -> Integers:
    """Order of derivative of the quantities u, x1 and x2, shape (n_moving, 3); negative where unused."""
    return kinds[:, None] - 1 - np.arange(3)


def _pins(question: FreePathProblem, joints: Integers, units: Floats) -> tuple[Flags, Floats]:
    """Mask and values of the states that are given at the waypoints."""
    orders, n = _orders(question.kinds[joints]), len(question.waypoints)
    pins = np.full((n, len(joints), 3), np.nan)
    pins[:, orders < 0] = 0.0
    for order, where in ((1, question.stops | (question.dwells > 0)), (2, question.dwells > 0)):
        pins[where] = np.where(orders == order, 0.0, pins[where])
    for row, state in ((0, question.start), (-1, question.end)):
        for order in (1, 2):
            given = np.broadcast_to(state[order - 1, joints, None] / units.T, orders.shape)
            pins[row] = np.where(orders == order, given, pins[row])
    pins = np.where((orders == 1) & _touching(question, joints)[:, :, None], 0.0, pins)
    exact = question.tolerance[:, joints, None] == 0
    pins = np.where((orders == 0) & exact, 0.0, pins)
    return np.isfinite(pins), np.nan_to_num(pins)


def _touching(question: FreePathProblem, joints: Integers) -> Flags:
    """Waypoints at the end of the range of positions, where the joint can only turn, shape (n_waypoints, n_moving)."""
    points, room = question.waypoints, ROOM * np.ptp(question.waypoints, axis=0)
    near = (points[:-1] - question.range_lower <= room) | (question.range_upper - points[:-1] <= room)
    after = (points[1:] - question.range_lower <= room) | (question.range_upper - points[1:] <= room)
    touching = np.zeros(points.shape, dtype=bool)
    touching[:-1] |= near
    touching[1:] |= after
    touching[[0, -1]] = False
    return (touching & (question.tolerance == 0))[:, joints]


def _node_bounds(question: FreePathProblem, joints: Integers, units: Floats) -> tuple[Floats, Floats]:
    """Bounds of the states at the waypoints: the tighter ones of both segments, and the tolerance.

    Velocity under a jerk limit lies between the middle coefficients of both neighbouring pieces, so that it needs
    bounds of its own only at the ends and where limits change.
    """
    orders, points = _orders(question.kinds[joints]), question.waypoints[:, joints]
    slack = question.tolerance[:, joints]
    sides = []
    for pick, sign, rates, span in (
        (np.maximum, -1, question.lower, question.range_lower),
        (np.minimum, 1, question.upper, question.range_upper),
    ):
        both = [np.concatenate([r[:1], r])[:, joints] for r in (*rates[:2], span)]
        near = [np.concatenate([r, r[-1:]])[:, joints] for r in (*rates[:2], span)]
        velocity, acceleration, place = (pick(a, b) for a, b in zip(both, near, strict=True))
        steady = np.equal(both[0], near[0])
        steady[[0, -1]] = False
        bound = np.stack([pick(place - points, sign * slack), velocity, acceleration], axis=2)
        bound = np.take_along_axis(bound, np.maximum(orders, 0)[None].repeat(len(points), 0), axis=2)
        idle = (orders[None] < 0) | (steady[:, :, None] & (orders == 1) & (np.arange(3) == 1))
        sides.append(np.where(idle, sign * np.inf, bound / units.T))
    return sides[0], sides[1]
