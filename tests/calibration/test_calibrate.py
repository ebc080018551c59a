"""Parameters that follow from readings, and designs that are calibrated with them."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification.verify import verify
from fingertip.calibration.printer import (
    CLEARANCES,
    Calibration,
    apply_calibration,
    calibrate_printer,
    find_kept,
    list_calibrated,
)
from fingertip.calibration.readings import check_readings
from fingertip.catalogues.bundled import list_bundled_files
from fingertip.catalogues.file_kinds import DESIGN as DESIGN_KIND
from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from tests.calibration.simulated import OFFSET_MM, SCALE, THINNEST_MM, simulate
from tests.conftest import some_of

DESIGNS = sorted(list_bundled_files(DESIGN_KIND))
NEEDS_KEEP = {"child_finger": "sensor.clearance_mm"}
"""Bundled designs that 0.1 mm of offset makes impossible, and what lets them pass: its collar is full."""


def calibration_of(
    design: Design, seed: int = 0, offset_mm: float = OFFSET_MM, keep: tuple[str, ...] = ()
) -> Calibration:
    tables = simulate(design, seed, offset_mm=offset_mm)
    return calibrate_printer(design, check_readings(tables, design, "r.toml"), keep)


def test_values_compensate_scale_and_offset() -> None:
    design = Design()
    values = {value.path: value for value in calibration_of(design).values}
    assert tuple(values) == list_calibrated()
    truth = {
        "printer.scale_percent": 100 / SCALE,
        "printer.offset_mm": OFFSET_MM,
        "sensor.clearance_mm": design.sensor.clearance_mm + OFFSET_MM / 2,
        "mold.fit_clearance_mm": design.mold.fit_clearance_mm + OFFSET_MM,
        "mold.key_clearance_mm": design.mold.key_clearance_mm + OFFSET_MM,
        "mold.nut_width_mm": design.mold.nut_width_mm + OFFSET_MM,
        "mold.bolt_diameter_mm": design.mold.bolt_diameter_mm + OFFSET_MM,
    }
    for path, true in truth.items():
        value = values[path]
        assert value.low <= true <= value.high, path
        assert value.low < value.value < value.high
        assert value.high - value.low == pytest.approx(2 * 2.201 * value.uncertainty, rel=1e-3), "11 degrees of freedom"
    assert values["printer.scale_percent"].uncertainty < 0.02
    assert values["mold.fit_clearance_mm"].uncertainty < 0.005


def test_thinnest_wall_from_which_on_all_print() -> None:
    design = Design()
    tables = simulate(design, 0)

    def wall() -> float | None:
        made = calibrate_printer(design, check_readings(tables, design, "r.toml"))
        for value in made.values:
            if value.path == "printer.min_wall_mm":
                # The limit lies anywhere between this wall and the next thinner one.
                assert value.uncertainty == pytest.approx((value.value - value.low) / 12**0.5)
        return made.changes.get("printer.min_wall_mm")

    assert wall() == THINNEST_MM
    tables["wall_0_7_mm"] = [0.41, 0.4]  # a torn one: less than 80 % of its thickness
    assert wall() == 0.8
    tables["wall_0_7_mm"] = [0.71, 0.7]
    tables["wall_1_2_mm"] = []
    assert wall() is None
    for name in [name for name in tables if name.startswith("wall_")]:
        tables[name] = []
    assert wall() is None


def test_surface_error_covers_95_of_100_surfaces() -> None:
    """A length errs by two surfaces of 0.02 mm each; of single surfaces 95 % stay below t times that."""
    design, errors = Design(), []
    for seed in range(100):
        tables = simulate(design, seed, noise_mm=0.001, length_error_mm=0.02 * math.sqrt(2.0))
        made = calibrate_printer(design, check_readings(tables, design, "r.toml"))
        (value,) = (each for each in made.values if each.path == "printer.surface_error_mm")
        errors.append((value.value, value.low <= 2.201 * 0.02 <= value.high))
    root_mean_square = np.mean([error**2 for error, _ in errors]) ** 0.5
    assert root_mean_square == pytest.approx(2.201 * 0.02, rel=0.065), "three standard deviations of 100 draws"
    assert 88 <= sum(inside for _, inside in errors) <= 100


def test_calibrating_a_calibrated_design_changes_nothing_more() -> None:
    """The printer keeps its scale and offset; neither is counted twice."""
    first = apply_calibration(Design(), calibration_of(Design()))
    again = calibration_of(first, seed=1)
    for value in again.values:
        if value.path in ("printer.scale_percent", "printer.offset_mm", *CLEARANCES):
            assert value.low - 0.01 <= value.before <= value.high + 0.01, value.path


@pytest.mark.parametrize("name", some_of(DESIGNS, "fsr400", "adult_finger", "child_finger"))
def test_calibrated_design_passes_all_rules(name: str) -> None:
    design = Design.load(name)
    made = calibration_of(design)
    if name not in NEEDS_KEEP:
        calibrated = apply_calibration(design, made)
        assert calibrated.printed_fit_mm == pytest.approx(design.printed_fit_mm, abs=1e-9)
        return
    with pytest.raises(DesignError, match=r"at most .*"):
        apply_calibration(design, made)
    assert find_kept(design, made, CLEARANCES) == NEEDS_KEEP[name]
    apply_calibration(design, calibration_of(design, keep=(NEEDS_KEEP[name],)))


@pytest.mark.full
@pytest.mark.parametrize("method", ["overmold", "sleeve"])
@pytest.mark.parametrize("name", some_of(DESIGNS, "fsr400", "adult_finger", "child_finger"))
def test_calibrated_design_passes_all_checks(name: str, method: str) -> None:
    design = Design.load(name, changes=[f"mold.method={method}"])
    keep = (NEEDS_KEEP[name],) if name in NEEDS_KEEP else ()
    calibrated = apply_calibration(design, calibration_of(design, keep=keep))
    checks = verify(calibrated, parts_by_name(calibrated), ("stl",), MeshEvaluator(0.01)).checks
    assert [check for check in checks if not check.passed] == []
