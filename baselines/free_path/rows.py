"""All inequalities as one vector: the bounds of the pieces, then those of the states at the waypoints."""

from __future__ import annotations

import numpy as np

from baselines.free_path.model import Model
from baselines.free_path.pieces import Bounds, Costates, Pieces, Point, curvature, pieces_at, pull, push
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
        self.weight = self.active.astype(float)
        self.spare = 1.0 - self.weight
        self.count = int(self.active.sum())

    def pieces(self, vector: Floats) -> Floats:
        """Entries of the pieces, shape (2, n_quantities, n_segments, n_moving, K)."""
        return vector[: self.cut].reshape(self.on_pieces)

    def nodes(self, vector: Floats) -> Floats:
        """Entries of the waypoints, shape (2, n_waypoints, n_moving, 3)."""
        return vector[self.cut :].reshape(self.on_nodes)

    def at(self, point: Point) -> Pieces:
        """Evaluate all at a point; rows become one vector of distances from all bounds, 1 where there is none."""
        at, rows = pieces_at(self.model, self.bounds, point), np.empty(len(self.active))
        rows[: self.cut] = at.rows.ravel()
        self.fill_nodes(rows, point.nodes)
        return at._replace(rows=rows)

    def change(self, at: Pieces, step: Point) -> Floats:
        """Directional derivative of the rows along a step."""
        rows = np.empty(len(self.active))
        rows[: self.cut] = push(self.model, self.bounds, at, step).ravel()
        self.fill_node_changes(rows, step.nodes)
        return rows

    def pull(self, at: Pieces, weights: Floats, ends: Floats) -> Costates:
        """Gradient of the rows' weighted sum plus `ends` times the last x1 and x2."""
        return pull(self.model, self.bounds, at, self.pieces(weights), ends)

    def curvature(self, at: Pieces, multipliers: Floats, stiffness: Floats, costates: Costates) -> Floats:
        """Second derivatives of every piece's share in the Lagrangian, with the barrier's."""
        return curvature(self.model, self.bounds, at, self.pieces(multipliers), self.pieces(stiffness), costates)

    def fill_nodes(self, rows: Floats, nodes: Floats) -> None:
        """Write the waypoints' distances from their bounds into the vector of all rows."""
        into = self.nodes(rows)
        np.subtract(self.node_bounds[0], nodes, out=into[0])
        np.subtract(nodes, self.node_bounds[1], out=into[1])
        into[self.nodes_idle] = 1.0

    def fill_node_changes(self, rows: Floats, step: Floats) -> None:
        """Write their changes along a step into the vector of all rows."""
        into = self.nodes(rows)
        np.negative(step, out=into[0])
        into[1] = step
        into[self.nodes_idle] = 0.0
