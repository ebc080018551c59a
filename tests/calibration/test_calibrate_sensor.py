"""Force curve of a sensor from weighings: the fit against numpy,
its errors and intervals, and the command.
"""

from __future__ import annotations

import json
import math
import shlex
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fingertip.board.analysis.board_values import board_values
from fingertip.calibration.printer import apply_calibration
from fingertip.calibration.sensor import (
    PowerLaw,
    calibrate_sensor,
    fit_power_law,
    list_warnings,
    parse_weighings,
    read_weighings,
)
from fingertip.cli import app
from fingertip.design import Design
from fingertip.foundation.errors import TraceError
from fingertip.sim.signal.bridge import Bridge, ConductanceCurve, fit_conductance_curve
from tests.designs import ARTICLE

DESIGN = ARTICLE
RESPONSE = board_values(DESIGN).tactile_response
TURN_ON_N = DESIGN.force_curve.turn_on_n
WEIGHTS_G = (50.0, 100.0, 200.0, 500.0, 1000.0)
WEAK = ConductanceCurve(TURN_ON_N, fit_conductance_curve().scale / 3, 0.7)
"""Sensor that conducts a third of the typical one."""


def force_at(law: PowerLaw, conductance_s: float) -> float:
    """Force of a curve [N] at a conductance [S]."""
    return law.turn_on_n + float(math.pow(conductance_s / law.conductance_s, 1.0 / law.exponent))


def run(*words: object):
    return CliRunner().invoke(app, [str(word) for word in words])


def volts(curve: ConductanceCurve, force_n: float) -> float:
    return RESPONSE.tactile_v(curve.conductance_s(force_n))


def weighings_csv(
    curve: ConductanceCurve = WEAK, delimiter: str = ",", offset_v: float = 0.0
) -> str:
    lines = [f"{g:g}{delimiter}{volts(curve, g * 9.80665e-3) + offset_v:.6f}" for g in WEIGHTS_G]
    return "\n".join([f"weight_g{delimiter}voltage_v", *lines]) + "\n"


def test_exact_readings_give_the_curve_back() -> None:
    found = calibrate_sensor(DESIGN, parse_weighings(weighings_csv(), "w.csv"))
    assert found.law.exponent == pytest.approx(0.7, abs=1e-4)
    assert found.law.conductance_s == pytest.approx(WEAK.scale, rel=1e-4)
    assert found.interval_factor == pytest.approx(1.0, abs=1e-3)
    calibrated = apply_calibration(DESIGN, found.changes)
    forces = np.array([g * 9.80665e-3 for g in WEIGHTS_G])
    assert Bridge.of_board(calibrated).voltage_v(forces) == pytest.approx(
        [volts(WEAK, f) for f in forces], abs=1e-4
    )
    assert found.points[2].voltage_v == pytest.approx(volts(WEAK, forces[2]), abs=1e-4)
    middle = forces[2]
    assert found.ratio_to_typical == pytest.approx(
        WEAK.conductance_s(middle) / fit_conductance_curve().conductance_s(middle), rel=1e-3
    )


def test_a_calibrated_design_can_be_calibrated_again() -> None:
    """The bridge keeps its resistances: they are sized for the typical sensor."""
    once = apply_calibration(
        DESIGN, calibrate_sensor(DESIGN, parse_weighings(weighings_csv(), "w.csv")).changes
    )
    assert board_values(once).tactile_response == RESPONSE
    again = apply_calibration(
        once, calibrate_sensor(once, parse_weighings(weighings_csv(), "w.csv")).changes
    )
    assert again == once


@pytest.mark.parametrize("delimiter", [",", ";", "\t"])
def test_volts_counts_ohms_and_newtons_give_one_curve(delimiter: str, tmp_path: Path) -> None:
    forces = [g * 9.80665e-3 for g in WEIGHTS_G]
    conductances = [WEAK.conductance_s(f) for f in forces]
    step = 2.0**-20
    tables = {
        "force_n;voltage_v": [RESPONSE.tactile_v(g) for g in conductances],
        "force_n;counts": [round(RESPONSE.tactile_v(g) / step) for g in conductances],
        "force_n;resistance_ohm": [1 / g for g in conductances],
    }
    for header, values in tables.items():
        lines = [
            header.replace(";", delimiter),
            *(f"{f!r}{delimiter}{v!r}" for f, v in zip(forces, values, strict=True)),
        ]
        text = "\n".join(["# weighed today", "", *lines])
        if delimiter == ";":
            text = text.replace(".", ",")
        (tmp_path / "w.csv").write_bytes(("\ufeff" + text).encode())
        found = calibrate_sensor(
            DESIGN, read_weighings(tmp_path / "w.csv"), step if "counts" in header else None
        )
        assert found.law.exponent == pytest.approx(0.7, abs=1e-4), header
        assert found.law.conductance_s == pytest.approx(WEAK.scale, rel=1e-4), header


def test_readings_without_load_take_the_offset_off() -> None:
    text = weighings_csv(offset_v=0.05) + f"0,{RESPONSE.open_v + 0.05:.6f}\n"
    found = calibrate_sensor(DESIGN, parse_weighings(text, "w.csv"))
    assert found.offset_v == pytest.approx(0.05, abs=1e-6)
    assert found.law.exponent == pytest.approx(0.7, abs=1e-4)
    without = calibrate_sensor(DESIGN, parse_weighings(weighings_csv(offset_v=0.05), "w.csv"))
    assert abs(without.law.exponent - 0.7) > 0.01


@pytest.mark.parametrize(
    ("kind", "scale", "end"), [("counts", 3.3 / 4096, 4095.0), ("voltage_v", None, 2.0)]
)
def test_weighings_at_a_limit_are_left_out_and_named(
    kind: str, scale: float | None, end: float
) -> None:
    """The readings of the largest loads stand still; without them the curve is that of
    the others.
    """
    design = Design.load("fsr400")
    response = board_values(design).tactile_response
    curve = ConductanceCurve(TURN_ON_N, WEAK.scale, 0.52)
    forces = (0.5, 1.0, 2.0, 3.0, 20.0, 40.0)
    readings = [
        response.tactile_v(curve.conductance_s(force)) / (scale or 1.0) for force in forces[:4]
    ] + [end, end]
    table = f"force_n,{kind}\n" + "".join(
        f"{f},{r:.6f}\n" for f, r in zip(forces, readings, strict=True)
    )
    weighings = parse_weighings(table, "w.csv")
    assert [row.line for row in weighings.saturated] == [6, 7]
    assert "lines 6 and 7 at" in list_warnings(weighings)[0]
    assert calibrate_sensor(design, weighings, scale).law.exponent == pytest.approx(0.52, abs=1e-3)


def test_a_sensor_that_is_pressed_at_rest_is_named() -> None:
    for offset_v in (0.3, -0.3):
        text = weighings_csv(offset_v=offset_v) + f"0,{RESPONSE.open_v + offset_v:.6f}\n"
        weighings = parse_weighings(text, "w.csv")
        found = calibrate_sensor(DESIGN, weighings)
        pressed = (found.points[-1].voltage_v - found.points[0].voltage_v) * found.offset_v > 0
        assert (
            any(
                "the skin presses on the sensor" in each for each in list_warnings(weighings, found)
            )
            == pressed
        )


def test_fit_equals_numpys_and_its_interval_is_that_of_a_prediction() -> None:
    rng = np.random.default_rng(3)
    forces = np.array([0.5, 1.0, 2.0, 5.0, 10.0, 10.0])
    conductances = 1e-4 * (forces - 0.2) ** 0.6 * np.exp(rng.normal(0, 0.05, 6))
    law = fit_power_law(forces.tolist(), conductances.tolist(), 0.2)
    x = np.log(forces - 0.2)
    y = np.log(conductances)
    (b, a), covariance = np.polyfit(x, y, 1, cov=True)
    assert (law.exponent, math.log(law.conductance_s)) == pytest.approx((b, a))
    assert law.exponent_uncertainty == pytest.approx(math.sqrt(covariance[0, 0]))
    # At either end of the interval the reading lies at an edge of the prediction interval of that
    # force.
    for reading in (3e-5, 1e-4, 4e-4):
        for end in law.interval_n(reading):
            d = math.log(end - 0.2) - x.mean()
            half = (
                law.coverage_factor
                * law.scatter
                * math.sqrt(1 + 1 / 6 + d * d / ((x - x.mean()) ** 2).sum())
            )
            assert abs(math.log(reading) - a - b * math.log(end - 0.2)) == pytest.approx(half)
        low, high = law.interval_n(reading)
        assert low < force_at(law, reading) < high
    assert PowerLaw(0.2, 0.1, 1e-4, 0.5, 4, 0.0, 1.0).interval_n(1e-4) == (0.2, math.inf)


@pytest.mark.parametrize(("turn_on_n", "bound"), [(0.0, 0.09), (0.1, 0.05), (0.3, 0.07)])
@pytest.mark.parametrize("exponent", [0.5, 1.0])
def test_sensor_with_another_turn_on(turn_on_n: float, bound: float, exponent: float) -> None:
    """The turn-on is not fitted.

    What a wrong one costs is within the interval, as it shows as scatter.
    """
    forces = [0.5, 1.0, 3.0, 10.0]
    law = fit_power_law(forces, [(f - turn_on_n) ** exponent for f in forces], TURN_ON_N)
    for force in (0.7, 2.0, 5.0, 8.0):
        reading = (force - turn_on_n) ** exponent
        low, high = law.interval_n(reading)
        assert low < force < high
        assert force_at(law, reading) == pytest.approx(force, rel=bound)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "cannot be read"),
        (b"PK\0\0", "is not a text file"),
        (b"1" * (2**20 + 1), "of less than 1 MB"),
    ],
)
def test_files_that_are_no_weighings(content: bytes | None, message: str, tmp_path: Path) -> None:
    if content is not None:
        (tmp_path / "w.csv").write_bytes(content)
    with pytest.raises(TraceError, match=message):
        read_weighings(tmp_path / "w.csv")


def test_a_scale_is_for_counts_only() -> None:
    with pytest.raises(TraceError, match="scale: does not apply to voltage_v; leave it out"):
        calibrate_sensor(DESIGN, parse_weighings(weighings_csv(), "w.csv"), 0.1)
    counts = parse_weighings(weighings_csv().replace("voltage_v", "counts"), "w.csv")
    for scale in (0.0, math.nan, math.inf):
        with pytest.raises(TraceError, match="is not a scale; give volts per count"):
            calibrate_sensor(DESIGN, counts, scale)


def test_the_command_writes_a_design_that_the_printed_changes_give_too(tmp_path: Path) -> None:
    path = tmp_path / "w.csv"
    path.write_text(weighings_csv(fit_conductance_curve()) + "200,3.75\n")
    out = tmp_path / "mine.toml"
    done = run("calibrate", "sensor", path, "article", "--out", out)
    assert done.exit_code == 0, done.stderr
    (changes,) = (line for line in done.stdout.splitlines() if line.startswith("--set "))
    calibrated = Design.load(out)
    assert calibrated == Design.load(
        "article", changes=[word for word in shlex.split(changes) if word != "--set"]
    )
    assert str(tmp_path) not in out.read_text()
    data = json.loads(run("calibrate", "sensor", path, "article", "--json", "-q").stdout)
    assert " ".join(f"--set {change}" for change in data["set"]) == changes
    assert data["fit"]["weighings"] == 6
    low, high = data["curve"][2]["interval_95_n"]
    assert low < data["curve"][2]["force_n"] < high
    assert calibrated.force_curve.describe(calibrated.sensor.model) in done.stdout
    table = [line for line in done.stdout.splitlines() if " ohm " in line]
    assert table
    assert not [line for line in table if "e+" in line]
    refused = run("calibrate", "sensor", out, "article", "--out", out)
    assert "is an input of this command; give another name." in refused.stderr


def test_command_warns_of_a_missing_reading_without_load(tmp_path: Path) -> None:
    rows = [f"{weight},{volts(WEAK, weight / 1000 * 9.81)}" for weight in WEIGHTS_G]
    for more, warns in (([], True), ([f"0,{RESPONSE.open_v}"], False)):
        path = tmp_path / "w.csv"
        path.write_text("\n".join(["weight_g,voltage_v", *rows, *more]))
        done = run("calibrate", "sensor", path, "article", "--json")
        assert done.exit_code == 0
        assert ("holds no reading without load" in done.output) is warns
    ohms = "\n".join(f"{weight},{1e5 / weight}" for weight in WEIGHTS_G)
    alone = parse_weighings(f"weight_g,resistance_ohm\n{ohms}\n", "w.csv")
    assert list_warnings(alone) == [], "no board, no offset"
