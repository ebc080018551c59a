"""PrusaSlicer reads and slices the exported files."""

from __future__ import annotations

import re
import subprocess
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fingertip.cad.files import threemf
from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.printing.orientations import print_orientations, supports_by_part
from fingertip.cad.printing.overhang import Pose
from fingertip.cad.printing.settings import FDM, PROFILE, estimate_print, slicer_settings
from fingertip.cad.verification.verify import verify
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.design import Design
from fingertip.models.parts import parts_by_name
from tests.conftest import DESIGNS, design_file
from tests.tools import require_tool

COARSE = 0.05
"""Tolerance of the plates' meshes [mm], which slice faster than those of a build."""
LAYER_MM = 0.2


@pytest.fixture(scope="module")
def slicer() -> Path:
    return require_tool("prusa-slicer", "apt-get install prusa-slicer")


def support_moves(gcode: str) -> np.ndarray:
    """Ends of all moves that extrude support material, shape (n, 3)
    [mm]; positions of the extruder are absolute.
    """
    at = {"X": 0.0, "Y": 0.0, "Z": 0.0, "E": 0.0}
    kind = False
    found = []
    for line in gcode.splitlines():
        if line.startswith(";TYPE:"):
            kind = line.startswith(";TYPE:Support material")
        elif line.startswith(("G1 ", "G92 ")):
            words = {word[0]: float(word[1:]) for word in line.split(";")[0].split()[1:]}
            before = at
            at = at | {axis: value for axis, value in words.items() if axis in at}
            if kind and at["E"] > before["E"] and words.keys() & {"X", "Y"}:
                found += [[one[axis] for axis in "XYZ"] for one in (before, at)]
    return np.array(found).reshape(-1, 3)


def slice_to_gcode(program: Path, folder: Path, plate: bytes, design: Design) -> str:
    """Slice a plate with automatic supports, unless its objects ask for none.

    Its settings come before these.
    """
    x = design.printer.bed_x_mm
    y = design.printer.bed_y_mm
    (folder / "plate.3mf").write_bytes(plate)
    command = [
        program,
        "--export-gcode",
        "--dont-arrange",
        "--bed-shape",
        f"0x0,{x:g}x0,{x:g}x{y:g},0x{y:g}",
        "--layer-height",
        f"{LAYER_MM}",
        "--first-layer-height",
        f"{LAYER_MM}",
        "--support-material",
        "--support-material-threshold",
        "45",
        "-o",
        folder / "plate.gcode",
        folder / "plate.3mf",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert not re.search(
        r"\[(warning|error|fatal)\]|warning:|error:", done.stdout + done.stderr, re.IGNORECASE
    )
    return (folder / "plate.gcode").read_text()


def read_estimate(gcode: str) -> tuple[float, float]:
    """Print time [min] and filament [cm3], as the comments at the end of the G-code state them."""
    (time,) = re.findall(r"^; estimated printing time \(normal mode\) = (.+)$", gcode, re.MULTILINE)
    (filament,) = re.findall(r"^; filament used \[cm3\] = ([\d.]+)$", gcode, re.MULTILINE)
    units = {"d": 1440.0, "h": 60.0, "m": 1.0, "s": 1.0 / 60.0}
    return sum(float(word[:-1]) * units[word[-1]] for word in time.split()), float(filament)


@pytest.mark.full
@pytest.mark.parametrize("name", [*DESIGNS, *PRESETS])
def test_plate_slices_without_a_complaint(slicer: Path, name: str, tmp_path: Path) -> None:
    """With automatic supports at 45 degrees: none stands beside a part that needs none."""
    design = Design.load(design_file(name))
    plate = plate_of(design)
    code = slice_to_gcode(slicer, tmp_path, plate, design)
    items = threemf.read_items(plate)
    points = support_moves(code)
    assert read_estimate(code)[0] > 60
    supports = supports_by_part(design)
    assert (len(points) > 100) == any(supports[item.name].places for item in items)
    for item in items:
        if not supports[item.name].places:
            mesh = threemf.from_bytes(threemf.write_items("one", [item]))
            assert item.rotation is not None
            placed = Pose(item.rotation, item.shift).apply(mesh).vertices
            inside = ((points > placed.min(axis=0)) & (points < placed.max(axis=0)))[:, :2].all(
                axis=1
            )
            assert not inside.any(), item.name


def plate_of(design: Design) -> bytes:
    prints = verify(design, print_orientations(design), ("3mf",), MeshEvaluator(COARSE)).prints
    (plate,) = prints.plates
    return prints.contents[plate]


@pytest.mark.full
def test_slicer_takes_layers_brim_and_infill_from_the_filament_plate(
    slicer: Path, tmp_path: Path
) -> None:
    """The command asks for layers of 0.2 mm without a brim, and for the usual infill of 20 %."""
    design = Design()
    (bone,) = (item for item in threemf.read_items(plate_of(design)) if item.name == "bone")
    settings = slicer_settings(
        FDM, "bone", print_orientations(design)["bone"], supports_by_part(design)["bone"]
    )
    heights = []
    filaments_cm3 = []
    brims = []
    for item in (bone, replace(bone, settings=settings)):
        code = slice_to_gcode(slicer, tmp_path, threemf.write_items("plate", [item]), design)
        found = Counter(
            round(float(z), 2) for z in re.findall(r"^;HEIGHT:([\d.]+)$", code, re.MULTILINE)
        )
        heights.append(found.most_common(1)[0][0])
        filaments_cm3.append(read_estimate(code)[1])
        brims.append(code.partition(";TYPE:Skirt/Brim\n")[2].partition(";TYPE:")[0].count("\nG1 X"))
    assert heights == [LAYER_MM, PROFILE.layer_mm]
    volume_cm3 = (
        MeshEvaluator(COARSE).manifold(parts_by_name(design)["bone"].solid(design)).volume()
        / 1000.0
    )
    assert filaments_cm3[1] == pytest.approx(volume_cm3, rel=0.05), (
        "it is solid, with a skirt and a brim"
    )
    assert brims[1] > brims[0], "a brim beside the usual skirt"


@pytest.mark.full
@pytest.mark.every_case
@pytest.mark.parametrize("changes", [(), ("skin.length_mm=30",)])
def test_print_time_is_estimated_within_its_error(
    slicer: Path, changes: tuple[str, ...], tmp_path: Path
) -> None:
    """All that a first finger needs lies on one plate, in layers of
    0.15 mm with 3 walls, and prints in an evening.
    """
    design = Design.load("first_finger", changes=changes)
    prints = verify(design, print_orientations(design), ("3mf",), MeshEvaluator(COARSE)).prints
    assert set(prints.plates["plate_fdm.3mf"]) == {
        "bone",
        "mold_palmar",
        "mold_dorsal",
        "core",
        "stand",
    }
    code = slice_to_gcode(slicer, tmp_path, prints.contents["plate_fdm.3mf"], design)
    minutes, filament_cm3 = read_estimate(code)
    estimated = estimate_print(design)
    assert estimated.minutes == pytest.approx(minutes, rel=0.15)
    assert estimated.filament_cm3 == pytest.approx(filament_cm3, rel=0.06)
    if not changes:
        assert max(estimated.minutes, minutes) <= 270.0
    assert not len(support_moves(code)), "nothing stands on supports"
