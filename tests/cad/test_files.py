"""Files of parts: STL, 3MF and STEP, written and read back, the
process that makes STEP, and JUnit reports.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import zipfile
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
import pytest

from fingertip.cad.build_result import Build
from fingertip.cad.files.step_process import BrepMeasurements, StepFiles, StepJob, StepProcess
from fingertip.cad.verification.check import Check
from fingertip.cad.verification.printing import part_genus
from fingertip.cli.check_reports import to_junit
from fingertip.design import Design
from fingertip.foundation.errors import GeometryError
from fingertip.models.hardware import hardware
from fingertip.models.parts import PARTS
from fingertip.models.solids import Box, Solid
from tests.conftest import design_file, run_fingertip

if TYPE_CHECKING:
    import trimesh

NAMES = ("bone", "core", "mold_dorsal", "mold_palmar", "skin", "stand")
"""Parts of the bundled designs with a post."""


def load(built: Build, name: str, file_format: str) -> trimesh.Trimesh:
    import trimesh

    loaded = trimesh.load(built.folder / f"{name}.{file_format}", force="mesh")
    assert isinstance(loaded, trimesh.Trimesh)
    return loaded


@pytest.mark.full
def test_build_writes_exactly_the_expected_files_without_a_date(built: Build) -> None:
    others = {"assembly.step", "casting.md", "design.toml", "manifest.json", "print", "report.json"}
    expected = {f"{name}.{file_format}" for name in NAMES for file_format in ("stl", "3mf", "step")}
    assert {path.name for path in built.folder.iterdir()} == expected | others
    printed = {f"{name}.stl" for name in NAMES if PARTS[name].is_printed}
    assert {path.name for path in (built.folder / "print").iterdir()} == printed | {
        "plate_fdm.3mf",
        "manifest.json",
    }
    assert Design.load(built.folder / "design.toml") == built.design
    with zipfile.ZipFile(built.folder / "bone.3mf") as bundle:
        assert {entry.date_time for entry in bundle.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    assert "1970-01-01T00:00:00" in (built.folder / "bone.step").read_text()[:600]


@pytest.mark.full
def test_trimesh_finds_the_same_valid_solid_of_the_expected_genus_in_stl_and_3mf(
    built: Build,
) -> None:
    for name in NAMES:
        meshes = [load(built, name, file_format) for file_format in ("stl", "3mf")]
        for mesh in meshes:
            assert mesh.is_watertight
            assert mesh.is_winding_consistent
            assert mesh.body_count == 1
            assert 1 - mesh.euler_number / 2 == part_genus(built.design, name)
        stl, packed = meshes
        assert len(stl.faces) == len(packed.faces)
        assert np.array_equal(np.unique(stl.vertices, axis=0), np.unique(packed.vertices, axis=0))


@pytest.mark.full
def test_step_holds_one_valid_named_solid_with_the_volume_of_the_mesh(built: Build) -> None:
    import cadquery as cq

    from fingertip.cad.kernel import brep

    for name in NAMES:
        path = built.folder / f"{name}.step"
        solids = cq.importers.importStep(str(path)).solids().vals()
        assert len(solids) == 1
        assert solids[0].isValid()
        exact = brep.volume(solids[0].wrapped)
        mesh = load(built, name, "stl")
        assert abs(exact - mesh.volume) <= built.tolerance_mm * mesh.area
        assert f"PRODUCT('{name}','{name}'" in path.read_text()


@pytest.mark.full
def test_assembly_holds_parts_and_hardware_with_names_and_colours(built: Build) -> None:
    import cadquery as cq

    path = built.folder / "assembly.step"
    assembly = cq.Assembly.importStep(str(path))
    found = {child.name: child.color.toTuple()[:3] for child in assembly.children}
    bought = {item.name: item.colour for item in hardware(built.design, NAMES)}
    assert set(found) == {*NAMES} - {"stand"} | set(bought), (
        "the stand holds a finger without its mold"
    )
    for name, colour in found.items():
        assert colour == pytest.approx(bought.get(name) or PARTS[name].colour, abs=1e-6)
    assert len(cq.importers.importStep(str(path)).solids().vals()) == len(found)
    stated = json.loads((built.folder / "report.json").read_text())["assembly"]
    assert {*stated["parts"], *stated["hardware"]} == set(found)


@pytest.mark.full
def test_report_agrees_with_the_files(built: Build) -> None:
    text = (built.folder / "report.json").read_text()
    report = json.loads(text)
    assert report["passed"]
    assert report["checks"]
    for name, entry in report["parts"].items():
        assert entry["volume_mm3"] == pytest.approx(load(built, name, "stl").volume, abs=1e-6)
        for file_format, file in entry["files"].items():
            assert (
                entry["sha256"][file_format]
                == hashlib.sha256((built.folder / file).read_bytes()).hexdigest()
            )
    for check in report["checks"]:
        assert set(check) == {"name", "value", "limit", "unit", "relation", "passed"}
    assert not re.search(r"\.\d{7,}(e[-+]?\d+)?,?$", text, re.MULTILINE), (
        "numbers have six decimals"
    )


@pytest.mark.full
def test_two_builds_in_two_processes_are_byte_identical(built: Build, tmp_path) -> None:
    """The hash seed differs on purpose, because no output may depend on the order of a set."""
    done = run_fingertip(
        "build", design_file(built.design.name), "--out", tmp_path, "-q", PYTHONHASHSEED="4711"
    )
    assert done.returncode == 0, done.stderr
    for path in (path for path in built.folder.rglob("*") if path.is_file()):
        assert path.read_bytes() == (tmp_path / path.relative_to(built.folder)).read_bytes(), (
            path.name
        )


GREY = (0.5, 0.5, 0.5)
BOX = Box((0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
EMPTY = BOX.cut(Box((-1.0, -1.0, -1.0), (4.0, 4.0, 4.0)))


class CrashingSolid:
    """Object that ends the process which evaluates it, as a crash of the kernel does."""

    def __hash__(self) -> int:
        os.write(2, b"first words\nlast words\n")
        os._exit(9)


def make_step_files(*solids: Solid, **options: Any) -> StepFiles:
    job = StepJob(
        "test", tuple((f"part{i}", solid, GREY) for i, solid in enumerate(solids)), **options
    )
    with StepProcess.start(job) as process:
        return process.result()


def test_files_and_measurements_of_both_processes_are_returned() -> None:
    """The assembly leaves the tool out, and holds the hardware."""
    names = [f"part{i}" for i in range(3)]
    more = {"hardware": (("pin", BOX, GREY),), "tools": ("part1",)}
    measured = (("a", BOX), ("b", BOX))
    also = tuple((name, type) for name in names)
    found = make_step_files(BOX, BOX, BOX, measured_solids=measured, also=also, **more)
    assert sorted(found.contents) == sorted(f"{name}.step" for name in [*names, "assembly"])
    assert {"part0", "part2", "pin"} == {
        *re.findall(r"PRODUCT\('(part\d|pin)'", found.contents["assembly.step"].decode())
    }
    assert found.measurements == dict.fromkeys(names, BrepMeasurements(pytest.approx(6.0), 0))
    assert found.volumes_mm3 == pytest.approx({"a": 6.0, "b": 6.0})
    assert {name: kind.__name__ for name, kind in found.also.items()} == dict.fromkeys(
        names, "BrepEvaluator"
    )


@pytest.mark.full
@pytest.mark.parametrize("position", [0, 1])
@pytest.mark.parametrize(
    ("solid", "message"),
    [
        (EMPTY, "one valid solid was expected"),
        (CrashingSolid(), r"the B-rep kernel crashed (\(last words\)|while it made part1)"),
    ],
    ids=["invalid", "crash"],
)
def test_fault_of_either_process_is_reported(
    position: int, solid: Solid, message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # trame_vuetify 3.3.0 installs a package `tests`, which the process would find before this one.
    root = Path(__file__).parents[2]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(root), str(root / "src")]))
    solids: list[Solid] = [BOX, BOX]
    solids[position] = solid
    with pytest.raises(GeometryError, match=message):
        make_step_files(*solids)


PASSED = Check("bone.stl.genus", 2, 2, "through holes", "exactly")
FAILED = Check("overlap.bone.skin", 0.5, 1e-3, "mm3")
# (required, allowed) attributes of each element in the schema of Jenkins' xUnit plug-in
# (junit-10.xsd).
ALLOWED = {
    "testsuites": (
        {"name", "tests", "failures", "errors"},
        {"name", "time", "tests", "failures", "errors"},
    ),
    "testsuite": (
        {"name", "tests", "failures", "errors"},
        {"name", "tests", "failures", "errors", "skipped", "time"},
    ),
    "testcase": ({"name", "classname"}, {"name", "classname", "time"}),
    "failure": ({"message", "type"}, {"message", "type"}),
    "system-out": (set(), set()),
}


def test_junit_report_counts_its_cases_and_conforms_to_the_schema() -> None:
    root = ElementTree.fromstring(to_junit({"one": [PASSED, FAILED], "two": [PASSED]}))
    assert (root.get("tests"), root.get("failures"), root.get("errors")) == ("3", "1", "0")
    assert [(s.get("name"), s.get("tests"), s.get("failures")) for s in root] == [
        ("one", "2", "1"),
        ("two", "1", "0"),
    ]
    (failure,) = root.iter("failure")
    assert failure.get("message") == "value 0.5 mm3, must be at most 0.001"
    assert [
        case.get("name") for case in root.iter("testcase") if case.find("failure") is not None
    ] == [FAILED.name]
    for element in root.iter():
        required, allowed = ALLOWED[element.tag]
        assert required <= set(element.attrib) <= allowed, element.tag
    nan = ElementTree.fromstring(to_junit({"one": [Check("overlap", float("nan"), 1.0, "mm3")]}))
    assert nan.get("failures") == "1"
    read = pytest.importorskip("junitparser").JUnitXml.fromroot(root)
    assert [[case.is_passed for case in suite] for suite in read] == [[True, False], [True]]


def test_junit_report_replaces_invalid_characters() -> None:
    root = ElementTree.fromstring(to_junit({'a<&"\x00\x1b.toml': [PASSED]}))
    assert root[0].get("name") == 'a<&"??.toml'
    (case,) = root.iter("testcase")
    assert case.get("classname", "").count(".") == 1, (
        "readers group test cases by the dots in the class name"
    )
