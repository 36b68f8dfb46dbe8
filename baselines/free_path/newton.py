"""Newton's equations of the interior-point method at one point: gradient, factorisation and steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from baselines.free_path.elimination import Elimination
from baselines.free_path.model import Model
from baselines.free_path.pieces import Bounds, Costates, Pieces, Point
from baselines.free_path.rows import Rows
from baselines.free_path.shared_system import GIVE_UP, Layout, SharedSystem, gathered
from study.problem import Floats

if TYPE_CHECKING:
    from baselines.free_path.compiled_steps import CompiledElimination


@dataclass(frozen=True, eq=False)
class Frame:
    """Constants of a run of the interior-point method.

    Attributes
    ----------
    model : Model
    bounds : Bounds
    rows : Rows
    layout : Layout
    free : bool
        Whether widths are unknowns.
    shares : array of shape (n_segments, n_moving, K)
        Shares of the widths in the durations where they are not.
    elimination : type
        Code that eliminates the blocks.
    """

    model: Model
    bounds: Bounds
    rows: Rows
    layout: Layout
    free: bool
    shares: Floats
    elimination: type[Elimination] | type[CompiledElimination]


@dataclass(frozen=True, eq=False)
class Gradient:
    """A gradient in all unknowns.

    Attributes
    ----------
    costates : Costates
    inner : array of shape (n_segments, n_moving, n_inner)
    shared : array of shape (n_segments, n_moving, 7)
    nodes : array of shape (n_waypoints, n_moving, 3)
    durations : array of shape (n_segments,)
        The objective's own.
    """

    costates: Costates
    inner: Floats
    shared: Floats
    nodes: Floats
    durations: Floats

    def size(self, layout: Layout) -> float:
        """Largest entry."""
        shared = gathered(layout, self.shared, self.nodes, self.durations)
        return max(float(np.abs(self.inner).max(initial=0.0)), float(np.abs(shared).max()))


def gradient(frame: Frame, at: Pieces, weights: Floats, multipliers: Floats) -> Gradient:
    """Gradient of the objective, plus weights times rows, plus multipliers times closing equations.

    Parameters
    ----------
    weights : array, one entry for every row
    multipliers : array of shape (n_segments, n_moving, 3)
    """
    model, pieces = frame.model, frame.model.pieces
    ends = multipliers[:, :, :2] / model.closures
    costates = frame.rows.pull(at, weights, ends)
    shared = np.empty((*model.shape[:2], 7))
    shared[..., 0], shared[..., 3] = costates.u[..., 0], costates.u[..., -1]
    shared[..., 1:3], shared[..., 4:6] = costates.start, -ends
    inner = costates.u[..., 1:pieces]
    if frame.free:
        inner = np.concatenate([inner, costates.h + multipliers[..., 2:]], axis=2)
        shared[..., 6] = -multipliers[..., 2]
    else:
        shared[..., 6] = (frame.shares * costates.h).sum(axis=2)
    above, below = frame.rows.nodes(weights)
    return Gradient(costates, inner, shared, below - above, model.weights)


class Damping(NamedTuple):
    """Multiples of the identity to add to the Hessian.

    Attributes
    ----------
    shared : float
        At first, to be raised until the matrix is positive definite.
    inner : float
        At least, inside of the blocks.
    """

    shared: float
    inner: float


class Newton:
    """The factorised equations at one point.

    Parameters
    ----------
    frame : Frame
    at : Pieces
    multipliers, stiffness : arrays, one entry for every row
    costates : Costates
        Of the Lagrangian.
    damping : Damping
    """

    def __init__(
        self,
        frame: Frame,
        at: Pieces,
        multipliers: Floats,
        stiffness: Floats,
        costates: Costates,
        damping: Damping,
    ) -> None:
        rows = frame.rows
        self.frame, self.at = frame, at
        local = rows.curvature(at, multipliers, stiffness, costates)
        nodes = rows.nodes(stiffness)
        elimination = frame.elimination(frame.model, at, local, frame.free, frame.shares)
        regularisation = damping.shared
        while True:
            self.blocks, self.regularisation = elimination.blocks(max(regularisation, damping.inner)), regularisation
            self.system = SharedSystem(frame.layout, self.blocks.reduced, nodes[0] + nodes[1], regularisation)
            if self.system.solvable or regularisation > GIVE_UP:
                break
            regularisation = max(1e-6, 8 * regularisation)

    def step(self, slope: Gradient) -> tuple[Point, Floats]:
        """Step in the unknowns and in the multipliers of the equations, down a gradient and onto the equations."""
        blocks, pieces = self.blocks, self.frame.model.pieces
        start, right = blocks.begin(-slope.inner, self.at.errors)
        nodes, durations, shared = self.system.solve(right - slope.shared, -slope.nodes, -slope.durations)
        inner, multipliers = blocks.complete(-slope.inner, start, shared)
        widths = inner[..., pieces - 1 :] if self.frame.free else self.frame.shares * durations[:, None, None]
        return Point(durations, nodes, inner[..., : pieces - 1], widths), multipliers
