"""Recordings beside their simulation: what was changed in simulated
recordings is recovered within its interval.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fingertip.design import Design
from fingertip.drivers import SampleReader
from fingertip.foundation import jit
from fingertip.recorded_trials.record import Plan, Recorder
from fingertip.recorded_trials.simulation_comparison import compare
from fingertip.recorded_trials.simulation_fit import mean_interval
from fingertip.recorded_trials.trials import prepare_folder, read_recordings
from tests.conftest import run_fingertip
from tests.recorded_trials.player import HEADER, format_line, simulate_person

DESIGN = Design.load("first_finger")
FORCES_N = (0.5, 0.8, 1.5, 2.5, 3.5)
CURVE = {
    "force_curve.turn_on_n": 0.15,
    "force_curve.conductance_us": 120.0,
    "force_curve.exponent": 0.7,
}


def record(folder: Path, truth: Design, trials: int, felt_um: float = 0.0) -> None:
    samples = simulate_person(truth, trials, FORCES_N, "medium", felt_um)
    lines = [line.encode() for line in HEADER.decode().splitlines()]
    lines += [format_line(i, *sample).rstrip() for i, sample in enumerate(samples)]
    prepare_folder(folder, DESIGN)
    assert (
        Recorder(DESIGN, folder, Plan(trials, FORCES_N, "medium")).run(SampleReader(lines)).lost
        == 0
    )


def test_intervals_have_their_closed_form() -> None:
    assert mean_interval([1.0, 2.0, 3.0]) == pytest.approx(
        (2.0, 2.0 - 4.302653 / 3**0.5, 2.0 + 4.302653 / 3**0.5)
    )
    assert mean_interval([4.0])[1:] == (-np.inf, np.inf)


@pytest.mark.second
@pytest.mark.parametrize(
    ("changed", "noise_v", "felt_um"),
    [(CURVE, 1.2e-3, 2.48), pytest.param({}, 0.5e-3, 0.78, marks=pytest.mark.full)],
)
def test_changed_level_noise_and_curve_are_recovered(
    changed: dict[str, float], noise_v: float, felt_um: float, tmp_path: Path
) -> None:
    calibrated = {"force_curve.curve": "calibrated", "force_curve.conductance_us": 190.0, **changed}
    truth = DESIGN.with_values({**calibrated, "detector.noise_v": noise_v})
    with jit.compiled():
        record(tmp_path / "trials", truth, 24, felt_um)
    done = run_fingertip(
        "validate", "--recordings", str(tmp_path / "trials"), "--out", str(tmp_path / "found")
    )
    assert done.returncode == 0, done.stderr
    report = compare(DESIGN, read_recordings(tmp_path / "trials"), "fast")
    curve = truth.force_curve
    expected = {
        "force_curve.turn_on_n": curve.turn_on_n,
        "force_curve.exponent": curve.exponent,
        "force_curve.conductance_us": curve.conductance_us,
        "detector.noise_v": noise_v,
        "surface.felt_um (medium)": felt_um,
    }
    print(report.as_text())
    assert [one.name for one in report.figures] == [*expected]
    for one in report.figures:
        assert one.low <= expected[one.name] <= one.high, str(one)
        assert one.high - one.low < 0.35 * expected[one.name], f"{one}: the interval says nothing"
    assert report.results["measured"].slips == 15
    assert report.fitted.force_curve.interval_factor >= 1.1, "no sensor repeats better"
    wider = replace(report, onset_error_s=0.005)
    (low, high), (wide_low, wide_high) = (
        dict(each._rows())["median [ms]"][0][1:] for each in (report, wider)
    )
    assert (low - wide_low, wide_high - high) == pytest.approx((5.0, 5.0)), (
        "the contact's error counts"
    )
    assert "of minutes" in report.as_text()
    # A design takes the file over, and a simulation the surface.
    taken = Design.load(tmp_path / "found/fitted.toml")
    assert taken.detector.noise_v == pytest.approx(noise_v, rel=0.1)
    assert taken.force_curve.exponent == pytest.approx(curve.exponent, rel=0.02)
    words = (
        "simulate",
        str(tmp_path / "found/fitted.toml"),
        "--surface",
        str(tmp_path / "found/surface_medium.toml"),
    )
    assert run_fingertip(*words, "--out", str(tmp_path / "again.csv")).returncode == 0
