"""View of a clevis: the finger on the hand's knuckle, straight and bent to the end of its travel, cut open."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator, to_canonical_mesh
from fingertip.cad.shapes.clevis import knuckle
from fingertip.cad.solids import Solid
from fingertip.design import Design
from fingertip.design.geometry.joint import Joint

HAND = "hand"
"""Name of the hand's part of the joint."""
_GAP_MM = 12.0


def place_on_hand(
    design: Design, joint: Joint, evaluator: MeshEvaluator, parts: Mapping[str, Solid]
) -> list[tuple[str, Mesh]]:
    """Place the given parts on the hand twice, side by side along the finger, without their half at x < 0."""
    placed: list[tuple[str, Mesh]] = []
    shift = 0.0
    for angle_deg in (0.0, design.hand.travel_deg) if design.hand.travel_deg else (0.0,):
        turned = {name: _turn(evaluator, solid, joint, angle_deg) for name, solid in parts.items()}
        hand = evaluator.manifold(knuckle(design, joint)).trim_by_plane((1.0, 0.0, 0.0), 0.0)
        hand = hand.trim_by_plane((0.0, 0.0, 1.0), joint.axis_z - 3 * joint.radius)
        hand = hand.trim_by_plane((0.0, -1.0, 0.0), -design.dimensions.collar.section.dorsal)
        turned[HAND] = to_canonical_mesh(hand)
        high = max(float(mesh.vertices[:, 2].max()) for mesh in turned.values())
        low = min(float(mesh.vertices[:, 2].min()) for mesh in turned.values())
        placed += [(name, _shift(mesh, shift - low)) for name, mesh in turned.items()]
        shift += high - low + _GAP_MM
    return placed


def _turn(evaluator: MeshEvaluator, solid: Solid, joint: Joint, angle_deg: float) -> Mesh:
    """Cut a solid open, and bend it about the pin by an angle towards the palmar side."""
    cut = evaluator.manifold(solid).trim_by_plane((1.0, 0.0, 0.0), 0.0)
    at_origin = cut.translate((0.0, -joint.axis_y, -joint.axis_z))
    return to_canonical_mesh(at_origin.rotate((angle_deg, 0.0, 0.0)).translate((0.0, joint.axis_y, joint.axis_z)))


def _shift(mesh: Mesh, z_mm: float) -> Mesh:
    return Mesh(mesh.vertices + np.array((0.0, 0.0, z_mm)), mesh.triangles)
