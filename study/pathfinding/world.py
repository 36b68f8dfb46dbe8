"""Obstacle world of axis-aligned boxes, and exact tests of segments and capsules against it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.errors import StudyError
from study.problem import Floats, frozen_array


@dataclass(frozen=True, eq=False)
class World:
    """Obstacle world: free space is a box, and obstacles are boxes inside it, all in one unit of length.

    Parameters
    ----------
    lower, upper : arrays of shape (3,)
        Corners of the space.
    obstacles : array of shape (n_obstacles, 2, 3)
        Lower and upper corner of every obstacle.

    Raises
    ------
    StudyError
        If a corner is not below its opposite, or shapes disagree.
    """

    lower: Floats
    upper: Floats
    obstacles: Floats

    def __post_init__(self) -> None:
        for name in ("lower", "upper", "obstacles"):
            object.__setattr__(self, name, frozen_array(getattr(self, name), f"world: {name}"))
        if self.obstacles.ndim != 3 or self.obstacles.shape[1:] != (2, 3) or self.lower.shape != (3,):
            raise StudyError(
                "world: corners need shape (3,) and obstacles (n, 2, 3), "
                f"got {self.lower.shape} and {self.obstacles.shape}"
            )
        if (self.obstacles[:, 0] >= self.obstacles[:, 1]).any() or (self.lower >= self.upper).any():
            raise StudyError("world: every box needs a lower corner below its upper corner in all three coordinates")

    def hits(self, start: Floats, stop: Floats) -> np.ndarray:
        """Collision test of segments with the obstacles, by the slab method; bool array of shape (n_segments,).

        Parameters
        ----------
        start, stop : arrays of shape (n_segments, 3)
        """
        direction = (stop - start)[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            near = (self.obstacles[:, 0] - start[:, None]) / direction
            far = (self.obstacles[:, 1] - start[:, None]) / direction
        inside = (start[:, None] >= self.obstacles[:, 0]) & (start[:, None] <= self.obstacles[:, 1])
        enter = np.where(direction == 0, np.where(inside, -np.inf, np.inf), np.minimum(near, far)).max(axis=2)
        leave = np.where(direction == 0, np.where(inside, np.inf, -np.inf), np.maximum(near, far)).min(axis=2)
        return ((enter <= leave) & (leave >= 0) & (enter <= 1)).any(axis=1)

    def clearance(self, start: Floats, stop: Floats) -> Floats:
        """Smallest distance from each segment to any obstacle, shape (n_segments,); 0 where they touch.

        The distance from a point of a segment to a convex box is convex along the segment, so a golden-section search
        finds its minimum to rounding.

        Parameters
        ----------
        start, stop : arrays of shape (n_segments, 3)
        """
        if not len(self.obstacles):
            return np.full(len(start), np.inf)
        low = np.zeros((len(start), len(self.obstacles)))
        high = np.ones_like(low)
        ratio = (np.sqrt(5.0) - 1.0) / 2.0
        for _ in range(60):
            left, right = high - ratio * (high - low), low + ratio * (high - low)
            nearer = self._distance(start, stop, left) < self._distance(start, stop, right)
            low, high = np.where(nearer, low, left), np.where(nearer, right, high)
        ends = [self._distance(start, stop, np.full_like(low, u)) for u in (0.0, 1.0)]
        inner = self._distance(start, stop, 0.5 * (low + high))
        distance = np.minimum(inner, np.minimum(*ends)).min(axis=1)
        return np.where(self.hits(start, stop), 0.0, distance)

    def _distance(self, start: Floats, stop: Floats, u: Floats) -> Floats:
        points = start[:, None] + u[..., None] * (stop - start)[:, None]
        gap = np.maximum(np.maximum(self.obstacles[:, 0] - points, points - self.obstacles[:, 1]), 0.0)
        return np.linalg.norm(gap, axis=2)


def arm_clearance(world: World, links: Floats, radius: float) -> Floats:
    """Distance between a moving arm and the obstacles at every instant, shape (n_times,); negative in collision.

    Parameters
    ----------
    world : World
    links : array of shape (n_times, n_points, 3)
        Joint positions along the arm; consecutive points are the axis of a capsule.
    radius : float
        Radius of the capsules.
    """
    n_times, n_points, _ = links.shape
    start, stop = links[:, :-1].reshape(-1, 3), links[:, 1:].reshape(-1, 3)
    return world.clearance(start, stop).reshape(n_times, n_points - 1).min(axis=1) - radius


def segment_distances(first: Floats, second: Floats, third: Floats, fourth: Floats) -> Floats:
    """Smallest distance between segments from first to second and from third to fourth, shape (n,).

    The nearest points are inside both segments, or one of them is an end.

    Parameters
    ----------
    first, second, third, fourth : arrays of shape (n, 3)
    """
    u, v, w = second - first, fourth - third, first - third
    a, b, c = ((x * y).sum(axis=1) for x, y in ((u, u), (u, v), (v, v)))
    d, e = (u * w).sum(axis=1), (v * w).sum(axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        inside = np.clip(np.nan_to_num((b * e - c * d) / (a * c - b * b)), 0.0, 1.0)
        starts = [inside, np.clip(np.nan_to_num(-d / a), 0.0, 1.0), np.clip(np.nan_to_num((b - d) / a), 0.0, 1.0)]
        places = [(s, np.clip(np.nan_to_num((b * s + e) / c), 0.0, 1.0)) for s in (*starts[:1], 0.0 * d, 0.0 * d + 1.0)]
    places += [(starts[1], 0.0 * d), (starts[2], 0.0 * d + 1.0)]
    gaps = [np.linalg.norm(w + s[:, None] * u - t[:, None] * v, axis=1) for s, t in places]
    return np.min(gaps, axis=0)


def boxes_between(
    rng: np.random.Generator, space: tuple[Floats, Floats], ends: tuple[Floats, Floats], n_obstacles: int
) -> World:
    """Random boxes of varying size in a space, every other one on the straight segment between two ends that stay free.

    Parameters
    ----------
    rng : numpy.random.Generator
    space : tuple of two arrays of shape (3,)
        Lower and upper corner.
    ends : tuple of two arrays of shape (3,)
    n_obstacles : int
    """
    lower, upper = (np.asarray(corner, dtype=float) for corner in space)
    start, goal = (np.asarray(end, dtype=float) for end in ends)
    span = upper - lower
    boxes: list[Floats] = []
    while len(boxes) < n_obstacles:
        size = rng.uniform(0.1, 0.3, 3) * span
        on_way = start + rng.uniform(0.15, 0.85) * (goal - start)
        centre = on_way if len(boxes) % 2 == 0 else lower + rng.uniform(size=3) * span
        corner = np.clip(centre - size / 2, lower, upper - size)
        box = np.stack([corner, corner + size])
        distances = [np.linalg.norm(np.clip(end, box[0], box[1]) - end) for end in (start, goal)]
        if min(distances) > 0.1 * span.max():
            boxes.append(box)
    return World(lower, upper, np.array(boxes).reshape(-1, 2, 3))
