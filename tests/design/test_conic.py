"""Superconic arcs in closed form, and the draft of a recess whose outline they are."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.models.conic import ELLIPSE, ConicBody, CrossSection
from fingertip.models.profile import Tip, arc_abscissa, arc_point
from tests.oracles.conic_area import arc_area

WEIGHTS = st.floats(0.4, 8.0)
BODY = ConicBody(
    CrossSection(8.5, 6.0, 7.0, 0.8, 0.75), ((0.0, 1.0), (24.0, 0.94)), Tip(34.0, 0.75)
)


@given(t=st.floats(0, 1), w=WEIGHTS)
def test_abscissa_lies_on_the_arc(t: float, w: float) -> None:
    assert arc_abscissa(t, ELLIPSE) == pytest.approx(math.sqrt(1 - t * t), abs=1e-7), "a circle"
    x, y = arc_point(t, w)
    # Near its top the arc is level: there y says little about x.
    assert arc_abscissa(y, w) == pytest.approx(x, abs=1e-7)


@pytest.mark.parametrize(
    ("w", "area"), [(ELLIPSE, math.pi / 4), (1e-9, 0.5), (1.0, 5 / 6), (1e9, 1.0)]
)
def test_area_of_arcs_with_known_areas(w: float, area: float) -> None:
    assert arc_area(w) == pytest.approx(area, abs=1e-8)


@given(t=st.floats(0.001, 0.999))
def test_tip_continues_the_taper_without_a_kink(t: float) -> None:
    (z0, s0), (z1, s1) = BODY.stations
    h = 1e-6
    assert (BODY.scale_at(z1 + h) - s1) / h == pytest.approx((s1 - s0) / (z1 - z0), abs=1e-5)
    z, scale, _ = BODY.spans[-1].evaluate(t)
    assert BODY.scale_at(z) == pytest.approx(scale, abs=1e-9)


@given(y=st.floats(-6, 7), z=st.floats(0, 34))
def test_sections_widen_towards_the_parting_plane(y: float, z: float) -> None:
    """Both halves of a mold pull because no point lies further out than the points nearer
    to y = 0.
    """
    assert BODY.half_width_at(y, z) <= BODY.half_width_at(y * 0.9, z) + 1e-12
