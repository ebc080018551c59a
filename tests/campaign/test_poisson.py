"""Interval of a rate, against scipy's distributions."""

from __future__ import annotations

import pytest

from fingertip.foundation.numerics import poisson_interval


@pytest.mark.parametrize("count", [0, 1, 4, 30, 400])
@pytest.mark.parametrize("confidence", [0.9, 0.95])
def test_the_interval_is_that_of_the_chi_square_distribution(count, confidence):
    from scipy import stats

    low, high = poisson_interval(count, confidence)
    tail = (1 - confidence) / 2
    assert low == pytest.approx(stats.chi2.ppf(tail, 2 * count) / 2 if count else 0.0, rel=1e-9)
    assert high == pytest.approx(stats.chi2.ppf(1 - tail, 2 * count + 2) / 2, rel=1e-9)
