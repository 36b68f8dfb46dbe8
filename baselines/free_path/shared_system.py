"""The reduced Newton system over what joints and segments share: a band along the waypoints.

Unknowns are ordered waypoint by waypoint: the states there that are not given, then the duration of the segment that
follows. A segment couples its own duration with the states at both of its ends only, so that the matrix is a band whose
width depends on the number of joints and not on the number of waypoints.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from baselines.free_path.model import Model
from baselines.free_path.question import Flags, Integers
from baselines.lapack import factor_banded, solve_factored
from study.problem import Floats

GIVE_UP = 1e12
"""Regularisation beyond which the system counts as unsolvable."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Index of every shared unknown in the reduced system.

    Attributes
    ----------
    size : int
    nodes : int array of shape (n_waypoints, n_moving, 3)
        Number of every state that is not given; -1 where given.
    durations : int array of shape (n_segments,)
    blocks : int array of shape (n_segments, n_moving, 7)
        Numbers of a block's shared unknowns; -1 where given.
    lower : bool array of shape (n_segments, n_moving, 7, 7)
        Entries of the blocks that count, one for each pair.
    flat : int array
        Their places in the flattened band.
    width : int
        Half bandwidth.
    places : int array
        Numbers of all of the blocks' unknowns, the waypoints' and the durations; `size` where given.
    """

    size: int
    nodes: Integers
    durations: Integers
    blocks: Integers
    lower: Flags
    flat: Integers
    width: int
    places: Integers


def layout_of(model: Model) -> Layout:
    """Number the shared unknowns of a model."""
    segments, joints, _ = model.shape
    free = np.concatenate(
        [~model.pinned.reshape(segments + 1, -1), np.append(np.ones(segments, bool), False)[:, None]], axis=1
    )
    numbers = np.where(free, np.cumsum(free).reshape(free.shape) - 1, -1)
    nodes, durations = numbers[:, :-1].reshape(segments + 1, joints, 3), numbers[:-1, -1]
    last = np.broadcast_to(durations[:, None, None], (segments, joints, 1))
    blocks = np.concatenate([nodes[:-1], nodes[1:], last], axis=2)
    row, column = blocks[..., :, None], blocks[..., None, :]
    lower = (row >= column) & (column >= 0)
    distance = (row - column)[lower]
    size = int(free.sum())
    flat = distance * size + np.broadcast_to(column, lower.shape)[lower]
    places = np.concatenate([blocks.ravel(), nodes.ravel(), durations])
    places[places < 0] = size
    return Layout(size, nodes, durations, blocks, lower, flat, int(distance.max(initial=0)), places)


class SharedSystem:
    """A reduced system and its factorisation.

    Parameters
    ----------
    layout : Layout
    reduced : array of shape (n_segments, n_moving, 7, 7)
        The blocks' shares.
    stiffness : array of shape (n_waypoints, n_moving, 3)
        The barrier's at the waypoints.
    regularisation : float
        What to add to the diagonal at first.
    """

    def __init__(self, layout: Layout, reduced: Floats, stiffness: Floats, regularisation: float) -> None:
        self.layout = layout
        band = np.bincount(layout.flat, weights=reduced[layout.lower], minlength=(layout.width + 1) * layout.size)
        band = band.reshape(layout.width + 1, layout.size)
        own = layout.nodes >= 0
        band[0, layout.nodes[own]] += stiffness[own]
        band[0] += max(regularisation, 1e-11)
        self.factor = factor_banded(np.asarray(band, dtype=np.float64))

    @property
    def solvable(self) -> bool:
        """Whether the matrix is positive definite."""
        return self.factor.size > 0

    def solve(self, right: Floats, nodes: Floats, durations: Floats) -> tuple[Floats, Floats, Floats]:
        """Solve for the shared unknowns.

        Parameters
        ----------
        right : array of shape (n_segments, n_moving, 7)
            The blocks' shares of the right side.
        nodes : array of shape (n_waypoints, n_moving, 3)
        durations : array of shape (n_segments,)
            The rest of the right side.

        Returns
        -------
        nodes : array of shape (n_waypoints, n_moving, 3)
        durations : array of shape (n_segments,)
        shared : array of shape (n_segments, n_moving, 7)
        """
        total = gathered(self.layout, right, nodes, durations)
        answer: Floats = np.append(solve_factored(self.factor, total), 0.0)
        layout = self.layout
        return answer[layout.nodes], answer[layout.durations], answer[layout.blocks]


def gathered(layout: Layout, shared: Floats, nodes: Floats, durations: Floats) -> Floats:
    """Add up shares of the blocks, of the waypoints and of the durations, shape (layout.size,)."""
    values = np.concatenate([shared.ravel(), nodes.ravel(), durations])
    total: Floats = np.bincount(layout.places, weights=values, minlength=layout.size + 1)[: layout.size].astype(
        np.float64
    )
    return total
