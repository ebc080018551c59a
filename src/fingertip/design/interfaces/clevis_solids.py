"""Solids of a clevis: eyes with their hard stops, the space that the hand needs, and the anchor of the tendon.

With stops the eyes are as wide and high as the collar where they lie outside the mold: the wider the cheeks and the
longer the stop, the less the pin pulls at its bore at a knock.
"""

from __future__ import annotations

import math

from fingertip.design.geometry import DesignTables
from fingertip.design.geometry.conic import TANGENT_STEP_MM, ConicBody
from fingertip.design.geometry.features import NOTCH_WIDTH_MM, Joint, TendonAnchor
from fingertip.design.geometry.foot import conic_foot, flat_foot, foot_line
from fingertip.design.geometry.solids import (
    Box,
    Prism,
    Solid,
    SuperconicSolid,
    cylinder,
    difference,
    intersection,
    union,
)


def stops(design: DesignTables, joint: Joint, top: float) -> Solid:
    """Build eyes and stops as wide and high as the collar, outside the mold.

    The stop of the bent finger is as wide as the base at its flat, down to its blunt toe: it stands out of the outline.
    """
    dims, collar = design.dimensions, design.dimensions.collar.section
    section = dims.bone_outline.section
    low, foot = joint.low_z - joint.radius, eye_foot(design, joint, top)
    end = foot[-1][0] - TANGENT_STEP_MM if foot else top
    outline: Solid = SuperconicSolid(ConicBody(collar, ((low, 1.0), (end, 1.0))))
    if foot:
        along = SuperconicSolid(ConicBody(collar, ((low, 1.0), (top, 1.0))))
        outline = union(outline, intersection(along, conic_foot(section, foot, low)))
    half = min(section.half_width_at(joint.axis_y), section.half_width_at(-dims.base_flat_depth))
    below = Box((-half, -collar.palmar, joint.low_z - 1.0), (half, joint.axis_y, top))
    reach = 2 * (collar.half_width + collar.dorsal + collar.palmar)
    within = Box((-reach, stop_toe_y(design, joint, top), -reach), (reach, reach, reach))
    return intersection(union(outline, below), eye_profile(joint, reach), within)


def eye_radius_mm(design: DesignTables, joint: Joint, top: float) -> float:
    """Radius of the fillet where the base stands on the eyes, which leaves a wall beside the bore of the pin."""
    dims = design.dimensions
    rise = dims.collar.section.half_width - dims.bone_outline.section.half_width
    wall = design.printer.min_wall_mm + TANGENT_STEP_MM
    return max(0.0, min(rise, top - joint.axis_z - joint.pin_radius - wall))


def eye_foot(design: DesignTables, joint: Joint, top: float) -> list[tuple[float, float]]:
    """List points (z, outward) of that fillet, from the base to the eyes [mm]; none without room."""
    radius = eye_radius_mm(design, joint, top)
    return foot_line(radius, top - radius, -1.0) if radius else []


def stop_toe_y(design: DesignTables, joint: Joint, top: float) -> float:
    """Palmar end of the stop of the bent finger, which is a wall thick there."""
    angle, toe_z = math.radians(joint.travel_deg), top - design.bone.wall_mm - joint.axis_z
    toe_y = joint.axis_y - (joint.radius + toe_z * math.cos(angle)) / math.sin(angle)
    return max(-design.dimensions.collar.section.palmar, toe_y)


def stop_top_y(design: DesignTables, joint: Joint) -> float:
    """Dorsal end of the stop of the straight finger. Cheeks end beside the gap, or where they would be an edge."""
    collar = design.dimensions.collar
    if not joint.is_fork:
        return collar.section.dorsal
    blunt = design.dimensions.blunt_up_to_y(joint.half_width, -design.bone.collar_length_mm / 2, collar)
    return collar.section.dorsal_height_at(joint.half_width) if blunt is None else blunt


def stop_height_mm(design: DesignTables) -> float:
    """Height of the stop of the straight finger above the pin's axis; 0 without a joint."""
    joint = design.dimensions.joint
    return stop_top_y(design, joint) - joint.axis_y if joint else 0.0


def space(design: DesignTables, joint: Joint) -> Solid:
    """Build the space that the hand needs: all but the eyes proximal to the base, and the gap between them."""
    dims = design.dimensions
    section = dims.collar.section
    reach = 2 * (section.half_width + section.palmar + section.dorsal)
    low, high = joint.low_z - reach, joint.shoulder_z
    beyond = Box((-reach, -reach, low), (reach, reach, high))
    y, half = joint.axis_y, joint.half_width
    line, end = foot_line(joint.foot, high, 1.0) if joint.foot else [], high + section.half_width
    eyes = [eye_profile(joint, reach)]
    if not joint.travel_deg:
        eyes.append(flat_foot("x", y - joint.eye_radius, y + joint.eye_radius, line, end, reach))
    around = difference(beyond, *eyes)
    if not joint.is_fork:
        tongue = Box((-half, -2 * reach, low - reach), (half, 2 * reach, end))
        return union(around, difference(beyond, tongue, flat_foot("y", -half, half, line, end, 2 * reach)))
    # The window of a folded tail lies above the gap, and opens into it.
    top = max(high, dims.fold.window_low_z + TANGENT_STEP_MM) if dims.fold else high
    gap: Solid = Box((-half, -reach, low), (half, reach, top))
    edges: list[Solid] = []
    cut_y, from_z = reach, low if dims.stops_top_z is None else dims.stops_top_z
    if (blunt := dims.blunt_up_to_y(half, 0.0)) is not None:
        # Beside the window of a folded tail the cheeks are lower still.
        cut_y, end_z = (min(blunt, dims.cheek_top_y), dims.fold.nose_z) if dims.fold else (blunt, top)
        edges.append(Box((-reach, cut_y, from_z), (reach, reach, end_z)))
    if from_z > low:
        # The fillet goes on along the cut edges of the cheeks.
        stop_y = stop_top_y(design, joint)
        foot = (eye_foot(design, joint, from_z) if cut_y < stop_y else []) or [(from_z, 0.0)]
        rise = [(cut_y + out, z) for z, out in foot if out > 0.0 and cut_y + out < stop_y - TANGENT_STEP_MM]
        end = foot[min(len(rise) + 1, len(foot) - 1)][0]
        ring = ((reach, low), (reach, from_z), (min(cut_y, stop_y), from_z), *rise, (stop_y, end), (stop_y, low))
        edges.append(Prism("x", tuple(dict.fromkeys(ring)), -reach, reach))
    if dims.fold and half > dims.tail_half_width:
        # The window is narrower than the gap. A fillet of the step weakens the cheeks less; its axis is the edge of the
        # hand's tongue, so that all of the clearance remains.
        line = foot_line(joint.clearance, top, 1.0)
        sides = ((half, reach), (-reach, -half))
        gap = difference(gap, *(flat_foot("y", *side, line, top + reach, 2 * reach) for side in sides))
    return union(around, gap, *edges)


def eye_profile(joint: Joint, reach: float) -> Solid:
    """Build an eye of any width: round about the pin, and with the hard stops or narrower than the base."""
    y, z = joint.axis_y, joint.axis_z
    around = cylinder("x", (y, z), -reach, reach, joint.eye_radius)
    if joint.travel_deg:
        return union(Prism("x", joint.stopped_profile(reach), -reach, reach), around)
    half = joint.eye_radius - TANGENT_STEP_MM
    return union(Box((-reach, y - half, z), (reach, y + half, z + reach)), around)


def pin_bore(joint: Joint, half_length: float) -> Solid:
    return cylinder("x", (joint.axis_y, joint.axis_z), -half_length, half_length, joint.pin_radius)


def notch(design: DesignTables, anchor: TendonAnchor) -> Solid:
    """Build the notch of the tendon, from its anchor to the palmar and the proximal side."""
    section, joint = design.dimensions.collar.section, design.dimensions.joint
    assert joint
    half = NOTCH_WIDTH_MM / 2
    return Box(
        (-half, -2 * section.palmar, joint.low_z - section.palmar),
        (half, anchor.y + anchor.radius, anchor.z + 2 * anchor.radius),
    )


def open_ends(design: DesignTables, anchor: TendonAnchor) -> tuple[Box, Box]:
    """Build the slots that open the anchor's hole towards the palm where the wall there would be too thin to print."""
    section, begin = design.dimensions.collar.section, anchor.open_half_width
    reach, high = 2 * section.half_width, anchor.z + anchor.radius
    # The foot of the collar rises towards the palm.
    low = anchor.z - anchor.radius + design.dimensions.draft_slope * (section.palmar + anchor.y)
    return (
        Box((begin, -2 * section.palmar, low), (reach, anchor.y, high)),
        Box((-reach, -2 * section.palmar, low), (-begin, anchor.y, high)),
    )


def knuckle(design: DesignTables, joint: Joint, *added: Solid) -> Solid:
    """Build the hand's part of the joint as `[hand]` describes it: shoulder and knuckle, with what is added to that."""
    hand, reach = design.hand, 4 * joint.radius
    y, z, half = joint.axis_y, joint.axis_z, hand.width_mm / 2
    # The hand ends on its palmar side at the height from which its axis is measured.
    palmar = y - hand.axis_height_mm
    shoulder = Box((-reach, palmar, z - joint.radius - reach), (reach, y + reach, z - joint.radius))
    flat = joint.radius - TANGENT_STEP_MM
    neck = union(
        Box((-reach, y - flat, z - joint.radius - TANGENT_STEP_MM), (reach, y + flat, z)),
        cylinder("x", (y, z), -reach, reach, joint.radius),
        *added,
    )
    inner = Box((-half, y - reach, z - reach), (half, y + reach, z + reach))
    return union(shoulder, intersection(neck, inner) if joint.is_fork else difference(neck, inner))
