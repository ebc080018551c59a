"""Overhangs: closed forms on simple solids, and parts with a defect that the check must find."""

from __future__ import annotations

import math

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.overhang import (
    MAX_BRIDGE_MM,
    MAX_LEDGE_MM,
    MAX_UNSUPPORTED_MM2,
    find_ceilings,
)
from fingertip.cad.verification.check import Solids
from fingertip.cad.verification.printing import check_overhang
from fingertip.design import Design
from fingertip.models.parts import PARTS
from fingertip.models.solids import Box, Cone, Prism, Solid, cylinder

TOLERANCE = 0.02
WIDTH = 6.0


def unsupported_mm2(solid: Solid) -> float:
    """Largest unsupported ceiling of a solid that stands on z = 0."""
    ceilings = find_ceilings(MeshEvaluator(TOLERANCE).mesh(solid))
    return max((ceiling.unsupported_mm2() for ceiling in ceilings), default=0.0)


def shelf(reach: float) -> Solid:
    """A wall with a shelf that stands out by `reach`."""
    return Box((-2.0, 0.0, 0.0), (0.0, WIDTH, 8.0)).union(
        Box((-1.0, 0.0, 5.0), (reach, WIDTH, 8.0))
    )


def gate(span: float) -> Solid:
    """Two pillars with a beam across."""
    beam = Box((-1.0, 0.0, 5.0), (span + 1.0, WIDTH, 8.0))
    return Box((-2.0, 0.0, 0.0), (0.0, WIDTH, 8.0)).union(
        Box((span, 0.0, 0.0), (span + 2.0, WIDTH, 8.0)), beam
    )


def test_long_shelves_and_beams_are_unsupported_over_their_whole_area() -> None:
    """Askew threads hold on to a little of a shelf, at its corners."""
    assert unsupported_mm2(shelf(MAX_LEDGE_MM - 0.01)) == 0.0
    assert unsupported_mm2(shelf(1.5 * MAX_LEDGE_MM)) == pytest.approx(
        1.5 * MAX_LEDGE_MM * WIDTH, rel=0.03
    )
    assert unsupported_mm2(gate(MAX_BRIDGE_MM - 0.01)) == 0.0
    assert unsupported_mm2(gate(MAX_BRIDGE_MM + 1.0)) == pytest.approx(
        (MAX_BRIDGE_MM + 1.0) * WIDTH, rel=0.03
    )


@pytest.mark.parametrize("angle", [30.0, 45.0, 90.0])
def test_bridge_is_found_in_every_direction(angle: float) -> None:
    """A beam of 9 mm across two pillars that stand askew; its ends are parallel to them."""
    c = math.cos(math.radians(angle))
    s = math.sin(math.radians(angle))

    def block(low: float, high: float, bottom: float) -> Solid:
        ring = ((low, -3.0), (high, -3.0), (high, 3.0), (low, 3.0))
        return Prism("z", tuple((c * u - s * v, s * u + c * v) for u, v in ring), bottom, 8.0)

    assert (
        unsupported_mm2(block(-2.0, 0.0, 0.0).union(block(9.0, 11.0, 0.0), block(-1.0, 10.0, 5.0)))
        < 0.01
    )


@pytest.mark.parametrize(("run", "overhangs"), [(0.99, False), (1.01, True)])
def test_slope_counts_above_45_degrees(run: float, overhangs: bool) -> None:
    """A funnel upside down: its wall is its ceiling, of the area of the ring seen from above."""
    height = 4.0
    area = unsupported_mm2(Cone("z", (0.0, 0.0), 0.0, height, 1.0, 1.0 + run * height))
    ring = math.pi * ((1.0 + run * height) ** 2 - 1.0)
    assert area == pytest.approx(ring if overhangs else 0.0, rel=0.02)


def test_small_horizontal_bore_needs_no_supports() -> None:
    block = Box((-8.0, -8.0, 0.0), (8.0, 8.0, 16.0))
    # Of a bore whose overhanging arc is as wide as the longest bridge.
    across = MAX_BRIDGE_MM * math.sqrt(2.0)
    assert unsupported_mm2(block.cut(cylinder("x", (0.0, 8.0), -9.0, 9.0, 0.49 * across))) == 0.0
    assert unsupported_mm2(block.cut(cylinder("x", (0.0, 8.0), -9.0, 9.0, 0.51 * across))) > 100.0


def overhang(part: str, *changes: str, added: Solid | None = None, name: str = "fsr400") -> float:
    """Value of the check for a part of a design, with something added to it."""
    design = Design.load(name, changes=changes)
    solid = PARTS[part].solid(design)
    solids = Solids(
        design, MeshEvaluator(TOLERANCE), {part: solid.union(added) if added else solid}
    )
    check = check_overhang(design, solids, part)
    assert check.name == f"{part}.overhang"
    assert check.passed == (check.value <= MAX_UNSUPPORTED_MM2)
    return check.value


def test_fin_above_the_collar_fails_and_below_it_where_supports_may_stand_does_not() -> None:
    def fin(z: float) -> Box:
        return Box((-12.0, -1.0, z), (12.0, 1.0, z + 2.0))

    assert overhang("bone", added=fin(10.0)) > 5.0
    assert overhang("bone", added=fin(-12.0)) > 5.0
    assert overhang("bone", added=fin(10.0), name="adult_finger") > 5.0
    assert overhang("bone", added=fin(-12.0), name="adult_finger") <= MAX_UNSUPPORTED_MM2
    for scale in (98, 103):  # the places of supports follow the scale of the print
        assert (
            overhang("bone", f"printer.scale_percent={scale}", name="adult_finger")
            <= MAX_UNSUPPORTED_MM2
        )
