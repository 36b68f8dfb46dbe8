"""Constraint activity of a motion: the joints that use a limit up, and the times at which they do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from study.problem import Floats, JointLimits
from study.trajectory import Extrema, Motion

SATURATED = 0.999
"""Share of a limit from which on it counts as active."""

POINTS = 1500
"""About how many times a motion is looked at; peaks and knots are always among them."""

CUTS, PASSES = 32, 6
"""The end of a stretch is closed in by cutting its bracket so often, so many times: to less than a nanosecond."""


@dataclass(frozen=True)
class Use:
    """One stretch of time over which one joint uses one limit up.

    Attributes
    ----------
    joint : int
        Counted from 0.
    order : int
        1 velocity, 2 acceleration, 3 jerk.
    start, end : float, s
    """

    joint: int
    order: int
    start: float
    end: float


def limit_uses(
    motion: Motion, limits: JointLimits, share: float = SATURATED, extrema: Sequence[Extrema] = ()
) -> tuple[Use, ...]:
    """Find every stretch of time over which a joint uses at least this share of a limit.

    Each piece is looked at on a grid that contains its ends, seen from both sides, and the exact peaks; the ends of a
    stretch are closed in afterwards. A gap shorter than a five-hundredth of the motion is passed over, so that a limit
    that a discretised method touches again and again counts as one use.

    Parameters
    ----------
    motion : Motion
    limits : JointLimits
    share : float
    extrema : sequence of Extrema, optional
        Of velocity, acceleration and jerk, where they are known already.

    Returns
    -------
    tuple of Use
        Ordered by order, joint and start.
    """
    uses: list[Use] = []
    for order, limit in enumerate(limits.rates, start=1):
        extreme = extrema[order - 1] if extrema else motion.extrema(order)
        if (extreme.peak < share * limit).all():
            continue
        times = _times(motion, extreme)
        active = np.abs(motion(times, order)) >= share * limit
        for joint in np.flatnonzero(active.any(axis=0)):
            edges = _stretches(active[:, joint])
            closed = _closed(motion, times, edges, (order, int(joint), share * limit[joint]))
            uses += [Use(int(joint), order, *map(float, pair)) for pair in _joined(closed, motion.duration / 500)]
    return tuple(uses)


def lane(uses: Iterable[Use], order: int, names: tuple[str, ...]) -> list[tuple[float, str]]:
    """Say from when on which joints use one kind of limit.

    Parameters
    ----------
    uses : iterable of Use
    order : int
        1 velocity, 2 acceleration, 3 jerk.
    names : tuple of str
        Joint names.

    Returns
    -------
    list of (time in s, text)
        The text names the active joints and is empty where there are none; the first entry is at time 0.
    """
    wanted = [use for use in uses if use.order == order]
    changes = sorted({0.0, *(use.start for use in wanted), *(use.end for use in wanted)})
    texts = [" + ".join(names[use.joint] for use in wanted if use.start <= t < use.end) for t in changes]
    return [(t, text) for i, (t, text) in enumerate(zip(changes, texts, strict=True)) if not i or text != texts[i - 1]]


def _times(motion: Motion, extrema: Extrema) -> Floats:
    """Times to look at: a grid over every piece, both sides of every knot and the exact peaks."""
    knots = motion.knots
    steps = max(POINTS // (len(knots) - 1), 4)
    grid = knots[:-1, None] + np.diff(knots)[:, None] * np.linspace(0.0, 1.0, steps, endpoint=False)
    return np.unique(
        np.concatenate([grid.ravel(), np.nextafter(knots[1:], 0.0), knots, extrema.at_lowest, extrema.at_highest])
    )


def _stretches(mask: np.ndarray) -> np.ndarray:
    """First and last index of every run of true values, shape (n_runs, 2)."""
    steps = np.diff(np.concatenate([[0], mask.astype(int), [0]]))
    return np.column_stack([np.flatnonzero(steps == 1), np.flatnonzero(steps == -1) - 1])


def _closed(motion: Motion, times: Floats, edges: np.ndarray, wanted: tuple[int, int, float]) -> Floats:
    """Move both ends of every run out to where the threshold is crossed, shape (n_runs, 2), s."""
    order, joint, threshold = wanted
    inside = times[edges].ravel()
    outside = times[np.clip(edges + np.array([-1, 1]), 0, len(times) - 1)].ravel()
    rows = np.arange(len(inside))
    for _ in range(PASSES):
        grid = inside[:, None] + (outside - inside)[:, None] * np.linspace(0.0, 1.0, CUTS + 1)
        below = np.abs(motion(grid.ravel(), order)[:, joint]).reshape(grid.shape) < threshold
        below[:, 0] = False  # known; rounding may say otherwise
        crossing = np.where(below.any(axis=1), below.argmax(axis=1), CUTS + 1)
        inside, outside = grid[rows, crossing - 1], grid[rows, np.minimum(crossing, CUTS)]
    return inside.reshape(-1, 2)


def _joined(stretches: Floats, gap: float) -> list[tuple[float, float]]:
    joined = [tuple(stretches[0])]
    for start, end in stretches[1:]:
        if start - joined[-1][1] < gap:
            joined[-1] = (joined[-1][0], end)
        else:
            joined.append((start, end))
    return joined
