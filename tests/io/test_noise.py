"""Noise of a recording that its tolerance covers costs next to nothing."""

from dataclasses import replace

import numpy as np
import pytest

from study import judge, plan
from study.cases.library import own_case
from study.io.passages import passages

S = np.linspace(0, 1, 80)[:, None]
STRAIGHT = np.array([0.8, -0.5, 0.3, 0.6, -0.2, 0.4])


def taught(kind, rng):
    """A smooth path of six joints as 80 rows, rad."""
    if kind == "waves":
        return rng.uniform(0.3, 1.0, 6) * np.sin(2 * np.pi * rng.uniform(0.5, 1.5, 6) * S + rng.uniform(0, 6, 6))
    if kind == "polynomials":
        return sum(rng.normal(0, 0.6, 6) * S ** (k + 1) for k in range(5))
    if kind == "arc":
        return np.hstack(
            [0.5 * np.cos(np.pi * S), 0.5 * np.sin(np.pi * S), 0.3 * S, 0.1 * S**2, 0.2 * S**2, 0.3 * S**3]
        )
    return STRAIGHT * S


def duration(folder, rows, **more):
    limits = {"velocity": 2.0, "acceleration": 6.0, "jerk": 60.0}
    case = own_case({"units": "rad", "waypoints": rows.tolist(), "limits": limits, **more}, folder / "mine.yaml")
    return plan(case.problem).duration


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("kind", ["waves", "polynomials", "arc", "line"])
def test_half_a_milliradian_of_noise_costs_at_most_a_tenth(tmp_path, kind, seed):
    rng = np.random.default_rng([seed, len(kind)])
    rows = taught(kind, rng)
    noisy = rows + rng.normal(0, 5e-4, rows.shape)
    assert duration(tmp_path, noisy, tolerance=0.001) <= 1.1 * duration(tmp_path, rows)


def test_a_straight_recording_is_planned_within_its_tolerance(tmp_path):
    plain = duration(tmp_path, STRAIGHT * S[[0, -1]])
    assert plain * 0.98 < duration(tmp_path, STRAIGHT * S, tolerance=0.001) < plain


def test_passages_of_a_motion_with_tolerances_are_found_inside_them(tmp_path):
    rows = taught("arc", np.random.default_rng(0))[::4, :3] + np.random.default_rng(1).normal(0, 1e-3, (20, 3))
    limits = {"velocity": 2.0, "acceleration": 6.0}
    content = {"units": "rad", "waypoints": rows.tolist(), "limits": limits, "tolerance": 0.003}
    problem = own_case(content, tmp_path / "mine.yaml").problem
    motion = plan(problem, "free-path").motion
    times = passages(motion.knots, motion.coefficients, problem.waypoints, problem.tolerances)
    assert (np.diff(times) >= 0).all()
    assert judge(problem, replace(motion, waypoint_times=times)).feasible
