"""Files of readings and the plan of the coupon: template, refusals of what cannot be a reading, places on the mesh."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import Mesh, MeshEvaluator
from fingertip.cad.shapes.coupon import COUPON_PARTS, list_heights
from fingertip.calibration.readings import (
    MIN_LENGTH_MM,
    Length,
    check_readings,
    list_lengths,
    read_readings,
    write_template,
)
from fingertip.design import Design
from fingertip.foundation.errors import DesignError, TomlFileError
from fingertip.pictures import coupon_plan
from fingertip.pictures.coupon_plan import draw_plan
from tests.approved import check_figures
from tests.calibration.simulated import simulate, to_toml
from tests.conftest import ROOT, design_file, some_of
from tests.drawing.test_printed_sizes import calibrated
from tests.view.describe import PenRecord, describe_pixels

DESIGN = Design()


def refuse(changes: dict[str, Any]) -> list[str]:
    """Messages about sound readings with changes."""
    with pytest.raises(DesignError) as caught:
        check_readings(simulate(DESIGN, 0) | changes, DESIGN, "r.toml")
    return [str(issue) for issue in caught.value.issues]


def test_template_has_every_length_with_its_nominal_value_and_place() -> None:
    text = write_template(DESIGN)
    tables = tomllib.loads(text)
    lengths = {length.name: length for length in list_lengths(DESIGN)}
    assert tables.keys() - {"coupon"} == lengths.keys()
    assert all(tables[name] == [] for name in lengths)
    for line in text.splitlines():
        if (name := line.partition(" = ")[0]) in lengths:
            assert f": nominal {lengths[name].nominal_mm:.3f}. {lengths[name].where}" in line
    assert {length.kind for length in lengths.values()} == {"outer", "inner", "wall"}
    assert min(length.nominal_mm for length in lengths.values() if length.kind != "wall") >= MIN_LENGTH_MM


def test_nominal_lengths_are_those_of_the_files() -> None:
    """The scale of the files is part of them, so a coupon of a scaled design is another one."""
    scaled = Design.load(changes=["printer.scale_percent=99.5"])
    for plain, other in zip(list_lengths(DESIGN), list_lengths(scaled), strict=True):
        assert other.nominal_mm == pytest.approx(0.995 * plain.nominal_mm, abs=1e-6)
    (issue,) = refuse({"coupon": simulate(scaled, 0)["coupon"]})
    assert "is another coupon than that of fsr400" in issue


@pytest.mark.every_case
@pytest.mark.parametrize(
    ("readings", "message"),
    [
        (["10,02", 10.0, 10.0], "slot_mm: reading 1, '10,02', is text; write the number in mm with a decimal point"),
        ([10.02, 10, 10.0], "slot_mm: reading 2, 10, is a whole number, as a decimal comma leaves two of them"),
        ([10.02, -10.0, 10.0], "slot_mm: reading 2, -10 mm, is not positive"),
        ([10.02, 10.0, 0.0], "slot_mm: reading 3, 0 mm, is not positive"),
        ([math.nan, 10.0, 10.0], "slot_mm: reading 1, nan, is not a length"),
        ([math.inf, 10.0, 10.0], "slot_mm: reading 1, inf, is not a length"),
        ([True, 10.0, 10.0], "slot_mm: reading 1, True, is not a length"),
        ([0.394, 10.0, 10.0], "slot_mm: reading 1, 0.394, looks like inches; write it in millimetres, about 10.00."),
        ([1.01, 10.0, 10.0], "slot_mm: reading 1, 1.01, looks like centimetres"),
        ([11.2, 10.0, 10.0], "slot_mm: reading 1, 11.2 mm, is more than 0.5 mm off the nominal 10.00 mm"),
        (10.0, "slot_mm: 10.0 is no list of readings; write 3 or more in square brackets."),
        ([10.0, 10.1], "slot_mm: 2 readings cannot show a slip; at least 3, or none."),
    ],
)
def test_a_value_that_is_no_reading_is_refused(readings: Any, message: str) -> None:
    (issue,) = refuse({"slot_mm": readings})
    assert issue.startswith(message)


def test_all_faults_are_reported_at_once() -> None:
    issues = refuse({"slt_mm": [1.0], "outer_x_mm": ["x", -1.0], "coupon": "00000000", "tongue_mm": 3.0})
    assert [issue.partition(":")[0] for issue in issues] == [
        "coupon", "outer_x_mm", "outer_x_mm", "tongue_mm", "slt_mm",
    ]  # fmt: skip
    assert "did you mean slot_mm?" in issues[-1]


def test_too_few_lengths_are_refused_with_the_names_of_others() -> None:
    inner = {length.name: [] for length in list_lengths(DESIGN) if length.kind == "inner"}
    inner["slot_mm"] = [10.0, 10.01, 10.0]
    (issue,) = refuse(inner)
    assert issue.startswith("readings: 1 inner length with readings are too few to tell scale from offset; at least 3")
    assert "window_x_mm and window_y_mm" in issue


def test_a_decimal_comma_and_another_file_are_named(tmp_path: Path) -> None:
    path = tmp_path / "r.toml"
    path.write_text(to_toml(simulate(DESIGN, 0)).replace("slot_mm = [", "slot_mm = [10,02, "))
    with pytest.raises(TomlFileError, match="write the number with a decimal point, not with a comma"):
        read_readings(path, DESIGN)
    with pytest.raises(DesignError, match="is not a file of caliper readings; `fingertip coupon` writes one"):
        read_readings(design_file("fsr400"), DESIGN)
    with pytest.raises(DesignError) as caught:
        check_readings(tomllib.loads(write_template(DESIGN)), DESIGN, "r.toml")
    assert [issue.field for issue in caught.value.issues] == ["readings", "readings"], "the empty template"


# Plan view of the coupon, and the places of its lengths and heights, found again on the mesh


FILES = sorted(path.stem for path in (ROOT / "params").glob("*.toml"))
STEP_MM = 0.1
"""Distance from the end of a length at which material begins or ends; half the thinnest wall is more."""


def meshes_of(design: Design) -> dict[str, Mesh]:
    evaluator = MeshEvaluator(0.01)
    return {name: evaluator.mesh(part.solid(design)) for name, part in COUPON_PARTS.items()}


def has_material(mesh: Mesh, x: float, y: float, z: float) -> bool:
    """Whether a point lies in a mesh: a vertical ray from it leaves once more than it enters."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    point = np.array([x + 1e-7, y + 2e-7])

    def side(p: np.ndarray, q: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
        along, to = q[:, :2] - p[:, :2], point - p[:, :2]
        found: np.ndarray = along[:, 0] * to[:, 1] - along[:, 1] * to[:, 0]  # type: ignore[type-arg]
        return found

    u, v, w = side(b, c), side(c, a), side(a, b)
    total = u + v + w
    crossed = ((u > 0) & (v > 0) & (w > 0)) | ((u < 0) & (v < 0) & (w < 0))
    heights = (u * a[:, 2] + v * b[:, 2] + w * c[:, 2])[crossed] / total[crossed]
    return bool((heights > z).sum() % 2)


def is_at_its_place(meshes: Mapping[str, Mesh], length: Length) -> bool:
    """Whether the material ends, or begins, at both ends of a length at some height."""
    (x0, y0), (x1, y1) = length.ends
    dx, dy = (STEP_MM, 0.0) if length.axis == "x" else (0.0, STEP_MM)
    within, beyond = ((x0 + dx, y0 + dy), (x1 - dx, y1 - dy)), ((x0 - dx, y0 - dy), (x1 + dx, y1 + dy))
    mesh, is_inner = meshes[length.piece], length.kind == "inner"
    for z in (0.2, 1.0, 1.5, 2.0, 3.0, 5.0):
        inside = [has_material(mesh, *point, z) for point in within]
        outside = [has_material(mesh, *point, z) for point in beyond]
        if inside == [not is_inner] * 2 and outside == [is_inner] * 2:
            return True
    return False


@pytest.mark.full
@pytest.mark.parametrize("name", some_of(FILES, "fsr400", "adult_thumb"))
def test_lengths_and_heights_are_where_the_plan_draws_them(name: str) -> None:
    design = Design.load(design_file(name))
    meshes = meshes_of(design)
    lengths = list_lengths(design)
    assert [each.name for each in lengths if not is_at_its_place(meshes, each)] == []
    for height in list_heights(design):
        below, above = height.height_mm - 0.02, height.height_mm + 0.02
        found = [has_material(meshes[height.piece], *height.at, z) for z in (below, above)]
        assert found == [True, False], height.feature
    for each in lengths:  # the place states the same length, and one that is off is found
        (x0, y0), (x1, y1) = each.ends
        assert each.nominal_mm == pytest.approx(abs(x1 - x0) + abs(y1 - y0), abs=1e-6), each.name
        dx, dy = (0.25, 0.0) if each.axis == "x" else (0.0, 0.25)
        moved = replace(each, ends=((x0 + dx, y0 + dy), (x1 + dx, y1 + dy)))
        assert not is_at_its_place(meshes, moved), each.name


def test_plan_of_a_calibrated_printer_is_the_approved_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """It states the heights of the files."""
    pen = PenRecord(monkeypatch)
    monkeypatch.setattr(coupon_plan, "_WIDTH_PX", 400)
    design = calibrated("fsr400")
    meshes = {
        name: Mesh(1.004 * mesh.vertices, mesh.triangles)
        for name, part in COUPON_PARTS.items()
        for mesh in [MeshEvaluator(0.2).mesh(part.solid(design))]
    }
    picture = draw_plan(design, meshes)
    heights = [float(height) for line in pen.lines for height in re.findall(r"'Z\d+: ([\d.]+)'", line)]
    tallest = max(mesh.vertices[:, 2].max() for mesh in meshes.values())
    assert max(heights) == pytest.approx(tallest, abs=0.006)
    check_figures(Path(__file__).parent / "approved" / "plan.txt", [*pen.lines, *describe_pixels(picture)], abs_=0.6)
