"""Checks of the skin: thickness, deviation of its mesh from the exact surface, and stretch of a sleeve.

Thickness is measured above the plane z = 0, where the skin is cut square.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_arrays
from fingertip.cad.shapes.insert import filled_bone, skin_interior
from fingertip.cad.solids import SuperconicSolid
from fingertip.cad.verification.check import PLANE_OFFSET_MM, Check, above_z
from fingertip.cad.verification.enclosing_surface import EnclosingSurface
from fingertip.cad.verification.surface_deviation import max_facet_deviation
from fingertip.design import Design
from fingertip.design.geometry.bone_play import Loss, Motion, worst
from fingertip.design.rules.chaplet import MIN_RETAINED, MIN_RETAINED_OVER_SENSOR

if TYPE_CHECKING:
    from manifold3d import Manifold

_STEEP = 0.5
"""Component of a normal from which on it points to the dorsal or palmar side, or to the tip."""
_PERCENT_SLACK = 1e-3
"""Rounding error of a share that the rules have accepted [%]."""
_SECTIONS = 24
"""Sections along the straight part of a sleeve whose perimeters are measured."""


def check_skin(design: Design, evaluator: MeshEvaluator, mesh: Mesh) -> Iterator[Check]:
    """Check the thickness of the skin, with the bone in place and off it, and its mesh against the outer surface."""
    interior, outside = _interior(design, evaluator), _outer_surface(design, evaluator)
    minimum = design.skin.min_thickness_mm - evaluator.tolerance_mm
    yield Check("skin.min_thickness", _thickness(interior, outside), minimum, "mm", "at least")
    yield from _check_play(design, interior, outside, minimum)
    deviation = max_facet_deviation(design.dimensions.outer, mesh.vertices, mesh.triangles)
    yield Check("skin.surface_deviation", deviation, evaluator.tolerance_mm, "mm")


def min_thickness(design: Design, evaluator: MeshEvaluator) -> float:
    """Measure the smallest thickness of the skin [mm]."""
    return _thickness(_interior(design, evaluator), _outer_surface(design, evaluator))


def check_sleeve_stretch(design: Design, evaluator: MeshEvaluator) -> Check:
    """Check the stretch [%] of a sleeve's narrowest section when it is pulled over the widest section of the bone."""
    interior, whole = (evaluator.manifold(s) for s in (skin_interior(design), filled_bone(design)))
    straight_length = design.skin.length_mm - design.skin.tip_length_mm
    heights = [straight_length * (i + 0.5) / _SECTIONS for i in range(_SECTIONS)]
    narrowest = min(_perimeter(interior, z) for z in heights)
    widest = max(_perimeter(whole, z) for z in heights)
    stretch = widest / narrowest - 1.0
    return Check("skin.fitting_stretch", 100 * stretch, design.mold.max_stretch_percent, "%")


def _interior(design: Design, evaluator: MeshEvaluator) -> Manifold:
    """Evaluate what the skin encloses, above the plane where it is cut square."""
    return above_z(evaluator.manifold(skin_interior(design)), PLANE_OFFSET_MM)


def _outer_surface(design: Design, evaluator: MeshEvaluator) -> EnclosingSurface:
    """Outer surface of the skin without its flat end, where the skin is open."""
    vertices, triangles = to_arrays(evaluator.manifold(SuperconicSolid(design.dimensions.outer)))
    in_flat_end = (vertices[triangles][:, :, 2] == vertices[:, 2].min()).all(axis=1)
    return EnclosingSurface(vertices, triangles[~in_flat_end])


def _thickness(interior: Manifold, outside: EnclosingSurface) -> float:
    """Measure the smallest thickness [mm] between a skin's interior and its outer surface; 0 where they meet."""
    corners, _ = to_arrays(interior)
    return max(0.0, outside.distance_to(corners))


def _check_play(design: Design, interior: Manifold, outside: EnclosingSurface, minimum: float) -> Iterator[Check]:
    """Check the silicone that is left where bone or core lies off as far as its supports allow."""
    losses = design.dimensions.losses
    for name, over_sensor, limit in (
        ("over_sensor", True, MIN_RETAINED_OVER_SENSOR), ("elsewhere", False, MIN_RETAINED),
    ):  # fmt: skip
        retained = 100 * worst(losses, over_sensor).retained
        yield Check(f"skin.retained_{name}", retained, 100 * limit - _PERCENT_SLACK, "%", "at least")
    thickness = min(_thickness(_move(interior, loss.motion), outside) for loss in _worst_by_direction(design, losses))
    yield Check("skin.min_thickness_misaligned", thickness, minimum, "mm", "at least")


def _worst_by_direction(design: Design, losses: Iterable[Loss]) -> list[Loss]:
    """Select the largest loss towards each side of the finger, in its proximal and in its distal half."""
    worst_by: dict[tuple[int, int, bool], Loss] = {}
    for loss in losses:
        _, y, z = loss.point.normal
        side = int(y > _STEEP) - int(y < -_STEEP), int(z > _STEEP), loss.point.point_mm[2] > design.skin.length_mm / 2
        if side not in worst_by or loss.loss_mm > worst_by[side].loss_mm:
            worst_by[side] = loss
    return [*worst_by.values()]


def _move(solid: Manifold, motion: Motion) -> Manifold:
    """Move a solid by a shift and a small rotation, of which the order does not matter then."""
    shift, rotation = motion[:3], motion[3:]
    x, y, z = (math.degrees(angle) for angle in rotation)
    return solid.rotate((x, 0.0, 0.0)).rotate((0.0, y, 0.0)).rotate((0.0, 0.0, z)).translate(shift)


def _perimeter(solid: Manifold, z: float) -> float:
    """Compute the perimeter [mm] of a solid's section at height `z` [mm]."""
    total = 0.0
    for outline in solid.slice(z).to_polygons():
        total += sum(math.dist(a, b) for a, b in zip(outline, [*outline[1:], outline[0]], strict=True))
    return total
