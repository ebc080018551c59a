"""Parts and formats that are not requested are not built, written or imported."""

from __future__ import annotations

from pathlib import Path

import pytest

from fingertip.cad.kernel import mesh
from fingertip.design import Design
from fingertip.tasks.build import build
from tests.conftest import design_file, run_python

HEAVY = ("cadquery", "OCP", "trimesh", "vtk", "matplotlib", "scipy", "numba")


def test_only_the_requested_parts_are_evaluated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    evaluated = []
    original = mesh.MeshEvaluator.manifold

    def spy(self: mesh.MeshEvaluator, solid: object) -> object:
        evaluated.append(solid)
        return original(self, solid)  # type: ignore[arg-type]

    monkeypatch.setattr(mesh.MeshEvaluator, "manifold", spy)
    design = Design()
    result = build(design, tmp_path, parts=["bone"], formats=["stl"])
    files = {"bone.stl", "design.toml", "manifest.json", "report.json"}
    assert {path.name for path in tmp_path.iterdir()} == {*files, "print"}
    assert {path.name for path in (tmp_path / "print").iterdir()} == {"bone.stl", "manifest.json"}
    assert [built.part.name for built in result.parts] == ["bone"]
    from fingertip.cad.shapes.parts import PARTS
    from fingertip.design.geometry.solids import SuperconicSolid

    assert SuperconicSolid(design.dimensions.outer) not in evaluated
    assert not {PARTS[name].solid(design) for name in ("skin", "mold_palmar", "mold_dorsal")} & set(evaluated)


@pytest.mark.full
def test_mesh_build_imports_no_brep_kernel_and_starts_no_process(tmp_path: Path) -> None:
    script = f"""
import subprocess, sys
subprocess.Popen = None
from fingertip.cli import app
try:
    app(["build", {str(design_file("fsr400"))!r}, "--out", {str(tmp_path)!r}, "--formats", "stl,3mf", "-q"])
except SystemExit as stop:
    assert not stop.code, stop.code
print(sorted({{name.split(".")[0] for name in sys.modules}} & set({HEAVY!r})))
"""
    done = run_python("-c", script)
    assert done.returncode == 0, done.stderr
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.full
def test_step_build_writes_no_mesh_files(tmp_path: Path) -> None:
    build(Design(), tmp_path, parts=["skin"], formats=["step"])
    assert {p.name for p in tmp_path.iterdir()} == {
        "skin.step",
        "assembly.step",
        "design.toml",
        "manifest.json",
        "report.json",
    }


def test_importing_fingertip_imports_no_heavy_package() -> None:
    done = run_python("-c", "import fingertip, sys; print(len({'numpy','pydantic','typer'} & set(sys.modules)))")
    assert done.stdout.strip() == "0", done.stderr
