"""Origin of a trace, the robot's motion in it, and the words that tell detection from truth."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from fingertip import Design, Trace, detect, detect_file, simulate
from fingertip.catalogues.output_files import SIGNAL
from fingertip.slip.report import as_data, as_text
from fingertip.slip.traces.truth import Origin, encoder_band_s, encoder_delay_band_s, format_delay_band, read_origin
from fingertip.tasks.make import simulate_and_detect


@pytest.fixture(scope="module")
def trace() -> Trace:
    return simulate(Design())


def test_encoders_know_the_motion_to_one_period() -> None:
    assert encoder_band_s(1.5) == pytest.approx((1.5, 1.51))
    assert encoder_delay_band_s(0.0245) == pytest.approx((0.0145, 0.0245))
    assert format_delay_band(0.0245) == "14.5-24.5 ms"


def test_text_names_the_detector_and_tells_detection_from_truth(trace: Trace) -> None:
    found = detect(trace, Design(), "fast")
    first, second, third, last = as_text(found).splitlines()
    threshold = found.threshold
    assert first.startswith("detector fast, on voltage_v alone (no column filtered_v), statistic of fast: threshold ")
    assert f"{1000 * threshold.lowest_v:.3g} to {1000 * threshold.highest_v:.3g} mV" in first
    assert second.startswith("detected ")
    assert third.startswith("true slip (simulated) ")
    assert found.motion_delays_s
    (since_motion,) = found.motion_delays_s
    assert since_motion is not None
    assert f"{1000 * since_motion:.1f} ms after the robot moved ({format_delay_band(since_motion)}" in third
    assert last == "false intervals: 0"


def test_slip_that_a_recording_states_is_not_called_simulated(trace: Trace) -> None:
    text = as_text(detect(replace(trace, origin=Origin()), Design()))
    assert "true slip (column slip) " in text
    assert "simulated" not in text
    assert "robot" not in text


def test_threshold_is_the_same_in_every_output(trace: Trace) -> None:
    """The threshold before the noise is learned is that of no decision, so it stands nowhere."""
    found = detect(trace, Design(), "fast")
    data = as_data(found, None)
    used = found.output.threshold_v
    assert data["threshold_v"] == pytest.approx(used[found.output.on][0], abs=1e-7)
    assert data["threshold_range_v"] == pytest.approx([used.min(), used.max()], abs=1e-7)
    assert data["threshold_of"] == "statistic of fast"
    assert f"{1e3 * used.min():.3g} to {1e3 * used.max():.3g} mV" in as_text(found)
    constant = detect(trace, Design(), "digital")
    assert as_text(constant).startswith("detector digital, on voltage_v, mean of the envelope: threshold 23 mV\n")
    assert as_data(constant, None)["threshold_range_v"] == [0.023, 0.023]


@pytest.mark.full
def test_files_of_a_set_are_simulated_unless_they_were_changed(tmp_path: Path) -> None:
    contents, made = simulate_and_detect(Design(), lambda message: None)
    folder = tmp_path / "signal"
    SIGNAL.writer(Design(), folder).write(contents)
    origin = read_origin(folder / "trace.csv")
    assert origin.is_simulated
    assert origin.motion_s == pytest.approx(made.trace.origin.motion_s, abs=1e-7)
    assert detect_file(folder / "trace.csv").trace.origin == origin
    (tmp_path / "own.csv").write_bytes(contents["trace.csv"])
    assert read_origin(tmp_path / "own.csv") == Origin()
    (folder / "detection.json").write_text("{}")  # no longer what was written
    assert read_origin(folder / "trace.csv") == Origin(is_simulated=True)
    with (folder / "trace.csv").open("a") as file:
        file.write("\n")
    assert read_origin(folder / "trace.csv") == Origin()
