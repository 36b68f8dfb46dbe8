"""All inequalities as one vector: the bounds of the pieces, then those of the states at the waypoints."""

from __future__ import annotations

import numpy as np

from baselines.free_path.model import Model
from baselines.free_path.pieces import Bounds, Pieces, Point, push
from study.problem import Floats


class Rows:
    """Views of a vector with one entry for every inequality.

    Parameters
    ----------
    model : Model
    bounds : Bounds
    """

    def __init__(self, model: Model, bounds: Bounds) -> None:
        self.model, self.bounds = model, bounds
        self.on_pieces = bounds.active.shape
        self.cut = bounds.active.size
        self.on_nodes = (2, *model.pinned.shape)
        raw = np.stack([model.node_upper, model.node_lower])
        active = np.isfinite(raw) & ~model.pinned
        self.node_bounds = np.where(active, raw, 0.0)
        self.nodes_idle = ~active
        self.active = np.concatenate([bounds.active.ravel(), active.ravel()])
        self.idle = ~self.active
        self.weight = self.active.astype(float)
        self.count = int(self.active.sum())

    def pieces(self, vector: Floats) -> Floats:
        """Entries of the pieces, shape (2, n_quantities, n_segments, n_moving, K)."""
        return vector[: self.cut].reshape(self.on_pieces)

    def nodes(self, vector: Floats) -> Floats:
        """Entries of the waypoints, shape (2, n_waypoints, n_moving, 3)."""
        return vector[self.cut :].reshape(self.on_nodes)

    def values(self, at: Pieces, point: Point) -> Floats:
        """Distances from all bounds; 1 where there is none."""
        nodes = np.stack([self.node_bounds[0] - point.nodes, point.nodes - self.node_bounds[1]])
        nodes[self.nodes_idle] = 1.0
        return np.concatenate([at.rows.ravel(), nodes.ravel()])

    def change(self, at: Pieces, step: Point) -> Floats:
        """Directional derivative of the rows along a step."""
        nodes = np.stack([-step.nodes, step.nodes])
        nodes[self.nodes_idle] = 0.0
        return np.concatenate([push(self.model, self.bounds, at, step).ravel(), nodes.ravel()])
