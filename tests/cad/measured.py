"""What the measures find in a design whose geometry may have been broken on purpose."""

from __future__ import annotations

from fingertip.cad.kernel.mesh import Evaluator
from fingertip.cad.shapes import parts
from fingertip.cad.verification import measures
from fingertip.design import Design

TOLERANCE = 0.02
SOCKET = ["bone.interface=socket", "bone.base_length_mm=32"]
SLEEVE = ["mold.method=sleeve"]


def measured(*changes: str) -> dict[str, measures.Check]:
    design, evaluator = Design.load(changes=changes), Evaluator(TOLERANCE)
    meshes = {name: evaluator.mesh(part.describe(design)) for name, part in parts.parts_of(design).items()}
    return {check.name: check for check in measures.of_parts(design, evaluator, meshes)}


def failures(*changes: str) -> set[str]:
    return {name for name, check in measured(*changes).items() if not check.passed}
