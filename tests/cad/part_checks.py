"""Runs the part checks on a design whose geometry a test may have broken on purpose."""

from __future__ import annotations

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification import verify
from fingertip.cad.verification.check import Check, Solids
from fingertip.design import Design
from fingertip.models.parts import parts_by_name
from tests.conftest import design_file

TOLERANCE = 0.02
SOCKET = ["bone.interface=socket", "bone.base_length_mm=32"]


def run_checks(*changes: str, name: str = "fsr400") -> dict[str, Check]:
    """Return the checks of a design with these changes, by name."""
    design = Design.load(design_file(name), changes=changes)
    solids = Solids.of(design, MeshEvaluator(TOLERANCE), parts_by_name(design))
    return {check.name: check for check in verify.run_checks(design, solids)}


def failed_checks(*changes: str, name: str = "fsr400") -> set[str]:
    """Return the names of the checks that fail."""
    return {name for name, check in run_checks(*changes, name=name).items() if not check.passed}


def run_all_checks(design: Design) -> dict[str, Check]:
    """Return the checks of a design by name, with those of its
    files for the printer and of its strength.
    """
    found = verify.verify(
        design, list(parts_by_name(design)), ("stl",), MeshEvaluator(TOLERANCE)
    ).checks
    return {check.name: check for check in found}
