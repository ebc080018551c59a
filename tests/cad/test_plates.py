"""Files for the printer: poses, plates read by another library, and checks that find
broken ones.
"""

from __future__ import annotations

import functools
import hashlib
import io
import json
import random
from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import ZipFile

import numpy as np
import pytest

from fingertip.cad.files import stl, threemf
from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.overhang import bed_pose
from fingertip.cad.printing.print_files import (
    PrintFiles,
    arrange,
    make_print_files,
    parts_on_plates,
)
from fingertip.cad.printing.settings import (
    FDM,
    SLA,
    choose_plate_kind,
    describe_part,
    slicer_settings,
)
from fingertip.cad.verification.printing import check_print_files
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.catalogues.output_files import PRINT_FOLDER
from fingertip.design import Design
from fingertip.models.mold_layout import LIP_GAP_MM
from fingertip.models.parts import PARTS, parts_by_name, print_scale
from fingertip.tasks.build import build
from fingertip.tasks.manifest_comparison import verify_sets
from tests.conftest import DESIGNS, design_file

if TYPE_CHECKING:
    import trimesh

TOLERANCE = 0.1
NOTE = "cast in silicone, not to be printed"


@functools.cache
def make(
    *changes: str, name: str = "fsr400"
) -> tuple[Design, dict[str, Mesh], dict[str, str], PrintFiles]:
    """Meshes of a design, the same as text, and the files for the printer."""
    design = Design.load(design_file(name), changes=changes)
    evaluator = MeshEvaluator(TOLERANCE)
    meshes = {
        name: evaluator.mesh(part.solid(design).scaled(print_scale(design, part)))
        for name, part in parts_by_name(design).items()
    }
    encoded = {name: threemf.encode_mesh(mesh) for name, mesh in meshes.items()}
    return design, meshes, encoded, make_print_files(design, meshes, encoded, with_stl=True)


def failed(
    design: Design, meshes: Mapping[str, Mesh], encoded: Mapping[str, str], prints: PrintFiles
) -> set[str]:
    """Names of the checks that fail."""
    return {
        check.name
        for check in check_print_files(design, meshes, encoded, prints)
        if not check.passed
    }


def test_a_part_is_described_as_its_settings_print_it() -> None:
    design = Design()
    for part, pose in print_orientations(design).items():
        printed = FDM, part, pose, supports_by_part(design)[part]
        settings = dict(slicer_settings(*printed))
        text = describe_part(*printed, design.strength.material)
        brim = (
            "no brim" if settings["brim_type"] == "no_brim" else f"brim {settings['brim_width']} mm"
        )
        layers = (
            f"Layers {settings['layer_height']} mm, {settings['perimeters']} walls of a 0.4 "
            "mm nozzle, infill "
        )
        assert text.replace(" %", "%").startswith(
            f"{layers}{settings['fill_density']}, {brim}. As it lies here: on "
        )


def placed_on(plate: bytes) -> dict[str, trimesh.Trimesh]:
    """Objects of a plate where they stand, as trimesh reads them."""
    import trimesh

    scene = trimesh.load(io.BytesIO(plate), file_type="3mf")
    assert isinstance(scene, trimesh.Scene)
    found = {}
    for node in scene.graph.nodes_geometry:
        matrix, name = scene.graph[node]
        mesh = scene.geometry[name].copy()
        mesh.apply_transform(matrix)
        found[name] = mesh
    return found


@pytest.mark.full
@pytest.mark.parametrize("name", [*DESIGNS, *PRESETS])
def test_plates_of_bundled_designs_hold_all_printed_parts_apart_on_the_bed(name: str) -> None:
    design, meshes, encoded, prints = make(name=name)
    assert failed(design, meshes, encoded, prints) == set()
    bed = np.array([design.printer.bed_x_mm, design.printer.bed_y_mm, design.printer.bed_z_mm])
    kind = choose_plate_kind(design)
    (plate,) = prints.plates  # one is enough for each bundled design
    placed = placed_on(prints.contents[plate])
    assert set(placed) == {n for n in meshes if PARTS[n].is_printed} == set(parts_on_plates(design))
    for part, mesh in placed.items():
        assert mesh.volume == pytest.approx(meshes[part].volume(), rel=1e-9)
        assert mesh.bounds[0, 2] == pytest.approx(0.0, abs=1e-9)
        assert (mesh.bounds[0] > -1e-6).all()
        assert (mesh.bounds[1] < bed + 1e-6).all()
    for (_, one), (_, other) in combinations(placed.items(), 2):
        gap = np.maximum(one.bounds[0] - other.bounds[1], other.bounds[0] - one.bounds[1])[:2].max()
        assert gap >= kind.gap_mm - 1e-6


@pytest.mark.full
def test_part_lies_alike_in_its_own_file_and_on_a_plate() -> None:
    """Halves stand on their feet, the bone stands upright, and all have the scale of
    the printer.
    """
    design, _, _, prints = make()
    larger = make("printer.scale_percent=102")[3]
    placed = placed_on(prints.contents["plate_fdm.3mf"])
    heights = {}
    for name, mesh in placed.items():
        alone = stl.from_bytes(prints.contents[f"{name}.stl"])
        assert (alone.vertices.min(axis=0) == 0.0).all()
        shifted = mesh.vertices - mesh.bounds[0]
        extents = alone.vertices.max(axis=0)
        heights[name] = extents[2]
        turned = not np.allclose(shifted.max(axis=0), extents, atol=1e-6)
        assert np.allclose(sorted(shifted.max(axis=0)[:2]), sorted(extents[:2]), atol=1e-6)
        assert turned or np.allclose(
            np.sort(shifted[:, 2]), np.sort(alone.vertices[:, 2]), atol=1e-6
        )
        scaled_up = stl.from_bytes(larger.contents[f"{name}.stl"]).vertices.max(axis=0)
        assert scaled_up == pytest.approx(1.02 * extents, abs=0.05)
    height = design.mold_layout.foot_z - LIP_GAP_MM
    assert heights["mold_palmar"] == heights["mold_dorsal"] == pytest.approx(height, abs=1e-4)
    with pytest.raises(ValueError, match="30 degrees are no quarter turns"):
        bed_pose(make()[1]["bone"], 30.0)


@pytest.mark.parametrize(
    ("material", "plate", "holds"),
    [
        ("petg", "plate_fdm.3mf", True),
        ("clear", "plate_sla.3mf", True),
        ("pa12", "plate_fdm.3mf", False),
    ],
)
def test_plate_is_for_the_printer_of_the_bone_if_there_is_one(
    material: str, plate: str, holds: bool
) -> None:
    prints = make(f"strength.print_material={material}")[3]
    assert {plate: "bone" in parts for plate, parts in prints.plates.items()} == {plate: holds}


def test_parts_that_fit_only_behind_each_other_have_the_gap_in_the_middle_of_the_bed() -> None:
    (plate,) = arrange(dict.fromkeys("abc", (60.0, 30.0)), (100.0, 100.0), 2.0)
    assert [(part.name, part.x, part.y) for part in plate] == [
        ("a", 20.0, 3.0),
        ("b", 20.0, 35.0),
        ("c", 20.0, 67.0),
    ]
    # Turned, each stands alone.
    row, alone = arrange(dict.fromkeys("abc", (45.0, 60.0)), (100.0, 90.0), 2.0)
    assert [(part.x, part.y) for part in row] == [(4.0, 15.0), (51.0, 15.0)]
    assert [(part.name, part.x, part.y) for part in alone] == [("c", 27.5, 15.0)]


def test_small_bed_takes_several_plates() -> None:
    design, meshes, encoded, prints = make("printer.bed_x_mm=60", "printer.bed_y_mm=60")
    assert list(prints.plates)[:2] == ["plate_fdm_1.3mf", "plate_fdm_2.3mf"]
    assert failed(design, meshes, encoded, prints) == set()
    assert sorted(part for parts in prints.plates.values() for part in parts) == sorted(
        parts_on_plates(design)
    )
    found = failed(*make("printer.bed_x_mm=40", "printer.bed_y_mm=40"))
    assert found == {"plate.bed_excess"}, "a part is larger than the bed"


@pytest.mark.parametrize(
    ("change", "check"),
    [
        (lambda item: replace(item, shift=(item.shift[0] + 1.0, *item.shift[1:])), "gap"),
        (lambda item: replace(item, shift=(*item.shift[:2], item.shift[2] + 0.1)), "bed_distance"),
        (
            lambda item: replace(item, shift=(item.shift[0], item.shift[1] - 72.0, item.shift[2])),
            "bed_excess",
        ),
        (lambda item: replace(item, name="bone"), "wrong_parts"),
        (lambda item: replace(item, mesh=item.mesh.replace('v1="', 'v1="1', 1)), "wrong_parts"),
        (lambda item: replace(item, rotation=np.diag([1.0, -1.0, -1.0])), "bed_distance"),
    ],
)
def test_broken_plate_fails(change: Callable[[Any], Any], check: str) -> None:
    """The first object of the FDM plate is another one."""
    design, meshes, encoded, prints = make()
    first, *others = threemf.read_items(prints.contents["plate_fdm.3mf"])
    plate = threemf.write_items("plate", [change(first), *others])
    broken = replace(prints, contents={**prints.contents, "plate_fdm.3mf": plate})
    assert f"plate.{check}" in failed(design, meshes, encoded, broken)


def test_broken_part_for_the_printer_fails() -> None:
    design, meshes, encoded, prints = make()
    bone = stl.from_bytes(prints.contents["bone.stl"])
    for broken, check in (
        (replace(bone, vertices=bone.vertices + np.array([0.0, 0.0, 0.25])), "bed_distance"),
        (replace(bone, triangles=bone.triangles[1:]), "open_edges"),
        (replace(bone, vertices=bone.vertices * 1.01), "volume_difference"),
    ):
        changed = replace(
            prints, contents={**prints.contents, "bone.stl": stl.to_bytes(broken, "bone")}
        )
        assert f"bone.print.stl.{check}" in failed(design, meshes, encoded, changed)


@pytest.mark.every_case
@pytest.mark.parametrize("seed", range(12))
def test_random_parts_are_placed_apart_on_as_few_plates_as_their_area_needs_twice_over(
    seed: int,
) -> None:
    rng = random.Random(seed)
    bed = (rng.uniform(60.0, 250.0), rng.uniform(60.0, 250.0))
    gap = rng.choice((FDM, SLA)).gap_mm
    sizes = {
        f"part_{i}": (rng.uniform(2.0, 58.0), rng.uniform(2.0, 58.0))
        for i in range(rng.randint(1, 6))
    }
    plates = arrange(sizes, bed, gap)
    assert sorted(part.name for plate in plates for part in plate) == sorted(sizes)
    assert len(plates) <= len(sizes)
    for plate in plates:
        for part in plate:
            assert -1e-3 <= part.x <= part.x + part.width <= bed[0] + 1e-3
            assert -1e-3 <= part.y <= part.y + part.depth <= bed[1] + 1e-3
            assert (part.depth, part.width)[:: 1 if part.is_turned else -1] == sizes[part.name]
        for one, other in combinations(plate, 2):
            assert one.distance(other) >= gap - 1e-6
    assert arrange(sizes, bed, gap) == plates
    area = sum((width + gap) * (depth + gap) for width, depth in sizes.values())
    assert len(plates) <= 1 + 3 * area / (bed[0] * bed[1])


@pytest.mark.full
def test_folder_for_the_printer_is_a_set_with_the_parts(tmp_path: Path) -> None:
    """A build of other parameters removes it, also if that makes none itself."""
    result = build(Design(), tmp_path, formats=["stl", "3mf"], tolerance_mm=TOLERANCE)
    folder = tmp_path / PRINT_FOLDER
    report = json.loads((tmp_path / "report.json").read_text())["print"]
    files = {path.name for path in folder.iterdir()} - {"manifest.json"}
    assert {name.removeprefix("print/") for name in report} == files == set(result.prints.contents)
    for name, entry in report.items():
        assert entry["sha256"] == hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()
    assert sorted(report["print/plate_fdm.3mf"]["parts"]) == [
        "bone",
        "core",
        "mold_dorsal",
        "mold_palmar",
        "stand",
    ]
    assert report["print/bone.stl"]["parts"] == ["bone"]
    # The skin says that it is not to be printed.
    assert NOTE in (tmp_path / "skin.stl").read_bytes()[:80].decode()
    with ZipFile(tmp_path / "skin.3mf") as bundle:
        assert (
            f'<metadata name="Description">{NOTE}</metadata>'
            in bundle.read("3D/3dmodel.model").decode()
        )
    assert NOTE not in (tmp_path / "bone.stl").read_bytes()[:80].decode()
    assert not list(folder.glob("skin*"))
    assert verify_sets(tmp_path)[1] == []
    other = Design.load(changes=["name=other"])
    built = build(other, tmp_path, parts=["skin"], formats=["stl"], tolerance_mm=TOLERANCE)
    assert "print/plate_fdm.3mf" in built.removed
    assert [path.name for path in folder.iterdir()] == ["manifest.json"]
    assert verify_sets(tmp_path)[1] == []
