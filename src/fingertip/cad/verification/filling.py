"""Checks of the filling: time, force on the syringe, trapped air, and loads on bone and mold."""

from __future__ import annotations

import math
from collections.abc import Iterator

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.kernel.solids import Solid, difference, intersection, union
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.insert import cavity, filled_bone
from fingertip.cad.shapes.mold import base_recess
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.shapes.seals import seals
from fingertip.cad.verification.check import VOLUME_TOLERANCE_MM3, Check
from fingertip.catalogues.print_materials import PRINT_MATERIALS
from fingertip.catalogues.silicones import Silicone
from fingertip.catalogues.threads import select_thread
from fingertip.design import Design
from fingertip.design.geometry.insert_body import add_draft
from fingertip.design.geometry.seat import creep_mm, tape_span_mm
from fingertip.design.silicone import select_silicone
from fingertip.filling.mold_filling import MAX_AIR_MM3, injected_cm3, largest_pocket, predict_mold_filling
from fingertip.filling.predict import FillingPrediction, head_pressure_pa

PUSH_S = 60.0
"""Time for which a thumb can push [s]. An assumption."""
_PRELOAD_N_PER_MM = 100.0
"""Preload of a bolt tightened by hand in a printed mold, per millimetre of its diameter [N/mm]. An assumption."""
_MIN_BEARING_FACTOR = 2.0
"""Least strength of the bone over the pressure of the chaplet's screw on its thread."""
_GRAVITY_M_S2 = 9.81


def check_filling(design: Design) -> Iterator[Check]:
    """Check the filling of a mold with the silicone of its design."""
    prediction, silicone = predict_mold_filling(design), select_silicone(design)
    allowed_s = silicone.filling_limit_s
    syringe = design.mold_layout.inlet.syringe if design.mold_layout.inlet else None
    yield Check("mold.fill_time", prediction.fill_s, allowed_s, "s")
    if syringe:
        force = prediction.force_for_time_n(PUSH_S, syringe.bore_mm)
        yield Check("mold.syringe_force", force, design.mold.thumb_force_n, "N")
        yield Check("mold.syringe_volume", injected_cm3(prediction), syringe.volume_ml, "cm3")
        pocket = largest_pocket(prediction)
        yield Check("mold.air_trapped", pocket.volume_mm3 if pocket else 0.0, MAX_AIR_MM3, "mm3")
    else:
        yield Check("mold.air_rise_time", air_rise_s(design, silicone), allowed_s - prediction.fill_s, "s")
    if design.dimensions.chaplet:
        yield Check("mold.bone_load", _bearing_factor(design, prediction), _MIN_BEARING_FACTOR, "", "at least")
    bolts = len(design.mold_layout.bolts) * _PRELOAD_N_PER_MM * select_thread(design.mold.bolt_diameter_mm).diameter_mm
    yield Check("mold.opening_force", prediction.static_opening_force_n, bolts, "N")


def air_rise_s(design: Design, silicone: Silicone) -> float:
    """Time in which air rises from the collar to the tip through silicone that is poured on it [s].

    Air that is wider than the gap rises in it at rho g h^2 / (12 mu), as silicone flows down through the same gap
    (G. I. Taylor and P. G. Saffman, Q. J. Mech. Appl. Math. 12 (1959) 265).
    """
    skin = design.skin
    gap_m = 1e-3 * min(skin.thickness_side_mm, skin.thickness_dorsal_mm)
    density = 1e3 * silicone.density_g_cm3.low
    speed = density * _GRAVITY_M_S2 * gap_m**2 / (12.0 * silicone.viscosity_pa_s.high)
    return 1e-3 * skin.length_mm / speed


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


# Check that silicone cannot leave the cavity: a flood fill of the closed assembly, and the leak along the bone's seat.
#
# Gaps up to the clearance of the recess count as closed in the flood fill. How far silicone creeps into them follows
# from its pressure and the time until it sets.


_MAX_LEAK_SHARE = 0.5
"""Share of the seat's length that silicone may creep along."""
_IN_THE_MOLD = ("bone", "lid")
_FLOOD_TOLERANCE_MM = 0.05
"""Tolerance of the meshes that are flooded, unless those of the files are coarser [mm]. A flood fill asks which
surfaces meet, and takes gaps as wide as the clearance of the recess for closed, so it needs no finer ones."""
_DEEPER_MM = 0.1
"""Distance below the surface of the bone from which on a hollow counts as reached [mm]."""


def check_seals(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check the seals of an overmolding, and the seat of bone or core."""
    if design.mold.method == "overmold":
        yield Check("mold.open_paths", flooded_mm3(design, evaluator), VOLUME_TOLERANCE_MM3, "mm3")
    yield Check("mold.leak_length", leak_mm(design), _MAX_LEAK_SHARE * design.mold.recess_length_mm, "mm")


def flooded_mm3(design: Design, evaluator: MeshEvaluator) -> float:
    """Compute the volume that silicone in the cavity can reach outside it and in hollows of the bone [mm3]."""
    if evaluator.tolerance_mm < _FLOOD_TOLERANCE_MM:
        evaluator = MeshEvaluator(_FLOOD_TOLERANCE_MM)
    present, recess = parts_by_name(design), base_recess(design, 0.0)
    inside = [present[name].solid(design) for name in _IN_THE_MOLD if name in present]
    solid = union(*inside, bone.sensor_body(design), *seals(design))
    room = evaluator.manifold(difference(union(cavity(design), *recess), solid))
    flooded = max(room.decompose(), key=lambda body: float(body.volume()))  # the skin, or what it leaks into
    # Above the recess all of the room lies in the cavity. Below, the two share few of the surfaces that take time.
    top = max(evaluator.manifold(part).bounding_box()[5] for part in recess)
    low = flooded.trim_by_plane((0.0, 0.0, -1.0), -top)
    outside = low.volume() - (low ^ evaluator.manifold(cavity(design))).volume()
    hollows = evaluator.manifold(_hollows(design))
    return float(outside + (flooded ^ hollows).volume())


def _hollows(design: Design) -> Solid:
    """Build the hollows of the bone, a little below its surface."""
    hollows = [bone.sensor_recess(design)]
    if not design.dimensions.window_opens_into_gap:
        hollows.append(bone.cable_channel(design))
    return intersection(union(*hollows), filled_bone(design, _DEEPER_MM))


def leak_mm(design: Design) -> float:
    """Compute how far silicone creeps along the seat until it sets [mm].

    During the filling the gate's pressure drives it, of which the integral over the viscosity is that of the cavity's
    resistance; later the head of the silicone does.
    """
    silicone, prediction, dims = select_silicone(design), predict_mold_filling(design), design.dimensions
    section = dims.collar.section
    widening = add_draft(section, dims.draft_slope).half_width - section.half_width if dims.draft_slope else 0.0
    gap_mm = design.printed_fit_mm + widening
    head = head_pressure_pa(silicone.density_g_cm3.high, design.skin.length_mm)
    setting = head * silicone.planned_pot_life_min * 60.0 / silicone.viscosity_pa_s.low
    return creep_mm(prediction.cavity_integral + setting, gap_mm, design.mold.seat_tape_mm, tape_span_mm(design))
