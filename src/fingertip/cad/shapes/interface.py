"""Interface of the bone to the proximal phalanx: post, socket, flange or clevis."""

from __future__ import annotations

from fingertip.design import Design
from fingertip.design.geometry.conic import TANGENT_STEP_MM
from fingertip.design.geometry.features import NOTCH_WIDTH_MM, Joint, TendonAnchor
from fingertip.design.geometry.solids import Box, Prism, Solid, cylinder, difference, intersection, union

# Clevis: the eyes of the bone about the joint's pin, their hard stops, and the anchor of the tendon.


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


_MIN_FLAT_MM = 0.02
"""Depth of a post's flat below which it is left out [mm]: both kernels fail on slivers."""


def interface(design: Design) -> tuple[tuple[Solid, ...], tuple[Solid, ...]]:
    """Build the interface to the proximal phalanx."""
    dims, bone = design.dimensions, design.bone
    y = (dims.bone_outline.section.dorsal - dims.base_flat_depth) / 2
    end, across = -bone.base_length_mm, 2 * dims.bone_outline.section.half_width
    bolt = bone.cross_bolt_diameter_mm / 2
    if bone.interface == "socket":
        radius = bone.socket_diameter_mm / 2
        socket = cylinder("z", (0.0, y), end - radius, end + bone.socket_depth_mm, radius)
        hole = cylinder("x", (y, dims.cross_bolt_z), -across, across, bolt)
        return (), (socket, hole)
    if bone.interface == "flange":
        return (_flange(design, y),), _flange_holes(design, y)
    if bone.interface == "clevis":
        return clevis(design)
    foot = end - bone.post_length_mm
    return (_post(design, y, foot, end + bone.wall_mm / 2),), (
        cylinder("x", (y, dims.cross_bolt_z), -across, across, bolt),
    )


def _post(design: Design, y: float, low: float, high: float) -> Solid:
    """Build a round post with a dorsal and a palmar flat, or without them if it is as high as wide."""
    radius, half = design.bone.post_width_mm / 2, design.bone.post_height_mm / 2
    stem = cylinder("z", (0.0, y), low, high, radius)
    if half > radius - _MIN_FLAT_MM:
        return stem
    margin = radius  # past the round sides and the ends, by a length that scales with the design
    return intersection(
        stem, Box((-radius - margin, y - half, low - margin), (radius + margin, y + half, high + margin))
    )


def _flange(design: Design, y: float) -> Solid:
    """Build the plate at the proximal end of the base."""
    bone = design.bone
    end, x, half = -bone.base_length_mm, bone.flange_width_mm / 2, bone.flange_height_mm / 2
    return Box((-x, y - half, end), (x, y + half, end + bone.flange_thickness_mm))


def _flange_holes(design: Design, y: float) -> tuple[Solid, ...]:
    """Build the bolt holes of the flange."""
    bone = design.bone
    end, top = -bone.base_length_mm, -bone.base_length_mm + bone.flange_thickness_mm
    radius, x, rows = bone.flange_hole_diameter_mm / 2, bone.flange_spacing_x_mm / 2, bone.flange_spacing_y_mm / 2
    return tuple(
        cylinder("z", (side * x, y + row), end - radius, top + radius, radius)
        for row in ((-rows, rows) if rows else (0.0,))
        for side in (-1.0, 1.0)
    )


def interface_genus(design: Design) -> int:
    """Count the through holes of the interface.

    Post and socket have the hole of the cross bolt. A socket adds one more: it is blind, but it opens into that hole,
    which then has three mouths. A fork has a hole in each cheek. The anchor of a tendon has two holes, one on either
    side of the notch or window that it crosses.
    """
    dims = design.dimensions
    if design.bone.interface == "clevis":
        assert dims.joint
        return (2 if dims.joint.is_fork else 1) + (2 if dims.anchor else 0)
    return {"post": 1, "socket": 2, "flange": 4 if design.bone.flange_spacing_y_mm else 2}[design.bone.interface]
