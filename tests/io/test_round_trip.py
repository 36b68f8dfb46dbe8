"""What the program writes it reads back to the same motion: every form, every wish about time, any names."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from study import JointLimits, Problem, StudyError, judge, plan
from study.cases.recorded import with_room
from study.io.exact import read_exact
from study.io.export import FORMS, controller_points, write_motion
from study.io.recordings import read_samples
from study.io.sampled import joined
from study.io.sampling import Sampling
from study.parametric import ParametricTrajectory
from study.problem import EndCondition, Timing
from study.trajectory import Trajectory

CHEAP = settings(max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
FEW, MANY = settings(CHEAP, max_examples=5), settings(CHEAP, max_examples=60)
NAMES = st.text(st.characters(categories=["L", "N", "P", "S"], exclude_characters="#"), min_size=1, max_size=12)
SAMPLED = [form for form in FORMS if form != ".exact.json"]
SAMPLINGS = st.one_of(
    st.just(Sampling()),
    st.floats(3.0, 900.0).map(lambda rate: Sampling(rate=rate)),
    st.integers(2, 300).map(lambda points: Sampling(points=points)),
)


@st.composite
def problems(draw):
    """Waypoints of one to three joints with odd names, limits of two or three orders, and one wish about time."""
    n_joints, n_waypoints = draw(st.integers(1, 3)), draw(st.integers(2, 4))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    jerk = rng.uniform(5, 50, n_joints) if draw(st.booleans()) else None
    limits = JointLimits(rng.uniform(0.5, 3, n_joints), rng.uniform(1, 9, n_joints), jerk)
    rows = rng.uniform(-2, 2, (n_waypoints, n_joints)) * 10.0 ** draw(st.integers(-2, 0))
    names = draw(st.lists(NAMES, min_size=n_joints, max_size=n_joints, unique=True))
    problem = Problem("any", rows, limits, joint_names=names)
    wish = draw(st.sampled_from(["none", "duration", "speed", "cycle"]))
    if wish == "speed":
        return problem.at_speed(draw(st.floats(0.3, 1.0)))
    if wish == "cycle":
        return replace(problem, timing=Timing(cycle=draw(st.sampled_from([0.004, 0.008, 0.05]))))
    shortest = plan(problem, "ruckig-stops").duration
    return (
        replace(problem, timing=Timing(exactly=shortest * draw(st.floats(1.0, 5.0)))) if wish == "duration" else problem
    )


def check_samples(tmp_path, problem, sampling, form):
    motion = plan(problem, "ruckig-stops").motion
    if sampling.points is None and motion.duration * (sampling.rate or 0.0) > 5_000:
        sampling = Sampling()
    back = read_samples(write_motion(motion, problem, tmp_path / f"m{form}", sampling))
    back = back.of(problem.joint_names, "file")
    assert back.names == problem.joint_names
    assert back.times[0] == 0.0
    assert back.times[-1] == pytest.approx(motion.duration, abs=1e-9)
    scale = np.abs(problem.waypoints).max()
    np.testing.assert_allclose(back.positions, motion(back.times), rtol=0, atol=1e-13 * scale)
    for order, rate in enumerate(back.rates, start=1):
        room = 1e-7 * motion.extrema(order).peak.max()
        np.testing.assert_allclose(rate, motion(back.times, order), rtol=1e-12, atol=room)
        assert (order > 1 and problem.end is EndCondition.REST) or not rate[[0, -1]].any()
    if sampling.points is not None:
        assert len(back.times) == sampling.points
    cycle = problem.timing.cycle if problem.timing else None
    if cycle is not None and sampling == Sampling():
        assert np.diff(back.times) == pytest.approx(cycle, abs=2e-9)
    elif sampling == Sampling() and form != ".npz":  # of which `check` reads the exact coefficients
        again = joined(back, problem, "file").trajectory
        assert judge(with_room(problem, 1e-3), again).feasible
        times = np.linspace(0, motion.duration, 301)
        np.testing.assert_allclose(again(times), motion(times), atol=1e-6 * max(np.ptp(problem.waypoints), 1e-3))


@FEW
@given(problem=problems(), sampling=SAMPLINGS, form=st.sampled_from(SAMPLED))
def test_samples_are_the_motion_s_own(tmp_path, problem, sampling, form):
    check_samples(tmp_path, problem, sampling, form)


@pytest.mark.slow
@pytest.mark.timeout(600)
@MANY
@given(problem=problems(), sampling=SAMPLINGS, form=st.sampled_from(SAMPLED))
def test_samples_of_many_motions_are_their_own(tmp_path, problem, sampling, form):
    check_samples(tmp_path, problem, sampling, form)


@FEW
@given(problem=problems(), sampling=SAMPLINGS)
def test_points_for_a_controller_are_those_of_the_message(tmp_path, problem, sampling):
    planned = plan(problem, "ruckig-stops")
    points = planned.points(sampling.rate, sampling.points)
    back = read_samples(planned.write(tmp_path / "m.json", sampling.rate, sampling.points))
    np.testing.assert_array_equal(points.nanoseconds, back.nanoseconds)
    for mine, other in zip((points.positions, *points.rates), (back.positions, *back.rates), strict=True):
        np.testing.assert_array_equal(mine, other)
    np.testing.assert_array_equal(points.positions[:-1], planned.motion(points.nanoseconds[:-1] / 1e9))
    np.testing.assert_array_equal(points.positions[-1], planned.motion(planned.motion.duration)[0])


@st.composite
def motions(draw):
    """Piecewise polynomials with numbers of any size, and curves over a parameter."""
    n_pieces, n_joints, degree = draw(st.integers(1, 4)), draw(st.integers(1, 3)), draw(st.integers(1, 7))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    widths = rng.uniform(0.01, 3, n_pieces)
    knots = np.concatenate([[0.0], np.cumsum(widths)])
    numbers = rng.normal(size=(n_pieces, degree + 1, n_joints)) * 10.0 ** rng.integers(
        -9, 9, (n_pieces, degree + 1, n_joints)
    )
    if draw(st.booleans()):
        return Trajectory(knots, numbers, knots)
    times = np.column_stack([knots[:-1], widths])
    return ParametricTrajectory(times, numbers)


@CHEAP
@given(motion=motions(), form=st.sampled_from([".exact.json", ".npz"]))
def test_polynomials_come_back_to_the_last_bit(tmp_path, motion, form):
    width = motion(0.0).shape[-1]
    limits = JointLimits(np.ones(width), np.ones(width))
    problem = Problem("any", np.array([[0.0] * width, [1.0] * width]), limits)
    back = read_exact(write_motion(motion, problem, tmp_path / f"m{form}", Sampling(points=5)))
    assert type(back) is type(motion)
    parts = (
        ("time", "position")
        if isinstance(motion, ParametricTrajectory)
        else ("knots", "coefficients", "waypoint_times")
    )
    for part in parts:
        np.testing.assert_array_equal(getattr(back, part), getattr(motion, part))


@CHEAP
@given(rows=st.lists(st.lists(st.floats(-1e6, 1e6), min_size=2, max_size=2), min_size=2, max_size=9))
def test_plain_rows_are_read_from_every_form_of_array(tmp_path, rows):
    table = np.array(rows)
    np.save(tmp_path / "q.npy", table)
    np.savez(tmp_path / "q.npz", q=table)
    np.savetxt(tmp_path / "q.csv", table, delimiter=";", fmt="%r" if np.ndim(table) == 0 else "%.17g")
    np.savetxt(tmp_path / "q.txt", table, fmt="%.17g")
    for name in ("q.npy", "q.npz", "q.csv", "q.txt"):
        np.testing.assert_array_equal(read_samples(tmp_path / name).positions, table)


def test_points_that_no_arm_can_follow_are_refused_unless_accepted():
    problem = Problem("fast", np.array([[0.0], [1.0], [0.5]]), JointLimits(np.array([1.0])))
    motion = plan(problem, "ruckig-stops").motion
    with pytest.raises(StudyError, match="nothing is written for a controller"):
        controller_points(motion, problem)
    points = controller_points(motion, problem, accept_unbounded_acceleration=True)
    assert points.velocities is None
    assert points.positions[-1] == 0.5


@pytest.mark.parametrize("sampling", [Sampling(), Sampling(points=2)])
@pytest.mark.parametrize("name", ["a;b", "c\td", "0"])
def test_two_points_at_rest_and_names_with_separators_come_back(tmp_path, sampling, name):
    problem = Problem("any", np.array([[-1.9], [1.3]]), JointLimits([1.2], [1.3], [33.7]), joint_names=(name,))
    check_samples(tmp_path, problem, sampling, ".csv")


@pytest.mark.parametrize("seed", [0, 6, 7, 15])
def test_samples_at_bends_are_the_motion_again_within_a_thousandth(tmp_path, seed):
    rng = np.random.default_rng(seed)
    n_joints, n_waypoints = int(rng.integers(1, 8)), int(rng.integers(2, 14))
    waypoints = np.cumsum(rng.uniform(-1, 1, (n_waypoints, n_joints)), axis=0)
    limits = JointLimits(rng.uniform(1, 3, n_joints), rng.uniform(2, 8, n_joints), rng.uniform(20, 100, n_joints))
    problem = Problem("bends", waypoints, limits)
    planned = plan(problem, "free-path")
    for form in SAMPLED:
        planned.write(tmp_path / f"a{form}")
        again = joined(read_samples(tmp_path / f"a{form}"), problem, "here").trajectory
        assert judge(with_room(problem, 1e-3), again).feasible
