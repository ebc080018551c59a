"""Public names of the package: all can be imported, and none is loaded before it is used."""

from __future__ import annotations

import pytest

import fingertip
from tests.conftest import run_python


def test_every_public_name_exists_and_is_documented() -> None:
    values = {name: getattr(fingertip, name, None) for name in fingertip.__all__ if name != "__version__"}
    assert [name for name, value in values.items() if value is None or not value.__doc__] == []
    assert set(fingertip.__all__) <= set(dir(fingertip))
    assert fingertip.__version__
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = fingertip.nothing


@pytest.mark.full
def test_example_in_the_docstring_runs(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    example = (fingertip.__doc__ or "").split("::\n")[1].split("Importing this")[0]
    script = "\n".join(line[4:] for line in example.splitlines())
    done = run_python("-c", script, PWD=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out/fsr400/skin.stl").exists()
    assert (tmp_path / "out/fsr400/board/slip_filter.net").exists()


@pytest.mark.full
def test_part_as_cadquery_solid_and_trimesh() -> None:
    import cadquery
    import trimesh

    design = fingertip.Design()
    solid = fingertip.part_solid(design, "bone")
    assert isinstance(solid, cadquery.Solid)
    mesh = fingertip.part_trimesh(design, "bone")
    assert isinstance(mesh, trimesh.Trimesh)
    assert mesh.is_watertight
    assert abs(cadquery.Workplane(solid).val().Volume() - mesh.volume) / mesh.volume < 0.002
    with pytest.raises(fingertip.FingertipError, match="did you mean bone"):
        fingertip.part_mesh(design, "bome")


@pytest.mark.full
def test_commands_without_geometry_import_no_heavy_package() -> None:
    """Each command runs in a process of its own, which prints the heavy packages it has imported."""
    from tests.conftest import design_file

    heavy = ("cadquery", "OCP", "trimesh", "vtk", "matplotlib", "scipy", "numba", "manifold3d")
    for arguments in (["board"], ["simulate"], ["params"]):
        script = (
            "import sys, os, tempfile\nos.chdir(tempfile.mkdtemp())\nfrom fingertip.cli import app\n"
            f"try:\n    app({[*arguments, str(design_file('fsr400')), '-q']!r})\nexcept SystemExit as stop:\n"
            "    assert not stop.code, stop.code\n"
            f"print(sorted({{name.split('.')[0] for name in sys.modules}} & set({heavy!r})))"
        )
        done = run_python("-c", script)
        assert done.returncode == 0, done.stderr
        assert done.stdout.splitlines()[-1] == "[]", arguments
