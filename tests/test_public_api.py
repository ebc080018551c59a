"""Public names of the package: all can be imported, and none is loaded before it is used."""

from __future__ import annotations

import importlib
import inspect
import re
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fingertip
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.verification.verify import verify
from fingertip.models.parts import parts_by_name
from tests.approved import check_text
from tests.conftest import ROOT, run_python
from tools.mutation.mutants import list_modules


def describe_argument(argument: inspect.Parameter) -> str:
    default = argument.default
    given = default.__name__ if inspect.isfunction(default) else repr(default)
    return argument.name + ("" if default is argument.empty else f"={given}")


def test_every_public_name_is_documented_and_has_the_approved_defaults() -> None:
    values = {
        name: fingertip.__getattr__(name) for name in fingertip.__all__ if name != "__version__"
    }
    assert [name for name, value in values.items() if not value.__doc__] == []
    values |= {
        f"{name}.{key}": method
        for name, value in values.items()
        if inspect.isclass(value)
        for key, method in inspect.getmembers(value, inspect.isroutine)
        if not key.startswith("_")
        and str(getattr(method, "__module__", "")).startswith("fingertip")
    }
    lines = []
    for name, value in values.items():
        arguments = [describe_argument(one) for one in inspect.signature(value).parameters.values()]
        between = ", " if sum(map(len, arguments)) < 300 else ",\n    "
        lines.append(f"{name}({between.join(arguments)})\n")
    check_text(ROOT / "tests/approved/arguments.txt", "".join(lines))
    assert set(fingertip.__all__) <= set(dir(fingertip))
    assert fingertip.__version__
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = fingertip.nothing


ON = """at_knock automatic_layout bonded has_all_times in_volts is_default is_fitted is_left label_x
may_be_empty may_be_lower passed uncontrolled verified with_plots with_remedy with_strain"""
OWN = "boards count digits first_seed friction high seed silent_s size trials width width_px"
"""Flags that are on where they are left out, and numbers of which
functions have defaults of their own.
"""


def test_what_is_left_out_is_the_same_in_all_functions_and_flags_are_off() -> None:
    found: dict[str, set[str]] = {}
    for module in (
        importlib.import_module(name) for name, _ in list_modules() if not name.endswith("__main__")
    ):
        for one in vars(module).values():
            for function in (one, *(vars(one).values() if inspect.isclass(one) else ())):
                if inspect.isfunction(function) and function.__module__ == module.__name__:
                    for argument in inspect.signature(function).parameters.values():
                        if isinstance(argument.default, bool | int | float):
                            found.setdefault(argument.name, set()).add(repr(argument.default))
    assert [name for name, values in sorted(found.items()) if "True" in values] == ON.split()
    assert [name for name, values in sorted(found.items()) if len(values) > 1] == OWN.split()


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
    assert fingertip.part_solid(design, "sensor").isValid()
    assert fingertip.mesh_of(solid).volume() == pytest.approx(mesh.volume, rel=2e-3)


@pytest.mark.full
@pytest.mark.parametrize("name", ["fsr400", "adult_finger"])
def test_faces_of_a_part_are_tagged_and_frames_are_places_of_cadquery(name: str) -> None:
    import cadquery

    design = fingertip.Design.load(name)
    mold = fingertip.mold(design)
    parts = {
        "bone": fingertip.bone(design),
        "skin": fingertip.skin(design),
        "mold_palmar": mold.palmar,
        "mold_dorsal": mold.dorsal,
    }
    begin = time.process_time()
    assert fingertip.part_workplane(design, "bone").faces(tag="channel").size() == len(
        parts["bone"].ctx.tags["channel"].vals()
    )
    assert time.process_time() - begin <= 0.05
    walls = sorted(face.geomType() for face in parts["bone"].ctx.tags["channel"].vals())
    assert walls == ["CYLINDER", "CYLINDER", "TORUS"], (
        "two straight pieces and the bend between them"
    )
    tags = {part: set(workplane.ctx.tags) for part, workplane in parts.items()}
    ends = {"cheek_left", "cheek_right"} if design.bone.interface == "clevis" else {"post"}
    assert tags == {
        "bone": {"channel", "flat", "pocket", *ends},
        "skin": {"pad"},
        "mold_palmar": {"pad", "parting"},
        "mold_dorsal": {"parting"},
    }
    rows = re.findall(
        r"(?m)^\| `(\w+)` \| (`.*) \|$", (ROOT / "docs/python.md").read_text(encoding="utf-8")
    )
    said = {part: set(re.findall(r"`(\w+)`", said)) for part, said in rows if part in tags}
    assert said == tags | {"bone": tags["bone"] | {"post", "cheek_left", "cheek_right"}}
    places = fingertip.frames(design)
    dims = design.dimensions
    assert set(places) == {"interface", "tip", "sensor"}
    # The floor lies behind the sensor's front by sensor and film, and the pad in front of it by
    # that of the skin.
    thickness_mm = dims.sensor.thickness_mm + design.sensor.adhesive_thickness_mm
    sensor = cadquery.Plane(places["sensor"])
    local = [
        sensor.toLocalCoords(face.Center()) for face in parts["bone"].ctx.tags["pocket"].vals()
    ]
    assert all(abs(at.x) < 1e-6 and abs(at.z + thickness_mm) < 1e-3 for at in local)
    out = sensor.toWorldCoords((0.0, 0.0, design.skin.thickness_palmar_mm))
    assert (
        min(
            face.distance(cadquery.Vertex.makeVertex(*out.toTuple()))
            for face in parts["skin"].faces().vals()
        )
        < 0.2
    )
    assert parts["bone"].faces(tag="flat").workplane()  # flat faces alone have one
    for tag in ends:
        end = parts["bone"].faces(tag=tag).workplane(centerOption="CenterOfMass")
        drilled = end.circle(0.5).cutBlind(-2.0)
        assert drilled.val().isValid()
        assert 0.2 < parts["bone"].val().Volume() - drilled.val().Volume() < 1.6


@pytest.mark.full
def test_checks_are_those_of_the_command() -> None:
    design = fingertip.Design()
    checks = verify(design, parts_by_name(design), ("stl",), MeshEvaluator(0.05)).checks
    assert fingertip.check(design, tolerance_mm=0.05).checks == checks


def test_a_sweep_gives_a_row_for_each_design_and_goes_on_where_it_ended(tmp_path: Path) -> None:
    file = tmp_path / "mine.toml"
    told = list[str]()
    text = (
        'name = "mine"\noutputs = ["q", "cutoff_3db_hz"]\n\n[axes]\n"board.cutoff_hz" = [50.0, '
        "60.0]\n"
    )
    file.write_text(text, encoding="utf-8")
    table = fingertip.run_sweep(
        file, {"design.board.r5_ohm": 2e5}, tmp_path / "rows", jobs=1, progress=told.append
    )
    assert list(table.index) == [0, 1]
    assert list(table["board.cutoff_hz"]) == [50.0, 60.0]
    assert list(table["status"]) == ["ok", "ok"]
    assert table["cutoff_3db_hz"].to_numpy() == pytest.approx([50.0, 60.0], rel=0.03)
    assert "of 2 designs" in told[-1]
    tables = {
        "name": "mine",
        "outputs": ["q", "cutoff_3db_hz"],
        "axes": {"board.cutoff_hz": [50.0, 60.0]},
        "design": {"board": {"r5_ohm": 2e5}},
    }
    for again in (file, {"design.board.r5_ohm": 2e5}), (tables, ()):
        assert fingertip.run_sweep(*again, tmp_path / "rows", jobs=1).equals(table)


def test_detection_takes_arrays_and_follows_their_rate() -> None:
    design = fingertip.Design.load(changes={"detector.sample_rate_hz": 1000})
    trace = fingertip.simulate(design, fingertip.Trial(seed=3))
    wanted = fingertip.detect(trace, design, "fast")
    found = fingertip.detect(fingertip.Trace(trace.time_s, trace.voltage_v), detector="fast")
    assert wanted.intervals
    assert found.intervals
    assert (
        fingertip.detect(list(trace.voltage_v), None, "fast", rate_hz=1000).intervals
        == found.intervals
    )
    rows = np.stack([trace.time_s, trace.voltage_v], axis=1)
    assert fingertip.detect(rows, detector="fast").intervals == found.intervals
    stated = fingertip.Design.load(changes={"detector.sample_rate_hz": 2000})
    for recording in (trace.voltage_v, fingertip.Trace(trace.time_s, trace.voltage_v)):
        assert (
            fingertip.detect(recording, stated, "fast", rate_hz=1000).intervals == found.intervals
        )
    assert (
        fingertip.detect(trace.voltage_v, stated, "analog", rate_hz=1000).trace.envelope_v
        is not None
    )


GAP = fingertip.Trace(np.delete(np.arange(999), np.arange(300, 400)) / 1000, np.ones(899))


@pytest.mark.parametrize(
    ("recording", "rate_hz", "told"),
    [
        (
            np.zeros(9),
            None,
            "recording: has shape (9,) and no rate; give voltages (n,) with rate_hz",
        ),
        (np.zeros((9, 3)), None, "has shape (9, 3) and no rate"),
        (np.zeros(9), -1.0, "rate_hz: -1 Hz is out of range"),
        ("volts", 2000.0, "recording: is no array of numbers"),
        (np.ones(9, complex), 2000.0, "recording: is no array of numbers (its type is complex128)"),
        (
            np.ma.masked_less(np.arange(999) / 999, 0.5),
            1000.0,
            "nan at sample 0 is not a finite number",
        ),
        (
            np.full(999, 4.5),
            1000.0,
            "multiply the voltages if they are not in volts, or give a Design with a wider",
        ),
        (np.full(999, 2300), 1000.0, "a factor of 0.00080566406 converts counts of 12 bits"),
        (
            GAP,
            None,
            "comes after a gap (previous time 0.299 s, median step 0.001 s); detection requires "
            "evenly spaced "
            "samples; if few are missing, pass the voltages alone, with rate_hz=1000",
        ),
        (
            fingertip.Trace(np.arange(999) // 4 / 250, np.ones(999)),
            None,
            "rounded to 0.004 s, at a mean rate of 1000 Hz; pass the voltages alone, with "
            "rate_hz=1000",
        ),
        (
            fingertip.Trace(np.arange(999), np.zeros(999)),
            None,
            "if they are in milliseconds, convert them to seconds",
        ),
        (fingertip.Trace(np.zeros(9), np.zeros(9)), None, "time"),
        (
            np.zeros(4000),
            100.0,
            "rate_hz: 100 Hz is out of range; record at, or resample to, 1000 to 20000",
        ),
    ],
)
def test_arrays_that_are_no_recording_are_refused(
    recording: Any, rate_hz: float | None, told: str
) -> None:
    with pytest.raises(fingertip.FingertipError, match=re.escape(told)):
        fingertip.detect(recording, rate_hz=rate_hz)


HEAVY = {
    "cadquery",
    "OCP",
    "trimesh",
    "vtk",
    "matplotlib",
    "scipy",
    "numba",
    "distributed",
    "reportlab",
}
LIGHT_WORK = {
    "help pages": (
        "import typer.main\nfrom typer.testing import CliRunner\nfrom fingertip.cli import app\n"
        "for name in typer.main.get_command(app).commands:\n"
        "    assert CliRunner().invoke(app, [name, '--help']).exit_code == 0",
        {"manifold3d", "numpy"},
    ),
    "board": (
        "from fingertip.cli import app; app(['board', 'fsr400', '-q'], standalone_mode=False)",
        {"manifold3d"},
    ),
    "simulate": (
        "from fingertip.cli import app; app(['simulate', '-q'], standalone_mode=False)",
        {"manifold3d"},
    ),
    "meshes": (
        "from fingertip.cli import app\n"
        "app(['build', 'fsr400', '--formats', 'stl,3mf', '--parts', 'skin', '--verify', '-q'], "
        "standalone_mode=False)",
        set(),
    ),
    "params": (
        "from fingertip.cli import app; app(['params', '-q'], standalone_mode=False)",
        {"manifold3d"},
    ),
    "sweep of boards": (
        "from fingertip.sweep.sweep_plan import SweepPlan\n"
        "from fingertip.sweep.point_evaluator import PointEvaluator\n"
        "plan = SweepPlan.from_tables({'outputs': ['q'], 'axes': {'board.cutoff_hz': [60.0]}})\n"
        "assert PointEvaluator(plan).evaluate(0, plan.point(0))[1] == 'ok'",
        {"manifold3d"},
    ),
    "studio": (
        "from fingertip import Design\nfrom fingertip.studio.server import StudioServer\n"
        "from fingertip.studio.answers import ANSWERS, DOWNLOADS\n"
        "design = Design()\nStudioServer(design, 0).server_close()\n"
        "for make in (*ANSWERS.values(), *(make for _, make in DOWNLOADS.values())): make(design, "
        "lambda: None)",
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
