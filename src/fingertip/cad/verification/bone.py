"""Checks of the bone: walls, seat, room and air vent of the sensor, its post in the stand, and
safety factors.

The mesh kernel computes the distance between two meshes exactly. Facets deviate from the exact
surface by up to the tolerance, so the limits are relaxed by the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.cad.kernel.mesh import Manifold, MeshEvaluator
from fingertip.cad.verification.check import (
    PLANE_OFFSET_MM,
    VOLUME_TOLERANCE_MM3,
    Check,
    Checks,
    Solids,
    above_z,
    complement,
)
from fingertip.cad.verification.walls import NEGLIGIBLE_MM2, SPACING_MM, measure_walls
from fingertip.catalogues.hardware import select_thread
from fingertip.design import Design
from fingertip.design.interfaces import interface_of
from fingertip.design.interfaces.post_and_socket import Post
from fingertip.models import bone as bone_model
from fingertip.models import sensor_pocket
from fingertip.models.allowances import MATING_PLAY_MM
from fingertip.models.bone import filled_bone
from fingertip.models.dimensions import HEAD_MM, LONGER_MM, TAIL_MM
from fingertip.models.interfaces import shapes_of
from fingertip.models.sensor_pocket import flat_slab, sensor_body
from fingertip.models.skin_dimensions import RAMP_SLOPE
from fingertip.models.solids import Box, cylinder

CHECKS = Checks()
STRENGTH_CHECKS = Checks()

_AREA_TOLERANCE_MM2 = 0.01
"""Largest area that counts as zero [mm2]: a strip along the sensor as narrow as the rounding to the
vertex grid.
"""
_LEAST_OPEN_PERCENT = 50.0
_GAP_MM = 0.1
"""Length of the space behind the tail's end that counts as the mouth of its vent [mm]."""


@CHECKS.register(
    "bone",
    change={
        "bone.wall.channel*": ("bone.channel_diameter_mm", "bone.wall_mm"),
        "bone.wall.sensor*": ("bone.rim_mm", "bone.wall_mm", "skin.width_mm"),
        "bone.wall.socket*": ("bone.socket_diameter_mm", "bone.socket_depth_mm"),
        "sensor.pocket_clearance": ("sensor.clearance_mm", "sensor.adhesive_thickness_mm"),
        "sensor.unsupported_area": ("sensor.distance_from_tip_mm", "bone.base_length_mm"),
        "overlap.bone.sensor": (),
    },
)
def check_bone(design: Design, solids: Solids) -> Iterator[Check]:
    evaluator = solids.evaluator
    wall = design.printer.min_wall_mm - evaluator.tolerance_mm
    whole = evaluator.manifold(filled_bone(design))
    outside = complement(evaluator, filled_bone(design))
    recess = evaluator.manifold(sensor_pocket.sensor_recess(design))
    yield from _check_channel_walls(design, evaluator, outside, wall)

    # Pocket and slot open in the flat, so only what lies above flat, ramp and platform is measured.
    low_x, _, low_z, high_x, high_y, high_z = outside.bounding_box()
    above = evaluator.manifold(
        flat_slab(
            design,
            low_mm=PLANE_OFFSET_MM,
            high_mm=2 * high_y,
            half_width=max(-low_x, high_x),
            begin=low_z,
            end=high_z,
        )
    )
    recessed = recess ^ whole ^ above
    beside = outside ^ above
    rim = min(design.bone.rim_mm, wall)
    yield Check.min_distance("bone.wall.sensor_to_outside", recessed, beside, 0.95 * rim)
    interface = interface_of(design)
    name = interface.walled_hollow

    if name:
        # The hollow opens in the proximal face, so its mouth is left out.
        hollow = evaluator.manifold(shapes_of(design)[1][0])
        deep = above_z(hollow, -design.bone.base_length_mm + 2 * wall)
        yield Check.min_distance(f"bone.wall.{name}_to_outside", deep, outside, wall)
        yield Check.min_distance(f"bone.wall.{name}_to_sensor", deep, recess, wall)

    yield from _check_sensor_seat(design, solids)


def _check_channel_walls(
    design: Design, evaluator: MeshEvaluator, outside: Manifold, wall: float
) -> Iterator[Check]:
    """Check the part of the channel that has bone on all sides: from the trough's floor to short of
    its dorsal end.
    """
    dims = design.dimensions
    channel = evaluator.manifold(bone_model.cable_channel(design))
    buried = channel.trim_by_plane((0.0, 1.0, 0.0), dims.pocket_depth - dims.flat_depth + wall)
    mouth = dims.bone_outline.section.dorsal - wall - design.bone.channel_diameter_mm
    buried = buried.trim_by_plane((0.0, -1.0, 0.0), -mouth)
    yield Check.min_distance("bone.wall.channel_to_outside", buried, outside, wall)

    for hole in shapes_of(design)[1][:1]:
        yield Check.min_distance(
            "bone.wall.channel_to_interface", buried, evaluator.manifold(hole), wall
        )


@CHECKS.register("bone", change={"bone.wall.adapter": ("bone.adapter_file", "printer.min_wall_mm")})
def check_adapter(design: Design, solids: Solids) -> Iterator[Check]:
    """Check the walls of an adapter, by rays.

    A few narrow places, such as a sharp edge, are left out.
    """
    if design.bone.interface != "file":
        return

    limit = design.printer.min_wall_mm - 2 * solids.evaluator.tolerance_mm
    walls = measure_walls(solids["bone"], limit)
    thin = walls.thickness_mm[walls.points[:, 2] < -design.bone.base_length_mm]
    matters = len(thin) * SPACING_MM**2 > NEGLIGIBLE_MM2
    yield Check(
        name="bone.wall.adapter",
        value=float(thin.min()) if matters else limit,
        limit=limit,
        unit="mm",
        relation="at least",
        is_beyond=not matters,
    )


def _check_sensor_seat(design: Design, solids: Solids) -> Iterator[Check]:
    """Check clearance and flat seat of the sensor: one that bends over an unsupported area reads a
    false force.
    """
    dims = design.dimensions
    solid = solids["bone"]
    body = solids.evaluator.manifold(sensor_body(design))
    # The depth of the slot is measured along y, so the gap under a film on the ramp is thinner.
    oblique = math.hypot(1.0, RAMP_SLOPE) if design.bone.platform_mm else 1.0
    clearance = min(design.sensor.clearance_mm, design.sensor.adhesive_thickness_mm / oblique)
    clearance -= solids.evaluator.tolerance_mm
    if clearance > 0.0:
        yield Check.min_distance("sensor.pocket_clearance", body, solid, clearance)

    yield Check.zero_volume("overlap.bone.sensor", (body ^ solid).volume())
    distal = above_z(body, dims.tail_end_z + PLANE_OFFSET_MM)
    # Move the sensor into its seat by its own thickness. Where it then meets no bone, the seat does
    # not support it.
    thickness = dims.sensor.thickness_mm
    sunk = distal.translate((0.0, thickness + design.sensor.adhesive_thickness_mm, 0.0))
    unsupported = (sunk.volume() - (sunk ^ solid).volume()) / thickness
    yield Check("sensor.unsupported_area", unsupported, _AREA_TOLERANCE_MM2, "mm2")


@CHECKS.register(
    "bone",
    "skin",
    change={"sensor.air_volumes": ("sensor.distance_from_tip_mm", "bone.base_length_mm")},
)
def check_air_vent(design: Design, solids: Solids) -> Iterator[Check]:
    """Check that the air vent of the sensor, which lies in its tail, is open to the outside.

    The check counts the connected volumes of air in and around bone and skin. A pocket that is cut
    off from the outside is a second one.
    """
    evaluator = solids.evaluator
    solid = solids.parts["bone"].union(solids.parts["skin"])
    air = complement(evaluator, solid) - evaluator.manifold(sensor_body(design))
    # Inner walls have a negative volume, and surfaces that touch leave slivers.
    volumes = [body for body in air.decompose() if body.volume() > VOLUME_TOLERANCE_MM3]
    yield Check(
        name="sensor.air_volumes",
        value=len(volumes),
        limit=1,
        unit="volumes",
        relation="exactly",
    )


@CHECKS.register(
    "bone",
    "skin",
    change={
        "sensor.[rv]*": ("sensor.clearance_mm", "bone.channel_diameter_mm", "bone.base_length_mm")
    },
)
def check_laid_in(design: Design, solids: Solids) -> Iterator[Check]:
    """Check the trough in which the sensor is laid: room for what is sold, and an open vent."""
    body = design.dimensions.sensor
    # of the largest sensor that the trough has to take, with its tabs as more of its tail
    sizes = {
        "active_diameter_mm": body.active_diameter_mm,
        "thickness_mm": body.thickness_mm,
        "head_diameter_mm": body.head_diameter_mm + HEAD_MM,
        "tail_width_mm": body.tail_width_mm + TAIL_MM,
        "length_mm": body.length_mm + LONGER_MM + design.sensor.tab_length_mm,
    }
    own = design.custom_sensor.model_copy(update=sizes)
    sensor = design.sensor.model_copy(update={"model": "custom"})
    with_largest = design.model_copy(update={"sensor": sensor, "custom_sensor": own})
    largest = solids.evaluator.manifold(sensor_body(with_largest))
    yield Check.zero_volume("sensor.room_overlap", float((largest ^ solids["bone"]).volume()))
    yield Check(
        name="sensor.vent_open",
        value=_find_open_share(design, solids),
        limit=_LEAST_OPEN_PERCENT,
        unit="%",
        relation="at least",
    )


def _find_open_share(design: Design, solids: Solids) -> float:
    """Find how much of the mouth of the vent, at the end of the tail, is open to the outside [%].

    The skin lies over the trough, and a bead of adhesive around the collar fills it down to the
    tail.
    """
    dims = design.dimensions
    half = design.dimensions.sensor.tail_width_mm / 2
    far = 2 * design.skin.width_mm
    flat = -dims.flat_depth
    bead = Box((-far, -far, -design.bone.collar_length_mm), (far, flat, 0.0))
    filled = solids.parts["bone"].union(solids.parts["skin"], sensor_body(design), bead)
    air = complement(solids.evaluator, filled)
    # Surfaces come apart here: the largest surrounds all, those of parts enclose negative volumes,
    # the rest is cut off.
    _, *cut_off = sorted(
        (body for body in air.decompose() if body.volume() > 0.0), key=lambda body: -body.volume()
    )
    end = dims.tail_end_z - PLANE_OFFSET_MM
    mouth = solids.evaluator.manifold(
        Box((-half, flat, end - _GAP_MM), (half, flat + dims.pocket_depth, end))
    )
    free = (mouth ^ air).volume() - sum((mouth ^ body).volume() for body in cut_off)

    return 100.0 * float(free / mouth.volume())


@CHECKS.register(
    "bone",
    "stand",
    change={
        "stand.*": ("printer.surface_error_mm", "printer.offset_mm", "bone.cross_bolt_diameter_mm")
    },
)
def check_stand(design: Design, solids: Solids) -> Iterator[Check]:
    """Check that the print's errors leave half the mating play beside the post, and that the bolt
    passes both.
    """
    error = design.printer.surface_error_mm + max(0.0, design.printer.offset_mm)
    gap = MATING_PLAY_MM / 2 + error - solids.evaluator.tolerance_mm
    yield Check.min_distance("stand.post_gap", solids["bone"], solids["stand"], gap)
    far = design.skin.width_mm
    thread = select_thread(design.bone.cross_bolt_diameter_mm)
    centre = (design.dimensions.base_middle_y, Post().cross_bolt_z(design))
    bolt = solids.evaluator.manifold(
        cylinder(
            "x",
            centre=centre,
            low=-far,
            high=far,
            radius=thread.diameter_mm / 2,
        )
    )
    yield Check.zero_volume(
        "stand.bolt_overlap", (bolt ^ (solids["bone"] + solids["stand"])).volume()
    )


@STRENGTH_CHECKS.register(
    "bone",
    change={
        "bone.safety_factor.*": (
            "sensor.model",
            "bone.base_length_mm",
            "skin.length_mm",
            "skin.width_mm",
            "strength.print_material",
        ),
    },
)
def check_strength(design: Design, solids: Solids) -> Iterator[Check]:
    """Check the safety factors.

    The loads that both allow are the remedy of one that is too small.
    """
    stated = design.strength
    strength = solids.strength
    grip = strength.grip_safety_factor
    knock = strength.knock_safety_factor
    lighter = " --set ".join(f"{name}={load:g}" for name, load in strength.lighter_loads.items())

    for load, factor, limit in (
        ("grip", grip, stated.min_grip_factor),
        ("knock", knock, stated.min_knock_factor),
    ):
        yield Check(
            name=f"bone.safety_factor.{load}",
            value=factor,
            limit=limit,
            unit="",
            relation="at least",
            remedy=lighter,
        )
