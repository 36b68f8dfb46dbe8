"""Boxes, segments, capsules and trees."""

import numpy as np
import pytest

from study import StudyError
from study.pathfinding.rrt import RRT, four_waypoints, length, shortcut
from study.pathfinding.world import World, arm_clearance, boxes_between

BOX = World(np.zeros(3), np.full(3, 10.0), np.array([[[4.0, 4.0, 4.0], [6.0, 6.0, 6.0]]]))
EMPTY = World(np.zeros(3), np.full(3, 10.0), np.empty((0, 2, 3)))


def segment(a, b):
    return np.array([a], dtype=float), np.array([b], dtype=float)


def random_world(rng, n_obstacles=10, side=1000.0):
    """Random boxes in the PUMA560 paper's cube, whose obstacles are not printed; the diagonal is not free."""
    corner = np.full(3, side)
    return boxes_between(rng, (np.zeros(3), corner), (np.zeros(3), corner), n_obstacles)


@pytest.mark.parametrize(
    ("a", "b", "hit"),
    [
        ([0, 5, 5], [10, 5, 5], True),
        ([0, 5, 5], [3.9, 5, 5], False),
        ([0, 5, 5], [4.0, 5, 5], True),
        ([5, 5, 5], [5, 5, 5], True),
        ([0, 0, 0], [0, 0, 0], False),
        ([0, 3.9, 5], [10, 3.9, 5], False),
        ([3, 5, 5], [5, 3, 5], True),
        ([2.9, 5, 5], [5, 2.9, 5], False),
        ([4.5, 5, 5], [5.5, 5, 5], True),
        ([5, 5, 9], [5, 5, 7], False),
    ],
)
def test_segments_against_a_box(a, b, hit):
    assert BOX.hits(*segment(a, b))[0] == hit
    assert BOX.hits(*segment(b, a))[0] == hit
    assert (BOX.clearance(*segment(a, b))[0] == 0) == hit


def test_the_slab_test_agrees_with_dense_sampling():
    rng = np.random.default_rng(0)
    world = random_world(rng, 8, 10.0)
    start, stop = rng.uniform(0, 10, (2, 400, 3))
    u = np.linspace(0, 1, 2001)[:, None, None]
    points = (start + u * (stop - start))[:, :, None]
    inside = ((points >= world.obstacles[:, 0]) & (points <= world.obstacles[:, 1])).all(axis=3).any(axis=(0, 2))
    hits = world.hits(start, stop)
    assert (hits | ~inside).all()
    grazing = world.clearance(start, stop) < 0.02
    assert (hits == inside)[~grazing | inside].all()


@pytest.mark.parametrize(
    ("a", "b", "distance"),
    [
        ([5, 5, 9], [5, 5, 7], 1.0),
        ([0, 2, 5], [10, 2, 5], 2.0),
        ([3, 3, 5], [0, 0, 5], np.sqrt(2)),
        ([3, 3, 3], [3, 3, 3], np.sqrt(3)),
        ([2, 5, 5], [5, 2, 5], np.sqrt(0.5)),
    ],
)
def test_clearance_in_closed_form(a, b, distance):
    assert BOX.clearance(*segment(a, b))[0] == pytest.approx(distance, abs=1e-9)
    links = np.array([[a, b]], dtype=float)
    assert arm_clearance(BOX, links, 0.5)[0] == pytest.approx(distance - 0.5, abs=1e-9)


def test_no_obstacles_means_infinite_clearance():
    assert EMPTY.clearance(*segment([0, 0, 0], [1, 1, 1]))[0] == np.inf
    assert not EMPTY.hits(*segment([0, 0, 0], [1, 1, 1]))[0]


@pytest.mark.parametrize("method", ["path", "connect"])
def test_trees_find_free_paths_between_the_ends(method):
    for seed in range(5):
        rng = np.random.default_rng(seed)
        world = random_world(rng)
        start, goal = np.zeros(3), np.full(3, 1000.0)
        path = getattr(RRT(), method)(world, start, goal, rng)
        assert path[0].tolist() == start.tolist()
        assert path[-1].tolist() == goal.tolist()
        assert not world.hits(path[:-1], path[1:]).any()
        steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
        assert (steps[:-1] if method == "path" else steps).max() <= 50.0 + 1e-9
        shorter = shortcut(world, path, rng)
        assert not world.hits(shorter[:-1], shorter[1:]).any()
        assert np.sqrt(3) * 1000 <= length(shorter) <= length(path)


def test_same_seed_same_path():
    paths = []
    for _ in range(2):
        rng = np.random.default_rng(4)
        world = random_world(rng)
        paths.append(RRT().path(world, np.zeros(3), np.full(3, 1000.0), rng))
    assert paths[0].tobytes() == paths[1].tobytes()


def test_a_shortcut_through_free_space_is_the_straight_line():
    rng = np.random.default_rng(0)
    path = rng.uniform(0, 10, (30, 3))
    straight = shortcut(EMPTY, path, rng, attempts=2000)
    assert straight.tolist() == path[[0, -1]].tolist()


def test_four_waypoints():
    path = np.arange(30.0).reshape(10, 3)
    assert four_waypoints(path)[:, 0].tolist() == [0, 12, 24, 27]
    with pytest.raises(StudyError, match="at least 4 nodes"):
        four_waypoints(path[:3])


def test_mistakes_are_named():
    rng = np.random.default_rng(0)
    with pytest.raises(StudyError, match=r"goal .* lies inside an obstacle"):
        RRT().path(BOX, np.zeros(3), np.full(3, 5.0), rng)
    walls = np.array([[[4.0, 0.0, 0.0], [5.0, 10.0, 10.0]]])
    shut = World(np.zeros(3), np.full(3, 10.0), walls)
    for method in ("path", "connect"):
        with pytest.raises(StudyError, match="found no path with"):
            getattr(RRT(step=1.0, max_nodes=50), method)(shut, np.zeros(3), np.full(3, 9.0), rng)
    with pytest.raises(StudyError, match="lower corner below"):
        World(np.zeros(3), np.ones(3), np.ones((1, 2, 3)))


def test_boxes_stand_between_two_ends_in_their_space_and_leave_the_ends_free():
    lower, upper = np.array([1.0, -2.0, 0.0]), np.array([3.0, 4.0, 1.5])
    start, goal = np.array([2.0, 3.5, 0.7]), np.array([1.5, -1.5, 0.7])
    world = boxes_between(np.random.default_rng(3), (lower, upper), (start, goal), 8)
    assert (world.obstacles[:, 0] >= lower - 1e-12).all()
    assert (world.obstacles[:, 1] <= upper + 1e-12).all()
    assert not world.hits(np.array([start, goal]), np.array([start, goal])).any()
    assert world.hits(start[None], goal[None])[0]
