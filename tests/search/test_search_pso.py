"""Swarms with velocities: peers, reductions, schedules and the papers' table."""

from dataclasses import replace

import numpy as np
import pytest

from study.planning import Meter
from study.search.cfpso import CFPSO, constriction
from study.search.chaotic_spso import ChaoticSPSO
from study.search.dynamic_adaptive_pso import DynamicAdaptivePSO
from study.search.loop import minimise
from study.search.pso import PSO, VelocityUpdate, linear, swarm_at_rest
from study.search.state import Box
from tests.helpers.searches import BOX, bowl, candidates

CHI = 0.729843788128357  # Clerc and Kennedy 2002, for c1 = c2 = 2.05


def transcribed_pso(start, generations, weights, v_max, rng):
    """Plain PSO with loops over particles and dimensions, fed with the same random numbers."""
    w, c1, c2 = weights
    x, v = start.copy(), np.zeros_like(start)
    best, best_values = x.copy(), np.full(len(x), np.inf)
    leader, leader_value, seen = x[0].copy(), np.inf, []
    for _ in range(generations):
        seen.append(x.copy())
        for i, value in enumerate(bowl(x)):
            if value < best_values[i]:
                best[i], best_values[i] = x[i], value
            if value < leader_value:
                leader, leader_value = x[i].copy(), value
        r1, r2 = rng.random(x.shape), rng.random(x.shape)
        for i, j in np.ndindex(*x.shape):
            step = w * v[i, j] + c1 * r1[i, j] * (best[i, j] - x[i, j]) + c2 * r2[i, j] * (leader[j] - x[i, j])
            v[i, j] = min(max(step, -v_max[j]), v_max[j])
            x[i, j] = min(max(x[i, j] + v[i, j], BOX.lower[j]), BOX.upper[j])
    return np.array(seen)


@pytest.mark.parametrize("velocity", [VelocityUpdate(0.2), VelocityUpdate(1.0), VelocityUpdate(0.3, unit="absolute")])
def test_pso_equals_its_transcription_candidate_by_candidate(velocity):
    ours = candidates(PSO((0.7, 0.7), 1.5, 1.8, velocity))
    rng = np.random.default_rng(0)
    start = BOX.at(rng.random((12, 3)))
    v_max = velocity.clamp * BOX.width if velocity.unit == "share" else np.full(3, velocity.clamp)
    assert ours == pytest.approx(transcribed_pso(start, 25, (0.7, 1.5, 1.8), v_max, rng), abs=1e-12)
    assert (np.abs(np.diff(ours, axis=0)) <= v_max + 1e-12).all()


def test_pso_equals_pymoo_where_no_particle_meets_a_wall():
    pymoo_pso = pytest.importorskip("pymoo.algorithms.soo.nonconvex.pso")
    problem_module = pytest.importorskip("pymoo.core.problem")
    wide = Box(np.full(3, -1e3), np.full(3, 1e3))
    start = np.random.default_rng(7).normal(size=(12, 3))

    class Bowl(problem_module.Problem):
        def __init__(self):
            super().__init__(n_var=3, n_obj=1, xl=wide.lower, xu=wide.upper)

        def _evaluate(self, x, out, *args, **kwargs):
            out["F"] = bowl(x)[:, None]

    peer = pymoo_pso.PSO(
        pop_size=12, sampling=start, w=0.6, c1=1.2, c2=1.4, adaptive=False, initial_velocity="zero", pertube_best=False
    )
    peer.setup(Bowl(), seed=1, verbose=False)
    ours, rng = PSO((0.6, 0.6), 1.2, 1.4), np.random.default_rng(11)
    state = swarm_at_rest(wide, start, 30)
    for _ in range(20):
        asked = peer.ask()
        assert asked.get("X") == pytest.approx(state.candidates, abs=1e-9)
        peer.evaluator.eval(peer.problem, asked)
        peer.tell(infills=asked)
        state = ours.tell(state, bowl(state.candidates), rng)
        peer.random_state = np.random.default_rng(state.generation)
        state = ours.ask(state, np.random.default_rng(state.generation))


def test_pso_moves_with_its_problem():
    shift, stretch = np.array([3.0, -7.0, 100.0]), np.array([2.0, 0.5, 10.0])
    moved = Box(BOX.lower * stretch + shift, BOX.upper * stretch + shift)
    there = candidates(PSO(), moved, lambda x: bowl((x - shift) / stretch))
    assert there == pytest.approx(candidates(PSO()) * stretch + shift, abs=1e-9)


def test_cfpso_is_pso_with_three_times_the_constriction():
    velocity = VelocityUpdate(0.5)
    assert constriction(4.1) == pytest.approx(CHI)
    reduced = PSO((CHI, CHI), CHI * 2.05, CHI * 2.05, velocity)
    assert candidates(CFPSO(velocity=velocity)) == pytest.approx(candidates(reduced), abs=1e-9)
    inertia_only = PSO((CHI, CHI), 2.05, 2.05, velocity)
    assert candidates(CFPSO(inertia_only=True, velocity=velocity)) == pytest.approx(candidates(inertia_only), abs=1e-9)


def test_chaotic_spso_without_its_novelties_is_pso():
    bare = ChaoticSPSO(chaotic_start=False, asynchronous=False, reading="standard")
    assert (candidates(bare) == candidates(PSO())).all()
    for switch in ({"chaotic_start": True}, {"asynchronous": True}, {"reading": "as-printed"}):
        assert (candidates(replace(bare, **switch)) != candidates(PSO())).any()


def test_dynamic_adaptive_pso_with_constant_factors_moves_as_pso():
    bare = DynamicAdaptivePSO(inertia=(0.9, 0.4), learning=(2.0, 2.0), velocity=VelocityUpdate())
    rng = np.random.default_rng(0)
    state = bare.tell(bare.init(BOX, 12, 9, rng), np.arange(12.0), rng)
    moves = [search.ask(state, np.random.default_rng(5)).candidates for search in (bare, PSO())]
    assert (moves[0] == moves[1]).all()


def states(search, total):
    start = search.init(BOX, 4, total, np.random.default_rng(0))
    return [replace(start, generation=n) for n in range(total + 1)]


def test_dynamic_adaptive_schedules():
    standard, printed = DynamicAdaptivePSO(), DynamicAdaptivePSO(reading="as-printed")
    w, c1, c2 = np.transpose([standard.weights(s) for s in states(standard, 50)])
    assert (w[0], w[-1], c1[0], c1[-1], c2[0], c2[-1]) == pytest.approx((0.9, 0.1, 2.5, 1.5, 1.5, 2.5))
    assert (np.diff(w) < 0).all()
    assert (np.diff(c1) < 0).all()
    assert (np.diff(c2) > 0).all()
    w, c1, printed_c2 = np.transpose([printed.weights(s) for s in states(printed, 50)])
    assert (np.diff(w) > 0).all()
    assert np.ptp(c1) == 0
    assert c1[0] == pytest.approx(1.5, abs=1e-3)
    assert (printed_c2 == c2).all()


def test_dynamic_adaptive_start_of_eq_15():
    rng = np.random.default_rng
    above = DynamicAdaptivePSO(reading="as-printed", start_inside=False).init(BOX, 30, 9, rng(0))
    assert (above.candidates >= BOX.upper).all()
    diagonal = DynamicAdaptivePSO().init(BOX, 30, 9, rng(0))
    fractions = (diagonal.candidates - BOX.lower) / BOX.width
    assert fractions == pytest.approx(fractions[:, [0, 0, 0]])
    assert (diagonal.velocities >= 0).all()
    spread = DynamicAdaptivePSO(one_number=False).init(BOX, 30, 9, rng(0))
    assert np.ptp((spread.candidates - BOX.lower) / BOX.width, axis=1).min() > 0.01


def test_asynchronous_factors_trade_places(monkeypatch):
    seen = []
    monkeypatch.setattr(
        "study.search.chaotic_spso.moved_swarm", lambda state, rng, weights, velocity: seen.append(weights)
    )
    for state in states(ChaoticSPSO(), 10):
        ChaoticSPSO().ask(state, np.random.default_rng(0))
    w, c1, c2 = np.transpose(seen)
    assert w == pytest.approx(np.linspace(0.9, 0.4, 11))
    assert c1 == pytest.approx(np.linspace(2.5, 0.5, 11))
    assert c2 == pytest.approx(np.linspace(0.5, 2.5, 11))


def test_printed_inertia_vanishes_and_then_jumps():
    search, rng = ChaoticSPSO(reading="as-printed"), np.random.default_rng(0)
    w = np.array([search.printed_inertia(t, 100, rng) for t in range(101)])
    assert w[0] == 0
    assert w[1] == pytest.approx(8 / 100 / 2**24)
    assert w[1:61].max() < 1e-6
    assert w[61:].min() >= 0.5
    assert w[61:].max() < 0.6


def test_linear_goes_from_end_to_end():
    assert [linear((0.9, 0.4), p) for p in (0.0, 0.5, 1.0)] == pytest.approx([0.9, 0.65, 0.4])


def test_basic_pso_explains_the_papers_sphere_and_the_standard_pso_beats_it():
    """Woodworking paper, Table 3, F1: PSO 37.3 and CFPSO 1.23 with an absolute clamp of 3 and no walls."""
    box, loose = Box(np.full(30, -100.0), np.full(30, 100.0)), VelocityUpdate(3.0, unit="absolute", bounds="free")
    means = []
    for search in (PSO((1.0, 1.0), 1.49445, 1.49445, loose), CFPSO(inertia_only=True, velocity=loose), PSO()):
        meters = [Meter(lambda x: (x**2).sum(axis=1), 30_000) for _ in range(3)]
        for seed, meter in enumerate(meters):
            minimise(search, meter, box, 30, np.random.default_rng(seed))
        means.append(np.mean([meter.incumbent_value for meter in meters]))
    assert means[0] == pytest.approx(37.3, rel=0.3)
    assert means[1] == pytest.approx(1.23, rel=0.5)
    assert means[2] < 1e-2
