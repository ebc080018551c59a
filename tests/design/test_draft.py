"""Walls of a recess slope by at least the draft, everywhere."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.design.geometry.conic import (
    CrossSection,
    add_draft,
    arc_parameter_at_height,
    arc_parameter_at_slope,
    arc_point,
)

LENGTHS, WEIGHTS, SLOPES = st.floats(2.0, 30.0), st.floats(0.4, 8.0), st.floats(0.001, 0.3)


def slope_at(a: float, b: float, weight: float, t: float) -> float:
    """Slope -dx/dy of the arc at t, by central differences."""
    (x0, y0), (x1, y1) = (arc_point(t + d, weight) for d in (-1e-6, 1e-6))
    return a * (x0 - x1) / (b * (y1 - y0))


@given(LENGTHS, LENGTHS, WEIGHTS, SLOPES)
def test_the_slope_of_the_arc_equals_the_draft_where_its_wall_begins(
    a: float, b: float, weight: float, slope: float
) -> None:
    t = arc_parameter_at_slope(a, b, weight, slope)
    assert abs(slope_at(a, b, weight, t) - slope) < 1e-4 * (1.0 + slope)
    assert all(slope_at(a, b, weight, t + (0.999 - t) * i / 8) >= slope * (1 - 1e-3) for i in range(1, 9))


@given(st.floats(0.0, 0.999), WEIGHTS)
def test_parameter_at_a_height(y: float, weight: float) -> None:
    assert abs(arc_point(arc_parameter_at_height(y, weight), weight)[1] - y) < 1e-9


@pytest.mark.full
@given(LENGTHS, LENGTHS, LENGTHS, WEIGHTS, WEIGHTS, SLOPES, st.floats(0.01, 0.99))
def test_both_walls_have_draft_and_meet_at_the_parting_plane(
    a: float, palmar: float, dorsal: float, wp: float, wd: float, slope: float, flat: float
) -> None:
    section = CrossSection(a, palmar, dorsal, wp, wd)
    found = add_draft(section, slope, flat * palmar)
    for height, weight, t in ((palmar, wp, found.palmar_start), (dorsal, wd, found.dorsal_start)):
        x, y = arc_point(t, weight)
        assert found.half_width - a * x >= slope * height * y - 1e-9
    assert arc_point(found.palmar_start, wp)[1] <= flat + 1e-9, "the straight wall reaches at most to the flat"
    assert found.half_width >= a
