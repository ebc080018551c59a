"""Fit of scale and offset: exact, against numpy, and with intervals that hold the truth as often as they say."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fingertip.calibration.printer import fit_printer
from fingertip.design import Design
from fingertip.foundation.numerics import chi_square_probability, chi_square_quantile, t_probability, t_quantile
from tests.calibration.simulated import NOISE_MM, OFFSET_MM, SCALE, measured, simulate

DRAWS = 500


@pytest.fixture(scope="module")
def design() -> Design:
    return Design()


def test_fit_is_that_of_numpy_over_all_readings(design: Design) -> None:
    """With different numbers of readings, so that the weights matter."""
    rows = [type(r)(r.length, r.readings_mm[: 2 + i % 3]) for i, r in enumerate(measured(design, simulate(design, 1)))]
    fit = fit_printer(rows)
    model = np.array(
        [(r.length.nominal_mm, 1.0 if r.length.kind == "outer" else -1.0) for r in rows for _ in r.readings_mm]
    )
    readings = np.array([value for r in rows for value in r.readings_mm])
    solution, *_ = np.linalg.lstsq(model, readings, rcond=None)
    assert (fit.scale, fit.offset_mm) == pytest.approx(tuple(solution), rel=1e-9)
    weights = np.array([len(r.readings_mm) for r in rows])
    first = np.cumsum(weights) - weights
    means = np.array([r.mean_mm for r in rows])
    variance = (weights * (means - model[first] @ solution) ** 2).sum() / (len(rows) - 2)
    covariance = variance * np.linalg.inv(model.T @ model)
    assert fit.scale_uncertainty == pytest.approx(covariance[0, 0] ** 0.5, rel=1e-9)
    assert fit.offset_uncertainty_mm == pytest.approx(covariance[1, 1] ** 0.5, rel=1e-9)
    assert (fit.degrees, fit.readings) == (len(rows) - 2, len(readings))


def covered(design: Design, **noise: float) -> tuple[int, int, float, float]:
    """Numbers of draws whose intervals hold the true scale and the true offset, and mean half widths of both."""
    scale = offset = 0
    widths = []
    for seed in range(DRAWS):
        fit = fit_printer(measured(design, simulate(design, seed, **noise)))
        half_scale = fit.coverage_factor * fit.scale_uncertainty
        half_offset = fit.coverage_factor * fit.offset_uncertainty_mm
        scale += abs(fit.scale - SCALE) <= half_scale
        offset += abs(fit.offset_mm - OFFSET_MM) <= half_offset
        widths.append((half_scale, half_offset))
    mean_scale, mean_offset = np.mean(widths, axis=0)
    return scale, offset, float(mean_scale), float(mean_offset)


@pytest.mark.full
def test_intervals_hold_the_truth_in_95_of_100_draws(design: Design) -> None:
    """Scale 0.5 % and offset 0.1 mm, readings with 0.02 mm: the intervals are right, and narrow enough to be used.

    Repeated readings do not average away an error of the surfaces, so they must not narrow the intervals.
    """
    stats = pytest.importorskip("scipy.stats")
    low, high = stats.binom.ppf([0.0005, 0.9995], DRAWS, 0.95)
    narrow, wide = covered(design), covered(design, length_error_mm=0.03)
    for scale, offset, *_ in (narrow, wide):
        assert low <= scale <= high
        assert low <= offset <= high
    assert narrow[2] < 0.0004, "0.04 %, or 0.02 mm on the whole frame; the error is 0.5 %"
    assert narrow[3] < 0.009, "a tenth of the offset"
    assert wide[3] > 2 * narrow[3]


def test_a_slip_of_the_calipers_is_named(design: Design) -> None:
    tables = simulate(design, 3)
    tables["slot_mm"][2] = round(tables["slot_mm"][2] + 0.3, 2)
    (outlier,) = fit_printer(measured(design, tables)).outliers
    assert (outlier.name, outlier.number, outlier.reading_mm) == ("slot_mm", 3, tables["slot_mm"][2])
    assert outlier.deviation_mm == pytest.approx(0.3, abs=4 * NOISE_MM)


def test_a_length_measured_in_the_wrong_place_is_doubted(design: Design) -> None:
    """All of its readings agree, so that none of them is an outlier by itself."""
    tables = simulate(design, 3)
    tables["slot_mm"] = [reading + 0.25 for reading in tables["slot_mm"]]
    fit = fit_printer(measured(design, tables))
    assert [each.name for each in fit.residuals if each.is_doubtful] == ["slot_mm"]
    sound = [fit_printer(measured(design, simulate(design, seed))).residuals for seed in range(100)]
    assert sum(any(each.is_doubtful for each in residuals) for residuals in sound) <= 5


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
