"""Stand and stub: bodies that print without supports, into which
post and bolt go, and on which a joint turns.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import print_orientations
from fingertip.cad.verification import verify
from fingertip.design import Design
from fingertip.models.clevis import pin_bore
from fingertip.models.hand_stub import hand_stub, stub_bore_radius
from fingertip.models.joint import joint_of
from fingertip.models.parts import PARTS
from fingertip.models.pin import pin as build_pin
from fingertip.models.solids import cylinder
from fingertip.models.stand import socket_ceiling_mm, stand, stand_outline

DESIGN = Design.load("first_finger")


JOINTED = {
    "tongue": Design.load("adult_finger"),
    "fork": Design.load(
        "adult_finger",
        changes=["hand.knuckle=fork", "bone.base_length_mm=17", "hand.tendon_distance_mm=0"],
    ),
}


def run(design: Design = DESIGN, part: str = "stand") -> dict[str, Any]:
    parts = ("bone", part) if part == "stand" else ("bone", "skin", part)
    checks = verify.verify(design, parts, ("stl",), MeshEvaluator(0.02)).checks
    return {check.name: check for check in checks if part in check.name}


def test_the_gap_beside_the_post_is_measured() -> None:
    assert run()["stand.post_gap"].value == pytest.approx(0.15, abs=0.02), (
        "half the mating play and the surface error"
    )


def test_a_stand_whose_socket_is_too_wide_for_a_bridge_prints_on_the_end_of_its_handle() -> None:
    wide = Design.load("fsr402", changes=["bone.post_width_mm=12.8", "bone.post_height_mm=7.8"])
    assert socket_ceiling_mm(wide) == pytest.approx(2 * math.sqrt(6.55**2 - 4.05**2))
    assert socket_ceiling_mm(DESIGN) == pytest.approx(5.65 * math.sqrt(2)), (
        "round side, wider than the flat"
    )
    assert [print_orientations(design)["stand"].rotate_x_deg for design in (DESIGN, wide)] == [
        -90.0,
        0.0,
    ]
    assert run(wide)["stand.overhang"].passed


def test_its_volume_is_that_of_its_outline_without_socket_and_hole() -> None:
    """Post of 11 x 10 x 14.5 mm, gap 0.15, wall 2.4; 0.5 below the post, handle 26, hole 3.2 mm."""
    low = stand_outline(DESIGN).low
    high = stand_outline(DESIGN).high
    r = 5.65
    h = 5.15
    whole = (11 + 0.3 + 4.8) * (10 + 0.3 + 4.8) * (high[2] - low[2])
    socket = (
        2 * (h * math.sqrt(r * r - h * h) + r * r * math.asin(h / r)) * (high[2] - low[2] - 26.0)
    )
    volume = MeshEvaluator(0.005).manifold(stand(DESIGN)).volume()
    assert volume == pytest.approx(whole - socket - math.pi * 1.6**2 * 4.8, rel=1e-3)
    assert low[2] == pytest.approx(-DESIGN.bone.base_length_mm - 14.5 - 0.5 - 26.0)


@pytest.mark.parametrize(
    ("change", "failed"),
    [
        (
            lambda solid: solid.union(cylinder("y", (-20.0, 0.0), -4.0, -2.9, 1.0)),
            {"stand.post_gap"},
        ),
        (
            lambda solid: solid.union(cylinder("x", (2.1, -22.9), 6.0, 7.0, 2.0)),
            {"stand.bolt_overlap"},
        ),
    ],
)
def test_a_stand_that_does_not_fit_is_found(
    change: Any, failed: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(
        PARTS, "stand", replace(PARTS["stand"], solid=lambda design: change(stand(design)))
    )
    assert failed <= {name for name, check in run().items() if not check.passed}


@pytest.mark.parametrize("knuckle", JOINTED)
def test_every_check_of_the_stub_passes(knuckle: str) -> None:
    checks = run(JOINTED[knuckle], "hand_stub")
    assert [name for name, check in checks.items() if not check.passed] == []
    assert {f"hand_stub.{name}" for name in ("overhang", "travel_overlap", "clearance")} <= set(
        checks
    )
    assert ("hand_stub.wall.guide" in checks) == (JOINTED[knuckle].hand.tendon_distance_mm > 0.0)
    assert checks["hand_stub.clearance"].value == pytest.approx(
        JOINTED[knuckle].bone.joint_clearance_mm, abs=0.03
    )


def test_the_stub_has_the_sizes_of_the_hand() -> None:
    """A section through the pin shows the tongue, one behind the
    mouth of the guide both ways of the tendon.
    """
    design = JOINTED["tongue"]
    hand = design.hand
    joint = design.dimensions.joint
    anchor = design.dimensions.anchor
    solid = MeshEvaluator(0.005).manifold(hand_stub(design))
    tongue = solid.trim_by_plane((0.0, 0.0, 1.0), joint.low_z + 0.1)
    low, high = np.split(np.array(tongue.bounding_box()), 2)
    assert high[0] - low[0] == pytest.approx(hand.width_mm)
    assert high[2] - joint.axis_z == pytest.approx(hand.clearance_radius_mm, abs=0.01)
    for z, radius in (
        (joint.low_z - 8.0, hand.tendon_diameter_mm / 2 + 0.7),
        (joint.low_z - 3.01, 2.3),
    ):
        contours = [np.array(points) for points in solid.slice(z).to_polygons()]
        ways = sorted(
            (ring for ring in contours if np.ptp(ring[:, 0]) < 6.0), key=lambda ring: ring[0, 0]
        )
        middles = [(ring.min(axis=0) + ring.max(axis=0)) / 2 for ring in ways]
        assert np.array(middles) == pytest.approx(
            np.array([(-anchor.strand_x, anchor.y), (anchor.strand_x, anchor.y)])
        )
        assert [np.ptp(ring[:, 1]) / 2 for ring in ways] == pytest.approx([radius] * 2, abs=0.2)


@pytest.mark.parametrize(
    ("change", "failed"),
    [
        (
            lambda stub, joint: stub.union(
                pin_bore(replace(joint, pin_radius=joint.radius + 0.2), 3.0)
            ),
            "clearance",
        ),
        (
            lambda stub, joint: stub.union(cylinder("x", (3.0, joint.low_z), 5.0, 7.0, 1.0)),
            "travel_overlap",
        ),
    ],
)
def test_a_stub_that_does_not_fit_is_found(
    change: Any, failed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def changed(design: Design) -> Any:
        return change(hand_stub(design), joint_of(design))

    monkeypatch.setitem(PARTS, "hand_stub", replace(PARTS["hand_stub"], solid=changed))
    assert not run(JOINTED["tongue"], "hand_stub")[f"hand_stub.{failed}"].passed


def test_pin_wedges_in_a_cheek_and_turns_in_the_tongue() -> None:
    """The taper begins wider than the bore of the cheek, and ends as thin as the pin."""
    design = JOINTED["tongue"]
    joint = joint_of(design)
    pin = MeshEvaluator(0.005).manifold(build_pin(design))
    areas = [pin.slice(z).area() for z in (0.5, 1.01, 5.5)]
    radii = [joint.pin_radius + out for out in (1.0, 0.1, -0.05)]
    assert areas == pytest.approx([math.pi * radius**2 for radius in radii], rel=0.01)
    assert radii[1] > joint.pin_radius > radii[2]
    assert stub_bore_radius(joint) - radii[2] == pytest.approx(0.15)
