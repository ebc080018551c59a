"""Measures of the parts: distances between solids, not assumptions about them.

The thinnest place between two surfaces is the least gap between the solids on both sides of it, which the mesh
kernel finds exactly for its meshes. Each check names the part it measures and the parameter it is held against; as
facets stray from the surface by up to the tolerance, limits are eased by that much.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from fingertip.cad import bone, deviation, mold
from fingertip.cad import skin as skin_part
from fingertip.cad.checks import NO_VOLUME_MM3, Check
from fingertip.cad.core import core, inside_skin
from fingertip.cad.mesh import Evaluator, Mesh
from fingertip.cad.parts import PARTS
from fingertip.cad.solids import Box, Form, Solid, difference, union
from fingertip.design import Design
from fingertip.design.mold_layout import lay_out

if TYPE_CHECKING:
    from manifold3d import Manifold

_NO_AREA_MM2 = 1e-4
_CLEAR_MM = 0.02  # a cut on a plane that both solids share would leave them touching there


def of_parts(design: Design, evaluator: Evaluator, meshes: Mapping[str, Mesh]) -> Iterator[Check]:
    """Measures of those parts that were asked for."""
    yield from _on_the_bed(design, meshes)
    if "skin" in meshes:
        yield from _skin(design, evaluator)
        strays = deviation.of_facets(design.dimensions.outer, meshes["skin"].vertices, meshes["skin"].triangles)
        yield Check("skin.deviation_from_form", strays, evaluator.tolerance_mm, "mm")
    if "bone" in meshes:
        yield from _bone(design, evaluator)
    if "bone" in meshes and "skin" in meshes:
        yield _vent_open(design, evaluator)
    if "mold_palmar" in meshes and "mold_dorsal" in meshes:
        yield from _mold(design, evaluator)
    if "core" in meshes:
        yield _stretch(design, evaluator)


def _on_the_bed(design: Design, meshes: Mapping[str, Mesh]) -> Iterator[Check]:
    """How far a printed part, turned as it fits best, reaches past the printer's volume [mm]."""
    room = sorted((design.printer.bed_x_mm, design.printer.bed_y_mm, design.printer.bed_z_mm))
    for name, mesh in meshes.items():
        if PARTS[name].printed:
            size = sorted((mesh.vertices.max(axis=0) - mesh.vertices.min(axis=0)).tolist())
            excess = max(a - b for a, b in zip(size, room, strict=True))
            yield Check(f"{name}.past_the_printer", excess, 0.0, "mm")


def _skin(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """Thinnest silicone between bone and surface; only above the plane where the skin ends, where it is cut square."""
    inside = _above(evaluator.manifold(inside_skin(design)), _CLEAR_MM)
    outside = _above(_around(evaluator, Form(design.dimensions.outer)), _CLEAR_MM)
    least = design.skin.least_thickness_mm - evaluator.tolerance_mm
    yield _apart("skin.thinnest", inside, outside, least)


def _bone(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """Walls of the bone: around the channel, beside the sensor, around socket and tie hole."""
    dims, wall = design.dimensions, design.printer.least_wall_mm - evaluator.tolerance_mm
    d, y_flat = design.bone.channel_diameter_mm, -dims.flat_depth
    whole = evaluator.manifold(core(design))
    outside = _around(evaluator, core(design))
    channel, recess = (evaluator.manifold(s(design)) for s in (bone.cable_channel, bone.sensor_recess))
    _, minus = bone.interface(design)
    others = [evaluator.manifold(s) for s in (bone.tie_hole(design), *minus)]

    # The channel where it is inside on all sides: behind the relief, and below its mouth in the back.
    buried = channel.trim_by_plane((0.0, 0.0, -1.0), -(dims.relief_proximal_z - 1e-3))
    mouth = dims.envelope.section.dorsal - wall - d
    buried = buried.trim_by_plane((0.0, -1.0, 0.0), -mouth)
    yield _apart("bone.wall.channel_to_outside", buried, outside, wall)
    for name, other in zip(("tie_hole", "interface"), others, strict=False):
        yield _apart(f"bone.wall.channel_to_{name}", buried, other, wall)

    # Beside pocket and slot: in the plane of the flat both are open, so only what lies above it counts.
    let_in = recess.trim_by_plane((0.0, 1.0, 0.0), y_flat + _CLEAR_MM) ^ whole
    beside = outside.trim_by_plane((0.0, 1.0, 0.0), y_flat + _CLEAR_MM)
    rim = min(design.bone.rim_mm, wall)
    yield _apart("bone.wall.beside_sensor", let_in, beside, 0.95 * rim)
    yield _apart("bone.wall.sensor_to_tie_hole", recess, others[0], wall)
    if design.bone.interface == "socket":
        deep = others[1].trim_by_plane((0.0, 0.0, 1.0), -design.bone.base_length_mm + 2 * wall)  # off its mouth
        yield _apart("bone.wall.socket_to_outside", deep, outside, wall)
        yield _apart("bone.wall.socket_to_sensor", deep, recess, wall)


def _vent_open(design: Design, evaluator: Evaluator) -> Check:
    """The sensor's air vent, in its tail: everything hollow in bone and skin is one with the air around them.

    Counted are bodies of air; a pocket cut off from the outside is a second one.
    """
    solid = union(PARTS["bone"].describe(design), PARTS["skin"].describe(design))
    air = _around(evaluator, solid) - evaluator.manifold(bone.sensor_body(design))
    bodies = [surface for surface in air.decompose() if surface.volume() > 0.0]  # the others are their inner walls
    return Check("sensor.vent_open_to_outside", len(bodies), 1, "bodies of air", "exactly")


def _mold(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """Gate, vents and what surrounds the cavity."""
    m = lay_out(design, design.dimensions)
    block, cavity = (evaluator.manifold(s) for s in (mold.block(design), skin_part.cavity(design)))
    runners = evaluator.manifold(union(*mold.runners(design, m)))
    hollow = evaluator.manifold(mold.openings(design)) ^ block
    yield Check("mold.hollows_connected", len(hollow.decompose()), 1, "bodies", "exactly")
    face = hollow.trim_by_plane((0.0, 0.0, 1.0), m.distal_z - 0.01)
    yield Check("mold.gate_and_vents_reach_outside", len(face.decompose()), 1 + len(m.vents_x), "mouths", "exactly")
    for half, opens in (("mold_palmar", -1.0), ("mold_dorsal", 1.0)):
        yield Check(f"{half}.undercut", _undercut(hollow, opens), _NO_AREA_MM2, "mm2")
    if design.mold.method == "overmold":
        in_the_way = (evaluator.manifold(bone.cable_channel(design)) ^ block).volume()
        inside = (evaluator.manifold(bone.cable_channel(design)) ^ evaluator.manifold(core(design)) ^ block).volume()
        yield Check("mold.across_the_cables", in_the_way - inside, NO_VOLUME_MM3, "mm3")
    highest = cavity.bounding_box()[5]
    vented = (cavity ^ runners).bounding_box()[5]
    yield Check("mold.unvented_height", highest - vented, 2 * evaluator.tolerance_mm, "mm")

    wall = design.printer.least_wall_mm - evaluator.tolerance_mm
    outer = _around(evaluator, mold.block(design))
    engraved = (*mold.engraving(design, m, "palmar"), *mold.engraving(design, m, "dorsal"))
    cuts = union(*mold.nut_traps(design, m), *mold.pry_slots(design, m), *engraved)
    yield _apart("mold.wall.cavity_to_outside", cavity, outer, wall)
    yield _apart("mold.wall.cavity_to_cuts", cavity, evaluator.manifold(cuts), wall)
    fasteners = {
        "bolts": (*mold.bolts(design, m), *mold.nut_traps(design, m)),
        "keys": mold.keys(design, m, design.mold.key_clearance_mm),
    }
    for name, solids in fasteners.items():
        # sockets are wider than keys by their clearance
        least = design.mold.land_mm - 2 * design.mold.key_clearance_mm
        yield _apart(f"mold.land.{name}_to_cavity", cavity, evaluator.manifold(union(*solids)), least)


def _undercut(hollow: Manifold, opens: float) -> float:
    """Area [mm2] of the hollow's surface on one side of the parting plane that looks back at it.

    There the mold holds what was cast. `opens` is the side's direction: the half is pulled off that way.
    """
    raw: Any = hollow.trim_by_plane((0.0, opens, 0.0), 0.0).to_mesh64()
    corners = np.asarray(raw.vert_properties)[:, :3][np.asarray(raw.tri_verts, dtype=np.int64)]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0
    area = np.linalg.norm(normal, axis=1)
    backwards = (normal[:, 1] * opens < -1e-4 * area) & (np.abs(corners[:, :, 1]).max(axis=1) > 1e-6)
    return float(area[backwards].sum())


def _stretch(design: Design, evaluator: Evaluator) -> Check:
    """How far a sleeve's narrowest ring must stretch to pass the widest place of the bone [%]."""
    skin, whole = (evaluator.manifold(s) for s in (inside_skin(design), core(design)))
    join = design.skin.length_mm - design.skin.tip_length_mm
    heights = [join * (i + 0.5) / 24 for i in range(24)]
    narrowest = min(_perimeter(skin, z) for z in heights)
    widest = max(_perimeter(whole, z) for z in heights)
    worst = widest / narrowest - 1.0
    return Check("skin.stretch_to_strip", 100 * worst, design.mold.most_stretch_percent, "%")


def _perimeter(solid: Manifold, z: float) -> float:
    """Length of the outline of a solid's section [mm]."""
    total = 0.0
    for outline in solid.slice(z).to_polygons():
        total += sum(math.dist(a, b) for a, b in zip(outline, [*outline[1:], outline[0]], strict=True))
    return total


def _apart(name: str, first: Manifold, second: Manifold, least_mm: float) -> Check:
    """The gap between two solids must be at least `least_mm`.

    Gaps beyond twice that are not searched for (the search costs with its radius): the value then is twice the limit.
    """
    return Check(name, first.min_gap(second, 2.0 * least_mm), least_mm, "mm", "at least")


def _around(evaluator: Evaluator, solid: Solid) -> Manifold:
    """Everything but the solid, in a box that is wider than it by its own size."""
    inner = evaluator.manifold(solid)
    low_x, low_y, low_z, high_x, high_y, high_z = inner.bounding_box()
    past = high_x - low_x
    room = Box((low_x - past, low_y - past, low_z - past), (high_x + past, high_y + past, high_z + past))
    return evaluator.manifold(difference(room, solid))


def _above(solid: Manifold, z: float) -> Manifold:
    return solid.trim_by_plane((0.0, 0.0, 1.0), z)
