"""Resistances of ducts against other closed forms and quadrature."""

import math

import numpy as np
import pytest

from fingertip.filling.mouth import ConicalDuct, RectangularDuct, RoundDuct, fill_in_series


def test_round_duct() -> None:
    duct = RoundDuct(2.1, 10.0)
    assert duct.resistance == pytest.approx(8 * 10 / (math.pi * 1.05**4), rel=1e-12)
    assert duct.resistance == pytest.approx(20.95, abs=0.01)
    assert duct.resistance_integral == pytest.approx(0.5 * duct.resistance * duct.volume_mm3)


@pytest.mark.parametrize("outlet", [1.0, 2.9, 3.0, 3.0 + 1e-7, 3.001, 6.0])
def test_conical_duct_against_quadrature(outlet: float) -> None:
    duct = ConicalDuct(3.0, outlet, 12.0)
    x = np.linspace(0.0, 12.0, 100_001)
    d = 3.0 + (outlet - 3.0) * x / 12.0
    per_length, area = 128.0 / (math.pi * d**4), math.pi / 4 * d**2
    resistance = np.concatenate(([0.0], np.cumsum(0.5 * (per_length[1:] + per_length[:-1]) * np.diff(x))))
    assert duct.resistance == pytest.approx(float(resistance[-1]), rel=1e-6)
    assert duct.volume_mm3 == pytest.approx(float(np.trapezoid(area, x)), rel=1e-8)
    assert duct.resistance_integral == pytest.approx(float(np.trapezoid(resistance * area, x)), rel=1e-6)


def test_square_and_wide_rectangles() -> None:
    # White, Viscous Fluid Flow, table 3-1: f Re = 14.227 in a square, 24 between plates; R = 2 f Re L / (A D_h^2).
    assert RectangularDuct(1.0, 1.0, 1.0).resistance == pytest.approx(2 * 14.2271, rel=1e-4)
    wide = RectangularDuct(1000.0, 1.0, 1.0)
    assert wide.resistance == pytest.approx(12.0 / 1000.0 / (1 - 0.630 / 1000), rel=1e-5)
    assert RectangularDuct(3.0, 2.5, 12.0).resistance == pytest.approx(RectangularDuct(2.5, 3.0, 12.0).resistance)


def test_ducts_in_series_fill_one_after_the_other() -> None:
    whole = RoundDuct(2.0, 10.0)
    resistance, volume, integral = fill_in_series((RoundDuct(2.0, 4.0), RoundDuct(2.0, 6.0)))
    assert (resistance, volume, integral) == pytest.approx(
        (whole.resistance, whole.volume_mm3, whole.resistance_integral)
    )
