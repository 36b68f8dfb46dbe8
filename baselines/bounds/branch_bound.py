"""Branch and bound over boxes, a whole generation of boxes at a time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from study.deadline import Deadline
from study.problem import Floats

BoxBound = Callable[[Floats, Floats], Floats]
Value = Callable[[Floats], Floats]


@dataclass(frozen=True, eq=False)
class Enclosure:
    """Bounds on a global minimum.

    Attributes
    ----------
    lower, upper : float
        Proven bounds on the minimum.
    point : array of shape (n_dimensions,), optional
        Where the upper bound is reached; None if no box's middle beat the one given.
    boxes : int
        Boxes looked at.
    finished : bool
        Whether the gap asked for was reached.
    """

    lower: float
    upper: float
    point: Floats | None
    boxes: int
    finished: bool


def enclose(
    bound: BoxBound,
    value: Value,
    box: tuple[Floats, Floats],
    upper: float,
    *,
    gap: float,
    deadline: Deadline,
    most: int,
) -> Enclosure:
    """Split boxes in halves along their widest side until none can hold a value below upper (1 - gap).

    Parameters
    ----------
    bound : callable (lower, upper corners of shape (n_boxes, n_dimensions)) -> (n_boxes,)
        Proven lower bound of the function on every box.
    value : callable (n_points, n_dimensions) -> (n_points,)
    box : pair of arrays of shape (n_dimensions,)
        Where every point with a value below `upper` lies.
    upper : float
        A value that is reached somewhere.
    gap : float
        Relative.
    deadline : Deadline
    most : int
        Boxes after which to give up; the bounds hold all the same.
    """
    low, high = box[0][None], box[1][None]
    point, boxes, lower = None, 0, np.inf
    while len(low):
        bounds = bound(low, high)
        boxes += len(low)
        upper, point = _improved(value, low, high, bounds, upper, point)
        open_ = bounds < upper * (1 - gap)
        lower = min(lower, float(bounds[~open_].min(initial=np.inf)))
        if boxes > most or deadline.passed():
            lower = min(lower, float(bounds.min()))
            return Enclosure(min(lower, upper), upper, point, boxes, not open_.any())
        low, high = halves(low[open_], high[open_])
    return Enclosure(min(lower, upper), upper, point, boxes, True)


def _improved(
    value: Value, low: Floats, high: Floats, bounds: Floats, upper: float, point: Floats | None
) -> tuple[float, Floats | None]:
    """Try the middles of the most promising boxes."""
    middles = ((low + high) / 2)[np.argsort(bounds, kind="stable")[:32]]
    values = value(middles)
    best = int(values.argmin())
    return (float(values[best]), middles[best]) if values[best] < upper else (upper, point)


def halves(low: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Halve every box along its widest side; neighbours share the very same number, so no gap opens."""
    rows, side = np.arange(len(low)), (high - low).argmax(axis=1)
    middle = (low[rows, side] + high[rows, side]) / 2
    upper_low, lower_high = low.copy(), high.copy()
    upper_low[rows, side] = lower_high[rows, side] = middle
    return np.concatenate([low, upper_low]), np.concatenate([lower_high, high])
