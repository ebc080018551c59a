"""Checks of a joint: the finger is rotated about the pin, on the hand as `[hand]` describes it and
on its stub.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.cad.kernel.mesh import Manifold
from fingertip.cad.verification.check import (
    VOLUME_TOLERANCE_MM3,
    Check,
    Checks,
    Solids,
    complement,
    search_distance,
)
from fingertip.design import Design
from fingertip.models.bone import filled_bone
from fingertip.models.clevis import eye_profile, joint_base, knuckle, pin_bore, space, strands
from fingertip.models.hand_stub import GUIDE_MM, guide, without_ways
from fingertip.models.joint import Joint, joint_of
from fingertip.models.solids import Box, cylinder, union

CHECKS = Checks()

_FREE_ANGLES = 8
_STUB_ANGLES = 4
"""Angles at which the joint is tried on the hand and on its stub, besides straight."""
_BEYOND_STOP_DEG = 4.0
"""Angle beyond a stop at which it must block [degrees]."""


@CHECKS.register(
    "bone",
    "skin",
    change={
        "bone.wall.pin*": ("hand.pin_diameter_mm", "hand.clearance_radius_mm"),
        "bone.wall.cheek": ("hand.width_mm",),
        "bone.wall.tongue": ("hand.width_mm",),
        "joint.tendon_overlap": ("hand.tendon_distance_mm", "hand.tendon_diameter_mm"),
        "joint.*": ("hand.travel_deg", "bone.joint_clearance_mm", "hand.clearance_radius_mm"),
    },
)
def check_joint(design: Design, solids: Solids) -> Iterator[Check]:
    """Check walls and tendon, that the finger turns freely on the hand, and that stops block it
    beyond both ends.
    """
    joint = design.dimensions.joint
    anchor = design.dimensions.anchor
    evaluator = solids.evaluator
    if joint is None:
        return

    yield from _check_eyes(design, joint, solids)
    if anchor:
        tendon = evaluator.manifold(union(*strands(design, anchor, joint.low_z - joint.radius)))
        yield Check.zero_volume("joint.tendon_overlap", (tendon ^ solids["bone"]).volume())

    hand, travel = evaluator.manifold(knuckle(design, joint)), design.hand.travel_deg
    yield from _check_travel(
        "joint",
        design=design,
        joint=joint,
        solids=solids,
        hand=hand,
        angles=_FREE_ANGLES,
    )
    if travel:
        for name, angle in (("straight", -_BEYOND_STOP_DEG), ("bent", travel + _BEYOND_STOP_DEG)):
            blocked = float((turn_about_pin(solids["bone"], joint, angle) ^ hand).volume())
            yield Check(
                name=f"joint.stop_{name}_overlap",
                value=blocked,
                limit=_wedge(design, joint),
                unit="mm3",
                relation="at least",
            )


def _check_eyes(design: Design, joint: Joint, solids: Solids) -> Iterator[Check]:
    dims = design.dimensions
    half_length = 1.0
    evaluator = solids.evaluator
    wall = design.printer.min_wall_mm - evaluator.tolerance_mm
    reach = 2 * (joint.radius + dims.collar.section.dorsal + dims.collar.section.palmar)
    assert dims.stops_top_z is not None
    base = joint_base(design, joint, dims.stops_top_z)
    around = complement(evaluator, eye_profile(joint, 2 * reach).intersect(base))
    bore = evaluator.manifold(pin_bore(joint, half_length))
    yield Check.min_distance("bone.wall.pin_to_outside", bore, around, wall)
    # Cheeks, or a tongue, beside the pin.
    edge = joint.pin_radius + wall
    beside = Box(
        (-reach, joint.axis_y - edge, joint.axis_z),
        (reach, joint.axis_y + edge, joint.shoulder_z - joint.clearance),
    )

    if joint.is_fork:
        gap = evaluator.manifold(space(design, joint).intersect(beside))
        gap = gap.trim_by_plane((1.0, 0.0, 0.0), -joint.half_width).trim_by_plane(
            (-1.0, 0.0, 0.0), -joint.half_width
        )
        outside = complement(evaluator, filled_bone(design).union(base)) ^ evaluator.manifold(
            beside
        )
        yield Check.min_distance("bone.wall.cheek", gap, outside, wall)
    else:
        box = (solids["bone"] ^ evaluator.manifold(beside)).bounding_box()
        yield Check(
            name="bone.wall.tongue",
            value=box[3] - box[0],
            limit=wall,
            unit="mm",
            relation="at least",
        )


def _check_travel(
    name: str,
    design: Design,
    joint: Joint,
    solids: Solids,
    hand: Manifold,
    angles: int,
) -> Iterator[Check]:
    """Check that the finger turns freely on a solid, from straight to bent, and its clearance
    halfway.
    """
    travel = design.hand.travel_deg
    finger = [solids["bone"], solids["skin"]]
    turned = [travel * i / angles for i in range(angles + 1)] if travel else [0.0]
    worst = max(
        sum((turn_about_pin(part, joint, angle) ^ hand).volume() for part in finger)
        for angle in turned
    )
    # Surfaces in contact may share a volume, because meshes deviate by up to the tolerance.
    contact_mm2 = 4 * joint.radius * design.dimensions.bone_outline.section.half_width
    allowed = VOLUME_TOLERANCE_MM3 + 0.05 * contact_mm2 * solids.evaluator.tolerance_mm
    yield Check(f"{name}.travel_overlap", float(worst), allowed, "mm3")
    halfway = [turn_about_pin(part, joint, travel / 2) for part in finger]
    # Without the shoulder, which the stops meet.
    ahead = hand.trim_by_plane((0.0, 0.0, 1.0), joint.axis_z)
    gap = search_distance(
        lambda reach: min(part.min_gap(ahead, reach) for part in halfway), 2 * joint.clearance
    )
    yield Check(
        name=f"{name}.clearance",
        value=gap,
        limit=0.9 * joint.clearance - solids.evaluator.tolerance_mm,
        unit="mm",
        relation="at least",
    )


def turn_about_pin(part: Manifold, joint: Joint, angle_deg: float) -> Manifold:
    """Turn a part of the finger about the pin: its tip (+z) to the palmar side (-y), a positive
    rotation about x.
    """
    at_origin = part.translate((0.0, -joint.axis_y, -joint.axis_z))
    return at_origin.rotate((angle_deg, 0.0, 0.0)).translate((0.0, joint.axis_y, joint.axis_z))


def _wedge(design: Design, joint: Joint) -> float:
    """Half the volume of a stop as long as the pin's radius, pressed past the shoulder by the angle
    beyond it [mm3].
    """
    dims = design.dimensions
    # Beside the strands of a tendon the stop ends at their horns.
    free = dims.anchor.half_width if dims.anchor else dims.joint_base_half_width
    half = min(dims.bone_outline.section.half_width, free)
    width = 2 * (half - joint.half_width if joint.is_fork else joint.half_width)
    depth = math.tan(math.radians(_BEYOND_STOP_DEG))

    return 0.25 * width * depth * joint.pin_radius**2


@CHECKS.register(
    "bone",
    "skin",
    "hand_stub",
    change={"hand_stub.*": ("hand.travel_deg", "hand.axis_height_mm", "hand.tendon_distance_mm")},
)
def check_hand_stub(design: Design, solids: Solids) -> Iterator[Check]:
    """Check that the joint turns on the stub of a hand, and the walls of its way for the tendon."""
    joint = joint_of(design)
    evaluator = solids.evaluator
    yield from _check_travel(
        "hand_stub",
        design=design,
        joint=joint,
        solids=solids,
        hand=solids["hand_stub"],
        angles=_STUB_ANGLES,
    )
    way = guide(design)

    if way:
        wall = design.printer.min_wall_mm
        outside = complement(evaluator, without_ways(design))
        low = way.mouth_z - GUIDE_MM
        high = way.mouth_z - 2 * wall
        guides = union(
            *(
                cylinder(
                    "z",
                    centre=(x, way.y),
                    low=low,
                    high=high,
                    radius=way.radius,
                )
                for x in way.x
            )
        )
        wall -= evaluator.tolerance_mm
        yield Check.min_distance("hand_stub.wall.guide", evaluator.manifold(guides), outside, wall)
