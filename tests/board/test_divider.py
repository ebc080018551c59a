"""Divider in place of a board: one circuit in all its files, the
signal it gives, and what it refuses.
"""

from __future__ import annotations

import csv
import json
import math
import subprocess
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingertip import Design, FingertipError, Readout, board_values, detect
from fingertip.board.analysis.board_values import find_range_warnings
from fingertip.board.analysis.tactile_response import find_tactile_response
from fingertip.detection.live import detect_stream
from fingertip.documents.acceptance import expect_readings
from fingertip.documents.board.divider import compute_current_ratio, list_readings
from fingertip.lab.board_comparison import BOARD, DIVIDER, NOISY, compare_with_board
from fingertip.lab.campaign.campaign import CampaignPlan
from fingertip.lab.campaign.run import run_campaign
from fingertip.lab.validation import validate
from fingertip.sim.signal import readout
from fingertip.sim.signal.bridge import Bridge
from fingertip.sim.signal.finger_curve import FingerCurve
from fingertip.sim.simulation import Trial, simulate
from fingertip.slip.detectors.registry import DETECTORS, make_detector
from fingertip.sweep.compute import GROUP_FUNCTIONS, PointContext
from fingertip.tasks.board_files import board_differences, write_board
from tests.board.kicad import read_netlist
from tests.board.ngspice import HOW_TO_INSTALL_NGSPICE
from tests.conftest import run_fingertip
from tests.tools import require_tool
from tools.article.steps import compare_grids, generate_trials

CHANGES = ["board.variant=divider"]
DESIGN = Design.load("fsr400", changes=CHANGES)


def hand_calculated_v(ohm: float, sensor_ohm: float, supply_v: float = 3.3) -> float:
    """Voltage across the lower of two resistors in series [V]."""
    return supply_v / (ohm + sensor_ohm) * ohm


@given(st.floats(1000, 1e6), st.floats(100, 1e7))
def test_response_is_that_of_two_resistors(ohm: float, sensor_ohm: float) -> None:
    design = DESIGN.model_copy(
        update={"board": DESIGN.board.model_copy(update={"divider_ohm": ohm})}
    )
    found_v = find_tactile_response(design).tactile_v(1 / sensor_ohm)
    assert found_v == pytest.approx(hand_calculated_v(ohm, sensor_ohm), rel=1e-9)


def test_folder_states_one_circuit(tmp_path: Path) -> None:
    write_board(DESIGN, tmp_path)
    assert not board_differences(DESIGN, tmp_path)
    assert not list(tmp_path.glob("*.kicad_*"))
    nets, parts = read_netlist(tmp_path / "slip_filter.net")
    assert parts["R1"][0] == "10k"
    assert nets["/TACTILE"] == {("J1", "2"), ("R1", "1"), ("J3", "2")}
    assert nets["VCC"] == {("J1", "1"), ("J3", "1")}
    assert nets["GND"] == {("R1", "2"), ("J3", "3")}
    assert "\nVJ3 vcc 0 3.3\n" in (tmp_path / "slip_filter.cir").read_text(encoding="utf-8")
    words = {
        text.text
        for text in ElementTree.parse(tmp_path / "wiring.svg").iter(
            "{http://www.w3.org/2000/svg}text"
        )
    }
    assert {"ADC_VREF (pin 35)", "A0: GP26 (pin 31)", "GND (pin 33)", "10k ohm"} <= words
    assert all(
        "pin 35" in (tmp_path / name).read_text(encoding="utf-8")
        for name in ("README.md", "slip_filter.net")
    )
    assert ".kicad_sch" not in (tmp_path / "slip_filter.net").read_text(encoding="utf-8")
    values = json.loads((tmp_path / "values.json").read_text(encoding="utf-8"))
    assert values["parameters"] == {"variant": "divider", "divider_ohm": 10e3, "supply_v": 3.3}
    with (tmp_path / "bom.csv").open(encoding="utf-8") as file:
        assert [row["References"] for row in csv.DictReader(file)] == ["J1", "J3", "R1"]
    assert len((tmp_path / "README.md").read_text(encoding="utf-8").split()) <= 140


def test_ngspice_gives_the_expected_readings(tmp_path: Path) -> None:
    ngspice = require_tool("ngspice", HOW_TO_INSTALL_NGSPICE)
    write_board(DESIGN, tmp_path)
    done = subprocess.run(
        [ngspice, "-b", "slip_filter.cir"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    rows = [line.split() for line in done.stdout.splitlines() if line[:1] in ("0", "1")]
    computed = sorted(float(volts) for _, _, volts in rows)
    readings = json.loads((tmp_path / "values.json").read_text(encoding="utf-8"))["readings"]
    assert [one["mass_g"] for one in readings] == [0.0, 100.0, 500.0]
    assert [round(volts, 2) for volts in computed] == [one["tactile_v"] for one in readings[1:]]
    assert [one["counts"] for one in readings] == [
        0,
        *(round(volts / 3.3 * 4096) for volts in computed),
    ]


@pytest.mark.parametrize("change", ["board.divider_ohm=10000", "force_curve.curve=calibrated"])
def test_hand_reads_the_weight_off_the_expected_voltage(change: str) -> None:
    """The skin carries a part of the weight, for the readings as for
    the forces of sketch and simulated hand.
    """
    design = Design.load("fsr400", changes=[*CHANGES, change])
    for reading in expect_readings(design):
        found_n = FingerCurve.from_design(design).force_n(reading.tactile_v)
        assert found_n == pytest.approx(reading.mass_g * 9.81e-3, rel=5e-3)


def test_current_and_range_are_stated() -> None:
    # The data sheet's 250 ohm at 10 kg; the sensor conducts less at 20 N.
    ohm = 10e3 + 3.3 / 3.3 * 250
    assert (
        0.9 < compute_current_ratio(DESIGN) / (3.3 / ohm / (1e-3 * math.pi / 4 * 0.508**2)) <= 1.0
    )
    assert not list(find_range_warnings(DESIGN))
    clipped = Design.load("fsr400", changes=[*CHANGES, "board.supply_v=5"])
    assert "--set board.supply_v=3.3" in next(find_range_warnings(clipped))


def test_rules_of_the_filter_do_not_refuse_a_divider() -> None:
    changes = [
        "board.capacitor_uf=3",
        "board.passband_gain=9000",
        "detector.threshold_v=3",
        "board.r5_ohm=9e6",
    ]
    assert Design.load("fsr400", changes=[*CHANGES, *changes]).board.has_filter is False
    with pytest.raises(FingertipError):
        Design.load("fsr400", changes=changes)


def test_only_fast_works_on_it() -> None:
    trace = simulate(DESIGN, Trial(seed=3, force_n=1.0))
    found = detect(trace, DESIGN, "fast")
    assert found.score
    assert found.score.delays_s[0]
    assert 0.0 < found.score.delays_s[0] < 0.06
    assert not found.score.false_intervals
    rows = [f"{t:.7f},{v:.6f}" for t, v in zip(trace.time_s, trace.voltage_v, strict=True)]
    streamed = detect_stream(["time_s,voltage_v", *rows], DESIGN, "fast").transitions
    assert next(streamed).time_s == pytest.approx(found.intervals[0].onset_s, abs=1e-6)
    for name in DETECTORS.keys() - {"fast"}:
        with pytest.raises(FingertipError) as refused:
            make_detector(name, DESIGN)
        assert "use detector fast, or a board with" in str(refused.value)
        # The other remedy.
        make_detector(name, Design.load("fsr400", changes=[*CHANGES, "board.variant=precision"]))


def test_what_needs_a_board_is_refused(tmp_path: Path) -> None:
    words = ["fsr400", "--set", "board.variant=divider", "--out", str(tmp_path / "board")]
    for option in ("--fab", "--bringup", "--analysis"):
        done = run_fingertip("board", *words, option)
        assert done.returncode == 2
        assert f"{option}: needs a board" in done.stderr
    assert not (tmp_path / "board").exists()
    with pytest.raises(FingertipError, match="is no board"):
        board_values(DESIGN)


def test_readout_and_sweep_leave_out_the_board(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(readout, "_compile", lambda: readout._readout_loop)
    sample = Readout(DESIGN, [None]).step(np.array([1.0]))
    expected_v = float(Bridge.of_board(DESIGN).voltage_v(np.array([1.0]))[0])
    assert sample.sampled_tactile_v[0] == pytest.approx(expected_v, abs=DESIGN.detector.adc_step_v)
    assert np.isnan([sample.filtered_v[0], sample.envelope_v[0], sample.sampled_output_v[0]]).all()
    context: Any = PointContext(DESIGN, None, None, None)  # type: ignore[arg-type]
    for group in ("board", "circuit", "noise"):
        assert all(map(math.isnan, GROUP_FUNCTIONS[group](context).values()))
    found = GROUP_FUNCTIONS["acceptance"](context)
    assert found["tactile_100g_v"] == pytest.approx(list_readings(DESIGN)[1]["tactile_v"], abs=5e-3)


def test_time_step_is_compared_without_an_envelope() -> None:
    errors, _ = compare_grids(DESIGN, next(generate_trials(1)), ("fast",), refinement=2)
    assert errors.keys() == {"force_n", "voltage_v"}
    assert 0.0 < errors["force_n"] < 5e-5
    assert errors["voltage_v"] <= DESIGN.detector.adc_step_v


@pytest.mark.second
def test_validation_says_what_a_board_would_add() -> None:
    found = validate(DESIGN, CampaignPlan(2, 0.5))
    assert found.passed
    assert "the divider suffices; a board would find 2 slips in place of 2" in found.as_verdict()
    assert found.as_data()["comparison"].keys() == {DIVIDER, NOISY, BOARD}
    assert found.files().keys() == {"validation.txt", "validation.json"}


def test_divider_whose_filter_has_no_board_is_validated_alone() -> None:
    refused = Design.load("fsr400", changes=[*CHANGES, "board.capacitor_uf=3"])
    result = run_campaign(refused, CampaignPlan(1, 0.5), ("fast",), (1.0,))
    assert "does not suffice; no board is compared" in compare_with_board(
        refused, result, "fast"
    ).tell(passed=False)
