"""PrusaSlicer reads and slices the exported files."""

from __future__ import annotations

import re
import subprocess
import zipfile
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from fingertip.cad.files import threemf
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.estimate import ERROR_PERCENT, estimate_print
from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.overhang import Pose
from fingertip.cad.printing.settings import FDM, slicer_settings
from fingertip.cad.printing.settings import LAYER_MM as SETTINGS_LAYER_MM
from fingertip.cad.printing.slicer import parse_gcode, slice_to_gcode
from fingertip.cad.shapes.bridged_ceiling import CEILING_STEPS_MM
from fingertip.cad.verification.verify import verify
from fingertip.design import Design
from fingertip.tasks.build import build
from tests.conftest import DESIGNS, design_file, some_of
from tests.tools import require_tool

COARSE = 0.05
"""Tolerance of the plates' meshes [mm], which slice faster than those of a build."""
NO_ROOM = "[error]   Pinhead width is negative!"
"""What PrusaSlicer says of one of its own automatic supports that has no room for its head, in a slot of 1.2 mm."""
LAYER_MM = 0.2


@pytest.fixture(scope="module")
def slicer() -> Path:
    return require_tool("prusa-slicer", "apt-get install prusa-slicer")


@pytest.mark.parametrize(
    "name", ["bone", *(pytest.param(n, marks=pytest.mark.full) for n in ("skin", "mold_palmar", "mold_dorsal"))]
)
def test_slicer_sees_one_manifold_part(slicer: Path, name: str, tmp_path: Path) -> None:
    """The exit code of PrusaSlicer does not report whether a mesh is manifold; its output does."""
    (part,) = build(Design(), tmp_path, parts=[name], formats=["stl", "3mf"], tolerance_mm=COARSE).parts
    for file_format in ("stl", "3mf"):
        words = [slicer, "--info", tmp_path / f"{name}.{file_format}"]
        output = subprocess.run(words, capture_output=True, text=True, check=True)
        facts = dict(line.split(" = ", 1) for line in output.stdout.splitlines() if " = " in line)
        assert facts["manifold"].strip() == "yes"
        assert facts["number_of_parts"].strip() == "1"
        assert float(facts["volume"]) == pytest.approx(part.mesh.volume(), rel=1e-5)


def support_moves(gcode: str) -> np.ndarray:
    """Ends of all moves that extrude support material, shape (n, 3) [mm]; positions of the extruder are absolute."""
    at, kind, found = {"X": 0.0, "Y": 0.0, "Z": 0.0, "E": 0.0}, False, []
    for line in gcode.splitlines():
        if line.startswith(";TYPE:"):
            kind = line.startswith(";TYPE:Support material")
        elif line.startswith(("G1 ", "G92 ")):
            words = {word[0]: float(word[1:]) for word in line.split(";")[0].split()[1:]}
            before, at = at, at | {axis: value for axis, value in words.items() if axis in at}
            if kind and at["E"] > before["E"] and words.keys() & {"X", "Y"}:
                found += [[one[axis] for axis in "XYZ"] for one in (before, at)]
    return np.array(found).reshape(-1, 3)


def in_nut_traps(design: Design, items: list[threemf.Item], points: np.ndarray) -> int:
    """Count the points that lie in a nut trap of the palmar half on its plate."""
    item = next(item for item in items if item.name == "mold_palmar")
    assert item.rotation is not None
    layout, depth = design.mold_layout, design.mold.nut_depth_mm + CEILING_STEPS_MM
    count = 0
    for x, z in layout.bolts:
        axis = item.rotation @ np.array([x, -layout.palmar_height, z]) + np.array(item.shift)
        across = np.hypot(*(points - axis)[:, :2].T)
        count += int(((across < layout.nut_circumradius) & (points[:, 2] <= depth + LAYER_MM)).sum())
    return count


@pytest.mark.full
@pytest.mark.parametrize(
    ("name", "kind"),
    [
        *((name, "fdm") for name in (*DESIGNS, "adult_thumb", "child_finger", "youth_thumb")),
        ("fsr402", "sla"),
        ("adult_finger", "sla"),
    ],
)
def test_plate_slices_without_a_complaint_and_without_supports_in_the_mold(
    slicer: Path, name: str, kind: str, tmp_path: Path
) -> None:
    """With automatic supports at 45 degrees: none stands under a mold half, and some under the bone."""
    design = Design.load(design_file(name), changes=["strength.print_material=petg"])
    plate = plate_of(design, kind)
    (tmp_path / "plate.3mf").write_bytes(plate)
    x, y = design.printer.bed_x_mm, design.printer.bed_y_mm
    command = [
        slicer, "--export-gcode", "--dont-arrange", "--bed-shape", f"0x0,{x:g}x0,{x:g}x{y:g},0x{y:g}", "--layer-height",
        f"{LAYER_MM}", "--first-layer-height", f"{LAYER_MM}", "--support-material", "--support-material-threshold",
        "45", "-o", tmp_path / "plate.gcode", tmp_path / "plate.3mf",
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert not re.search(r"\[(warning|error|fatal)\]|warning:|error:", done.stdout + done.stderr, re.IGNORECASE)
    code = (tmp_path / "plate.gcode").read_text()
    items, points = threemf.read_items(plate), support_moves(code)
    assert parse_gcode("plate", code).minutes > 60
    assert len(points) > 100
    if kind == "fdm":
        assert in_nut_traps(design, items, points) == 0
        halves = [item for item in items if item.name.startswith("mold")]
        meshes = {item.name: threemf.from_bytes(threemf.write_items("one", [item])) for item in halves}
        for item in halves:
            assert item.rotation is not None
            placed = Pose(item.rotation, item.shift).apply(meshes[item.name]).vertices
            inside = ((points > placed.min(axis=0)) & (points < placed.max(axis=0)))[:, :2].all(axis=1)
            assert not inside.any(), item.name


def plate_of(design: Design, kind: str = "fdm") -> bytes:
    prints = verify(design, print_orientations(design), ("3mf",), MeshEvaluator(COARSE)).prints
    return prints.contents[f"plate_{kind}.3mf"]


@pytest.mark.full
def test_supports_would_stand_in_the_nut_traps_without_the_settings_of_the_plate(slicer: Path) -> None:
    """The measure of the test above finds supports in nut traps where the plate does not switch them off.

    With the settings a bridge is printed in each layer of the first two steps of a trap that is wide enough for one.
    """
    design = Design()
    items = threemf.read_items(plate_of(design))
    bare = [replace(item, settings=()) for item in items]
    code = slice_to_gcode(slicer, "plate", threemf.write_items("plate", bare), design, LAYER_MM)
    assert in_nut_traps(design, bare, support_moves(code)) > 100
    half = [item for item in items if item.name == "mold_palmar"]
    code = slice_to_gcode(slicer, "plate", threemf.write_items("plate", half), design, LAYER_MM)
    heights, z = set(), 0.0
    for line in code.splitlines():
        if line.startswith(";Z:"):
            z = float(line[3:])
        elif line in (";TYPE:Bridge infill", ";TYPE:Overhang perimeter"):
            heights.add(round(z, 2))
    depth = design.mold.nut_depth_mm
    assert {round(depth + LAYER_MM, 2), round(depth + 2 * LAYER_MM, 2)} <= heights


@pytest.mark.full
def test_slicer_takes_layers_brim_and_infill_from_the_filament_plate(slicer: Path) -> None:
    """The command asks for layers of 0.2 mm without a brim, and for the usual infill of 20 %."""
    design = Design.from_tables({"strength": {"print_material": "petg"}})
    (bone,) = (item for item in threemf.read_items(plate_of(design)) if item.name == "bone")
    settings = slicer_settings(FDM, "bone", print_orientations(design)["bone"], supports_by_part(design)["bone"])
    heights, infills, brims = [], [], []
    for item in (bone, replace(bone, settings=settings)):
        code = slice_to_gcode(slicer, "plate", threemf.write_items("plate", [item]), design, LAYER_MM)
        found = Counter(round(float(z), 1) for z in re.findall(r"^;HEIGHT:([\d.]+)$", code, re.MULTILINE))
        heights.append(found.most_common(1)[0][0])
        infills.append(code.count(";TYPE:Internal infill"))
        brims.append(code.partition(";TYPE:Skirt/Brim\n")[2].partition(";TYPE:")[0].count("\nG1 X"))
    assert heights == [LAYER_MM, SETTINGS_LAYER_MM]
    assert infills[0] > 0
    assert infills[1] == 0, "it is solid"
    assert brims[1] > brims[0], "a brim beside the usual skirt"


@pytest.mark.full
@pytest.mark.parametrize("name", some_of(("fsr400", "adult_thumb"), "fsr400"))
def test_resin_plate_slices_for_a_resin_printer(slicer: Path, name: str, tmp_path: Path) -> None:
    (tmp_path / "plate.3mf").write_bytes(plate_of(Design.load(design_file(name)), "sla"))
    command = [
        slicer, "--export-sla", "--printer-technology", "SLA", "--dont-arrange", "--layer-height", "0.1", "-o",
        tmp_path / "plate.sl1", tmp_path / "plate.3mf",
    ]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    said = (done.stdout + done.stderr).replace(NO_ROOM, "")
    assert not re.search(r"\[(warning|error|fatal)\]", said, re.IGNORECASE)
    with zipfile.ZipFile(tmp_path / "plate.sl1") as sliced:
        layers = sum(name.endswith(".png") for name in sliced.namelist())
    height_mm = trimesh.load(tmp_path / "plate.3mf", force="mesh").extents[2]
    assert layers > 0.99 * height_mm / 0.05, "of 0.05 mm as the plate says, not of 0.1 mm as the command does"


@pytest.mark.full
@pytest.mark.every_case
@pytest.mark.parametrize("changes", [(), ("skin.length_mm=30",)])
def test_print_time_is_estimated_within_its_error(slicer: Path, changes: tuple[str, ...]) -> None:
    """All that a first finger needs lies on one plate, in layers of 0.15 mm with 3 walls, and prints in an evening."""
    design = Design.load("first_finger", changes=changes)
    prints = verify(design, print_orientations(design), ("3mf",), MeshEvaluator(COARSE)).prints
    assert set(prints.plates["plate_fdm.3mf"]) == {"bone", "mold_palmar", "mold_dorsal", "core", "stand"}
    code = slice_to_gcode(slicer, "plate", prints.contents["plate_fdm.3mf"], design, 0.15)
    sliced, estimated = parse_gcode("plate", code), estimate_print(design)
    assert estimated.minutes == pytest.approx(sliced.minutes, rel=ERROR_PERCENT / 100.0)
    assert estimated.filament_cm3 == pytest.approx(sliced.filament_cm3, rel=0.06)
    if not changes:
        assert max(estimated.minutes, sliced.minutes) <= 270.0
    assert not len(support_moves(code)), "nothing stands on supports"
