"""Checks of the stub of a hand: the finger turns on it from straight to bent, and its guides have walls."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import hand_stub
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.verification.assembly import turn_about_pin
from fingertip.cad.verification.check import VOLUME_TOLERANCE_MM3, Check, complement, search_distance
from fingertip.design import Design
from fingertip.design.geometry.solids import cylinder, union

_POSES = 5
"""Angles at which the finger is tried on the stub, from straight to bent."""


def check_hand_stub(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    joint, travel = hand_stub.joint_of(design), design.hand.travel_deg
    stub = evaluator.manifold(PARTS["hand_stub"].solid(design))
    finger = [evaluator.manifold(PARTS[name].solid(design)) for name in ("bone", "skin")]
    angles = [travel * i / (_POSES - 1) for i in range(_POSES)] if travel else [0.0]
    worst = max(sum((turn_about_pin(part, joint, angle) ^ stub).volume() for part in finger) for angle in angles)
    # Bone and stub touch at the stops, where meshes deviate by up to the tolerance.
    touching_mm2 = 4 * joint.radius * design.dimensions.bone_outline.section.half_width
    allowed = VOLUME_TOLERANCE_MM3 + 0.05 * touching_mm2 * evaluator.tolerance_mm
    yield Check("hand_stub.travel_overlap", float(worst), allowed, "mm3")
    halfway, knuckle = turn_about_pin(finger[0], joint, travel / 2), stub.trim_by_plane((0.0, 0.0, 1.0), joint.axis_z)
    gap = search_distance(lambda reach: halfway.min_gap(knuckle, reach), 2 * joint.clearance)
    yield Check("hand_stub.clearance", gap, 0.9 * joint.clearance - evaluator.tolerance_mm, "mm", "at least")
    if way := hand_stub.guide(design):
        wall, outside = design.printer.min_wall_mm, complement(evaluator, hand_stub.without_ways(design))
        low, high = way.mouth_z - hand_stub.GUIDE_MM, way.mouth_z - 2 * wall
        guides = union(*(cylinder("z", (x, way.y), low, high, way.radius) for x in way.x))
        wall -= evaluator.tolerance_mm
        yield Check.min_distance("hand_stub.wall.guide", evaluator.manifold(guides), outside, wall)
