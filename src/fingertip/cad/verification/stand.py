"""Checks of the stand: post and cross bolt go into it."""

from __future__ import annotations

from collections.abc import Iterator

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import PARTS
from fingertip.cad.verification.check import Check
from fingertip.catalogues.hardware import select_thread
from fingertip.design import Design
from fingertip.design.geometry.solids import cylinder
from fingertip.design.interfaces.interface import MATING_PLAY_MM, middle_y
from fingertip.design.interfaces.rigid import Post


def check_stand(design: Design, evaluator: MeshEvaluator) -> Iterator[Check]:
    """Check that the print's errors leave half the mating play beside the post, and that the bolt passes both."""
    bone, stand = (evaluator.manifold(PARTS[name].solid(design)) for name in ("bone", "stand"))
    yield Check.zero_volume("overlap.bone.stand", (bone ^ stand).volume())
    error = design.printer.surface_error_mm + max(0.0, design.printer.offset_mm)
    yield Check.min_distance("stand.post_gap", bone, stand, MATING_PLAY_MM / 2 + error - evaluator.tolerance_mm)
    far, thread = design.skin.width_mm, select_thread(design.bone.cross_bolt_diameter_mm)
    centre = (middle_y(design.dimensions), Post().cross_bolt_z(design))
    bolt = evaluator.manifold(cylinder("x", centre, -far, far, thread.diameter_mm / 2))
    yield Check.zero_volume("stand.bolt_overlap", (bolt ^ (bone + stand)).volume())
