"""Checks of the bone: walls, seat and air vent of the sensor, and safety factors.

The mesh kernel computes the distance between two meshes exactly. Facets deviate from the exact surface by up to the
tolerance, so the limits are relaxed by the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.cad.kernel.mesh import Manifold, MeshEvaluator
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.shapes.skin import filled_bone, flat_slab
from fingertip.cad.verification.check import PLANE_OFFSET_MM, VOLUME_TOLERANCE_MM3, Check, above_z, complement
from fingertip.cad.verification.strength import BoneStrength
from fingertip.design import Design
from fingertip.design.geometry.skin_dimensions import RAMP_SLOPE
from fingertip.design.geometry.solids import union
from fingertip.design.interfaces import interface_of

_AREA_TOLERANCE_MM2 = 0.01
"""Largest area that counts as zero [mm2]: a strip along the sensor as narrow as the rounding to the vertex grid."""


def check_air_vent(design: Design, evaluator: MeshEvaluator) -> Check:
    """Check that the air vent of the sensor, which lies in its tail, is open to the outside.

    The check counts the connected volumes of air in and around bone and skin. A pocket that is cut off from the outside
    is a second one.
    """
    solid = union(*(PARTS[name].solid(design) for name in ("bone", "skin")))
    air = complement(evaluator, solid) - evaluator.manifold(bone.sensor_body(design))
    # Inner walls have a negative volume, and surfaces that touch leave slivers.
    volumes = [body for body in air.decompose() if body.volume() > VOLUME_TOLERANCE_MM3]
    return Check("sensor.air_volumes", len(volumes), 1, "volumes", "exactly")


def check_bone(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    wall = design.printer.min_wall_mm - evaluator.tolerance_mm
    whole, outside = evaluator.manifold(filled_bone(design)), complement(evaluator, filled_bone(design))
    recess = evaluator.manifold(bone.sensor_recess(design))
    yield from _check_channel_walls(design, evaluator, outside, wall)

    # Pocket and slot open in the flat, so only what lies above flat, ramp and platform is measured.
    low_x, _, low_z, high_x, high_y, high_z = outside.bounding_box()
    above = evaluator.manifold(flat_slab(design, PLANE_OFFSET_MM, 2 * high_y, max(-low_x, high_x), low_z, high_z))
    recessed, beside = recess ^ whole ^ above, outside ^ above
    rim = min(design.bone.rim_mm, wall)
    yield Check.min_distance("bone.wall.sensor_to_outside", recessed, beside, 0.95 * rim)
    interface = interface_of(design)
    if name := interface.walled_hollow:
        # The hollow opens in the proximal face, so its mouth is left out.
        hollow = evaluator.manifold(interface.shapes(design)[1][0])
        deep = above_z(hollow, -design.bone.base_length_mm + 2 * wall)
        yield Check.min_distance(f"bone.wall.{name}_to_outside", deep, outside, wall)
        yield Check.min_distance(f"bone.wall.{name}_to_sensor", deep, recess, wall)
    yield from _check_sensor_seat(design, evaluator)


def _check_channel_walls(design: Design, evaluator: MeshEvaluator, outside: Manifold, wall: float) -> Iterator[Check]:
    """Check the part of the channel that has bone on all sides: from the trough's floor to short of its dorsal end."""
    dims = design.dimensions
    channel = evaluator.manifold(bone.cable_channel(design))
    buried = channel.trim_by_plane((0.0, 1.0, 0.0), dims.pocket_depth - dims.flat_depth + wall)
    mouth = dims.bone_outline.section.dorsal - wall - design.bone.channel_diameter_mm
    buried = buried.trim_by_plane((0.0, -1.0, 0.0), -mouth)
    yield Check.min_distance("bone.wall.channel_to_outside", buried, outside, wall)
    hole = evaluator.manifold(interface_of(design).shapes(design)[1][0])
    yield Check.min_distance("bone.wall.channel_to_interface", buried, hole, wall)


def _check_sensor_seat(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check clearance and flat seat of the sensor: one that bends over an unsupported area reads a false force."""
    dims = design.dimensions
    solid, body = evaluator.manifold(PARTS["bone"].solid(design)), evaluator.manifold(bone.sensor_body(design))
    # The depth of the slot is measured along y, so the gap under a film on the ramp is thinner.
    oblique = math.hypot(1.0, RAMP_SLOPE) if design.bone.platform_mm else 1.0
    clearance = min(design.sensor.clearance_mm, design.sensor.adhesive_thickness_mm / oblique) - evaluator.tolerance_mm
    if clearance > 0.0:
        yield Check.min_distance("sensor.pocket_clearance", body, solid, clearance)
    yield Check.zero_volume("overlap.bone.sensor", (body ^ solid).volume())
    distal = above_z(body, dims.tail_end_z + PLANE_OFFSET_MM)
    # Move the sensor into its seat by its own thickness. Where it then meets no bone, the seat does not support it.
    thickness = dims.sensor.thickness_mm
    sunk = distal.translate((0.0, thickness + design.sensor.adhesive_thickness_mm, 0.0))
    unsupported = (sunk.volume() - (sunk ^ solid).volume()) / thickness
    yield Check("sensor.unsupported_area", unsupported, _AREA_TOLERANCE_MM2, "mm2")


def check_strength(design: Design, strength: BoneStrength) -> Iterator[Check]:
    """Check the safety factors. The loads that both allow are the remedy of one that is too small."""
    stated, lighter = design.strength, []
    grip, knock = strength.grip_safety_factor, strength.knock_safety_factor
    if grip < stated.min_grip_factor <= strength.breaks_n:  # the least grip of a design is 1 N
        lighter.append(f"strength.grip_force_n={_round_down(strength.breaks_n / stated.min_grip_factor):g}")
    if knock < stated.min_knock_factor:
        lighter.append(f"strength.knock_speed_m_s={_round_down(strength.held_speed_m_s):g}")
    for load, factor, limit in (("grip", grip, stated.min_grip_factor), ("knock", knock, stated.min_knock_factor)):
        remedy = " --set ".join(lighter) if factor < limit else ""
        yield Check(f"bone.safety_factor.{load}", factor, limit, "", "at least", remedy=remedy)


def _round_down(value: float) -> float:
    """Round down to two digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return float(f"{math.floor(value / step) * step:.6g}")
