"""A failed check names the parameters to change, and those exist."""

from __future__ import annotations

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification import check as causes
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.verify import verify
from fingertip.design import Design
from fingertip.design.parameters import PARAMETERS
from tests.conftest import design_file

VARIANTS = [
    ("fsr400", ["mold.filling=gravity"]),
    ("fsr400", ["mold.method=sleeve"]),
    ("fsr402", []),
    ("adult_finger", []),
    ("fsr400", ["bone.interface=socket", "bone.base_length_mm=32"]),
    ("youth_thumb", ["hand.knuckle=fork", "bone.base_length_mm=14.3"]),
]


def test_all_named_parameters_exist() -> None:
    named = {parameter for _, parameters in causes._CAUSES for parameter in parameters}
    assert named <= set(PARAMETERS)


@pytest.mark.full
@pytest.mark.parametrize(("name", "changes"), VARIANTS, ids=str)
def test_every_check_has_causes(name: str, changes: list[str]) -> None:
    design = Design.load(design_file(name), changes=changes)
    for check in verify(design, list(parts_by_name(design)), ("stl", "3mf"), MeshEvaluator(0.05)).checks:
        causes.list_causes(check.name)


def test_report_names_what_to_change() -> None:
    failed = Check("mold.fill_time", 200.0, 150.0, "s")
    assert failed.to_dict()["change"][0] == "mold.nozzle_bore_mm"
    assert "change" not in Check("mold.fill_time", 20.0, 150.0, "s").to_dict()
    assert causes.list_causes("bone.stl.open_edges") == ()
    with pytest.raises(LookupError):
        causes.list_causes("unknown")
