"""Public names of the package: all can be imported, and none is loaded before it is used."""

from __future__ import annotations

from pathlib import Path

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


HEAVY = {"cadquery", "OCP", "trimesh", "vtk", "matplotlib", "scipy", "numba", "distributed", "reportlab"}
LIGHT_WORK = {
    "board": ("from fingertip.cli import app; app(['board', 'fsr400', '-q'], standalone_mode=False)", {"manifold3d"}),
    "simulate": ("from fingertip.cli import app; app(['simulate', '-q'], standalone_mode=False)", {"manifold3d"}),
    "params": ("from fingertip.cli import app; app(['params', '-q'], standalone_mode=False)", {"manifold3d"}),
    "sweep of boards": (
        "from fingertip.sweep.plan import SweepPlan\n"
        "from fingertip.sweep.point_evaluator import PointEvaluator\n"
        "plan = SweepPlan.from_tables({'outputs': ['q'], 'axes': {'board.cutoff_hz': [60.0]}})\n"
        "assert PointEvaluator(plan).evaluate(0, plan.point(0))[1] == 'ok'",
        {"manifold3d"},
    ),
    "studio": (
        "from fingertip import Design\nfrom fingertip.studio.server import StudioServer, _ANSWERS\n"
        "from fingertip.studio.answers import DOWNLOADS\n"
        "design = Design()\nStudioServer(design, 0).server_close()\n"
        "for make in (*_ANSWERS.values(), *(make for _, make in DOWNLOADS.values())): make(design, lambda: None)",
        set(),
    ),
}
"""Program, and what it must not import beside the heavy packages."""


@pytest.mark.full
@pytest.mark.parametrize("name", LIGHT_WORK)
def test_light_work_imports_no_heavy_package(name: str, tmp_path: Path) -> None:
    program, others = LIGHT_WORK[name]
    imported = "import sys; print(*{name.partition('.')[0] for name in sys.modules})"
    done = run_python("-c", f"{program}\n{imported}", PWD=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert set(done.stdout.splitlines()[-1].split()) & (HEAVY | others) == set()
