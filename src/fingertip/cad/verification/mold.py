"""Checks of the mold: openings, walls, recess and draft, bolts and keys, and its filling with silicone and seals.

Gaps up to the clearance of the recess count as closed in the flood fill of the seals. How far silicone creeps into them
follows from its pressure and the time until it sets.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np

from fingertip.cad.kernel.mesh import Manifold, MeshEvaluator, to_arrays
from fingertip.cad.shapes import bone, mold
from fingertip.cad.shapes.insert import cavity, filled_bone, mold_insert, screw_hole
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification.check import PLANE_OFFSET_MM, Check, measure_gap
from fingertip.catalogues.hardware import select_thread
from fingertip.catalogues.print_materials import PRINT_MATERIALS
from fingertip.design import Design
from fingertip.design.geometry.conic import add_draft
from fingertip.design.geometry.seat import creep_mm, tape_span_mm
from fingertip.design.geometry.solids import Solid, difference, intersection, union
from fingertip.filling.mold_filling import MAX_AIR_MM3, injected_cm3, place_vents, predict_mold_filling, trapped_mm3
from fingertip.filling.predict import FillingPrediction, head_pressure_pa

_AREA_TOLERANCE_MM2 = 1e-4
_FACE_DEPTH_MM = 0.01
"""Depth below the distal face at which the openings of gate and vents are counted [mm]."""
_FIT_RATIO = 0.75
"""Smallest clearance in the recess relative to the nominal fit clearance. The nominal clearance is added to the half
width and the half heights of a section. Between them up to a fifth of it is lost, where arcs of small weight are
flat."""
_PULL_RATIO = 0.8
"""Distance by which a half is pulled to measure its draft, relative to the height of the keys, which must still be in
their sockets."""
_KEY_COUNT = 2
_MIN_BLOCKING_VOLUME_MM3 = 1.0
"""Smallest overlap that keeps the halves from being assembled the wrong way round [mm3]. A smaller volume would yield
when they are pressed together."""


def check_mold(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    yield from _check_openings(design, evaluator)
    yield from _check_recess(design, evaluator)
    if not design.dimensions.window_opens_into_gap:
        yield _check_cable_channel(design, evaluator)
    yield from _check_walls(design, evaluator)
    yield from _check_keys(design, evaluator)


def _check_openings(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check that the hollow is one connected volume, opens to the outside at inlet and vents, and has no undercut."""
    m = design.mold_layout
    hollow = evaluator.manifold(intersection(mold.hollow(design), mold.block(design)))
    yield Check("mold.hollow_bodies", len(hollow.decompose()), 1, "bodies", "exactly")
    distal = hollow.trim_by_plane((0.0, 0.0, 1.0), m.distal_z - _FACE_DEPTH_MM).decompose()
    dorsal = hollow.trim_by_plane((0.0, 1.0, 0.0), m.dorsal_height - _FACE_DEPTH_MM).decompose()
    vents = place_vents(design)
    others = 1 + sum(vent.kind != "side" for vent in vents)
    yield Check("mold.inlet_and_vent_openings", len(distal) + len(dorsal), others, "openings", "exactly")
    # Two grooves may meet on their way, so each is followed by itself.
    open_grooves = sum(_is_open(design, groove, evaluator) for groove in mold.side_vents(design))
    at_side = sum(vent.kind == "side" for vent in vents)
    yield Check("mold.side_vent_openings", open_grooves, at_side, "openings", "exactly")
    cast = evaluator.manifold(intersection(mold.cast_hollow(design), mold.block(design)))
    for half, direction in (("mold_palmar", -1.0), ("mold_dorsal", 1.0)):
        yield Check(f"{half}.undercut", _undercut_area_mm2(cast, direction), _AREA_TOLERANCE_MM2, "mm2")


def _is_open(design: Design, groove: Solid, evaluator: MeshEvaluator) -> bool:
    """Return whether a groove connects the cavity with the side of the mold."""
    solid, m = evaluator.manifold(groove), design.mold_layout
    low, high = solid.bounding_box()[0], solid.bounding_box()[3]
    return bool(max(-low, high) > m.half_width and (solid ^ evaluator.manifold(cavity(design))).volume() > 0.0)


def _undercut_area_mm2(hollow: Manifold, direction: float) -> float:
    """Compute the area [mm2] that faces back to the parting plane, so that the half holds the casting."""
    vertices, triangles = to_arrays(hollow.trim_by_plane((0.0, direction, 0.0), 0.0))
    corners = vertices[triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0
    area = np.linalg.norm(normal, axis=1)
    # Triangles in the parting plane itself come from the cut and are left out.
    faces_back = (normal[:, 1] * direction < -1e-4 * area) & (np.abs(corners[:, :, 1]).max(axis=1) > 1e-6)
    return float(area[faces_back].sum())


def _check_recess(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check the clearance in the recess, and that every distance to rigid surfaces grows as a half is pulled off.

    A wall with the draft angle d gains sin(d) times the distance pulled; a wall without draft gains nothing and rubs
    all along. The cavity is exempt: its round outline has no draft at the parting plane, but silicone yields there.
    """
    fit, tolerance = design.mold.fit_clearance_mm, evaluator.tolerance_mm
    palmar, dorsal = (evaluator.manifold(half(design)) for half in (mold.mold_palmar, mold.mold_dorsal))
    # The part of the bone that lies in the recess, below the plane where the skin ends.
    base = evaluator.manifold(mold_insert(design)).trim_by_plane((0.0, 0.0, -1.0), PLANE_OFFSET_MM)
    at_palmar, at_dorsal = (measure_gap(base, half, fit) for half in (palmar, dorsal))
    minimum = _FIT_RATIO * fit - tolerance
    if minimum > 0.0:  # else the mesh is too coarse to measure the clearance; the overlap checks still apply
        yield Check("mold_palmar.recess_clearance", at_palmar, minimum, "mm", "at least")
        yield Check("mold_dorsal.recess_clearance", at_dorsal, minimum, "mm", "at least")
    pull = _PULL_RATIO * design.mold.key_height_mm
    gain = math.sin(math.radians(design.mold.draft_deg)) * pull
    keys = dorsal.trim_by_plane((0.0, -1.0, 0.0), PLANE_OFFSET_MM)
    search = fit + design.mold.key_clearance_mm + 2 * gain
    for name, half, other, closed, distance in (
        ("mold_palmar.draft_clearance_gain.bone", palmar, base, at_palmar, -pull),
        ("mold_dorsal.draft_clearance_gain.bone", dorsal, base, at_dorsal, pull),
        ("mold_palmar.draft_clearance_gain.keys", palmar, keys, palmar.min_gap(keys, search), -pull),
    ):
        gained = half.translate((0.0, distance, 0.0)).min_gap(other, search) - min(closed, search)
        yield Check(name, gained, gain - tolerance, "mm", "at least")


def _check_cable_channel(design: Design, evaluator: MeshEvaluator) -> Check:
    """Check that the cables, which are in place during overmolding, leave the bone outside the mold."""
    channel = evaluator.manifold(bone.cable_channel(design))
    if design.dimensions.fold:  # a groove, which the mold covers up to its proximal face
        outside = design.mold_layout.proximal_z - channel.bounding_box()[2]
        needed = design.dimensions.cable_groove_depth - evaluator.tolerance_mm
        return Check("mold.cable_groove_outside", outside, needed, "mm", "at least")
    block = evaluator.manifold(mold.block(design))
    in_mold = (channel ^ block).volume()
    in_bone = (channel ^ evaluator.manifold(filled_bone(design)) ^ block).volume()
    return Check.zero_volume("mold.cable_channel_overlap", in_mold - in_bone)


def _check_walls(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check the walls between cavity, inlet, vents, bolts, keys and the outside, and the land that seals the cavity."""
    wall, whole = design.printer.min_wall_mm - evaluator.tolerance_mm, mold.block(design)
    block, cavity_body = evaluator.manifold(whole), evaluator.manifold(cavity(design))
    bolts = evaluator.manifold(union(*mold.bolt_holes(design), *mold.nut_traps(design)))
    sockets = evaluator.manifold(union(*mold.key_sockets(design)))
    # The sockets are wider than the keys by their clearance.
    land = design.mold.land_mm - 2 * design.mold.key_clearance_mm
    yield Check("mold.wall.cavity_to_outside", _distance_to_faces(cavity_body, block), wall, "mm", "at least")
    cutouts = evaluator.manifold(mold.outer_cutouts(design))
    yield Check.min_distance("mold.wall.cavity_to_cutouts", cavity_body, cutouts, wall)
    yield Check.min_distance("mold.land.bolts_to_cavity", cavity_body, bolts, land)
    yield Check.min_distance("mold.land.keys_to_cavity", cavity_body, sockets, land)

    cut = evaluator.manifold(intersection(mold.openings(design), whole))
    yield Check.min_distance("mold.wall.runners_to_keys", cut, sockets, wall)
    inlet = design.mold_layout.inlet
    led = evaluator.manifold(union(mold.sprue(design, inlet), mold.runner(inlet)))
    holes = evaluator.manifold(union(*mold.bolt_holes(design)))
    yield Check.min_distance("mold.land.bolts_to_runner", led, holes, land)
    # A groove in the parting plane ends in a pry slot where the mold's side has no room for both.
    grooves = mold.side_vents(design)
    cutouts = evaluator.manifold(mold.outer_cutouts_and_screw(design))
    clear = evaluator.manifold(intersection(difference(mold.openings(design), *grooves), whole))
    yield Check.min_distance("mold.wall.runners_to_cutouts", clear, cutouts, wall)
    if grooves:
        holes = evaluator.manifold(union(*mold.bolt_holes(design), *screw_hole(design)))
        beside = evaluator.manifold(intersection(union(*grooves), whole))
        yield Check.min_distance("mold.wall.side_vents_to_bolts", beside, holes, wall)
    # Along its own axis a hole opens to the outside.
    within = ((evaluator.manifold(intersection(solid, whole)), axis) for solid, axis in mold.runners_with_axes(design))
    nearest = min(_distance_to_faces(solid, block, {0, 1, 2} - {axis}) for solid, axis in within)
    yield Check("mold.wall.runners_to_outside", nearest, wall, "mm", "at least")

    yield Check("mold.wall.bolts_to_outside", _distance_to_faces(bolts, block, (0, 2)), wall, "mm", "at least")
    yield Check("mold.wall.keys_to_outside", _distance_to_faces(sockets, block), wall, "mm", "at least")
    yield Check.min_distance("mold.wall.keys_to_bolts", sockets, bolts, wall)


def _check_keys(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check the number of keys, and that the mold closes in one way only."""
    palmar, dorsal = (evaluator.manifold(half(design)) for half in (mold.mold_palmar, mold.mold_dorsal))
    protruding = dorsal.trim_by_plane((0.0, -1.0, 0.0), PLANE_OFFSET_MM)
    yield Check("mold_dorsal.key_count", len(protruding.decompose()), _KEY_COUNT, "keys", "exactly")
    # Turn the keys by half a turn about the middle of the block. They must then collide with the palmar half.
    low_x, _, low_z, high_x, _, high_z = evaluator.manifold(mold.block(design)).bounding_box()
    reversed_keys = protruding.rotate((0.0, 180.0, 0.0)).translate((low_x + high_x, 0.0, low_z + high_z))
    blocking = (reversed_keys ^ palmar).volume()
    yield Check("mold.reversed_assembly_overlap", blocking, _MIN_BLOCKING_VOLUME_MM3, "mm3", "at least")


def _distance_to_faces(inner: Manifold, block: Manifold, axes: Iterable[int] = range(3)) -> float:
    """Compute the smallest distance [mm] of a solid from the block's faces across some axes; 0 beyond them."""
    i, b = inner.bounding_box(), block.bounding_box()
    return float(max(0.0, min(min(i[axis] - b[axis], b[axis + 3] - i[axis + 3]) for axis in axes)))


PUSH_S = 60.0
"""Time for which a thumb can push [s]. An assumption."""
_LEAST_LOAD = 1.2
"""Least silicone in the syringe over what the mold takes. An assumption."""
_PRELOAD_N_PER_MM = 100.0
"""Preload of a bolt tightened by hand in a printed mold, per millimetre of its diameter [N/mm]. An assumption."""
_MIN_BEARING_FACTOR = 2.0
"""Least strength of the bone over the pressure of the chaplet's screw on its thread."""


def check_filling(design: Design) -> Iterator[Check]:
    prediction, silicone = predict_mold_filling(design), design.silicone.material
    syringe = design.mold_layout.inlet.syringe
    yield Check("mold.fill_time", prediction.fill_s, silicone.filling_limit_s, "s")
    force = prediction.force_for_time_n(PUSH_S, syringe.bore_mm)
    yield Check("mold.syringe_force", force, design.mold.thumb_force_n, "N")
    yield Check("mold.syringe_volume", _LEAST_LOAD * injected_cm3(prediction), syringe.load_cm3, "cm3")
    yield Check("mold.air_trapped", trapped_mm3(prediction), MAX_AIR_MM3, "mm3")
    if design.dimensions.chaplet:
        yield Check("mold.bone_load", _bearing_factor(design, prediction), _MIN_BEARING_FACTOR, "", "at least")
    bolts = len(design.mold_layout.bolts) * _PRELOAD_N_PER_MM * select_thread(design.mold.bolt_diameter_mm).diameter_mm
    yield Check("mold.opening_force", prediction.static_opening_force_n, bolts, "N")


def _bearing_factor(design: Design, prediction: FillingPrediction) -> float:
    """Strength of the bone over the pressure on the chaplet's thread, which holds the bone in the filled mold.

    The largest load acts if the vents are closed and the thumb goes on pushing: then the inlet's pressure pushes the
    bone out of the cavity.
    """
    chaplet = design.dimensions.chaplet
    assert chaplet
    load = math.hypot(prediction.static_axial_force_n, prediction.side_force_n)
    pressure = load / (chaplet.thread.diameter_mm * chaplet.engaged)
    return PRINT_MATERIALS[design.strength.print_material].across_mpa / pressure


_MAX_LEAK_SHARE = 0.5
"""Share of the seat's length that silicone may creep along."""
_IN_THE_MOLD = ("bone", "lid")
_FLOOD_TOLERANCE_MM = 0.05
"""Tolerance of the meshes that are flooded, unless those of the files are coarser [mm]. A flood fill asks which
surfaces meet, and takes gaps as wide as the clearance of the recess for closed, so it needs no finer ones."""
_DEEPER_MM = 0.1
"""Distance below the surface of the bone from which on a hollow counts as reached [mm]."""


def check_seals(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    yield Check.zero_volume("mold.open_paths", flooded_mm3(design, evaluator))
    yield Check("mold.leak_length", leak_mm(design), _MAX_LEAK_SHARE * design.mold.recess_length_mm, "mm")


def flooded_mm3(design: Design, evaluator: MeshEvaluator) -> float:
    """Compute the volume that silicone in the cavity can reach outside it and in hollows of the bone [mm3]."""
    if evaluator.tolerance_mm < _FLOOD_TOLERANCE_MM:
        evaluator = MeshEvaluator(_FLOOD_TOLERANCE_MM)
    present, recess = parts_by_name(design), mold.base_recess(design, 0.0)
    inside = [present[name].solid(design) for name in _IN_THE_MOLD if name in present]
    solid = union(*inside, bone.sensor_body(design), *bone.seals(design))
    room = evaluator.manifold(difference(union(cavity(design), *recess), solid))
    flooded = max(room.decompose(), key=lambda body: float(body.volume()))  # the skin, or what it leaks into
    # Above the recess all of the room lies in the cavity. Below, the two share few of the surfaces that take time.
    top = max(evaluator.manifold(part).bounding_box()[5] for part in recess)
    low = flooded.trim_by_plane((0.0, 0.0, -1.0), -top)
    outside = low.volume() - (low ^ evaluator.manifold(cavity(design))).volume()
    hollows = [bone.sensor_recess(design)]
    if not design.dimensions.window_opens_into_gap:
        hollows.append(bone.cable_channel(design))
    deep = intersection(union(*hollows), filled_bone(design, _DEEPER_MM))
    # Where faces coincide, a body that lies in one of the two only may remain: the second intersection removes it.
    return float(outside + (flooded ^ evaluator.manifold(deep) ^ flooded).volume())


def leak_mm(design: Design) -> float:
    """Compute how far silicone creeps along the seat until it sets [mm].

    During the filling the gate's pressure drives it, of which the integral over the viscosity is that of the cavity's
    resistance; later the head of the silicone does.
    """
    silicone, prediction, dims = design.silicone.material, predict_mold_filling(design), design.dimensions
    section = dims.collar.section
    widening = add_draft(section, dims.draft_slope).half_width - section.half_width if dims.draft_slope else 0.0
    gap_mm = design.printed_fit_mm + widening
    head = head_pressure_pa(silicone.density_g_cm3.high, design.skin.length_mm)
    setting = head * silicone.planned_pot_life_min * 60.0 / silicone.viscosity_pa_s.low
    return creep_mm(prediction.cavity_integral + setting, gap_mm, design.mold.seat_tape_mm, tape_span_mm(design))
