"""Elimination of blocks: what it solves, and that both engines do the same."""

from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

from baselines.free_path import elimination_engine
from baselines.free_path.elimination import Elimination
from baselines.free_path.interior_point import Goal, Run, frame_of, solve, started
from baselines.free_path.model import model_of
from baselines.free_path.newton import Damping, Newton, gradient
from baselines.free_path.phases import free_path
from baselines.free_path.pieces import Point
from baselines.free_path.question import of
from baselines.free_path.rows import Rows
from baselines.free_path.shared_system import gathered
from baselines.free_path.start import graded, spline_start
from study import JointLimits, Problem
from tests.helpers.reference_problems import INF


def mixed_run(free, ranged=False):
    """A run at its start, with joints of three kinds; `ranged` holds a range of positions."""
    points = np.cumsum(np.random.default_rng(5).uniform(-0.5, 0.5, (6, 4)), axis=0)
    problem = Problem("mixed", points, JointLimits([1.5] * 4, [5.0, 4.0, 5.0, INF], [50.0, 40.0, INF, INF]))
    question = of(problem)
    room = np.abs(points).max() + 0.1 if ranged else np.inf
    question = replace(
        question, range_lower=question.range_lower.clip(-room), range_upper=question.range_upper.clip(max=room)
    )
    model = model_of(question, 6, np.full((5, 4), ranged))
    frame = frame_of(model, free, graded(model))
    state = started(frame, spline_start(model, graded(model)), 0.1)
    equations = np.random.default_rng(6).normal(size=state.equations.shape)
    held = np.stack([model.kinds > 1, model.kinds > 2, np.full(4, free)], axis=1)
    return Run(frame, state._replace(equations=0.1 * equations * held))


def central(after, small):
    """Difference of what was found at both ends of a small step."""
    return (after[0] - after[1]) / (2 * small)


def test_a_newton_step_solves_the_linearised_conditions():
    run = mixed_run(free=False)
    state, frame = run.state._replace(equations=np.zeros_like(run.state.equations)), run.frame
    run, small = Run(frame, state), 1e-6
    stiffness = state.multipliers / state.slacks
    newton = Newton(frame, run.at, state.multipliers, stiffness, run.slope.costates, Damping(0.0, 0.0))
    step = run._direction(newton, stiffness, 0.05 * frame.rows.weight)
    errors, slopes = [], [run.slope]
    for sign in (small, -small):
        at = frame.rows.at(state.point.moved(step.point, sign))
        errors.append(at.errors)
        slopes.append(gradient(frame, at, -state.multipliers - sign * step.multipliers, sign * step.equations))
    now, *after = (gathered(frame.layout, slope.shared, slope.nodes, slope.durations) for slope in slopes)
    assert np.abs(central(errors, small) + run.at.errors).max() < 1e-8
    assert np.abs(central(after, small) + now).max() < 1e-7
    reached = state.multipliers * step.slacks + state.slacks * (step.multipliers + state.multipliers)
    assert np.abs(reached - 0.05 * frame.rows.weight).max() < 1e-12


def second_derivatives(run):
    state, rows = run.state, run.frame.rows
    return rows.curvature(run.at, state.multipliers, state.multipliers / state.slacks, run.slope.costates)


@pytest.mark.parametrize("free", [False, True])
def test_both_engines_eliminate_alike(free):
    module = pytest.importorskip("numba") and import_module("baselines.free_path.compiled_steps")
    run = mixed_run(free)
    arguments = (run.frame.model, run.at, second_derivatives(run), free, run.frame.shares)
    plain = Elimination(*arguments).blocks(1e-3)
    compiled = module.CompiledElimination(*arguments).blocks(1e-3)
    rng = np.random.default_rng(8)
    right, shared = rng.normal(size=plain.cross.shape[:3]), rng.normal(size=(*plain.cross.shape[:2], 7))
    results = []
    for blocks in (plain, compiled):
        start, onto = blocks.begin(right, run.at.errors)
        results.append((onto, *blocks.complete(right, start, shared), blocks.reduced))
    for expected, found in zip(*results, strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("ranged", [False, True])
@pytest.mark.parametrize("free", [False, True])
def test_both_engines_evaluate_alike(free, ranged):
    module = pytest.importorskip("numba") and import_module("baselines.free_path.compiled_pieces")
    run = mixed_run(free, ranged)
    plain, state, rng = run.frame.rows, run.state, np.random.default_rng(9)
    compiled = module.CompiledRows(plain.model, plain.bounds)
    step = Point(*(rng.normal(size=part.shape) for part in state.point))
    stiffness, ends = state.multipliers / state.slacks, rng.normal(size=(*plain.model.shape[:2], 2))
    results = []
    for rows in (plain, compiled):
        at = rows.at(state.point)
        costates = rows.pull(at, state.multipliers, ends)
        curved = rows.curvature(at, state.multipliers, stiffness, costates)
        results.append((at.states, at.rows, at.errors, rows.change(at, step), *costates, np.tril(curved)))
    for expected, found in zip(*results, strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-12 * max(1.0, np.abs(expected).max()))


def test_both_engines_give_the_same_duration(monkeypatch):
    pytest.importorskip("numba")
    points = np.cumsum(np.random.default_rng(7).uniform(-0.5, 0.5, (8, 3)), axis=0)
    question = of(Problem("walk", points, JointLimits([1.5] * 3, [5.0] * 3, [50.0] * 3)))
    durations = []
    for engine in ("numpy", "numba"):
        monkeypatch.setenv("STUDY_ENGINE", engine)
        durations.append(free_path(question).motion.duration)
    assert durations[0] == pytest.approx(durations[1], rel=1e-5)


def test_nobody_waits_for_the_compiler_unasked(monkeypatch):
    monkeypatch.delenv("STUDY_ENGINE", raising=False)
    monkeypatch.setattr(elimination_engine, "kept", lambda: False)
    assert elimination_engine.code_for(mixed_run(True).frame.model) == (Rows, Elimination)


def test_the_method_stops_where_the_conditions_hold():
    run = mixed_run(False)
    state = started(run.frame, run.state.point, 0.1)
    ended = Run(run.frame, solve(run.frame, state, Goal(1e-6, 1e-5)).state)
    assert ended.mu <= 1e-6
    assert max(ended.primal, ended.dual) <= 1e-5
