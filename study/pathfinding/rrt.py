"""Rapidly exploring random trees among boxes: the plain tree of the paper, RRT-Connect, and shortcut smoothing.

References
----------
PUMA560 paper, Sections 3.1 and 4; LaValle 1998 for the tree, Kuffner and LaValle 2000 for the connecting pair.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.errors import StudyError
from study.pathfinding.world import World
from study.problem import Floats


class _Tree:
    """Nodes in one growing array, with their parents; the root is its own parent."""

    def __init__(self, root: Floats, capacity: int) -> None:
        self._nodes = np.empty((capacity + 1, 3))
        self._nodes[0] = root
        self.parents = [0]

    @property
    def nodes(self) -> Floats:
        return self._nodes[: len(self.parents)]

    def nearest(self, point: Floats) -> int:
        return int(((self.nodes - point) ** 2).sum(axis=1).argmin())

    def add(self, node: Floats, parent: int) -> int:
        self._nodes[len(self.parents)] = node
        self.parents.append(parent)
        return len(self.parents) - 1

    def path_to_root(self, index: int) -> list[Floats]:
        path = [self.nodes[index]]
        while index != self.parents[index]:
            index = self.parents[index]
            path.append(self.nodes[index])
        return path


@dataclass(frozen=True)
class RRT:
    """Rapidly exploring random tree (RRT) and its settings.

    Attributes
    ----------
    step : float
        Length of an extension; the paper does not print it, ours is a twentieth of its cube.
    goal_bias : float
        Share of samples taken at the goal; 0 is the plain tree of the paper.
    max_nodes : int
        Give up after a tree has so many nodes, or after ten times as many samples.
    """

    step: float = 50.0
    goal_bias: float = 0.0
    max_nodes: int = 5_000

    def path(self, world: World, start: Floats, goal: Floats, rng: np.random.Generator) -> Floats:
        """Grow one tree from the start until a free straight segment joins its newest node to the goal.

        Parameters
        ----------
        world : World
        start, goal : arrays of shape (3,)
        rng : numpy.random.Generator

        Returns
        -------
        array of shape (n_nodes, 3)

        Raises
        ------
        StudyError
            If an end lies in an obstacle or no path was found.
        """
        _check_ends(world, start, goal)
        tree = _Tree(start, self.max_nodes)
        for _ in range(10 * self.max_nodes):
            sample = goal if rng.random() < self.goal_bias else rng.uniform(world.lower, world.upper)
            index = self._extend(world, tree, sample)
            if index is not None and not world.hits(tree.nodes[index][None], goal[None])[0]:
                return np.array([*reversed(tree.path_to_root(index)), goal])
            if len(tree.parents) > self.max_nodes:
                break
        raise StudyError(f"RRT found no path with {len(tree.parents)} nodes; raise max_nodes or free the way")

    def connect(self, world: World, start: Floats, goal: Floats, rng: np.random.Generator) -> Floats:
        """Grow trees from both ends, each greedily towards the other's newest node; same contract as `path`."""
        _check_ends(world, start, goal)
        trees = [_Tree(start, self.max_nodes), _Tree(goal, self.max_nodes)]
        for turn in range(10 * self.max_nodes):
            if max(len(tree.parents) for tree in trees) >= self.max_nodes:
                break
            ours, theirs = trees[turn % 2], trees[1 - turn % 2]
            index = self._extend(world, ours, rng.uniform(world.lower, world.upper))
            if index is None:
                continue
            meeting = self._reach(world, theirs, ours.nodes[index])
            if meeting is not None:
                halves = [ours.path_to_root(index)[::-1], theirs.path_to_root(meeting)[1:]]
                path = np.array(halves[0] + halves[1])
                return path if turn % 2 == 0 else path[::-1]
        raise StudyError(f"RRT-Connect found no path with {self.max_nodes} nodes; raise max_nodes or free the way")

    def _extend(self, world: World, tree: _Tree, target: Floats) -> int | None:
        near = tree.nearest(target)
        way = target - tree.nodes[near]
        length = float(np.linalg.norm(way))
        if length == 0:
            return None
        node = tree.nodes[near] + way * min(1.0, self.step / length)
        if world.hits(tree.nodes[near][None], node[None])[0]:
            return None
        return tree.add(node, near)

    def _reach(self, world: World, tree: _Tree, target: Floats) -> int | None:
        while len(tree.parents) <= self.max_nodes and (index := self._extend(world, tree, target)) is not None:
            if np.array_equal(tree.nodes[index], target):
                return index
        return None


def _check_ends(world: World, start: Floats, goal: Floats) -> None:
    for name, point in (("start", start), ("goal", goal)):
        if world.hits(point[None], point[None])[0]:
            raise StudyError(f"the {name} {np.asarray(point).tolist()} lies inside an obstacle; move one of them")


def shortcut(world: World, path: Floats, rng: np.random.Generator, attempts: int = 200) -> Floats:
    """Shortcut smoothing: free straight segments for random stretches of a path; never longer, never in collision.

    Parameters
    ----------
    world : World
    path : array of shape (n_nodes, 3)
    rng : numpy.random.Generator
    attempts : int

    Returns
    -------
    array of shape (n_kept, 3)
    """
    for _ in range(attempts):
        if len(path) < 3:
            break
        first, last = np.sort(rng.choice(len(path), 2, replace=False))
        if last - first > 1 and not world.hits(path[first][None], path[last][None])[0]:
            path = np.concatenate([path[: first + 1], path[last:]])
    return path


def length(path: Floats) -> float:
    """Length of a polyline of shape (n_nodes, 3)."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def four_waypoints(path: Floats) -> Floats:
    """Start, an intermediate node, the node where the tree ended, and the goal, shape (4, 3).

    The paper takes "an intermediate node between the initial point and the endpoint of the RRT": ours is the one in
    the middle of the node list.

    Raises
    ------
    StudyError
        If the path has fewer than four nodes.

    References
    ----------
    PUMA560 paper, Sections 3.4 and 4.
    """
    if len(path) < 4:
        raise StudyError(f"four waypoints need a path of at least 4 nodes, got {len(path)}; take a shorter step")
    end = len(path) - 2
    return path[[0, end // 2, end, len(path) - 1]]
