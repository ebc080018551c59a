"""`from fingertip import ...`: every name is there, nothing is loaded before it is used."""

from __future__ import annotations

import pytest

import fingertip
from tests.conftest import run_python


@pytest.mark.parametrize("name", fingertip.__all__)
def test_every_name_is_there_and_documented(name: str) -> None:
    value = getattr(fingertip, name)
    assert name == "__version__" or value.__doc__
    assert name in dir(fingertip)


def test_unknown_names_are_attribute_errors() -> None:
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = fingertip.nothing  # type: ignore[attr-defined]


def test_the_example_of_the_docstring_runs(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    from tests.conftest import ROOT

    example = (fingertip.__doc__ or "").split("::\n")[1].split("Importing this")[0]
    script = "\n".join(line[4:] for line in example.splitlines())
    (tmp_path / "params").symlink_to(ROOT / "params")
    done = run_python("-c", script, PWD=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out/fsr400/skin.stl").exists()
    assert (tmp_path / "pcb/slip_filter.net").exists()


def test_a_part_as_other_peoples_types() -> None:
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


def test_commands_that_need_no_geometry_import_none() -> None:
    """One line for each command, in a process of its own."""
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
