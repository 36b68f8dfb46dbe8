import importlib
import math
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from study.comparison import statistics
from study.comparison.claims import against
from study.comparison.claims_shown import claimed_together
from study.comparison.contestants import Contestant, Level, Reference
from study.comparison.ranking import levelled, omnibus, pairings
from study.errors import StudyError


def test_a12_by_hand():
    # pairs (1,2) (1,3) (2,3) smaller, (2,2) tied: 3.5 of 4
    assert statistics.a12([1, 2], [2, 3]) == 3.5 / 4
    assert statistics.a12([2, 3], [1, 2]) == 0.5 / 4
    assert statistics.a12([5, 5], [5, 5]) == 0.5


def test_a12_takes_failed_runs_as_the_worst_and_equal_to_one_another():
    assert statistics.a12([1.0, np.inf], [np.inf, np.inf]) == 3 / 4


def test_signed_rank_by_hand():
    # five differences of one sign: 2 of the 2^5 sign patterns are as extreme
    assert statistics.signed_rank([1, 2, 3, 4, 5], [2, 4, 6, 8, 10]) == pytest.approx(2 / 32)
    # ranks 1, 2, 3, of which the least is negative: W = 1, patterns with a rank sum of at most 1: {} and {1}, on both sides
    assert statistics.signed_rank([1.0, 5.0, 6.0], [2.0, 3.0, 3.0]) == pytest.approx(4 / 8)
    assert statistics.signed_rank([1, 1], [1, 1]) == 1.0


@pytest.mark.parametrize("seed", range(4))
def test_signed_rank_of_few_pairs_with_ties_is_that_of_all_sign_patterns(seed):
    first, second = np.random.default_rng(seed).integers(0, 5, size=(2, 7)).astype(float)
    assert statistics.signed_rank(first, second) == pytest.approx(stats.wilcoxon(first, second).pvalue, rel=1e-12)


def test_signed_rank_needs_pairs():
    with pytest.raises(StudyError, match="needs pairs, got 2 and 3"):
        statistics.signed_rank([1, 2], [1, 2, 3])


def test_rank_sum_by_hand():
    # complete separation of 3 and 3: 2 of C(6, 3) = 20 arrangements
    assert statistics.rank_sum([1, 2, 3], [4, 5, 6]) == pytest.approx(2 / 20)


def test_holm_by_hand():
    # sorted .01 .02 .03 .04 times 4 3 2 1 = .04 .06 .06 .04, made increasing
    assert statistics.holm([0.03, 0.01, 0.04, 0.02]) == pytest.approx([0.06, 0.04, 0.06, 0.06])
    assert statistics.holm([0.6, 0.9]) == pytest.approx([1.0, 1.0])
    assert statistics.holm([]).size == 0


def test_holm_agrees_with_statsmodels():
    multitest = pytest.importorskip("statsmodels.stats.multitest")
    p = np.random.default_rng(1).random(12) ** 3
    assert statistics.holm(p) == pytest.approx(multitest.multipletests(p, method="holm")[1])


def test_median_difference_by_hand():
    found = statistics.median_difference([1, 2, 3], [3, 3, 3])
    assert (found.estimate, found.lower, found.upper) == (-1.0, -2.0, 0.0)
    assert not found.excludes_zero


def test_bootstrap_matches_the_exact_distribution_of_a_resampled_median():
    # the median of 3 draws from {0, 1, 2} is 0 with probability 7/27: below 2.5 % nothing but 0, and the same for 2
    medians = [sorted((a, b, c))[1] for a in range(3) for b in range(3) for c in range(3)]
    assert medians.count(0) / 27 == pytest.approx(7 / 27)
    narrow = statistics.median_difference([0, 1, 2], [0, 0, 0], level=1 - 2 * 8 / 27)  # just inside the mass of 0
    assert (narrow.lower, narrow.upper) == (1.0, 1.0)


def test_bootstrap_depends_on_its_seed_only():
    a, b = np.random.default_rng(0).random((2, 20))
    assert statistics.median_difference(a, b, seed=4) == statistics.median_difference(a, b, seed=4)


def test_friedman_by_hand():
    # ranks 1 2 3 / 1 2 3 / 2 1 3: sums 4 5 9; chi2 = 12/(3*3*4) * (16+25+81) - 3*3*4 = 4.6667
    found = statistics.friedman([[1, 2, 3], [10, 20, 30], [5, 4, 6]])
    assert found.statistic == pytest.approx(12 / 36 * 122 - 36)
    assert found.p == pytest.approx(math.exp(-found.statistic / 2))  # chi-square with two degrees of freedom
    assert found.mean_ranks == pytest.approx([4 / 3, 5 / 3, 3.0])


def test_friedman_of_equals_and_of_failures():
    assert statistics.friedman([[1, 1, 1], [2, 2, 2]]).p == 1.0
    assert statistics.friedman([[1, np.inf, 2], [1, np.inf, 2]]).mean_ranks == pytest.approx([1, 3, 2])
    with pytest.raises(StudyError, match="at least 2 cases and 3 methods"):
        statistics.friedman([[1, 2, 3]])


def test_demsars_worked_example():
    # Demsar 2006, Section 3.2.2 and Table 6: 14 data sets, 4 classifiers, mean ranks 3.143, 2.000, 2.893, 1.964
    ranks = np.array([3.143, 2.000, 2.893, 1.964])
    chi2 = 12 * 14 / (4 * 5) * ((ranks**2).sum() - 4 * 25 / 4)
    assert chi2 == pytest.approx(9.28, abs=0.02)
    assert statistics.critical_difference(4, 14, 0.05) == pytest.approx(1.25, abs=0.005)
    assert statistics.critical_difference(4, 14, 0.10) == pytest.approx(1.12, abs=0.005)
    found = statistics.Friedman(chi2, 0.02, ranks, 14)
    adjusted = statistics.against_control(found, 0)  # z of 2.416, 2.342, 0.512: p 0.016, 0.019, 0.607
    assert adjusted == pytest.approx([1.0, 3 * 0.0157, 0.608, 3 * 0.0157], abs=0.002)  # 2 * 0.019 is raised


@pytest.mark.parametrize(
    ("n_methods", "at_5", "at_10"),
    [
        (2, 1.960, 1.645), (3, 2.343, 2.052), (4, 2.569, 2.291), (5, 2.728, 2.459), (6, 2.850, 2.589),
        (7, 2.949, 2.693), (8, 3.031, 2.780), (9, 3.102, 2.855), (10, 3.164, 2.920),
    ],
)  # fmt: skip
def test_critical_values_are_those_published(n_methods, at_5, at_10):
    # Demsar 2006, Table 5(a), computed in its day to three digits
    assert statistics.nemenyi_quantile(n_methods, 0.05) == pytest.approx(at_5, abs=0.0015)
    assert statistics.nemenyi_quantile(n_methods, 0.10) == pytest.approx(at_10, abs=0.0015)


def test_smallest_p_by_hand():
    # 4 cases that rank 3 methods alike: rank sums 4 8 12, chi2 = 12/(4*3*4) * (16+64+144) - 3*4*4 = 8, and exp(-8/2)
    assert statistics.smallest_omnibus_p(4, 3) == pytest.approx(math.exp(-4))
    assert statistics.friedman([[1, 2, 3]] * 3 + [[4, 5, 6]]).p == pytest.approx(math.exp(-4))
    assert statistics.smallest_pair_p(5) == pytest.approx(0.0625)


def test_nemenyi_agrees_with_the_critical_difference():
    pytest.importorskip("scikit_posthocs")
    table = np.random.default_rng(3).random((12, 5)) + np.arange(5) * 0.2
    found = statistics.friedman(table)
    p = statistics.nemenyi(table)
    apart = np.abs(found.mean_ranks[:, None] - found.mean_ranks) > statistics.critical_difference(5, 12)
    assert apart.any()
    assert not apart.all()
    assert ((p < 0.05) == apart).all()


def test_a_missing_library_is_one_sentence(monkeypatch):
    def missing(name):
        raise ModuleNotFoundError("no", name=name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(StudyError, match=r"'scikit_posthocs'.*time-optimal-study\[compare\]"):
        statistics.posthocs()


def test_cliques_by_hand():
    assert statistics.cliques([1.0, 2.0, 3.0, 6.0], 2.0) == [(0, 1, 2)]
    assert statistics.cliques([3.0, 1.0, 2.0], 1.0) == [(1, 2), (2, 0)]
    assert statistics.cliques([1.0, 5.0], 1.0) == []


def test_durations_within_the_judges_tolerance_are_ties():
    values = levelled(np.array([2.0, 2.0 * (1 + 4e-7), 2.0 * (1 + 2e-6), np.inf]), 2.0)
    assert values[0] == values[1] < values[2] < values[3]
    tied = levelled(np.array([2.2, 2.4, 2.6]), 2.0) - levelled(np.array([2.0, 2.2, 2.4]), 2.0)
    assert len(set(tied)) == 1  # so that the signed rank test sees ties, not rounding


def contestant(planner, case, durations):
    durations = np.array(durations, dtype=float)
    ones = np.ones(len(durations))
    return Contestant(case, planner, Level.SCALED, durations, durations, (), ones, ones)


REFERENCES = {"one": Reference("one", 2.0, "x", "poly353"), "two": Reference("two", 4.0, "x", "poly353")}


def test_pairings_by_hand():
    runs = {
        "pso": [2.2, 2.4, 2.6, 2.8],
        "better": [2.1, 2.2, 2.3, 2.4],
        "once": [2.4],
        "failing": [2.0, 2.0, np.inf, 2.0],
    }
    found = {one.planner: one for one in pairings([contestant(k, "one", v) for k, v in runs.items()], REFERENCES)}
    better, once, failing = (found[name] for name in ("better", "once", "failing"))
    # of 16 pairs 2.1 beats 4, 2.2 beats 3 and ties, 2.3 beats 3, 2.4 beats 2 and ties
    assert better.a12 == pytest.approx(13 / 16)
    assert better.difference.estimate == pytest.approx(-0.125)  # 0.25 s of 2 s
    assert (better.difference.lower, better.difference.upper) == pytest.approx((-0.2, -0.05))
    assert better.signed_rank == pytest.approx(3 * 2 / 2**4)  # all of one sign; the least of three p-values
    assert once.a12 == pytest.approx(
        (2 + 0.5) / 4
    )  # the one run stands for every seed: it beats 2.6 and 2.8, ties with 2.4
    assert failing.difference is None
    assert failing.a12 == pytest.approx(3 / 4)


def test_the_omnibus_ranks_medians_and_puts_failures_last():
    medians = {"pso": (2.2, 4.1), "a": (2.1, 4.2), "b": (np.inf, 4.3), "partly": (2.05, None)}
    found = omnibus(
        [
            contestant(name, case, [value] * 3)
            for name, values in medians.items()
            for case, value in zip(REFERENCES, values, strict=True)
            if value
        ],
        REFERENCES,
        Level.SCALED,
    )
    assert found.planners == (
        "pso",
        "a",
        "b",
    )  # ranks 2 1, 1 2, 3 3; the tie keeps its order; `partly` ran on one case only
    assert found.friedman.mean_ranks.tolist() == [1.5, 1.5, 3.0]
    assert found.friedman.statistic == pytest.approx(12 / (2 * 3 * 4) * (9 + 9 + 36) - 3 * 2 * 4)
    assert found.difference == pytest.approx(2.343 * math.sqrt(3 * 4 / 12), abs=2e-3)
    assert found.groups == [(0, 1, 2)]
    # z = 1.5 / sqrt(3 * 4 / 12) = 1.5 and two-sided p = 0.1336, doubled by Holm
    assert found.against_control == pytest.approx([1.0, 1.0, 2 * 0.1336], abs=2e-4)
    assert omnibus([contestant("pso", "one", [2.0])], REFERENCES, Level.SCALED) is None


def test_a_claim_against_its_opponent_by_hand():
    found = against(np.array([9.0, 8.0, 12.0]), np.array([10.0, 10.0, 10.0]))
    # differences -10 %, -20 %, +20 % of 10 s; ranks 1 and two of 2.5: of the 8 sign patterns 6 give W <= 2.5
    assert found.difference.estimate == pytest.approx(-0.1)
    assert (found.difference.lower, found.difference.upper) == pytest.approx((-0.2, 0.2))
    assert found.a12 == pytest.approx(2 / 3)
    assert 0.5 < found.p <= 1.0
    assert against(np.array([1.0, np.inf]), np.array([2.0, 2.0])).difference is None


def test_one_search_is_summed_up_as_one():
    against = SimpleNamespace(difference=None, p=1.0)
    claims = [
        SimpleNamespace(above_optimum=share, against_baseline=against, against_random=against) for share in (0.1, 0.2)
    ]
    assert claimed_together(claims[:1]).startswith(
        "Searches run their papers' own way: of 1, 0 end significantly shorter"
    )
    assert claimed_together(claims[:1]).endswith("they end at +10.0 %.")
    assert claimed_together(claims).endswith("they end at +10.0 % to +20.0 %.")
