"""Problems for tests: a few in which each demand binds in turn, and random ones of every kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from study.arm import ArmLimits
from study.errors import StudyError
from study.mechanism import Mechanism
from study.problem import EndCondition, Floats, JointLimits, Problem, State, StraightPath, Timing, Tube

HALVINGS = 100
"""Times that a given start is halved at most until it leaves room to stop."""


def random_problem(rng: np.random.Generator, name: str = "random") -> Problem:
    """Draw a problem of any kind.

    1 to 8 joints, some of which stand still or nearly so; 2 to 200 waypoints; sizes and limits over six decades; jerk and
    acceleration limited for all joints, for some or for none; ranges of positions, limits by direction, free and moving
    ends; and now and then stops, dwells, tolerances, paths, durations and limits of segments.

    Parameters
    ----------
    rng : numpy.random.Generator
    name : str
    """
    n_joints = int(rng.integers(1, 9))
    n_waypoints = int(rng.integers(2, 26)) if rng.random() < 0.95 else int(rng.integers(26, 201))
    size = 10.0 ** rng.uniform(-3, 3, n_joints)
    waypoints = size * np.cumsum(rng.uniform(-1.0, 1.0, (n_waypoints, n_joints)), axis=0)
    if n_joints > 1 and rng.random() < 0.25:
        waypoints[:, 0] = size[0] + rng.choice([0.0, 1e-16, 1e-12, 1e-6]) * size[0] * rng.normal(size=n_waypoints)
    rates = size * 10.0 ** rng.uniform(-1.5, 1.5, (3, n_joints))
    rates[int(rng.integers(3)) + 1 :, rng.random(n_joints) < rng.choice([1.0, 0.5], p=[0.8, 0.2])] = np.inf
    problem = Problem(name, waypoints, JointLimits(*rates))
    if rng.random() < 0.7:
        problem = replace(problem, end=list(EndCondition)[int(rng.choice(3, p=[0.2, 0.5, 0.3]))])
    for more, share in _MORE.items():
        if rng.random() < share:
            problem = _with(rng, problem, more)
    return _calmed(problem)


def _calmed(problem: Problem) -> Problem:
    """Slow a given start down until the joints can stop within the range and within the path's radius, so that there is
    a motion; where the path must be straight, the start points along it.
    """
    start = problem.start
    if not isinstance(start, State) or start.velocity is None:
        return problem
    velocity, limits = start.velocity, problem.segment_limits.get(0, problem.limits)
    place, step = problem.waypoints[0], problem.waypoints[1] - problem.waypoints[0]
    room = np.minimum(place - limits.lower, limits.upper - place)
    if problem.path is not None:
        room = np.minimum(room, problem.path.of(problem.n_joints))
    if isinstance(problem.path, StraightPath):
        moves = step != 0
        velocity = step * np.min(np.abs(velocity[moves] / step[moves]), initial=np.inf) if moves.any() else 0.0 * step
    _, acceleration, jerk = limits.rates
    factor = 1.0
    for _ in range(HALVINGS):
        speed = factor * np.abs(velocity)
        if (speed * (speed / acceleration + 2 * np.sqrt(speed / jerk)) <= room / 4).all():  # no stop takes longer
            break
        factor /= 2
    return replace(problem, start=replace(start, velocity=factor * velocity))


def _with(
    rng: np.random.Generator, problem: Problem, more: Callable[[np.random.Generator, Problem], Problem]
) -> Problem:
    try:
        return more(rng, problem)
    except StudyError:  # the demand contradicts what the problem has
        return problem


def _with_range(rng: np.random.Generator, problem: Problem) -> Problem:
    points = problem.waypoints
    room = np.ptp(points, axis=0).max() * rng.choice([0.0, 0.05, 1.0]) + 1e-6
    lower, upper = points.min(axis=0) - room, points.max(axis=0) + room
    return replace(problem, limits=replace(problem.limits, lower=lower, upper=upper))


def _by_direction(rng: np.random.Generator, problem: Problem) -> Problem:
    limits, shares = problem.limits, rng.uniform(0.3, 1.0, (3, problem.n_joints))
    lowest: dict[str, Floats] = dict(
        zip(("min_velocity", "min_acceleration", "min_jerk"), -limits.rates * shares, strict=True)
    )
    return replace(problem, limits=replace(limits, **lowest))


def _moving(rng: np.random.Generator, problem: Problem) -> Problem:
    if rng.random() < 0.3:
        return replace(problem, start=EndCondition.FREE, finish=EndCondition.REST)
    limit = np.where(np.isfinite(problem.limits.velocity), problem.limits.velocity, 1.0)
    start = State(0.1 * limit * rng.uniform(-1, 1, problem.n_joints))
    return replace(problem, start=start, finish=EndCondition.FREE if rng.random() < 0.5 else None)


def _stopping(rng: np.random.Generator, problem: Problem) -> Problem:
    return replace(problem, stops=[int(rng.integers(1, problem.n_waypoints))])


def _dwelling(rng: np.random.Generator, problem: Problem) -> Problem:
    time = problem.duration_bounds[1] * rng.uniform(0.01, 0.1)
    return replace(problem, dwells={int(rng.integers(1, problem.n_waypoints)): float(time)})


def _tolerant(rng: np.random.Generator, problem: Problem) -> Problem:
    share = 10.0 ** rng.uniform(-4, -1, (problem.n_waypoints, 1))
    return replace(problem, tolerance=share * np.ptp(problem.waypoints, axis=0))


def _shaped(rng: np.random.Generator, problem: Problem) -> Problem:
    radius = np.maximum(np.ptp(problem.waypoints, axis=0), 1e-3) * 10.0 ** rng.uniform(-2, 0)
    return replace(problem, path=Tube(radius) if rng.random() < 0.5 else StraightPath(radius))


def _timed(rng: np.random.Generator, problem: Problem) -> Problem:
    time = problem.duration_bounds[1]
    return replace(problem, timing=Timing(at_least=time) if rng.random() < 0.5 else Timing(cycle=time / 1000))


def _by_segment(rng: np.random.Generator, problem: Problem) -> Problem:
    slower = problem.limits.scaled(float(rng.uniform(1.0, 3.0)))
    return replace(problem, segment_limits={int(rng.integers(problem.n_segments)): slower})


_MORE: dict[Callable[[np.random.Generator, Problem], Problem], float] = {
    _with_range: 0.3,
    _by_direction: 0.15,
    _moving: 0.1,
    _stopping: 0.05,
    _dwelling: 0.05,
    _tolerant: 0.05,
    _shaped: 0.05,
    _timed: 0.05,
    _by_segment: 0.05,
}


def example_problems() -> tuple[Problem, ...]:
    """Small problems in which each limit and each demand binds in turn, with joints that hardly move."""
    four = np.array([[0.0, 0.2], [0.5, -0.1], [0.9, 0.3], [1.4, 0.1]])
    loose, tight = np.full(2, 100.0), np.array([1.0, 0.8])
    plain = JointLimits(tight, 2 * tight)
    moving = JointLimits(np.ones(3), 2 * np.ones(3), 20 * np.ones(3))
    still = np.column_stack([four, np.full(4, 0.7)])
    noisy = np.column_stack([four, 0.7 + 1e-12 * np.array([0, 1, -1, 0.5])])
    inside = replace(plain, lower=np.array([-0.01, -0.11]), upper=np.array([1.41, 0.31]))
    rest, smooth, free = EndCondition.REST, EndCondition.SMOOTH, EndCondition.FREE
    jerky = Problem("jerk", four, JointLimits(tight, 2 * tight, 20 * tight))
    slow = JointLimits(0.3 * tight)
    return (
        Problem("velocity binds", four, JointLimits(tight, loose, 100 * loose), rest),
        Problem("acceleration binds", four, JointLimits(loose, tight, 100 * loose), rest),
        Problem("jerk binds", four, JointLimits(loose, loose, tight), rest),
        Problem("no jerk limit", four, plain, rest),
        Problem("a joint that does not move", still, moving, rest),
        Problem("two waypoints", four[:2], plain, rest),
        Problem("smooth ends", four, JointLimits(tight, 2 * tight, 20 * tight), smooth),
        Problem("free ends", four, plain, EndCondition.FREE),
        Problem("a joint that moves by its noise", noisy, moving, smooth),
        Problem("a tight range of positions", four, inside, rest),
        Problem("another limit backwards", four, replace(plain, min_velocity=-0.5 * tight), rest),
        replace(jerky, name="a moving start", start=State(0.2 * tight, -0.5 * tight)),
        replace(jerky, name="a free start", start=free),
        replace(jerky, name="a stop", stops=[1]),
        replace(jerky, name="a dwell", dwells={2: 0.2}),
        replace(jerky, name="a slow segment", segment_limits={1: slow}),
        replace(jerky, name="a tolerance", tolerance=np.array(0.02)),
        replace(jerky, name="straight lines", path=StraightPath(np.array(0.05))),
        replace(jerky, name="a tube", path=Tube(np.array(0.03))),
        replace(jerky, name="a heavy arm", arm=ArmLimits(_two_links(), np.array([60.0, 20.0]), 0.6, 1.5)),
        replace(jerky, name="a duration", timing=Timing(exactly=5.0)),
        replace(jerky, name="whole cycles", timing=Timing(cycle=0.01)),
    )


def _two_links() -> Mechanism:
    """Two links of half a metre in a vertical plane, with a point mass at the end of each."""
    origins, centres = np.tile(np.eye(4), (3, 1, 1)), np.array([[0.5, 0.0, 0.0]] * 2)
    origins[0, :3, :3] = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    origins[1:, 0, 3] = 0.5
    nothing = np.zeros(2)
    masses, bodies = np.array([3.0, 2.0]), np.zeros((2, 3, 3))
    return Mechanism(origins[:2], nothing, masses, centres, bodies, nothing, nothing, nothing, tool=origins[2])
