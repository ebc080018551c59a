"""Silicone to pour and to mix, compared with volumes of meshes."""

from __future__ import annotations

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import PARTS
from fingertip.casting.sheet import measure_poured_cm3, mix
from fingertip.catalogues.materials import load_silicones
from fingertip.design import Design


def test_a_third_more_is_poured_than_the_skin_takes() -> None:
    """The cavity is larger than the skin by the shrinkage, 0.3 % in each direction."""
    design, evaluator = Design.load("first_finger"), MeshEvaluator(0.02)
    skin_cm3 = evaluator.manifold(PARTS["skin"].solid(design)).volume() / 1000.0
    assert measure_poured_cm3(design, evaluator) == pytest.approx(1.35 * skin_cm3, rel=0.03)


def test_mixture_is_rounded_to_what_a_scale_reads() -> None:
    mixture = mix(load_silicones()["smooth_sil_940"], 40.0)
    assert (mixture.in_cup_g, mixture.a_g, mixture.b_g, mixture.total_g) == (47.2, 53.6, 5.4, 59.0)
