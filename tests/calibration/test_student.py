"""Quantiles against scipy and against closed forms."""

from __future__ import annotations

import math

import pytest

from fingertip.foundation.numerics import chi_square_probability, chi_square_quantile, t_probability, t_quantile


def test_quantiles_are_those_of_scipy() -> None:
    stats = pytest.importorskip("scipy.stats")
    wrong = []
    for degrees in (1, 2, 3, 4, 7, 11, 12, 30, 101):
        for share in (0.5, 0.95, 0.999):
            ours = (t_quantile(share, degrees), chi_square_quantile(share, degrees))
            scipys = (stats.t.ppf((1 + share) / 2, degrees), stats.chi2.ppf(share, degrees))
            if ours != pytest.approx(scipys, rel=1e-8):
                wrong.append((degrees, share, ours, scipys))
    assert wrong == []


def test_closed_forms() -> None:
    """Cauchy's distribution for one degree of freedom, an exponential one for two."""
    assert t_probability(1.0, 1) == pytest.approx(0.5)
    assert t_probability(math.sqrt(2.0), 2) == pytest.approx(math.sqrt(0.5))
    assert chi_square_probability(2.0, 2) == pytest.approx(1.0 - math.exp(-1.0))
    assert chi_square_probability(1.0, 1) == pytest.approx(math.erf(math.sqrt(0.5)))
