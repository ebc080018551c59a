"""Fit of scale and offset against numpy, and the parameters and designs that follow from it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fingertip.cad.kernel.mesh import MeshEvaluator
from fingertip.cad.shapes.coupon_layout import WALLS_MM
from fingertip.cad.shapes.parts import parts_by_name
from fingertip.cad.verification.verify import verify
from fingertip.calibration.printer import (
    CALIBRATED,
    CLEARANCES,
    Calibration,
    apply_calibration,
    calibrate_printer,
    find_kept,
    fit_printer,
)
from fingertip.calibration.readings import check_readings
from fingertip.catalogues.bundled import list_bundled_files
from fingertip.catalogues.file_kinds import DESIGN as DESIGN_KIND
from fingertip.design import Design
from fingertip.foundation.errors import DesignError
from fingertip.foundation.numerics import chi_square_probability, chi_square_quantile, t_probability, t_quantile
from tests.calibration.simulated import NOISE_MM, OFFSET_MM, SCALE, THINNEST_MM, measured, simulate
from tests.conftest import some_of

DESIGNS = sorted(list_bundled_files(DESIGN_KIND))


def calibration_of(
    design: Design, seed: int = 0, offset_mm: float = OFFSET_MM, keep: tuple[str, ...] = ()
) -> Calibration:
    tables = simulate(design, seed, offset_mm=offset_mm)
    return calibrate_printer(design, check_readings(tables, design, "r.toml"), keep)


def test_values_compensate_scale_and_offset() -> None:
    design = Design().with_values({"printer.surface_error_mm": 0.0})
    values = {value.path: value for value in calibration_of(design).values}
    assert tuple(values) == CALIBRATED
    assert any("heights were not measured" in why for why in calibration_of(Design()).kept), "0.05 mm is not lowered"
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
    for mm in WALLS_MM:
        tables[f"wall_{mm:.1f}_mm".replace(".", "_")] = [mm]
    assert wall() == min(WALLS_MM), "thinner ones were not tried"
    tables["wall_1_2_mm"] = []
    assert wall() is None
    for name in [name for name in tables if name.startswith("wall_")]:
        tables[name] = []
    assert wall() is None


def test_surface_error_covers_95_of_100_surfaces() -> None:
    """A length errs by two surfaces of 0.02 mm each; of single surfaces 95 % stay below t times that."""
    design, errors = Design().with_values({"printer.surface_error_mm": 0.0}), []
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
    first = apply_calibration(Design(), calibration_of(Design()).changes)
    again = calibration_of(first, seed=1)
    for value in again.values:
        if value.path in ("printer.scale_percent", "printer.offset_mm", *CLEARANCES):
            assert value.low - 0.01 <= value.before <= value.high + 0.01, value.path


@pytest.mark.every_case
@pytest.mark.parametrize("name", some_of(DESIGNS, "fsr400", "adult_finger", "child_finger"))
def test_calibrated_design_passes_all_rules(name: str) -> None:
    design = Design.load(name)
    calibrated = apply_calibration(design, calibration_of(design).changes)
    assert calibrated.printed_fit_mm == pytest.approx(design.printed_fit_mm, abs=1e-9)


def test_a_parameter_that_must_be_kept_is_found() -> None:
    """An offset of 0.15 mm widens the pocket of an FSR 402 beyond its flat."""
    design = Design.load("fsr402")
    made = calibration_of(design, offset_mm=0.15)
    with pytest.raises(DesignError, match=r"at least .*"):
        apply_calibration(design, made.changes)
    assert find_kept(design, made, lambda tried: True) == "sensor.clearance_mm"
    apply_calibration(design, calibration_of(design, offset_mm=0.15, keep=("sensor.clearance_mm",)).changes)


@pytest.mark.full
@pytest.mark.parametrize("name", some_of(DESIGNS, "fsr400", "adult_finger", "child_finger"))
def test_calibrated_design_passes_all_checks(name: str) -> None:
    design = Design.load(name)
    calibrated = apply_calibration(design, calibration_of(design).changes)
    checks = verify(calibrated, parts_by_name(calibrated), ("stl",), MeshEvaluator(0.01)).checks
    assert [check for check in checks if not check.passed] == []


DRAWS = 500


@pytest.fixture(scope="module")
def design() -> Design:
    return Design()


def test_fit_is_that_of_numpy_over_all_readings(design: Design) -> None:
    """With different numbers of readings, so that the weights matter."""
    rows = [type(r)(r.length, r.readings_mm[: 2 + i % 3]) for i, r in enumerate(measured(design, simulate(design, 1)))]
    fit = fit_printer(rows)
    model = np.array(
        [(r.length.nominal_mm, 1.0 if r.length.kind == "outer" else -1.0) for r in rows for _ in r.readings_mm]
    )
    readings = np.array([value for r in rows for value in r.readings_mm])
    solution, *_ = np.linalg.lstsq(model, readings, rcond=None)
    assert (fit.scale, fit.offset_mm) == pytest.approx(tuple(solution), rel=1e-9)
    weights = np.array([len(r.readings_mm) for r in rows])
    first = np.cumsum(weights) - weights
    means = np.array([r.mean_mm for r in rows])
    variance = (weights * (means - model[first] @ solution) ** 2).sum() / (len(rows) - 2)
    covariance = variance * np.linalg.inv(model.T @ model)
    assert fit.scale_uncertainty == pytest.approx(covariance[0, 0] ** 0.5, rel=1e-9)
    assert fit.offset_uncertainty_mm == pytest.approx(covariance[1, 1] ** 0.5, rel=1e-9)
    assert (fit.degrees, fit.readings) == (len(rows) - 2, len(readings))


def covered(design: Design, **noise: float) -> tuple[int, int, float, float]:
    """Numbers of draws whose intervals hold the true scale and the true offset, and mean half widths of both."""
    scale = offset = 0
    widths = []
    for seed in range(DRAWS):
        fit = fit_printer(measured(design, simulate(design, seed, **noise)))
        half_scale = fit.coverage_factor * fit.scale_uncertainty
        half_offset = fit.coverage_factor * fit.offset_uncertainty_mm
        scale += abs(fit.scale - SCALE) <= half_scale
        offset += abs(fit.offset_mm - OFFSET_MM) <= half_offset
        widths.append((half_scale, half_offset))
    mean_scale, mean_offset = np.mean(widths, axis=0)
    return scale, offset, float(mean_scale), float(mean_offset)


@pytest.mark.full
def test_intervals_hold_the_truth_in_95_of_100_draws(design: Design) -> None:
    """Scale 0.5 % and offset 0.1 mm, readings with 0.02 mm: the intervals are right, and narrow enough to be used.

    Repeated readings do not average away an error of the surfaces, so they must not narrow the intervals.
    """
    stats = pytest.importorskip("scipy.stats")
    low, high = stats.binom.ppf([0.0005, 0.9995], DRAWS, 0.95)
    narrow, wide = covered(design), covered(design, length_error_mm=0.03)
    for scale, offset, *_ in (narrow, wide):
        assert low <= scale <= high
        assert low <= offset <= high
    assert narrow[2] < 0.0004, "0.04 %, or 0.02 mm on the whole frame; the error is 0.5 %"
    assert narrow[3] < 0.009, "a tenth of the offset"
    assert wide[3] > 2 * narrow[3]


def test_a_slip_of_the_calipers_is_named(design: Design) -> None:
    tables = simulate(design, 3)
    tables["slot_mm"][2] = round(tables["slot_mm"][2] + 0.3, 2)
    (outlier,) = fit_printer(measured(design, tables)).outliers
    assert (outlier.name, outlier.number, outlier.reading_mm) == ("slot_mm", 3, tables["slot_mm"][2])
    assert outlier.deviation_mm == pytest.approx(0.3, abs=4 * NOISE_MM)


def test_a_length_measured_in_the_wrong_place_is_doubted(design: Design) -> None:
    """All of its readings agree, so that none of them is an outlier by itself."""
    tables = simulate(design, 3)
    tables["slot_mm"] = [reading + 0.25 for reading in tables["slot_mm"]]
    fit = fit_printer(measured(design, tables))
    assert [each.name for each in fit.residuals if each.is_doubtful] == ["slot_mm"]
    sound = [fit_printer(measured(design, simulate(design, seed))).residuals for seed in range(100)]
    assert sum(any(each.is_doubtful for each in residuals) for residuals in sound) <= 5


def test_quantiles_are_those_of_scipy() -> None:
    stats = pytest.importorskip("scipy.stats")
    wrong = []
    for degrees in (1, 2, 3, 4, 7, 11, 12, 30, 101):
        for share in (0.5, 0.95, 0.999):
            ours = (t_quantile(share, degrees), chi_square_quantile(share, degrees))
            scipys = (stats.t.ppf((1 + share) / 2, degrees), stats.chi2.ppf(share, degrees))
            if ours != pytest.approx(scipys, rel=1e-8):
                wrong.append((degrees, share, ours, scipys))
    assert wrong == []


def test_closed_forms() -> None:
    """Cauchy's distribution for one degree of freedom, an exponential one for two."""
    assert t_probability(1.0, 1) == pytest.approx(0.5)
    assert t_probability(math.sqrt(2.0), 2) == pytest.approx(math.sqrt(0.5))
    assert chi_square_probability(2.0, 2) == pytest.approx(1.0 - math.exp(-1.0))
    assert chi_square_probability(1.0, 1) == pytest.approx(math.erf(math.sqrt(0.5)))
