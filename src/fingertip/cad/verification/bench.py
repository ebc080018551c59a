"""Checks of the parts for the bench: post and bolt go into the stand, and a joint turns on the stub of a hand."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import bench
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.verification.assembly import turn_about_pin
from fingertip.cad.verification.check import VOLUME_TOLERANCE_MM3, Check, complement, search_distance
from fingertip.catalogues.hardware import select_thread
from fingertip.design import Design
from fingertip.design.geometry.solids import cylinder, union
from fingertip.design.interfaces.interface import MATING_PLAY_MM, middle_y
from fingertip.design.interfaces.rigid import Post

_POSES = 5
"""Angles at which the finger is tried on the stub, from straight to bent."""


def check_hand_stub(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    joint, travel = bench.joint_of(design), design.hand.travel_deg
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
    if way := bench.guide(design):
        wall, outside = design.printer.min_wall_mm, complement(evaluator, bench.without_ways(design))
        low, high = way.mouth_z - bench.GUIDE_MM, way.mouth_z - 2 * wall
        guides = union(*(cylinder("z", (x, way.y), low, high, way.radius) for x in way.x))
        wall -= evaluator.tolerance_mm
        yield Check.min_distance("hand_stub.wall.guide", evaluator.manifold(guides), outside, wall)


def check_stand(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check that the print's errors leave half the mating play beside the post, and that the bolt passes both."""
    held, stand = (evaluator.manifold(PARTS[name].solid(design)) for name in ("bone", "stand"))
    error = design.printer.surface_error_mm + max(0.0, design.printer.offset_mm)
    yield Check.min_distance("stand.post_gap", held, stand, MATING_PLAY_MM / 2 + error - evaluator.tolerance_mm)
    far, thread = design.skin.width_mm, select_thread(design.bone.cross_bolt_diameter_mm)
    centre = (middle_y(design.dimensions), Post().cross_bolt_z(design))
    bolt = evaluator.manifold(cylinder("x", centre, -far, far, thread.diameter_mm / 2))
    yield Check.zero_volume("stand.bolt_overlap", (bolt ^ (held + stand)).volume())
