"""`fingertip calibrate printer`: scale and offset from two
readings, and the readings that it refuses.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.calibration.printer import CALIPER_MM, calibrate_printer, find_nominal_mm
from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from fingertip.models.parts import parts_by_name
from tests.conftest import run_fingertip

DESIGN = Design.load("first_finger")
HALF, PLATE = find_nominal_mm(DESIGN)


def test_nominal_lengths_are_those_of_the_files() -> None:
    parts = parts_by_name(DESIGN)
    evaluator = MeshEvaluator(0.05)
    sizes = {
        name: evaluator.manifold(parts[name].solid(DESIGN)).bounding_box()
        for name in ("mold_palmar", "core")
    }
    assert sizes["mold_palmar"][4] - sizes["mold_palmar"][1] == pytest.approx(HALF)
    assert sizes["core"][3] - sizes["core"][0] == pytest.approx(PLATE)
    larger = find_nominal_mm(DESIGN.with_values({"printer.scale_percent": 101.0}))
    assert larger == pytest.approx((1.01 * HALF, 1.01 * PLATE))


@pytest.mark.parametrize(
    ("scale", "offset_mm"), [(1.0, 0.0), (1.005, 0.1), (0.99, -0.2), (1.004, 0.3)]
)
def test_scale_and_offset_are_found(scale: float, offset_mm: float) -> None:
    found = calibrate_printer(DESIGN, scale * HALF + offset_mm, scale * PLATE + offset_mm)
    assert (found.scale, found.offset_mm) == pytest.approx((scale, offset_mm))
    assert found.changes["printer.offset_mm"] == pytest.approx(offset_mm)
    assert found.changes.get("printer.scale_percent", 100.0) == pytest.approx(
        100.0 / scale, abs=0.01
    )
    # What is printed of the calibrated design changes nothing more.
    again = DESIGN.with_values(found.changes)
    half, plate = (scale * nominal + offset_mm for nominal in find_nominal_mm(again))
    assert calibrate_printer(again, half, plate).changes == pytest.approx(
        {"printer.offset_mm": offset_mm}
    )


def test_one_reading_gives_the_offset_alone() -> None:
    found = calibrate_printer(DESIGN, HALF + 0.1)
    assert found.changes == pytest.approx({"printer.offset_mm": 0.1})
    assert CALIPER_MM < found.offset_uncertainty_mm < 2 * CALIPER_MM


@pytest.mark.parametrize(
    ("readings", "said"),
    [
        ((float("nan"),), "half_thickness_mm: nan mm is more than"),
        ((-HALF,), "mm off the"),
        ((HALF / 25.4,), "looks like inches"),
        ((HALF, PLATE / 10), "plate_width_mm: .* looks like centimetres"),
        ((PLATE, HALF), "half_thickness_mm: (?s:.*)plate_width_mm: "),
        ((HALF + 0.35, PLATE + 0.35), "half_thickness_mm and plate_width_mm: .* offset of 0.35 mm"),
        ((HALF + 0.3, PLATE - 0.6), "scale of 97.2 %"),
    ],
)
def test_what_cannot_be_a_reading_is_refused(readings: tuple[float, ...], said: str) -> None:
    with pytest.raises(DesignError) as caught:
        calibrate_printer(DESIGN, *readings)
    assert re.search(said, "\n".join(map(str, caught.value.issues)))


def test_command_writes_the_design_that_its_lines_give(tmp_path: Path) -> None:
    readings = (
        f"--half-thickness-mm={HALF + 0.1:.2f}",
        f"--plate-width-mm={1.005 * PLATE + 0.1:.2f}",
    )
    done = run_fingertip(
        "calibrate", "printer", "first_finger", *readings, "--out", "mine.toml", PWD=str(tmp_path)
    )
    assert done.returncode == 0, done.stderr
    (changes,) = (
        line.split()[1::2] for line in done.stdout.splitlines() if line.startswith("--set ")
    )
    assert all(change.replace("=", " = ") in done.stdout.splitlines() for change in changes)
    typed = Design.load("first_finger", changes=changes)
    assert Design.load(tmp_path / "mine.toml") == typed.model_copy(update={"name": "mine"})
    refused = run_fingertip(
        "calibrate", "printer", "first_finger", readings[0], "--out=mine.toml", PWD=str(tmp_path)
    )
    assert "mine.toml: exists and is not overwritten" in refused.stderr
