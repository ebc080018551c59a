"""Checks of a cup, the core that is lowered into it, and the skin between them."""

from __future__ import annotations

from collections.abc import Collection, Iterator

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.check import Check
from fingertip.design import Design


def check_cup(design: Design, evaluator: MeshEvaluator, parts: Collection[str]) -> Iterator[Check]:
    yield from ()
