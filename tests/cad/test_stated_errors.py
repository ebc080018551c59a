"""Errors that reports state: of meshes against finer ones, and from the report to the page."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fingertip import build
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.catalogues.file_kinds import DESIGN, list_bundled_files
from fingertip.catalogues.stated_errors import (
    find_volume_error_mm3,
    list_mesh_errors,
    list_pad_errors,
)
from fingertip.design import Design
from fingertip.models.parts import PARTS, parts_by_name
from fingertip.page.sources import Report
from tests.conftest import run_fingertip


@pytest.mark.parametrize("tolerance_mm", [0.08, 0.04, 0.02, 0.01])
@pytest.mark.parametrize("name", list_bundled_files(DESIGN))
def test_volumes_are_within_the_stated_error(name: str, tolerance_mm: float) -> None:
    """Against a mesh 8 times as fine, whose own error is an eighth of that; the bone has most."""
    design = Design.load(name)
    coarse, fine = (MeshEvaluator(tolerance_mm / parts) for parts in (1, 8))
    shares = {}
    for part in parts_by_name(design):
        solid = PARTS[part].solid(design)
        mesh = coarse.mesh(solid)
        bound = find_volume_error_mm3(tolerance_mm, mesh.area())
        shares[part] = abs(fine.mesh(solid).volume() - mesh.volume()) / bound

    assert max(shares.values()) <= 7 / 8, shares
    assert shares["bone"] > 0.5


def test_report_states_errors_that_page_and_command_show(tmp_path: Path) -> None:
    """One declaration: the report's entries, read by the page, and those of the command `pad`."""
    made = build(Design(), tmp_path, parts=["bone", "skin"], formats=["stl"], tolerance_mm=0.04)
    report = made.report()
    entries = report["errors"]
    assert list(entries) == ["facets", "volumes", "strength", "share_lying", "turn_on_lying"]
    assert entries["facets"]["high"] == 0.04
    for part in made.parts:
        bound = report["parts"][part.part.name]["volume_error_mm3"]
        assert bound == pytest.approx(entries["volumes"]["high"] * part.mesh.area(), abs=1e-3)

    told = {"print": {}, "checks": [], "errors": json.loads(json.dumps(entries))}
    read = Report.read(json.dumps(told).encode()).errors
    assert read[:2] == list_mesh_errors(0.04)
    assert read[3:] == list_pad_errors(bonded=False)
    done = run_fingertip("pad", "fsr400", "--set", "skin.made=encapsulated", "--json")
    of_pad = json.loads(done.stdout)["errors"]
    assert of_pad == {error.key: error.to_dict() for error in list_pad_errors(bonded=True)}
    assert [*of_pad] == ["share", "turn_on"]
