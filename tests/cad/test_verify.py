"""The checks read the bytes of the file, not the mesh it was written from."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.verification.verify import MIN_TOLERANCE_MM, validate_tolerance, verify
from fingertip.design import Design
from fingertip.foundation.errors import DesignError

TOLERANCE = 0.05


def failed_checks(design: Design) -> set[str]:
    return {
        check.name for check in verify(design, ["skin"], ["stl"], MeshEvaluator(TOLERANCE)).checks if not check.passed
    }


def test_writer_that_loses_a_triangle_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    write = stl.to_bytes
    assert failed_checks(Design()) == set()
    monkeypatch.setattr(
        stl, "to_bytes", lambda mesh, *words: write(replace(mesh, triangles=mesh.triangles[1:]), *words)
    )
    assert "skin.stl.open_edges" in failed_checks(Design())


def test_writer_that_inverts_the_mesh_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    write = stl.to_bytes

    def inverted(mesh: Mesh, *words: str) -> bytes:
        return write(replace(mesh, triangles=mesh.triangles[:, ::-1]), *words)

    monkeypatch.setattr(stl, "to_bytes", inverted)
    assert "skin.stl.inverted" in failed_checks(Design())


def test_only_requested_mesh_formats_are_made() -> None:
    assert set(verify(Design(), ["skin"], ["stl", "3mf", "step"], MeshEvaluator(TOLERANCE)).contents) == {
        "skin.stl",
        "skin.3mf",
    }


@pytest.mark.parametrize("tolerance", [0.0, MIN_TOLERANCE_MM / 2, 1.1, float("nan"), -0.01])
def test_tolerance_out_of_bounds_is_rejected(tolerance: float) -> None:
    with pytest.raises(DesignError, match=r"--tolerance-mm: .* out of bounds; choose 0\.0005 to 1 mm"):
        validate_tolerance(tolerance)
