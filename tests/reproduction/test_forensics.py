"""Arithmetic checks on numbers that the papers print, and on numbers that could have been measured."""

from __future__ import annotations

import math

import numpy as np
import pytest

from study.errors import StudyError
from study.reproduction.forensics import (
    Summary,
    above_largest,
    below_optimum,
    finer_than_doubles,
    mean_outside_extremes,
    mean_too_near_extreme,
    std_beyond_extremes,
    std_too_large,
    wrong_sum,
)


def rounded(values, digits):
    """Summary of real numbers as a table with so many digits would print it."""
    parts = (values.mean(), values.std(ddof=1), values.min(), values.max())
    return Summary(len(values), *(float(f"{part:.{digits - 1}e}") for part in parts), digits=digits)


def found_in(summary):
    """What all checks find in the statistics of non-negative numbers."""
    checks = [mean_outside_extremes(summary), mean_too_near_extreme(summary), std_beyond_extremes(summary)]
    checks += [below_optimum(summary, 0.0), std_too_large(summary, 0.0), finer_than_doubles(summary, 0.0, 1e-300)]
    return [finding for finding in (*checks, above_largest(summary, 1e300)) if finding is not None]


@pytest.mark.parametrize("digits", [1, 2, 3, 6])
def test_numbers_that_were_measured_raise_nothing(digits):
    rng = np.random.default_rng(digits)
    for n in (2, 3, 5, 30):
        for _ in range(200):
            values = 10.0 ** rng.uniform(-30, 3) * rng.lognormal(0.0, rng.uniform(0, 4), n)
            assert found_in(rounded(values, digits)) == []


def test_the_std_bound_is_reached_by_one_run_away_from_the_optimum():
    values = np.zeros(30)
    values[0] = 7.0
    n, mean, std = 30, values.mean(), values.std(ddof=1)
    assert std == pytest.approx(math.sqrt(n) * mean)
    assert std_too_large(Summary(n, mean, std, digits=12), 0.0) is None
    finding = std_too_large(Summary(n, mean, 1.01 * std, digits=12), 0.0)
    assert finding is not None
    assert "<= sqrt(30) (mean - f*) = 1.278 fails" in finding.inequality


def test_std_bound_on_the_smwoa_papers_table():
    # Table 3: F2, SMWOA: 3.57e-67 with 2.51e-64, more than sqrt(30) = 5.48 times; F1, WOA is possible
    assert std_too_large(Summary(30, 3.57e-67, 2.51e-64), 0.0) is not None
    assert std_too_large(Summary(30, 7.91e-74, 4.32e-74), 0.0) is None
    # F14, SMA: -3.8529 with 2.86e-6 lies well above f* = -3.8628, which no std bound forbids
    assert std_too_large(Summary(30, -3.8529, 2.86e-6, digits=5), -3.86278) is None


def test_std_bound_on_the_woodworking_table():
    # Table 3, F1, CFPSO: mean 1.2322, std 3.9174 is possible (bound 6.75); F6, PSO: mean 3.8518, std 11.5 is possible
    # too by this bound (21.1), though not with a largest value near the mean
    assert std_too_large(Summary(30, 1.2322, 3.9174, digits=5), 0.0) is None
    assert std_too_large(Summary(30, 3.8518, 11.5), 0.0) is None


def test_granularity_of_sums_near_ten():
    # Rastrigin is a sum of terms near 10, whose doubles are 1.8e-15 apart: a mean of 5.04e-29 over 30 runs cannot be
    grain = float(np.spacing(10.0))
    finding = finer_than_doubles(Summary(30, 5.04e-29), 0.0, grain)
    assert finding is not None
    assert "grain/n = 1.77636e-15/30 = 5.921e-17 fails" in finding.inequality
    assert finer_than_doubles(Summary(30, 0.0), 0.0, grain) is None
    assert finer_than_doubles(Summary(30, grain / 30, digits=6), 0.0, grain) is None


def test_puma_f4_mean_below_its_minimum():
    # Table 3, F4, SPSO: minimum 1.3754e-2, mean 1.0752e-2
    summary = Summary(30, 1.0752e-2, 8.8390e-2, 1.3754e-2, 3.1040e-1, digits=5)
    finding = mean_outside_extremes(summary)
    assert finding is not None
    assert finding.inequality == "minimum 0.013754 <= mean 0.010752 fails"
    assert mean_too_near_extreme(summary) is None
    high = mean_outside_extremes(Summary(30, 2.0, minimum=0.5, maximum=1.5))
    assert high is not None
    assert high.inequality == "mean 2 <= maximum 1.5 fails"


def test_one_far_run_pulls_the_mean():
    near = mean_too_near_extreme(Summary(10, 0.05, minimum=0.0, maximum=1.0))
    far = mean_too_near_extreme(Summary(10, 0.95, minimum=0.0, maximum=1.0))
    assert near is not None
    assert far is not None
    assert "/10 = 0.0995 fails" in near.inequality
    assert "maximum - (maximum - minimum)/10" in far.inequality
    assert mean_too_near_extreme(Summary(10, 0.1, minimum=0.0, maximum=1.0)) is None


def test_std_within_the_extremes():
    # half of the runs at each end: std = sqrt(n/(n-1))/2, the largest possible
    most = math.sqrt(10 / 9) / 2
    assert std_beyond_extremes(Summary(10, 0.5, most, 0.0, 1.0, digits=9)) is None
    assert std_beyond_extremes(Summary(10, 0.5, 1.01 * most, 0.0, 1.0, digits=9)) is not None


def test_woodworking_f5_exceeds_the_largest_value_in_its_box():
    largest = sum(range(1, 31)) * 1.28**4 + 1
    finding = above_largest(Summary(30, 1586.7973, 326.9182, 1011.8771, digits=8), largest)
    assert finding is not None
    assert finding.inequality == "mean 1586.8 <= largest value in the box = 1249.22 fails"
    assert above_largest(Summary(30, 1011.8771, digits=8), largest) is None


def test_values_below_the_optimum():
    assert below_optimum(Summary(30, -3.87, digits=3), -3.86278) is not None
    assert below_optimum(Summary(30, -3.86, minimum=-3.90), -3.86278) is not None
    assert below_optimum(Summary(30, -3.86, digits=3), -3.86278) is None


def test_sums_of_the_woodworking_table():
    # Table 5: the total of the maxima, 7.8776 s; Section 5 prints 7.8876 s
    maxima = [2.3189, 2.9540, 2.6047]
    assert wrong_sum(maxima, 7.8776, 4) is None
    finding = wrong_sum(maxima, 7.8876, 4)
    assert finding is not None
    assert finding.inequality == "|2.3189 + 2.954 + 2.6047 - 7.8876| = 0.01 <= 0.0002 fails"
    assert wrong_sum([4.227, 6.103, 4.319, 4.937, 5.049], 24.635, 3) is None  # SMWOA paper, Table 6


def test_a_summary_needs_two_runs():
    with pytest.raises(StudyError, match="at least 2 runs"):
        Summary(1, 0.0)
