"""Superconic arcs in closed form, and the draft of a recess whose outline they are."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.design.geometry.conic import (
    ELLIPSE,
    ConicBody,
    CrossSection,
    Tip,
    add_draft,
    arc_abscissa,
    arc_area,
    arc_parameter_at_height,
    arc_parameter_at_slope,
    arc_point,
)

WEIGHTS = st.floats(0.4, 8.0)
BODY = ConicBody(CrossSection(8.5, 6.0, 7.0, 0.8, 0.75), ((0.0, 1.0), (24.0, 0.94)), Tip(34.0, 0.75))


@given(t=st.floats(0, 1), w=WEIGHTS)
def test_abscissa_lies_on_the_arc(t: float, w: float) -> None:
    assert arc_abscissa(t, ELLIPSE) == pytest.approx(math.sqrt(1 - t * t), abs=1e-7), "a circle"
    x, y = arc_point(t, w)
    # Near its top the arc is level: there y says little about x.
    assert arc_abscissa(y, w) == pytest.approx(x, abs=1e-7)


@pytest.mark.parametrize(("w", "area"), [(ELLIPSE, math.pi / 4), (1e-9, 0.5), (1.0, 5 / 6), (1e9, 1.0)])
def test_area_of_arcs_with_known_areas(w: float, area: float) -> None:
    assert arc_area(w) == pytest.approx(area, abs=1e-8)


@given(w=WEIGHTS)
def test_area_agrees_with_the_shoelace_formula(w: float) -> None:
    n = 2000
    points = [arc_point(i / n, w) for i in range(n + 1)]
    shoelace = sum(a[0] * b[1] - b[0] * a[1] for a, b in itertools.pairwise(points)) / 2
    assert arc_area(w) == pytest.approx(shoelace, abs=3e-6)


@given(t=st.floats(0.001, 0.999))
def test_tip_continues_the_taper_without_a_kink(t: float) -> None:
    (z0, s0), (z1, s1) = BODY.stations
    h = 1e-6
    assert (BODY.scale_at(z1 + h) - s1) / h == pytest.approx((s1 - s0) / (z1 - z0), abs=1e-5)
    z, scale = BODY.tip_point(t)
    assert BODY.scale_at(z) == pytest.approx(scale, abs=1e-9)


@given(y=st.floats(-6, 7), z=st.floats(0, 34))
def test_sections_widen_towards_the_parting_plane(y: float, z: float) -> None:
    """Both halves of a mold pull because no point lies further out than the points nearer to y = 0."""
    assert BODY.half_width_at(y, z) <= BODY.half_width_at(y * 0.9, z) + 1e-12


LENGTHS, SLOPES = st.floats(2.0, 30.0), st.floats(0.001, 0.3)


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
