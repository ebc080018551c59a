"""What is left of the skin where bone or core lies in the mold as badly as its fit allows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from fingertip.cad.kernel.mesh import Evaluator
from fingertip.cad.shapes.core import inside_skin
from fingertip.cad.solids import Form
from fingertip.cad.verification.checks import Check
from fingertip.cad.verification.gaps import around
from fingertip.design import Design
from fingertip.design.tilt import held_lean

if TYPE_CHECKING:
    from manifold3d import Manifold

_TOWARDS_DEG = (-90.0, -60.0, -30.0, 0.0, 45.0, 90.0)  # from palmar by the side to dorsal: the other side is its mirror
_SEARCHED = 1.4  # times the least thickness: a wider search takes three times as long, and seldom finds anything
_CLEAR_MM = 0.02  # off the plane where the skin ends


def thinnest(design: Design, evaluator: Evaluator) -> Check:
    """Thinnest silicone when the bone is shifted by the fit and leans by what a collar that is held down allows."""
    inside, outside = (
        solid.trim_by_plane((0.0, 0.0, 1.0), _CLEAR_MM)
        for solid in (evaluator.manifold(inside_skin(design)), around(evaluator, Form(design.dimensions.outer)))
    )
    minimum = design.skin.min_thickness_mm - evaluator.tolerance_mm
    for farthest in (_SEARCHED * minimum, 3.0 * minimum):
        left = farthest
        for towards in _TOWARDS_DEG:
            left = min(left, _leaning(design, inside, towards).min_gap(outside, left))
        if left < farthest:
            break
    return Check("skin.thinnest_when_leaning", left, minimum, "mm", "at least")


def _leaning(design: Design, inside: Manifold, towards_deg: float) -> Manifold:
    x, y = math.cos(math.radians(towards_deg)), math.sin(math.radians(towards_deg))
    lean_deg = math.degrees(math.atan(held_lean(design, design.dimensions, x, y)))
    turned = inside.rotate((0.0, 0.0, -towards_deg)).rotate((0.0, lean_deg, 0.0)).rotate((0.0, 0.0, towards_deg))
    fit = design.mold.fit_clearance_mm
    return turned.translate((fit * x, fit * y, 0.0))
