"""Measures of the mold: gate, vents, what surrounds the cavity, and whether everything comes out of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from fingertip.cad.kernel.mesh import Evaluator
from fingertip.cad.shapes import bone, mold
from fingertip.cad.shapes import skin as skin_part
from fingertip.cad.shapes.core import cast_around, core
from fingertip.cad.solids import intersection, union
from fingertip.cad.verification.checks import NO_VOLUME_MM3, Check
from fingertip.cad.verification.gaps import apart, around
from fingertip.design import Design
from fingertip.design.mold_layout import lay_out

if TYPE_CHECKING:
    from manifold3d import Manifold

_NO_AREA_MM2 = 1e-4
_OFF_MM = 0.02  # cuts lie off the planes where solids end


def of_mold(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """Gate, vents and what surrounds the cavity."""
    m = lay_out(design, design.dimensions)
    cavity, block = evaluator.manifold(skin_part.cavity(design)), evaluator.manifold(mold.block(design))
    runners = evaluator.manifold(union(*mold.runners(design, m)))
    hollow = evaluator.manifold(intersection(mold.openings(design), mold.block(design)))
    yield Check("mold.hollows_connected", len(hollow.decompose()), 1, "bodies", "exactly")
    face = hollow.trim_by_plane((0.0, 0.0, 1.0), m.distal_z - 0.01)
    yield Check("mold.gate_and_vents_reach_outside", len(face.decompose()), 1 + len(m.vents_x), "mouths", "exactly")
    for half, opens in (("mold_palmar", -1.0), ("mold_dorsal", 1.0)):
        yield Check(f"{half}.undercut", _undercut(hollow, opens), _NO_AREA_MM2, "mm2")
    yield from _fits(design, evaluator)
    yield from _leaves(design, evaluator)
    if design.mold.method == "overmold":
        in_the_way = (evaluator.manifold(bone.cable_channel(design)) ^ block).volume()
        inside = (evaluator.manifold(bone.cable_channel(design)) ^ evaluator.manifold(core(design)) ^ block).volume()
        yield Check("mold.across_the_cables", in_the_way - inside, NO_VOLUME_MM3, "mm3")
    highest = cavity.bounding_box()[5]
    vented = (cavity ^ runners).bounding_box()[5]
    yield Check("mold.unvented_height", highest - vented, 2 * evaluator.tolerance_mm, "mm")

    wall = design.printer.min_wall_mm - evaluator.tolerance_mm
    outer = around(evaluator, mold.block(design))
    yield apart("mold.wall.cavity_to_outside", cavity, outer, wall)
    yield apart("mold.wall.cavity_to_cuts", cavity, evaluator.manifold(mold.cuts(design, m)), wall)
    fasteners = {
        "bolts": (*mold.bolts(design, m), *mold.nut_traps(design, m)),
        "keys": mold.keys(design, m, design.mold.key_clearance_mm),
    }
    for name, solids in fasteners.items():
        # sockets are wider than keys by their clearance
        minimum = design.mold.land_mm - 2 * design.mold.key_clearance_mm
        yield apart(f"mold.land.{name}_to_cavity", cavity, evaluator.manifold(union(*solids)), minimum)


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


def _fits(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """The gap all round what lies in the recess, bone or core: no print is so exact that it could do without.

    Half width and half heights are greater by the gap; where arcs of little weight run flat between them, up to a
    fifth of it is missing.
    """
    minimum = 0.75 * design.mold.fit_clearance_mm - evaluator.tolerance_mm
    if minimum <= 0.0:
        return  # a mesh this coarse cannot tell; an overlap is found elsewhere
    held = _in_recess(design, evaluator)
    for name, half in (("mold_palmar", mold.mold_palmar), ("mold_dorsal", mold.mold_dorsal)):
        yield apart(f"{name}.gap_in_recess", held, evaluator.manifold(half(design)), minimum)


def _in_recess(design: Design, evaluator: Evaluator) -> Manifold:
    """What of bone or core lies below the plane where the skin ends."""
    return evaluator.manifold(cast_around(design)).trim_by_plane((0.0, 0.0, -1.0), _OFF_MM)


def _leaves(design: Design, evaluator: Evaluator) -> Iterator[Check]:
    """What draft is for: when a half is pulled by a little, nothing rigid stays as near to it as it was.

    A wall with a draft of d leaves by sin(d) of the way; one without it rubs all along. The cavity's own form is round
    and has no draft at the parting plane: silicone gives way there.
    """
    pull = 0.8 * design.mold.key_height_mm  # the keys must still be in their sockets
    lean = math.sin(math.radians(design.mold.draft_deg)) * pull
    palmar, dorsal = (evaluator.manifold(half(design)) for half in (mold.mold_palmar, mold.mold_dorsal))
    held = _in_recess(design, evaluator)
    keys = dorsal.trim_by_plane((0.0, -1.0, 0.0), _OFF_MM)
    search = design.mold.fit_clearance_mm + design.mold.key_clearance_mm + 2 * lean
    for name, half, other, way in (
        ("mold_palmar.leaves_the_bone", palmar, held, -pull),
        ("mold_dorsal.leaves_the_bone", dorsal, held, pull),
        ("mold_palmar.leaves_the_keys", palmar, keys, -pull),
    ):
        gained = half.translate((0.0, way, 0.0)).min_gap(other, search) - half.min_gap(other, search)
        yield Check(name, gained, lean - evaluator.tolerance_mm, "mm", "at least")
