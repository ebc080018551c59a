"""Checks of a design, for Python."""

from __future__ import annotations

from collections.abc import Callable

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.verify import verify
from fingertip.design import Design


def check(
    design: Design, *, tolerance_mm: float = 0.01, progress: Callable[[str], None] = lambda message: None
) -> tuple[Check, ...]:
    """Check all parts of a design as meshes, as the command does. Raises GeometryError."""
    return tuple(verify(design, parts_by_name(design), ("stl",), MeshEvaluator(tolerance_mm), progress).checks)
