"""PrusaSlicer reads and slices the exported files."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from fingertip.build_files import Build
from tests.tools import require_tool

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def slicer() -> Path:
    return require_tool("prusa-slicer", "apt-get install prusa-slicer")


@pytest.mark.parametrize("file_format", ["stl", "3mf"])
@pytest.mark.parametrize("name", ["bone", "skin", "mold_palmar", "mold_dorsal"])
def test_slicer_sees_one_manifold_part(slicer: Path, built: Build, name: str, file_format: str) -> None:
    """The exit code of PrusaSlicer does not report whether a mesh is manifold; its output does."""
    output = subprocess.run(
        [slicer, "--info", built.folder / f"{name}.{file_format}"], capture_output=True, text=True, check=True
    )
    facts = dict(line.split(" = ", 1) for line in output.stdout.splitlines() if " = " in line)
    assert facts["manifold"].strip() == "yes"
    assert facts["number_of_parts"].strip() == "1"
    part = next(p for p in built.parts if p.part.name == name)
    assert float(facts["volume"]) == pytest.approx(part.mesh.volume(), rel=1e-5)


@pytest.mark.parametrize("name", ["bone", "mold_palmar", "mold_dorsal"])
def test_slicer_slices_printed_parts(slicer: Path, built: Build, name: str, tmp_path: Path) -> None:
    code = tmp_path / f"{name}.gcode"
    command = [slicer, "--export-gcode", "--layer-height", "0.15", "-o", code, built.folder / f"{name}.3mf"]
    subprocess.run(command, capture_output=True, text=True, check=True)
    text = code.read_text()
    assert text.count("\nG1 ") > 1000
    assert "filament used [mm]" in text
