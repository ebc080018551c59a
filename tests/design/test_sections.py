"""Sections over arrays: the same numbers as one section at a time, and distances by their
definition.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip.design import Design
from fingertip.design.geometry.sections import Quarters, half_widths_along, measure_gaps
from tests.conftest import DESIGNS, design_file

HEIGHTS = tuple(np.linspace(-1.0, 40.0, 83).tolist())
QUARTER = np.array([(8.0 * math.cos(a), 6.0 * math.sin(a)) for a in np.linspace(0, math.pi / 2, 9)])
QUARTER[0, 1] = QUARTER[-1, 0] = 0.0


@pytest.mark.parametrize("name", DESIGNS)
def test_half_widths_over_arrays_are_those_of_single_heights(name: str) -> None:
    dims = Design.load(design_file(name)).dimensions
    for body in (dims.outer, dims.bone_outline):
        for y in (-20.0, -dims.flat_depth, -0.5, 0.0, 3.0):
            found = half_widths_along(body, y, HEIGHTS).tolist()
            assert found == [body.half_width_at(y, z) for z in HEIGHTS]


@pytest.mark.parametrize("name", DESIGNS)
def test_quarters_lie_on_skin_and_core(name: str) -> None:
    """The palmar quarter of the core ends at its flat."""
    design = Design.load(design_file(name))
    dims = design.dimensions
    zs = (2.0, 12.0, dims.sensor_z, dims.bone_outline.spans[-1].z[2] - 0.5)
    quarters = Quarters(dims, 0.0, zs, zs)
    sides = [(z, sign) for sign in (1.0, -1.0) for z in zs]

    for row, (z, sign) in enumerate(sides):
        for body, points in (
            (dims.outer, quarters.surface(7)),
            (dims.bone_outline, quarters.core(7)),
        ):
            for x, y in points[:, row].T[1:-1]:
                assert x == pytest.approx(body.half_width_at(sign * y, z), abs=1e-9)

    deepest = quarters.core(7)[1, len(zs) :].max(axis=1)
    assert np.all(deepest <= dims.flat_depth)
    assert deepest[2] == dims.flat_depth


def distance_to_chords(x: float, y: float) -> float:
    """Return the distance of a point to the chords of the quarter, from 2000 points of each."""
    shares = np.linspace(0.0, 1.0, 2001)[:, None, None]
    points = QUARTER[:-1] + shares * (QUARTER[1:] - QUARTER[:-1])
    return float(np.hypot(points[..., 0] - x, points[..., 1] - y).min())


@given(x=st.floats(-1.0, 10.0), y=st.floats(-1.0, 8.0))
def test_gaps_are_distances_to_the_outline_within_it_and_beyond(x: float, y: float) -> None:
    gaps, supports = measure_gaps(np.array([[[x]], [[y]]]), QUARTER.T[:, None])
    assert gaps.shape == supports.shape == (1, 1)
    assert gaps[0, 0] == pytest.approx(distance_to_chords(x, y), abs=1e-3)
    middles = (QUARTER[1:] + QUARTER[:-1]) / 2
    assert np.hypot(*middles.T).min() - 0.5 < supports[0, 0] < 8.0


def test_each_section_is_measured_to_its_own_surface() -> None:
    points = np.array([[[1.0, 2.0], [1.0, 2.0]], [[2.0, 1.0], [2.0, 1.0]]])
    surface = np.array([QUARTER.T, 2.0 * QUARTER.T]).transpose(1, 0, 2)
    gaps, _ = measure_gaps(points, surface)
    for row in range(2):
        own, _ = measure_gaps(points[:, row : row + 1], surface[:, row : row + 1])
        assert np.array_equal(gaps[row], own[0])
    assert np.all(gaps[1] > gaps[0] + 4.0)
