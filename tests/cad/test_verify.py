"""What is checked is the file, not the mesh it was written from."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Evaluator, Mesh
from fingertip.cad.verification.verify import FINEST_MM, refuse_tolerance, verify
from fingertip.design import Design
from fingertip.errors import DesignError

TOLERANCE = 0.05


def failed(design: Design) -> set[str]:
    return {check.name for check in verify(design, ["skin"], ["stl"], Evaluator(TOLERANCE)).checks if not check.passed}


def test_a_writer_that_loses_a_triangle_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    write = stl.to_bytes
    assert failed(Design()) == set()
    monkeypatch.setattr(stl, "to_bytes", lambda mesh, name: write(replace(mesh, triangles=mesh.triangles[1:]), name))
    assert "skin.stl.open_edges" in failed(Design())


def test_a_writer_that_turns_the_mesh_inside_out_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    write = stl.to_bytes

    def turned(mesh: Mesh, name: str) -> bytes:
        return write(replace(mesh, triangles=mesh.triangles[:, ::-1]), name)

    monkeypatch.setattr(stl, "to_bytes", turned)
    assert "skin.stl.inside_out" in failed(Design())


def test_files_are_those_of_the_formats_asked_for() -> None:
    assert set(verify(Design(), ["skin"], ["stl", "3mf", "step"], Evaluator(TOLERANCE)).contents) == {
        "skin.stl",
        "skin.3mf",
    }


@pytest.mark.parametrize("tolerance", [0.0, FINEST_MM / 2, 1.1, float("nan"), -0.01])
def test_a_tolerance_out_of_bounds_is_refused(tolerance: float) -> None:
    with pytest.raises(DesignError, match=r"--tolerance-mm: .* out of bounds; choose 0\.0005 to 1 mm"):
        refuse_tolerance(tolerance)
