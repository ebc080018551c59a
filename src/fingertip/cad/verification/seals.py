"""Check that silicone cannot leave the cavity: a flood fill of the closed assembly, and the leak along the bone's seat.

Gaps up to the clearance of the recess count as closed in the flood fill. How far silicone creeps into them follows from
its pressure and the time until it sets.
"""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import bone
from fingertip.cad.shapes.insert import filled_bone
from fingertip.cad.shapes.mold import base_recess
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.shapes.seals import seals
from fingertip.cad.shapes.skin import cavity
from fingertip.cad.solids import Solid, difference, intersection, union
from fingertip.cad.verification.check import VOLUME_TOLERANCE_MM3, Check
from fingertip.design import Design
from fingertip.design.geometry.draft import add_draft
from fingertip.design.geometry.seat import creep_mm, tape_span_mm
from fingertip.design.silicone import select_silicone
from fingertip.filling.mold_filling import predict_mold_filling
from fingertip.filling.predict import head_pressure_pa

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
