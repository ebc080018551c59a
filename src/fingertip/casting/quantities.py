"""How much silicone a mold takes, measured on its meshes."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes import mold, skin
from fingertip.cad.shapes.core import mold_insert
from fingertip.cad.solids import intersection, union
from fingertip.design import Design
from fingertip.design.geometry.mold_layout import lay_out


@dataclass(frozen=True)
class SiliconeVolumes:
    """Silicone in the closed mold [cm3]."""

    skin_cm3: float
    """Cavity less what the skin is cast around."""
    runners_cm3: float
    """Gate, funnel and vents, filled up to the mold's face."""
    gap_cm3: float
    """Around the base in its recess: filled only if the fit leaks, but a full cup is cheaper than a void."""

    @property
    def total_cm3(self) -> float:
        """All of it [cm3]."""
        return self.skin_cm3 + self.runners_cm3 + self.gap_cm3


def measure_volumes(design: Design, evaluator: MeshEvaluator) -> SiliconeVolumes:
    """Volumes of a design's mold, on meshes of the evaluator's tolerance.

    Raises
    ------
    GeometryError
        If the mesh kernel refuses a solid.
    """
    block, cavity = evaluator.manifold(mold.block(design)), evaluator.manifold(skin.cavity(design))
    inside = evaluator.manifold(mold_insert(design))
    runners = evaluator.manifold(union(*mold.runners(design, lay_out(design, design.dimensions))))
    hollow = (evaluator.manifold(intersection(mold.openings(design), mold.block(design))) - inside).volume()
    skin_mm3 = (cavity - inside).volume()
    runners_mm3 = ((runners ^ block) - cavity).volume()
    gap_mm3 = max(0.0, hollow - skin_mm3 - runners_mm3)
    return SiliconeVolumes(skin_mm3 / 1000.0, runners_mm3 / 1000.0, gap_mm3 / 1000.0)
