"""Stand of a first finger: one body that prints without supports, into which post and bolt go."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import stand
from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.cad.verification import verify
from fingertip.design import Design
from fingertip.design.geometry.solids import cylinder, union

DESIGN = Design.load("first_finger")


def run(design: Design = DESIGN) -> dict[str, Any]:
    checks = verify.verify(design, ("bone", "stand"), ("stl",), MeshEvaluator(0.02)).checks
    return {check.name: check for check in checks if "stand" in check.name}


def test_every_check_of_the_stand_passes() -> None:
    checks = run()
    assert [name for name, check in checks.items() if not check.passed] == []
    assert {"stand.stl.bodies", "stand.stl.genus", "stand.overhang", "stand.post_gap"} <= set(checks)
    assert checks["stand.post_gap"].value == pytest.approx(0.15, abs=0.02), "half the mating play and the surface error"


def test_its_volume_is_that_of_its_outline_without_socket_and_hole() -> None:
    """Post of 11 x 10 x 14.5 mm, gap 0.15, wall 2.4; 0.5 below the post, handle 26, hole 3.2 mm."""
    (low, high), r, h = (stand.outline(DESIGN).low, stand.outline(DESIGN).high), 5.65, 5.15
    whole = (11 + 0.3 + 4.8) * (10 + 0.3 + 4.8) * (high[2] - low[2])
    socket = 2 * (h * math.sqrt(r * r - h * h) + r * r * math.asin(h / r)) * (high[2] - low[2] - 26.0)
    volume = MeshEvaluator(0.005).manifold(stand.stand(DESIGN)).volume()
    assert volume == pytest.approx(whole - socket - math.pi * 1.6**2 * 4.8, rel=1e-3)
    assert low[2] == pytest.approx(-11.6 - 14.5 - 0.5 - 26.0)


@pytest.mark.parametrize(
    ("change", "failed"),
    [
        (lambda solid: union(solid, cylinder("y", (-20.0, 0.0), -4.0, -2.9, 1.0)), {"stand.post_gap"}),
        (lambda solid: union(solid, cylinder("x", (2.1, -22.9), 6.0, 7.0, 2.0)), {"stand.bolt_overlap"}),
    ],
)  # fmt: skip
def test_a_stand_that_does_not_fit_is_found(change: Any, failed: set[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(PARTS, "stand", replace(PARTS["stand"], solid=lambda design: change(stand.stand(design))))
    assert failed <= {name for name, check in run().items() if not check.passed}


def test_only_a_post_on_a_finger_of_a_lowered_core_has_one() -> None:
    assert "stand" in parts_by_name(DESIGN)
    assert "stand" not in parts_by_name(Design())
    assert "stand" not in parts_by_name(
        Design.load("first_finger", changes=["bone.interface=socket", "bone.base_length_mm=20"])
    )
