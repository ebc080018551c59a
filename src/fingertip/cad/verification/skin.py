"""Checks of the skin: thickness, deviation of its mesh from the exact surface, and stretch of a sleeve.

Thickness is measured above the plane z = 0, where the skin is cut square.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.shapes.insert import filled_bone, skin_interior
from fingertip.cad.solids import SuperconicSolid
from fingertip.cad.verification.check import (
    PLANE_OFFSET_MM,
    Check,
    above_z,
    check_min_distance,
    complement,
    search_distance,
)
from fingertip.cad.verification.surface_deviation import max_facet_deviation
from fingertip.design import Design
from fingertip.design.geometry.misalignment import held_tilt_slope

if TYPE_CHECKING:
    from manifold3d import Manifold

_TILT_DIRECTIONS_DEG = (-90.0, -60.0, -30.0, 0.0, 45.0, 90.0)
"""Directions in which the bone is shifted and tilted, from palmar (-90) by the side (0) to dorsal (90). The other side
is the mirror image."""
_FIRST_REACH_RATIO = 1.4
"""Reach of the first search for the misaligned thickness, relative to the minimum thickness. It usually suffices."""
_SECTIONS = 24
"""Sections along the straight part of a sleeve whose perimeters are measured."""


def check_skin(design: Design, evaluator: MeshEvaluator, mesh: Mesh) -> Iterator[Check]:
    """Check the thickness of the skin, aligned and misaligned, and its mesh against the exact outer surface."""
    interior = above_z(evaluator.manifold(skin_interior(design)), PLANE_OFFSET_MM)
    exterior = above_z(complement(evaluator, SuperconicSolid(design.dimensions.outer)), PLANE_OFFSET_MM)
    minimum = design.skin.min_thickness_mm - evaluator.tolerance_mm
    yield check_min_distance("skin.min_thickness", interior, exterior, minimum)
    yield _check_misaligned_thickness(design, interior, exterior, minimum)
    deviation = max_facet_deviation(design.dimensions.outer, mesh.vertices, mesh.triangles)
    yield Check("skin.surface_deviation", deviation, evaluator.tolerance_mm, "mm")


def check_sleeve_stretch(design: Design, evaluator: MeshEvaluator) -> Check:
    """Check the stretch [%] of a sleeve's narrowest section when it is pulled over the widest section of the bone."""
    interior, whole = (evaluator.manifold(s) for s in (skin_interior(design), filled_bone(design)))
    straight_length = design.skin.length_mm - design.skin.tip_length_mm
    heights = [straight_length * (i + 0.5) / _SECTIONS for i in range(_SECTIONS)]
    narrowest = min(_perimeter(interior, z) for z in heights)
    widest = max(_perimeter(whole, z) for z in heights)
    stretch = widest / narrowest - 1.0
    return Check("skin.fitting_stretch", 100 * stretch, design.mold.max_stretch_percent, "%")


def _check_misaligned_thickness(design: Design, interior: Manifold, exterior: Manifold, minimum: float) -> Check:
    """Check the thickness when bone or core is misaligned as far as the fit allows while its collar is held down."""
    thickness = search_distance(
        lambda reach_mm: _min_misaligned_thickness(design, interior, exterior, reach_mm), _FIRST_REACH_RATIO * minimum
    )
    return Check("skin.min_thickness_misaligned", thickness, minimum, "mm", "at least")


def _min_misaligned_thickness(design: Design, interior: Manifold, exterior: Manifold, reach_mm: float) -> float:
    """Measure the smallest thickness [mm] over all tilt directions, or return the reach if none is smaller."""
    thickness = reach_mm
    for direction in _TILT_DIRECTIONS_DEG:
        thickness = min(thickness, _misalign(design, interior, direction).min_gap(exterior, thickness))
    return thickness


def _misalign(design: Design, interior: Manifold, direction_deg: float) -> Manifold:
    """Tilt and shift what lies inside the skin towards a direction."""
    x, y = math.cos(math.radians(direction_deg)), math.sin(math.radians(direction_deg))
    tilt_deg = math.degrees(math.atan(held_tilt_slope(design, x, y)))
    tilted = interior.rotate((0.0, 0.0, -direction_deg)).rotate((0.0, tilt_deg, 0.0)).rotate((0.0, 0.0, direction_deg))
    clearance = design.mold.fit_clearance_mm
    return tilted.translate((clearance * x, clearance * y, 0.0))


def _perimeter(solid: Manifold, z: float) -> float:
    """Compute the perimeter [mm] of a solid's section at height `z` [mm]."""
    total = 0.0
    for outline in solid.slice(z).to_polygons():
        total += sum(math.dist(a, b) for a, b in zip(outline, [*outline[1:], outline[0]], strict=True))
    return total
