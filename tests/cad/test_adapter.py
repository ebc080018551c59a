"""Adapter of a user: a body that plain CadQuery has drawn, united with the base in both kernels."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.cad.files import stl
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.verification.printing import part_genus
from fingertip.cad.verification.verify import verify
from fingertip.design import Design
from fingertip.design.interfaces import adapter
from fingertip.foundation.errors import DesignError
from fingertip.models import bone as finger
from fingertip.models.adapter import place_adapter
from fingertip.models.sensor_pocket import sensor_recess
from fingertip.tasks.build import build

SIZE = (8.0, 7.5, 14.0)
VOLUME = math.prod(SIZE) - math.pi * 1.5**2 * SIZE[0]
"""Volume of a bar with the hole of a cross bolt along x [mm3]."""
POINT = (20.0, 3.0, -4.0)
"""Middle of its distal end in the file, where it is drawn along -y [mm]."""
AT = {f"bone.adapter_{axis}_mm": value for axis, value in zip("xyz", POINT, strict=True)}


def draw() -> Any:
    """Draw the bar, whose width lies along z, height along x, length along y."""
    cq = pytest.importorskip("cadquery")
    low = (POINT[0] - SIZE[1] / 2, POINT[1], POINT[2] - SIZE[0] / 2)
    bar = cq.Workplane().box(SIZE[1], SIZE[2], SIZE[0], centered=False).translate(low)
    return bar.cut(
        cq.Workplane("XY").center(POINT[0], POINT[1] + 9.0).circle(1.5).extrude(20, both=True)
    )


def save(shape: Any, path: Path) -> Path:
    cq = pytest.importorskip("cadquery")
    cq.exporters.export(shape, str(path), tolerance=0.005)
    return path


def load(path: Path, **changes: Any) -> Design:
    own = {"bone.interface": "file", "bone.adapter_file": str(path), "bone.adapter_axis": "-y"}
    return Design.load(
        "fsr400", changes={**own, **AT, **{f"bone.{key}": value for key, value in changes.items()}}
    )


@pytest.mark.parametrize("sunk_mm", [0.0, 0.5])
@pytest.mark.parametrize("suffix", [pytest.param(".step", marks=pytest.mark.full), ".stl"])
def test_the_bone_has_the_volume_of_base_and_adapter(
    tmp_path: Path, suffix: str, sunk_mm: float
) -> None:
    design = load(save(draw(), tmp_path / f"bar{suffix}"), adapter_y_mm=POINT[1] + sunk_mm)
    base = finger.filled_bone(design).cut(sensor_recess(design), finger.cable_channel(design))
    shared = sunk_mm * SIZE[0] * SIZE[1]
    mesh = MeshEvaluator(0.01)
    bone = mesh.manifold(finger.bone(design))
    adapter = mesh.manifold(place_adapter(design))
    assert adapter.volume() == pytest.approx(VOLUME, abs=0.005 * 2 * math.pi * 1.5 * SIZE[0])
    assert bone.volume() == pytest.approx(
        mesh.manifold(base).volume() + adapter.volume() - shared, rel=1e-6
    )
    assert (bone.genus(), part_genus(design, "bone"), len(bone.decompose())) == (2, 2, 1)
    middle = (design.dimensions.bone_outline.section.dorsal - design.dimensions.base_flat_depth) / 2
    low = (-SIZE[0] / 2, middle - SIZE[1] / 2, -design.bone.base_length_mm - SIZE[2] + sunk_mm)
    assert adapter.bounding_box() == pytest.approx([*low, *np.add(low, SIZE)], abs=1e-4)
    if suffix == ".step":
        from fingertip.cad.kernel import brep

        exact = brep.BrepEvaluator()
        solid = exact.solid(finger.bone(design))
        assert brep.volume(solid) == pytest.approx(
            brep.volume(exact.shape(base)) + VOLUME - shared, rel=1e-6
        )
        assert brep.genus(solid) == 2


@pytest.mark.parametrize("axis", ["x", "-x", "y", "-y", "z", "-z"])
def test_an_axis_of_the_file_comes_to_point_to_the_tip_and_a_turn_is_about_it(
    tmp_path: Path, axis: str
) -> None:
    cq = pytest.importorskip("cadquery")
    way = np.eye(3)["xyz".index(axis[-1])] * (-1.0 if axis[0] == "-" else 1.0)
    end = {f"adapter_{name}_mm": float(value) for name, value in zip("xyz", 5 * way, strict=True)}
    path = save(cq.Workplane().box(10, 10, 10), tmp_path / "box.stl")
    designs = [load(path, adapter_axis=axis, adapter_turn_deg=turn, **end) for turn in (0.0, 90.0)]
    first, second = (np.array(place_adapter(design).rows)[:, :3] for design in designs)
    assert (first @ way).tolist() == [0.0, 0.0, 1.0]
    assert np.linalg.det(first) == 1.0
    assert second.tolist() == (np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]) @ first).tolist()


def write_stl(path: Path, change: Callable[[Mesh], Mesh] = lambda mesh: mesh) -> Path:
    path.write_bytes(stl.to_bytes(change(stl.from_bytes(save(draw(), path).read_bytes())), "bar"))
    return path


def write_inches(path: Path) -> None:
    text = save(draw(), path).read_text()
    mm = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) );"
    assert mm in text
    inch = (
        "( CONVERSION_BASED_UNIT('INCH',#9001) LENGTH_UNIT() NAMED_UNIT(#9003) );\n#9001 = "
        "LENGTH_MEASURE_WITH_UNIT("
        f"LENGTH_MEASURE(25.4),#9002);\n#9002 = {mm}\n#9003 = "
        "DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);"
    )
    path.write_text(text.replace(mm, inch))


def write_two(path: Path) -> Path:
    cq = pytest.importorskip("cadquery")
    return save(
        cq.Workplane().add([draw().val(), cq.Solid.makeSphere(3, cq.Vector(99, 0, 0))]).combine(),
        path,
    )


def write_hollow(path: Path) -> Path:
    cq = pytest.importorskip("cadquery")
    return save(draw().cut(cq.Workplane().sphere(1).translate((POINT[0], 15.3, POINT[2]))), path)


UNUSABLE: dict[str, tuple[str, Callable[[Path], object]]] = {
    "not closed": (
        "a.stl",
        lambda path: write_stl(path, lambda mesh: replace(mesh, triangles=mesh.triangles[1:])),
    ),
    "inside out": (
        "a.stl",
        lambda path: write_stl(path, lambda m: replace(m, triangles=m.triangles[:, ::-1])),
    ),
    "is 0.5512 mm long; export it in mm": (
        "a.stl",
        lambda path: write_stl(path, lambda mesh: replace(mesh, vertices=mesh.vertices / 25.4)),
    ),
    "no whole STL file": (
        "a.stl",
        lambda path: path.write_bytes(write_stl(path).read_bytes()[:-1]),
    ),
    "holds 2 bodies; unite them": ("a.stl", write_two),
    "hollow without a mouth": ("a.stl", write_hollow),
    "is neither .step, .stp nor .stl": ("a.obj", lambda path: path.write_text("")),
    "is a link": ("a.stl", lambda path: path.symlink_to(write_stl(path.with_name("b.stl")))),
    "No such file": ("a.step", lambda path: None),
    "is drawn in inch; export it in mm": ("a.step", write_inches),
    "holds 2 solids; unite those of an assembly": ("a.step", write_two),
    "holds no solid": ("a.step", lambda path: save(draw().faces(">Y"), path)),
    "no whole STEP file": ("a.stp", lambda path: path.write_text("ISO-10303-21;")),
}


@pytest.mark.parametrize(
    "reason",
    [
        pytest.param(key, marks=[pytest.mark.full] * (".st" in name and name != "a.stl"), id=key)
        for key, (name, _) in UNUSABLE.items()
    ],
)
def test_a_file_that_cannot_be_used_is_refused_with_the_reason(tmp_path: Path, reason: str) -> None:
    name, write = UNUSABLE[reason]
    write(tmp_path / name)
    with pytest.raises(DesignError, match=re.escape(reason)) as refused:
        load(tmp_path / name)
    assert refused.value.issues[-1].field == "bone.adapter_file"


@pytest.mark.second
def test_an_adapter_off_its_place_is_refused_with_the_one_that_passes(tmp_path: Path) -> None:
    path = write_stl(tmp_path / "bar.stl")
    for axis, place_mm, reason in (
        ("y", 2.0, "a gap of 1 mm between adapter and base; at least 3 mm."),
        ("y", 22.0, "beside it or wholly within it; 3 mm."),
        ("x", 40.0, "touches 0% of the end of the base"),
    ):
        with pytest.raises(DesignError, match=reason):
            load(path, **{f"adapter_{axis}_mm": place_mm})
    centred = load(path)
    section = centred.dimensions.bone_outline.section
    flat = centred.dimensions.base_flat_depth
    heights = np.linspace(-flat, section.dorsal, 4001)
    end_mm2 = 2 * np.mean([section.half_width_at(y) for y in heights]) * (flat + section.dorsal)
    measured = adapter._measure(centred)
    expected = (0.0, SIZE[0] * SIZE[1] / end_mm2)
    assert (measured.reach_mm, measured.share) == pytest.approx(expected, abs=2e-3)
    (tmp_path / "d.toml").write_text('bone.interface = "file"\nbone.adapter_file = "../bar.stl"')
    with pytest.raises(DesignError, match="is no name of a file beside the design file"):
        Design.load(tmp_path / "d.toml")


@pytest.mark.full
def test_a_folder_holds_the_adapter_beside_the_design_and_is_made_of_it_again(
    tmp_path: Path,
) -> None:
    """An STL file gives no exact bone; mold and skin are those of a finger with another
    interface.
    """
    path = write_stl(tmp_path / "bar.stl")
    made = build(load(path), tmp_path / "a", formats=["stl", "step"])
    assert [check.name for check in made.checks if not check.passed] == []
    again = build(
        Design.load(tmp_path / "a" / "design.toml"), tmp_path / "b", formats=["stl", "step"]
    )
    assert made.contents == again.contents
    assert made.contents["adapter.stl"] == path.read_bytes()
    assert made.contents.keys() >= {"bone.stl", "core.step", "assembly.step"}
    assert "bone.step" not in made.contents
    other = build(Design.load("fsr400"), tmp_path / "c", formats=["stl"])
    for name in ("skin.stl", "core.stl", "mold_palmar.stl", "mold_dorsal.stl"):
        assert made.contents[name] == other.contents[name]
    manifests = [(tmp_path / name / "manifest.json").read_bytes() for name in "ab"]
    assert manifests[0] == manifests[1]


def test_walls_of_an_adapter_are_measured(tmp_path: Path) -> None:
    cq = pytest.importorskip("cadquery")
    pocket = cq.Workplane().box(6.5, 10.0, 4.0).translate((POINT[0], 13.0, POINT[2]))
    design = load(save(draw().cut(pocket), tmp_path / "tube.stl"))
    checks = {
        check.name: check
        for check in verify(design, ("bone",), ("stl",), MeshEvaluator(0.02)).checks
    }
    assert checks["bone.wall.adapter"].value == pytest.approx(0.5, abs=0.01)
    failed = [name for name, check in checks.items() if not check.passed]
    assert [name for name in failed if "safety" not in name] == ["bone.wall.adapter"]
