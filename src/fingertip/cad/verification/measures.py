"""Measures of the parts: distances between solids, not assumptions about them.

The thinnest place between two surfaces is the least gap between the solids on both sides of it, which the mesh
kernel finds exactly for its meshes. Each check names the part it measures and the parameter it is held against; as
facets stray from the surface by up to the tolerance, limits are eased by that much.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from fingertip.cad.kernel.mesh import Evaluator, Mesh
from fingertip.cad.printing import past_the_printer
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.core import core, inside_skin
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.solids import Form, union
from fingertip.cad.verification import closing, deviation, leaning, mold_measures
from fingertip.cad.verification.checks import NO_VOLUME_MM3, Check
from fingertip.cad.verification.gaps import apart, around
from fingertip.design import Design

if TYPE_CHECKING:
    from manifold3d import Manifold

NO_AREA_MM2 = 0.01
"""Areas below this are nothing: a strip along a sensor as narrow as its rounding to the grid."""
_CLEAR_MM = 0.02  # a cut on a plane that both solids share would leave them touching there


def of_parts(design: Design, evaluator: Evaluator, meshes: Mapping[str, Mesh]) -> Iterator[Check]:
    """Measures of those parts that were asked for."""
    yield from _on_the_bed(design, meshes)
    if "skin" in meshes:
        yield from _skin(design, evaluator)
        yield leaning.thinnest(design, evaluator)
        strays = deviation.of_facets(design.dimensions.outer, meshes["skin"].vertices, meshes["skin"].triangles)
        yield Check("skin.deviation_from_form", strays, evaluator.tolerance_mm, "mm")
    if "bone" in meshes:
        yield from _bone(design, evaluator)
        yield from _seat(design, evaluator)
    if "bone" in meshes and "skin" in meshes:
        yield _vent_open(design, evaluator)
    if "mold_palmar" in meshes and "mold_dorsal" in meshes:
        yield from mold_measures.of_mold(design, evaluator)
        yield from closing.of_closing(design, evaluator)
    if "core" in meshes:
        yield _stretch(design, evaluator)


def _on_the_bed(design: Design, meshes: Mapping[str, Mesh]) -> Iterator[Check]:
    """How far a printed part reaches past the printer's volume [mm], lying as the casting sheet says."""
    for name, mesh in meshes.items():
        if PARTS[name].printed:
            yield Check(f"{name}.past_the_printer", past_the_printer(design, name, mesh), 0.0, "mm")


def _skin(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """Thinnest silicone between bone and surface; only above the plane where the skin ends, where it is cut square."""
    inside = _above(evaluator.manifold(inside_skin(design)), _CLEAR_MM)
    outside = _above(around(evaluator, Form(design.dimensions.outer)), _CLEAR_MM)
    minimum = design.skin.min_thickness_mm - evaluator.tolerance_mm
    yield apart("skin.thinnest", inside, outside, minimum)


def _bone(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """Walls of the bone: around the channel, beside the sensor, around socket and tie hole."""
    dims, wall = design.dimensions, design.printer.min_wall_mm - evaluator.tolerance_mm
    d, y_flat = design.bone.channel_diameter_mm, -dims.flat_depth
    whole = evaluator.manifold(core(design))
    outside = around(evaluator, core(design))
    channel, recess = (evaluator.manifold(s(design)) for s in (bone.cable_channel, bone.sensor_recess))
    _, minus = bone.interface(design)
    others = [evaluator.manifold(s) for s in (bone.tie_hole(design), *minus)]

    # The channel where it is inside on all sides: behind the relief, and below its mouth in the back.
    buried = channel.trim_by_plane((0.0, 0.0, -1.0), -(dims.relief_proximal_z - 1e-3))
    mouth = dims.envelope.section.dorsal - wall - d
    buried = buried.trim_by_plane((0.0, -1.0, 0.0), -mouth)
    yield apart("bone.wall.channel_to_outside", buried, outside, wall)
    for name, other in zip(("tie_hole", "interface"), others, strict=False):
        yield apart(f"bone.wall.channel_to_{name}", buried, other, wall)

    # Beside pocket and slot: in the plane of the flat both are open, so only what lies above it counts.
    let_in = recess.trim_by_plane((0.0, 1.0, 0.0), y_flat + _CLEAR_MM) ^ whole
    beside = outside.trim_by_plane((0.0, 1.0, 0.0), y_flat + _CLEAR_MM)
    rim = min(design.bone.rim_mm, wall)
    yield apart("bone.wall.beside_sensor", let_in, beside, 0.95 * rim)
    yield apart("bone.wall.sensor_to_tie_hole", recess, others[0], wall)
    if design.bone.interface == "socket":
        deep = others[1].trim_by_plane((0.0, 0.0, 1.0), -design.bone.base_length_mm + 2 * wall)  # off its mouth
        yield apart("bone.wall.socket_to_outside", deep, outside, wall)
        yield apart("bone.wall.socket_to_sensor", deep, recess, wall)


def _seat(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """Room around the sensor, and the flat it lies on from its head to the solder joints: it bends nowhere there."""
    dims = design.dimensions
    solid, body = evaluator.manifold(PARTS["bone"].describe(design)), evaluator.manifold(bone.sensor_body(design))
    room = min(design.sensor.clearance_mm, design.sensor.adhesive_thickness_mm) - evaluator.tolerance_mm
    if room > 0.0:
        yield apart("sensor.room_in_pocket", body, solid, room)
    yield Check("overlap.bone.sensor", (body ^ solid).volume(), NO_VOLUME_MM3, "mm3")
    floor = -dims.flat_depth + dims.pocket_depth
    before_joints = _above(body, dims.tail_end_z + dims.relief_half_length + _CLEAR_MM)
    low, high = before_joints.bounding_box()[1], before_joints.bounding_box()[4]
    # The sensor's outline sunk into the seat by as much as it is thick: what of it finds no bone lies hollow.
    sunk = before_joints.translate((0.0, floor - low, 0.0))
    hollow = (sunk.volume() - (sunk ^ solid).volume()) / (high - low)
    yield Check("sensor.unsupported", hollow, NO_AREA_MM2, "mm2")


def _vent_open(design: Design, evaluator: Evaluator) -> Check:
    """The sensor's air vent, in its tail: everything hollow in bone and skin is one with the air around them.

    Counted are bodies of air; a pocket cut off from the outside is a second one.
    """
    solid = union(PARTS["bone"].describe(design), PARTS["skin"].describe(design))
    air = around(evaluator, solid) - evaluator.manifold(bone.sensor_body(design))
    bodies = [surface for surface in air.decompose() if surface.volume() > 0.0]  # the others are their inner walls
    return Check("sensor.vent_open_to_outside", len(bodies), 1, "bodies of air", "exactly")


def _stretch(design: Design, evaluator: Evaluator) -> Check:
    """How far a sleeve's narrowest ring must stretch to pass the widest place of the bone [%]."""
    skin, whole = (evaluator.manifold(s) for s in (inside_skin(design), core(design)))
    join = design.skin.length_mm - design.skin.tip_length_mm
    heights = [join * (i + 0.5) / 24 for i in range(24)]
    narrowest = min(_perimeter(skin, z) for z in heights)
    widest = max(_perimeter(whole, z) for z in heights)
    worst = widest / narrowest - 1.0
    return Check("skin.stretch_to_strip", 100 * worst, design.mold.max_stretch_percent, "%")


def _perimeter(solid: Manifold, z: float) -> float:
    """Length of the outline of a solid's section [mm]."""
    total = 0.0
    for outline in solid.slice(z).to_polygons():
        total += sum(math.dist(a, b) for a, b in zip(outline, [*outline[1:], outline[0]], strict=True))
    return total


def _above(solid: Manifold, z: float) -> Manifold:
    return solid.trim_by_plane((0.0, 0.0, 1.0), z)
