"""Clevis: the eyes of the bone about the joint's pin, their hard stops, and the anchor of the tendon."""

from __future__ import annotations

from fingertip.cad.solids import Box, Prism, Solid, cylinder, difference, intersection, union
from fingertip.design import Design
from fingertip.design.geometry.joint import NOTCH_WIDTH_MM, Joint, TendonAnchor
from fingertip.design.geometry.tangency import TANGENT_STEP_MM


def clevis(design: Design) -> tuple[tuple[Solid, ...], tuple[Solid, ...]]:
    """Build what a clevis adds to the filled bone, and what it removes: first the space of the joint, then the holes.

    The eyes are cut from the base. The palmar stop stands out below it.
    """
    joint, anchor = design.dimensions.joint, design.dimensions.anchor
    assert joint
    added = (_palmar_stop(design, joint),) if joint.travel_deg else ()
    across = 2 * design.dimensions.collar.section.half_width
    removed = [space(design, joint), pin_bore(joint, across)]
    if anchor:
        removed.append(cylinder("x", (anchor.y, anchor.z), -across, across, anchor.radius))
        if not design.dimensions.window_opens_into_gap:
            removed.append(_notch(design, anchor))
    return added, tuple(removed)


def _palmar_stop(design: Design, joint: Joint) -> Solid:
    """Build the stop of the bent finger: it fills the finger's outline below the flat of the base, outside the mold."""
    dims, section = design.dimensions, design.dimensions.bone_outline.section
    half = min(section.half_width_at(joint.axis_y), section.half_width_at(-dims.base_flat_depth))
    top = min(-design.mold.recess_length_mm, joint.shoulder_z) - joint.clearance
    low = Box((-half, -dims.collar.section.palmar, joint.low_z - 1.0), (half, joint.axis_y, top))
    return intersection(eye_profile(joint, 2 * half), low)


def space(design: Design, joint: Joint) -> Solid:
    """Build the space that the hand needs: all but the eyes proximal to the base, and the gap between them."""
    dims = design.dimensions
    section = dims.collar.section
    reach = 2 * (section.half_width + section.palmar + section.dorsal)
    low, high = joint.low_z - reach, joint.shoulder_z
    beyond = Box((-reach, -reach, low), (reach, reach, high))
    around = difference(beyond, eye_profile(joint, reach))
    half = joint.half_width
    if not joint.is_fork:
        beside = (Box((-reach, -reach, low), (-half, reach, high)), Box((half, -reach, low), (reach, reach, high)))
        return union(around, *beside)
    # The window of a folded tail lies above the gap, and opens into it.
    top = max(high, dims.fold.window_low_z + TANGENT_STEP_MM) if dims.fold else high
    return union(around, Box((-half, -reach, low), (half, reach, top)))


def eye_profile(joint: Joint, reach: float) -> Solid:
    """Build an eye of any width: round about the pin, and with the hard stops or narrower than the base."""
    y, z = joint.axis_y, joint.axis_z
    around = cylinder("x", (y, z), -reach, reach, joint.eye_radius)
    if joint.travel_deg:
        return union(Prism("x", joint.stopped_profile(reach), -reach, reach), around)
    half = joint.eye_radius - TANGENT_STEP_MM
    return union(Box((-reach, y - half, z), (reach, y + half, z + reach)), around)


def pin_bore(joint: Joint, half_length: float) -> Solid:
    """Build the bore of the joint's pin."""
    return cylinder("x", (joint.axis_y, joint.axis_z), -half_length, half_length, joint.pin_radius)


def _notch(design: Design, anchor: TendonAnchor) -> Solid:
    """Build the notch of the tendon, from its anchor to the palmar and the proximal side."""
    section, joint = design.dimensions.collar.section, design.dimensions.joint
    assert joint
    half = NOTCH_WIDTH_MM / 2
    return Box(
        (-half, -2 * section.palmar, joint.low_z - section.palmar),
        (half, anchor.y + anchor.radius, anchor.z + 2 * anchor.radius),
    )


def knuckle(design: Design, joint: Joint) -> Solid:
    """Build the hand's part of the joint as `[hand]` describes it, for checks and pictures: knuckle and shoulder."""
    hand, reach = design.hand, 4 * joint.radius
    y, z, half = joint.axis_y, joint.axis_z, hand.width_mm / 2
    # The hand ends on its palmar side at the height from which its axis is measured.
    palmar = y - hand.axis_height_mm
    shoulder = Box((-reach, palmar, z - joint.radius - reach), (reach, y + reach, z - joint.radius))
    flat = joint.radius - TANGENT_STEP_MM
    neck = union(
        Box((-reach, y - flat, z - joint.radius - TANGENT_STEP_MM), (reach, y + flat, z)),
        cylinder("x", (y, z), -reach, reach, joint.radius),
    )
    inner = Box((-half, y - reach, z - reach), (half, y + reach, z + reach))
    return union(shoulder, intersection(neck, inner) if joint.is_fork else difference(neck, inner))
