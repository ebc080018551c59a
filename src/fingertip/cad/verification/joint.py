"""Checks of a clevis: walls around pin and anchor, and free travel between the hard stops.

The joint is moved: the finger is rotated about the pin against the hand's part of the joint as `[hand]` describes it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.kernel.solids import Box, cylinder, intersection
from fingertip.cad.shapes.insert import filled_bone
from fingertip.cad.shapes.interface import eye_profile, knuckle, pin_bore, space
from fingertip.cad.shapes.parts import PARTS, parts_by_name
from fingertip.cad.verification.check import (
    VOLUME_TOLERANCE_MM3,
    Check,
    check_min_distance,
    check_zero_volume,
    complement,
    search_distance,
)
from fingertip.design import Design
from fingertip.design.geometry.joint import Joint, TendonAnchor

if TYPE_CHECKING:
    from manifold3d import Manifold

_FREE_ANGLES = 8
"""Angles at which the joint is tried, besides straight."""
_BEYOND_STOP_DEG = 4.0
"""Angle beyond a stop at which it must block [degrees]."""
_FINGER = ("bone", "lid", "skin")


def check_joint(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check the clevis of a design that has one."""
    joint, anchor = design.dimensions.joint, design.dimensions.anchor
    if joint is None:
        return
    wall = design.printer.min_wall_mm - evaluator.tolerance_mm
    yield from _check_eyes(design, joint, evaluator, wall)
    if anchor:
        yield _check_anchor(design, anchor, evaluator, wall)
        yield _check_tendon(design, joint, anchor, evaluator)
    yield from _check_travel(design, joint, evaluator)


def _check_eyes(design: Design, joint: Joint, evaluator: MeshEvaluator, wall: float) -> Iterator[Check]:
    """Check the walls of the eyes around the pin and beside the joint's gap."""
    dims, half_length = design.dimensions, 1.0
    reach = 2 * (joint.radius + dims.collar.section.dorsal + dims.collar.section.palmar)
    heights = Box(
        (-reach, -dims.base_flat_depth, -reach + joint.axis_z), (reach, dims.bone_outline.section.dorsal, reach)
    )
    around = complement(evaluator, intersection(eye_profile(joint, 2 * reach), heights))
    bore = evaluator.manifold(pin_bore(joint, half_length))
    yield check_min_distance("bone.wall.pin_to_outside", bore, around, wall)
    # Cheeks, or a tongue, beside the pin.
    edge = joint.pin_radius + wall
    beside = Box(
        (-reach, joint.axis_y - edge, joint.axis_z), (reach, joint.axis_y + edge, joint.shoulder_z - joint.clearance)
    )
    solid = evaluator.manifold(PARTS["bone"].solid(design)) ^ evaluator.manifold(beside)
    if joint.is_fork:
        gap = evaluator.manifold(intersection(space(design, joint), beside))
        gap = gap.trim_by_plane((1.0, 0.0, 0.0), -joint.half_width).trim_by_plane((-1.0, 0.0, 0.0), -joint.half_width)
        outside = complement(evaluator, filled_bone(design)) ^ evaluator.manifold(beside)
        yield check_min_distance("bone.wall.cheek", gap, outside, wall)
    else:
        box = solid.bounding_box()
        yield Check("bone.wall.tongue", box[3] - box[0], wall, "mm", "at least")


def _check_anchor(design: Design, anchor: TendonAnchor, evaluator: MeshEvaluator, wall: float) -> Check:
    """Check the walls around the tendon's anchor along its first millimetres in each cheek."""
    inner = anchor.inner_half_width
    length = max(wall, design.printer.min_wall_mm / 2)  # a coarse mesh leaves nothing of the wall
    hole = cylinder("x", (anchor.y, anchor.z), inner, inner + length, anchor.radius)
    outside = complement(evaluator, filled_bone(design))
    return check_min_distance("bone.wall.anchor_to_outside", evaluator.manifold(hole), outside, wall)


def _check_tendon(design: Design, joint: Joint, anchor: TendonAnchor, evaluator: MeshEvaluator) -> Check:
    """Check that nothing lies in the way of the tendon, which leaves its anchor straight along the finger."""
    radius = min(design.hand.tendon_diameter_mm / 2, anchor.radius)
    tendon = evaluator.manifold(cylinder("z", (0.0, anchor.y), joint.low_z - joint.radius, anchor.z, radius))
    bone = evaluator.manifold(PARTS["bone"].solid(design))
    return check_zero_volume("joint.tendon_overlap", (tendon ^ bone).volume())


def _check_travel(design: Design, joint: Joint, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check that the finger turns freely from straight to bent, and that the stops block it beyond both ends."""
    hand = evaluator.manifold(knuckle(design, joint))
    present = parts_by_name(design)
    finger = [evaluator.manifold(present[name].solid(design)) for name in _FINGER if name in present]
    travel = design.hand.travel_deg
    angles = [travel * i / _FREE_ANGLES for i in range(_FREE_ANGLES + 1)] if travel else [0.0]
    worst = max(_overlap(finger, hand, joint, angle) for angle in angles)
    yield Check("joint.travel_overlap", worst, _touching_volume(design, joint, evaluator), "mm3")
    halfway = [_turn(part, joint, travel / 2) for part in finger]
    ahead = hand.trim_by_plane((0.0, 0.0, 1.0), joint.axis_z)  # without the shoulder, which the stops meet
    clearance = search_distance(lambda reach: min(part.min_gap(ahead, reach) for part in halfway), 2 * joint.clearance)
    yield Check("joint.clearance", clearance, 0.9 * joint.clearance - evaluator.tolerance_mm, "mm", "at least")
    if travel:
        for name, angle in (("straight", -_BEYOND_STOP_DEG), ("bent", travel + _BEYOND_STOP_DEG)):
            blocked = _overlap(finger[:1], hand, joint, angle)
            yield Check(f"joint.stop_{name}_overlap", blocked, _wedge(design, joint), "mm3", "at least")


def _overlap(finger: list[Manifold], hand: Manifold, joint: Joint, angle_deg: float) -> float:
    """Compute the volume [mm3] that finger and hand share if the finger is bent by an angle."""
    return float(sum((_turn(part, joint, angle_deg) ^ hand).volume() for part in finger))


def _turn(part: Manifold, joint: Joint, angle_deg: float) -> Manifold:
    """Turn a part of the finger about the pin: its tip (+z) to the palmar side (-y), a positive rotation about x."""
    at_origin = part.translate((0.0, -joint.axis_y, -joint.axis_z))
    return at_origin.rotate((angle_deg, 0.0, 0.0)).translate((0.0, joint.axis_y, joint.axis_z))


def _touching_volume(design: Design, joint: Joint, evaluator: MeshEvaluator) -> float:
    """Volume that surfaces in contact may share, because meshes deviate by up to the tolerance [mm3]."""
    area = 4 * joint.radius * design.dimensions.bone_outline.section.half_width
    return VOLUME_TOLERANCE_MM3 + 0.05 * area * evaluator.tolerance_mm


def _wedge(design: Design, joint: Joint) -> float:
    """Half the volume of a stop as long as the pin's radius, pressed past the shoulder by the angle beyond it [mm3]."""
    section = design.dimensions.bone_outline.section
    width = 2 * (section.half_width - joint.half_width if joint.is_fork else joint.half_width)
    depth = math.tan(math.radians(_BEYOND_STOP_DEG))
    return 0.25 * width * depth * joint.pin_radius**2
