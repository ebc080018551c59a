"""Walls measured by rays, on bodies of known thickness."""

from __future__ import annotations

import math

import numpy as np
import pytest
from manifold3d import Manifold

from fingertip.cad.verification.walls import SPACING_MM, measure_walls


def test_thickness_and_area_of_a_plate() -> None:
    found = measure_walls(Manifold.cube((20.0, 10.0, 0.5)), 0.8)
    assert found.thickness_mm == pytest.approx(0.5, abs=1e-9)
    assert found.area_mm2 == pytest.approx(2 * 20 * 10, rel=0.01)
    assert found.patches().area() == pytest.approx(len(found.points) * SPACING_MM**2), (
        "a square for each"
    )
    assert measure_walls(Manifold.cube((20.0, 10.0, 0.5)), 0.49).area_mm2 == 0.0


def test_edge_of_a_wedge_is_thin_as_far_as_its_angle_says() -> None:
    """A ray across a wedge of the angle a meets the other face after x
    tan(a); its edge of 90 degrees is no wall.
    """
    tangent = math.tan(math.radians(20.0))
    wedge = Manifold.hull_points(
        [(x, y, z) for y in (0, 30) for x, z in ((0, 0), (9, 0), (9, 9 * tangent))]
    )
    found = measure_walls(wedge, 0.8)
    along = found.points[np.abs(found.points[:, 2]) < 1e-9]
    assert along[:, 0].max() == pytest.approx(0.8 / tangent, abs=0.1)
    assert found.area_mm2 == pytest.approx(
        30 * 0.8 / tangent * (1 + math.cos(math.radians(20.0))), rel=0.1
    )


def test_cavity_is_measured_to_the_outside() -> None:
    shell = Manifold.sphere(5.0, 256) - Manifold.sphere(4.5, 256)
    found = measure_walls(shell, 0.8)
    assert found.thickness_mm == pytest.approx(0.5, abs=0.01)
    assert found.area_mm2 == pytest.approx(4 * math.pi * (5.0**2 + 4.5**2), rel=0.01)
