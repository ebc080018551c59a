"""Exported files, read back from disk by readers that share no code with the writers."""

from __future__ import annotations

import hashlib
import json
import re
import zipfile
from typing import TYPE_CHECKING

import numpy as np
import pytest
from manifold3d import Error, Manifold, Mesh64

from fingertip.cad.report import Build
from fingertip.cad.shapes.parts import PARTS, hardware
from tests.conftest import design_file, run_fingertip

if TYPE_CHECKING:
    import trimesh


def names(built: Build) -> set[str]:
    """Names of the parts: the bundled designs are overmolded, and a lid belongs to a folded tail."""
    return {"bone", "skin", "mold_palmar", "mold_dorsal"} | ({"lid"} if built.design.sensor.tail == "folded" else set())


def mesh_files(built: Build) -> list[tuple[str, str]]:
    """Parts and formats of all mesh files."""
    return [(name, file_format) for name in sorted(names(built)) for file_format in ("stl", "3mf")]


def load(built: Build, name: str, file_format: str) -> trimesh.Trimesh:
    import trimesh

    loaded = trimesh.load(built.folder / f"{name}.{file_format}", force="mesh")
    assert isinstance(loaded, trimesh.Trimesh)
    return loaded


@pytest.mark.full
def test_build_writes_exactly_the_expected_files(built: Build) -> None:
    expected = {f"{name}.{file_format}" for name in names(built) for file_format in ("stl", "3mf", "step")}
    assert {path.name for path in built.folder.iterdir()} == expected | {
        "assembly.step",
        "casting.md",
        "design.toml",
        "manifest.json",
        "print",
        "report.json",
    }
    printed = {f"{name}.stl" for name in names(built) if PARTS[name].is_printed}
    plates = {"plate_fdm.3mf", "plate_sla.3mf"}
    assert {path.name for path in (built.folder / "print").iterdir()} == printed | plates | {"manifest.json"}


@pytest.mark.full
def test_trimesh_finds_a_watertight_solid_of_the_expected_genus(built: Build) -> None:
    for name, file_format in mesh_files(built):
        mesh = load(built, name, file_format)
        assert mesh.is_watertight
        assert mesh.is_winding_consistent
        assert mesh.volume > 0
        assert mesh.body_count == 1
        assert 1 - mesh.euler_number / 2 == PARTS[name].genus(built.design)


@pytest.mark.full
def test_manifold3d_finds_a_valid_solid_of_the_expected_genus(built: Build) -> None:
    for name, file_format in mesh_files(built):
        mesh = load(built, name, file_format)
        solid = Manifold(Mesh64(np.array(mesh.vertices, order="C"), np.array(mesh.faces, dtype=np.uint64, order="C")))
        assert solid.status() == Error.NoError
        assert solid.volume() > 0
        assert len(solid.decompose()) == 1
        assert solid.genus() == PARTS[name].genus(built.design)
        assert solid.volume() == pytest.approx(mesh.volume, rel=1e-9)


@pytest.mark.full
def test_stl_and_3mf_hold_the_same_mesh(built: Build) -> None:
    for name in sorted(names(built)):
        stl, packed = load(built, name, "stl"), load(built, name, "3mf")
        assert len(stl.faces) == len(packed.faces)
        assert stl.volume == pytest.approx(packed.volume, rel=1e-9)
        assert np.array_equal(np.unique(stl.vertices, axis=0), np.unique(packed.vertices, axis=0))


@pytest.mark.full
def test_every_facet_has_three_different_vertices(built: Build) -> None:
    for name in sorted(names(built)):
        faces = load(built, name, "stl").faces
        assert (faces[:, 0] != faces[:, 1]).all()
        assert (faces[:, 1] != faces[:, 2]).all()
        assert (faces[:, 2] != faces[:, 0]).all()


@pytest.mark.full
def test_step_holds_one_valid_named_solid_with_the_volume_of_the_mesh(built: Build) -> None:
    import cadquery as cq

    from fingertip.cad.kernel import brep

    for name in sorted(names(built)):
        path = built.folder / f"{name}.step"
        solids = cq.importers.importStep(str(path)).solids().vals()
        assert len(solids) == 1
        assert solids[0].isValid()
        exact = brep.volume(solids[0])
        mesh = load(built, name, "stl")
        assert abs(exact - mesh.volume) <= built.tolerance_mm * mesh.area
        assert f"PRODUCT('{name}','{name}'" in path.read_text()


@pytest.mark.full
def test_assembly_holds_parts_and_hardware_with_names_and_colours(built: Build) -> None:
    import cadquery as cq

    path = built.folder / "assembly.step"
    assembly = cq.Assembly.importStep(str(path))
    found = {child.name: child.color.toTuple()[:3] for child in assembly.children}
    bought = {item.name: item.colour for item in hardware(built.design, names(built))}
    assert set(found) == names(built) | set(bought)
    for name, colour in found.items():
        assert colour == pytest.approx(bought.get(name) or PARTS[name].colour, abs=1e-6)
    assert len(cq.importers.importStep(str(path)).solids().vals()) == len(found)
    stated = json.loads((built.folder / "report.json").read_text())["assembly"]
    assert {*stated["parts"], *stated["hardware"]} == set(found)
    assert stated["threads"] == {"chaplet_screw": ["bone"]}


@pytest.mark.full
def test_report_agrees_with_the_files(built: Build) -> None:
    report = json.loads((built.folder / "report.json").read_text())
    assert report["passed"]
    assert report["checks"]
    for name, entry in report["parts"].items():
        assert entry["volume_mm3"] == pytest.approx(load(built, name, "stl").volume, abs=1e-6)
        for file_format, file in entry["files"].items():
            assert entry["sha256"][file_format] == hashlib.sha256((built.folder / file).read_bytes()).hexdigest()
    for check in report["checks"]:
        warns = {"warning", "change"} if check["state"] == "warning" else set[str]()
        assert set(check) == {"name", "value", "limit", "unit", "relation", "passed", "state", *warns}


@pytest.mark.full
def test_written_design_equals_the_design_built(built: Build) -> None:
    from fingertip.design import Design

    assert Design.load(built.folder / "design.toml") == built.design


@pytest.mark.full
def test_two_builds_in_two_processes_are_byte_identical(built: Build, tmp_path) -> None:
    """The hash seed differs on purpose, because no output may depend on the order of a set."""
    done = run_fingertip("build", design_file(built.design.name), "--out", tmp_path, "-q", PYTHONHASHSEED="4711")
    assert done.returncode == 0, done.stderr
    for path in (path for path in built.folder.rglob("*") if path.is_file()):
        assert path.read_bytes() == (tmp_path / path.relative_to(built.folder)).read_bytes(), path.name


@pytest.mark.full
def test_files_carry_no_date(built: Build) -> None:
    with zipfile.ZipFile(built.folder / "bone.3mf") as bundle:
        assert {entry.date_time for entry in bundle.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    assert "1970-01-01T00:00:00" in (built.folder / "bone.step").read_text()[:600]


@pytest.mark.full
def test_report_rounds_numbers_to_six_decimals(built: Build) -> None:
    for line in (built.folder / "report.json").read_text().splitlines():
        digits = re.search(r"\.(\d+)(e[-+]?\d+)?,?$", line)
        assert digits is None or len(digits[1]) <= 6, line
