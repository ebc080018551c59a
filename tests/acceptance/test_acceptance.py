"""Acceptance sheet: expected voltages, limits, wires, and the page."""

from __future__ import annotations

import json
import re
from dataclasses import asdict
from pathlib import Path

import pytest

from fingertip import Design, board_values
from fingertip.catalogues.file_kinds import PRESETS
from fingertip.documents.acceptance import (
    SPREAD,
    acceptance_sheet,
    expect_change_ratio,
    expect_readings,
    render_acceptance,
)
from fingertip.documents.board.divider import list_readings
from tests.conftest import ROOT, design_file, run_fingertip

NAMES = ("fsr400", "fsr402", *PRESETS)


def load(name: str, *changes: str) -> Design:
    return Design.load(design_file(name), changes=list(changes))


def test_voltage_is_that_of_the_loaded_front_end_by_hand() -> None:
    """The front end is a source with a resistance, and the sensor's
    current moves the output in proportion.
    """
    design = load("fsr400")
    response = board_values(design).tactile_response
    for reading in expect_readings(design):
        current = response.sensor_v / (reading.sensor_ohm + response.source_ohm)
        assert reading.tactile_v == pytest.approx(
            response.open_v - response.transfer_ohm * current, rel=1e-12
        )
        current = response.sensor_v / (reading.sensor_ohm / SPREAD + response.source_ohm)
        shown = re.search(r"(\S+) V \(20 N\)", (ROOT / "pcb/README.md").read_text())
        assert shown
        highest_v = min(float(shown[1]), response.open_v - response.transfer_ohm * current)
        assert reading.limits_v[1] == pytest.approx(highest_v, abs=0.005)


@pytest.mark.parametrize("name", [*NAMES, "article"])
def test_a_short_circuit_is_not_accepted(name: str) -> None:
    design = load(name)
    response = board_values(design).tactile_response
    shorted_v = min(max(0.0, response.tactile_v(1.0)), design.board.supply_v)
    for reading in expect_readings(design):
        limit_v = reading.limits_v[1 if response.rises else 0]
        assert abs(shorted_v - limit_v) > 0.1
        assert (limit_v < shorted_v) == response.rises


CALIBRATED = (
    "force_curve.curve=calibrated",
    "force_curve.min_force_n=0.5",
    "force_curve.max_force_n=10",
    "force_curve.interval_factor=1.2",
)


def test_calibration_narrows_the_limits_in_its_range() -> None:
    typical = expect_readings(load("fsr400"))
    calibrated = expect_readings(load("fsr400", *CALIBRATED))
    for wide, narrow in zip(typical, calibrated, strict=True):
        assert narrow.limits_v[1] - narrow.limits_v[0] < 0.3 * (wide.limits_v[1] - wide.limits_v[0])
    light, heavy = expect_readings(load("fsr400", *CALIBRATED, "force_curve.max_force_n=3"))
    assert light.limits_v == calibrated[0].limits_v
    width_v = heavy.limits_v[1] - heavy.limits_v[0]
    assert width_v > 2 * (calibrated[1].limits_v[1] - calibrated[1].limits_v[0]), (
        "500 g lie beyond the calibration"
    )


def test_a_sensor_without_a_curve_has_no_voltages_until_it_is_calibrated() -> None:
    for changes in (["sensor.model=custom"], ["sensor.model=custom", "board.variant=divider"]):
        unknown = load("fsr400", *changes)
        known = load("fsr400", *changes, *CALIBRATED)
        pages = [render_acceptance(acceptance_sheet(design)) for design in (unknown, known)]
        assert ["calibrate this one first" in page for page in pages] == [True, False]
        assert [" V, then " in page for page in pages] == [False, True]
        assert [len(list_readings(design)) for design in (unknown, known)] == [1, 3]


@pytest.mark.parametrize("name", NAMES)
def test_ratio_of_the_drops_holds_for_sensors_that_differ_by_factors(name: str) -> None:
    design = load(name)
    readings = expect_readings(design)
    response = board_values(design).tactile_response
    for factor in (0.3, 1.0, 3.0):
        light, heavy = (
            abs(response.open_v - response.tactile_v(factor / reading.sensor_ohm))
            for reading in readings
        )
        assert heavy / light == pytest.approx(expect_change_ratio(design), rel=0.3), factor
    assert 1.0 < expect_change_ratio(design) < 5.5, "no more than the weights differ by"


def test_command_writes_the_page_that_make_writes(tmp_path: Path) -> None:
    done = run_fingertip("acceptance", "fsr400", "--json", "--quiet", PWD=str(tmp_path))
    assert done.returncode == 0, done.stderr
    data = json.loads(done.stdout)
    assert data.pop("page") == "out/fsr400/acceptance.md"
    sheet = acceptance_sheet(load("fsr400"))
    assert data == json.loads(json.dumps(asdict(sheet)))
    assert (tmp_path / "out/fsr400/acceptance.md").read_text() == render_acceptance(sheet)
    wrong = run_fingertip("acceptance", "fsr400", "--out", "page.txt", PWD=str(tmp_path))
    assert wrong.returncode == 2
    assert ".md" in wrong.stderr
