"""L-SHADE against its transcription in scalar loops, against a peer, and the parts of its success history by hand."""

from __future__ import annotations

import importlib

import numpy as np
import pytest

from study import StudyError
from study.planning import Meter
from study.search.cma_es import CMAES
from study.search.loop import minimise
from study.search.lshade import LSHADE, Memory, parameters, two_others
from study.search.state import Box

BOX = Box(np.array([-3.0, -1.0, 0.5]), np.array([2.0, 4.0, 6.0]))


def valley(x):
    return (100.0 * (x[:, 1:] - x[:, :-1] ** 2) ** 2 + (1.0 - x[:, :-1]) ** 2).sum(axis=1)


def populations(search, budget, population=20, seed=0, objective=valley, box=BOX):
    seen = []
    meter = Meter(lambda x: seen.append(x.copy()) or objective(x), budget)
    minimise(search, meter, box, population, np.random.default_rng(seed))
    return seen


def corrected(v, x, low, high):
    if v < low:
        v = (low + x) / 2
    return (high + x) / 2 if v > high else v


def trial(i, x, archive, pick, f, cr, uniform, forced):
    """One trial vector, coordinate by coordinate; `pick` are the numbers of pbest, r1 and r2."""
    pool = [*x, *archive]
    best, r1, r2 = x[pick[0]], x[pick[1]], pool[pick[2]]
    u = x[i].copy()
    for j in range(len(u)):
        if uniform[j] < cr or j == forced:
            v = x[i][j] + f * (best[j] - x[i][j]) + f * (r1[j] - r2[j])
            u[j] = corrected(v, x[i][j], BOX.lower[j], BOX.upper[j])
    return u


def mean(values, gains):
    return sum(g * v * v for g, v in zip(gains, values, strict=True)) / sum(
        g * v for g, v in zip(gains, values, strict=True)
    )


def transcribed(n, budget, seed):
    """The algorithm member by member, with the draws of our implementation in their order."""
    rng = np.random.default_rng(seed)
    x = list(BOX.at(rng.random((n, 3))))
    seen, values = [np.array(x)], list(valley(np.array(x)))
    m_f, m_cr, k, archive, spent, first = [0.5] * 6, [0.5] * 6, 0, [], n, n
    while spent < budget:
        f, cr = parameters(Memory(np.array(m_f), np.array(m_cr), k), len(x), rng)
        ranked = sorted(range(len(x)), key=values.__getitem__)[: max(2, round(0.11 * len(x)))]
        best = rng.choice(np.array(ranked), size=len(x))
        r1, r2 = two_others(len(x), len(x) + len(archive), rng)
        uniform, forced = rng.random((len(x), 3)), rng.integers(3, size=(len(x), 1))[:, 0]
        picks = list(zip(best, r1, r2, strict=True))
        trials = [trial(i, x, archive, picks[i], f[i], cr[i], uniform[i], forced[i]) for i in range(len(x))]
        seen.append(np.array(trials))
        told, won, losers = valley(np.array(trials)), [], []
        for i, u in enumerate(trials):
            if told[i] < values[i]:
                won.append((f[i], cr[i], values[i] - told[i]))
                losers.append(x[i])
            if told[i] <= values[i]:
                x[i], values[i] = u, told[i]
        if won:
            s_f, s_cr, gains = zip(*won, strict=True)
            m_f[k] = mean(s_f, gains)
            m_cr[k] = np.nan if np.isnan(m_cr[k]) or max(s_cr) == 0 else mean(s_cr, gains)
            k = (k + 1) % 6
        spent += len(trials)
        size = round((4 - first) / budget * min(spent, budget) + first)
        worst = set(sorted(range(len(x)), key=values.__getitem__)[size:])
        x = [member for i, member in enumerate(x) if i not in worst]
        values = [value for i, value in enumerate(values) if i not in worst]
        room = round(2.6 * len(x))
        old = np.sort(rng.permutation(len(archive))[: max(room - len(losers), 0)])
        archive = ([archive[i] for i in old] + losers)[:room]
    return seen


@pytest.mark.parametrize("seed", range(3))
def test_lshade_equals_its_transcription_candidate_by_candidate(seed):
    ours = populations(LSHADE(), 600, seed=seed)
    theirs = transcribed(20, 600, seed)
    assert len(ours) > 40
    for mine, other in zip(ours[:-1], theirs, strict=False):
        np.testing.assert_allclose(mine, other, rtol=1e-9)


def test_the_population_shrinks_in_a_line_from_the_first_size_to_four():
    sizes = [len(x) for x in populations(LSHADE(), 2000)]
    spent = np.cumsum(sizes)
    planned = np.rint((4 - 20) * spent[1:-2] / 2000 + 20)
    np.testing.assert_array_equal(sizes[2:-1], planned)
    assert sizes[:2] == [20, 20]
    assert sizes[-2] in (4, 5)


def test_own_populations_follow_their_algorithms_rules():
    wide = Box(np.zeros(19), np.ones(19))
    rng = np.random.default_rng(0)
    assert LSHADE(own_population=True).init(wide, 24, 333, rng).candidates.shape == (18 * 19, 19)
    state = CMAES(own_population=True).init(wide, 24, 333, rng)
    assert state.candidates.shape == (4 + 8, 19)  # 3 ln 19 = 8.8
    assert state.generations == 24 * 333 // 12


@pytest.mark.parametrize("search", [LSHADE(own_population=True), CMAES(own_population=True)])
def test_own_populations_spend_the_same_budget(search):
    meter = Meter(valley, 777)
    minimise(search, meter, BOX, 30, np.random.default_rng(1))
    assert meter.evaluations == 777
    assert len(meter.history) != -(-777 // 30)


def test_success_history_takes_lehmer_means_weighted_by_gains():
    memory = Memory(np.full(6, 0.5), np.full(6, 0.5), 5)
    updated = memory.updated(np.array([0.4, 0.8]), np.array([0.0, 0.6]), np.array([1.0, 3.0]))
    assert updated.factors[5] == pytest.approx((0.4**2 + 3 * 0.8**2) / (0.4 + 3 * 0.8))
    assert updated.crossovers[5] == pytest.approx(0.6)
    assert updated.slot == 0
    assert memory.factors.tolist() == [0.5] * 6
    assert memory.updated(np.empty(0), np.empty(0), np.empty(0)) is memory


def test_a_crossover_memory_without_crossover_is_terminal_for_good():
    memory = Memory(np.full(1, 0.5), np.full(1, 0.5), 0).updated(np.ones(2), np.zeros(2), np.ones(2))
    assert np.isnan(memory.crossovers[0])
    assert np.isnan(memory.updated(np.ones(2), np.ones(2), np.ones(2)).crossovers[0])
    assert (parameters(memory, 50, np.random.default_rng(0))[1] == 0.0).all()


def test_an_infinite_gain_weighs_as_the_largest_finite_one():
    memory = Memory(np.full(1, 0.5), np.full(1, 0.5), 0)
    gains, f, cr = np.array([np.inf, 2.0, 1.0]), np.array([0.2, 0.4, 0.6]), np.array([0.1, 0.2, 0.3])
    finite = memory.updated(f, cr, np.array([2.0, 2.0, 1.0]))
    assert memory.updated(f, cr, gains).factors == pytest.approx(finite.factors)
    every = memory.updated(f, cr, np.full(3, np.inf))
    assert every.factors == pytest.approx(memory.updated(f, cr, np.ones(3)).factors)


def test_drawn_parameters_are_cauchy_and_normal_around_their_slots():
    memory = Memory(np.array([0.3, 0.9]), np.array([0.2, 0.2]), 0)
    f, cr = parameters(memory, 40_000, np.random.default_rng(3))
    assert ((f > 0.0) & (f <= 1.0)).all()
    assert ((cr >= 0.0) & (cr <= 1.0)).all()
    assert np.median(cr) == pytest.approx(0.2, abs=0.01)
    assert (f == 1.0).mean() == pytest.approx(0.15, abs=0.03)  # of a Cauchy number at 0.9 a quarter exceeds 1


@pytest.mark.parametrize("n_pool", [4, 7])
def test_the_two_others_are_others_and_evenly_drawn(n_pool):
    """For the third of four members: the second other is not the first, which is a member."""
    rng = np.random.default_rng(5)
    pairs = np.array([two_others(4, n_pool, rng) for _ in range(6000)])
    own = np.arange(4)
    assert (pairs[:, 0] != own).all()
    assert (pairs[:, 1] != own).all()
    assert (pairs[:, 0] != pairs[:, 1]).all()
    counts = np.bincount(pairs[:, 1, 2], minlength=n_pool)
    assert counts[2] == 0
    expected = np.repeat([6000 * 2 / 3, 6000], [3, n_pool - 4]) / (n_pool - 2)
    assert np.delete(counts, 2) == pytest.approx(expected, rel=0.1)


def test_the_archive_keeps_losers_up_to_its_size():
    search, rng = LSHADE(), np.random.default_rng(2)
    state = search.init(BOX, 10, 30, rng)
    for _ in range(25):
        previous = state
        state = search.tell(state, valley(state.candidates), rng)
        assert len(state.archive) <= round(2.6 * len(state.members))
        lost = state.archive[len(state.archive) - (len(state.archive) > 0) :]
        assert all(any(np.array_equal(row, old) for old in [*previous.members, *previous.archive]) for row in lost)
        state = search.ask(state, rng)


def test_an_objective_without_values_breaks_nothing():
    with np.errstate(all="raise"):
        seen = populations(LSHADE(), 300, objective=lambda x: np.full(len(x), np.inf))
    assert np.isfinite(np.concatenate(seen)).all()


def test_too_few_members_are_refused():
    with pytest.raises(StudyError, match="L-SHADE needs a population of at least 4, got 3"):
        populations(LSHADE(), 300, population=3)


def test_lshade_is_as_good_as_niapys():
    """The peer has the same constants and another archive order; medians of six runs, in orders of magnitude."""
    shade = pytest.importorskip("niapy.algorithms.modified.shade", reason="the peer package niapy is not installed")
    problem_module, task_module = importlib.import_module("niapy.problems"), importlib.import_module("niapy.task")

    class Valley(problem_module.Problem):
        def _evaluate(self, x):
            return float(valley(x[None])[0])

    box, ours, theirs = Box(np.full(5, -2.0), np.full(5, 2.0)), [], []
    for seed in range(6):
        meter = Meter(valley, 2000)
        minimise(LSHADE(), meter, box, 40, np.random.default_rng(seed))
        ours.append(meter.incumbent_value)
        peer = shade.LpsrSuccessHistoryAdaptiveDifferentialEvolution(
            population_size=40, extern_arc_rate=2.6, pbest_factor=0.11, hist_mem_size=6, seed=seed
        )
        task = task_module.Task(problem=Valley(dimension=5, lower=-2.0, upper=2.0), max_evals=2000)
        theirs.append(peer.run(task)[1])
    assert np.log10(np.median(ours)) == pytest.approx(np.log10(np.median(theirs)), abs=1.0)
