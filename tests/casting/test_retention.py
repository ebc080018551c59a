"""Pull-off force of the skin: of a thin ring, and zero where nothing but adhesion holds it."""

from __future__ import annotations

import math

import pytest

from fingertip.casting.quantities import FRICTION, name_retention, skin_pull_off_n
from fingertip.catalogues.silicones import SILICONES
from fingertip.design import Design

SILICONE = SILICONES["addition_40a"]


def pull(*changes: str) -> float:
    return skin_pull_off_n(Design.load(changes=changes), SILICONE)


def test_groove_holds_as_a_stretched_ring() -> None:
    """E e t / R over the width of a groove of 0.6 mm around a bone of 13 x 8.9 mm."""
    dims = Design().dimensions
    radius = (6.5 + (5.5 + dims.flat_depth) / 2) / 2
    expected = SILICONE.modulus_mpa.low * (0.6 / radius) * 1.5 / radius * math.tau * radius * 3.0
    assert pull() == pytest.approx(expected)
    assert pull("bone.groove_depth_mm=0") == 0.0
    assert pull("bone.groove_width_mm=6") == pytest.approx(2 * expected)


def test_sleeve_is_held_by_friction_along_its_length() -> None:
    tight, loose = (
        pull("mold.method=sleeve", "bone.groove_depth_mm=0", f"mold.sleeve_interference_mm={i}") for i in (0.2, 0.0)
    )
    assert loose == 0.0
    dims = Design().dimensions
    radius = (6.5 + (5.5 + dims.flat_depth) / 2) / 2
    force = FRICTION * SILICONE.modulus_mpa.low * (0.2 / radius) * 1.5 * math.tau * dims.taper_end_z
    assert tight == pytest.approx(force)


@pytest.mark.parametrize("method", ["overmold", "sleeve"])
@pytest.mark.parametrize("interference_mm", [0.0, 0.2])
@pytest.mark.parametrize("depth_mm", [0.0, 0.6])
def test_only_what_holds_is_named(depth_mm: float, interference_mm: float, method: str) -> None:
    changes = [f"mold.method={method}", f"mold.sleeve_interference_mm={interference_mm}"]
    held = name_retention(Design.load(changes=[*changes, f"bone.groove_depth_mm={depth_mm}"]))
    assert ("the groove" in held) == (depth_mm > 0.0)
    assert ("the tightness of the sleeve" in held) == (method == "sleeve" and interference_mm > 0.0)
    assert bool(held) == (pull(*changes, f"bone.groove_depth_mm={depth_mm}") > 0.0)
