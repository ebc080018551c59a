"""True slip, the words that tell detection from truth, and the plot of a detection."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fingertip import Design, Trace, detect, detect_file, simulate
from fingertip.catalogues.output_files import SIGNAL
from fingertip.foundation.errors import TraceError
from fingertip.slip import Interval
from fingertip.slip import report as plot
from fingertip.slip.detection import UsedThreshold
from fingertip.slip.report import as_data, as_text, format_delay
from fingertip.slip.traces.truth import (
    BAND_LABEL,
    Origin,
    SlipCollector,
    encoder_band_s,
    encoder_delay_band_s,
    format_delay_band,
    intervals,
    measure_false_on_s,
    merge,
    read_origin,
    score,
)
from fingertip.tasks.make import simulate_and_detect
from tests.tools import require_module

TIME = np.arange(10) / 10


def to_flags(text: str) -> np.ndarray:
    return np.array([c == "1" for c in text])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0000000000", []),
        ("0011100000", [(0.2, 0.5)]),
        ("1100000011", [(0.0, 0.2), (0.8, 0.9)]),
        ("1111111111", [(0.0, 0.9)]),
        ("0101000000", [(0.1, 0.2), (0.3, 0.4)]),
    ],
)
def test_intervals_of_flags(text, expected):
    assert [(i.onset_s, i.end_s) for i in intervals(TIME, to_flags(text))] == expected


@pytest.mark.parametrize("sizes", [(10,), (1,) * 10, (3, 0, 4, 3), (5, 5), (9, 1)])
def test_chunks_give_the_intervals_of_the_whole(sizes):
    for text in ("0000000000", "0011100000", "1100000011", "1111111111", "0101000000", "0000000001"):
        flags, at, collector = to_flags(text), 0, SlipCollector()
        for size in sizes:
            collector.add(TIME[at : at + size], flags[at : at + size])
            at += size
        assert collector.close() == intervals(TIME, flags), text
        assert collector.close() == intervals(TIME, flags), "nothing is added twice"


def test_a_gap_of_exactly_the_limit_is_merged_in_every_group():
    # Powers of two, so that the gaps have no rounding errors.
    parts = [Interval(1.0, 2.0), Interval(2.25, 3.0), Interval(8.0, 9.0), Interval(9.25, 10.0), Interval(20.0, 21.0)]
    assert merge(parts, 0.25) == (Interval(1.0, 3.0), Interval(8.0, 10.0), Interval(20.0, 21.0))
    assert merge(parts, 0.125) == tuple(parts)


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ((1.0, 2.0), (1.5, 3.0), True),
        ((1.0, 2.0), (2.0, 3.0), False),  # they touch
        ((3.0, 4.0), (1.0, 2.0), False),
        ((2.0, 2.0), (1.0, 2.0), True),  # one sample at the end of a trace
        ((1.0, 2.0), (2.0, 2.0), True),
        ((2.5, 2.5), (1.0, 2.0), False),
    ],
)
def test_overlap_of_two_intervals(first, second, expected):
    assert Interval(*first).overlaps(Interval(*second)) == expected


def test_score_of_detected_missed_and_false_intervals():
    truth = [Interval(1.0, 2.0), Interval(3.0, 3.5), Interval(5.0, 6.0)]
    found = [
        Interval(0.2, 0.3),  # false
        Interval(1.025, 2.03), Interval(2.02, 2.04),  # the slip, and a second interval within the window after it
        Interval(2.5, 2.6),  # false
        Interval(4.9, 5.5),  # ON before the slip
    ]  # fmt: skip
    scored = score(found, truth, 0.03)
    assert scored.delays_s == (pytest.approx(0.025), None, pytest.approx(-0.1))
    assert scored.missed == (truth[1],)
    assert scored.false_intervals == (found[0], found[3])


def test_an_alarm_that_ends_at_the_onset_does_not_detect_the_slip():
    scored = score([Interval(0.9, 1.0), Interval(1.02, 1.4)], [Interval(1.0, 1.5)], 0.03)
    assert scored.delays_s == (pytest.approx(0.02),)
    assert scored.false_intervals == (Interval(0.9, 1.0),)
    # An interval of one last sample has no length but is detected.
    assert score([Interval(1.5, 1.5)], [Interval(1.5, 1.5)], 0.03).delays_s == (0.0,)


def test_description_distinguishes_incipient_slip_from_already_on():
    assert format_delay(None) == "missed"
    assert format_delay(0.0123) == "detected after 12.3 ms"
    assert format_delay(-0.006) == "detected 6.0 ms before onset, in incipient slip"
    assert format_delay(-0.01) == "already ON 10 ms before onset"


def test_an_interval_that_began_long_before_a_slip_is_on_without_slip():
    detected = [Interval(0.0, 1.2), Interval(2.0, 2.25), Interval(3.0, 3.5)]
    assert measure_false_on_s(detected, [Interval(1.0, 1.5), Interval(2.1, 2.2)]) == pytest.approx(1.0 + 0.15 + 0.5)
    assert measure_false_on_s(detected, []) == pytest.approx(1.95)


def test_number_of_slips_does_not_depend_on_the_detector():
    truth = [Interval(1.0, 1.5), Interval(1.52, 1.523), Interval(2.0, 2.1)]
    assert score([], truth, 0.001).slips == score([], truth, 0.5).slips == (Interval(1.0, 1.523), truth[2])


def make_burst(length: int = 4000, start: int = 2000, stop: int = 3000) -> Trace:
    time = np.arange(length) / 2000
    slip = (np.arange(length) >= start) & (np.arange(length) < stop)
    voltage = 2.3 + np.where(slip, 0.01 * np.sin(2 * np.pi * 90 * time), 0.0)
    return Trace(time, voltage, None, slip)


def test_a_trace_in_memory_is_validated():
    trace = make_burst()
    invalid = Trace(trace.time_s * 2, np.where(np.arange(4000) == 7, np.nan, trace.voltage_v))
    with pytest.raises(TraceError) as caught:
        detect(invalid, Design())
    assert [issue.field for issue in caught.value.issues] == ["trace, voltage_v", "trace, time_s"]
    assert "at sample 7 is not a finite number" in str(caught.value)
    assert "--rate-hz 1000" in str(caught.value)


def test_thresholds_are_told_in_millivolts() -> None:
    constant, adapting = (UsedThreshold("statistic", 0.0123, last, 0.004, last) for last in (0.004, 0.015))
    assert constant.describe() == "threshold 4 mV"
    assert adapting.describe() == "threshold 4 to 15 mV, 12.3 at the first ON"


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


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Figures in place of pictures."""
    require_module("matplotlib")
    figures: list[Any] = []

    def keep(figure: Any) -> bytes:
        figure.canvas.draw()
        figures.append(figure)
        return b""

    monkeypatch.setattr(plot.style, "to_png", keep)
    return figures


def find_delay_s(figure: Any) -> float:
    lines = [line for line in figure.axes[3].get_lines() if len(line.get_xdata()) == 2]
    onset, on = sorted(float(line.get_xdata()[0]) for line in lines)
    return on - onset


@pytest.mark.parametrize("detector", ["digital", "fast", "fft"])
def test_the_delay_is_wide_enough_to_see(detector: str, trace: Trace, drawn: list[Any]) -> None:
    found = detect(trace, Design(), detector=detector)
    plot.draw(trace, found, "title")
    (figure,) = drawn
    assert found.score
    (delay,) = [delay for delay in found.score.delays_s if delay is not None]
    assert find_delay_s(figure) == pytest.approx(delay, abs=1e-9)
    large = figure.axes[3]
    low, high = large.get_xlim()
    pixels = large.get_window_extent().width * delay / (high - low)
    assert pixels > 40
    overview = figure.axes[0]
    whole = overview.get_xlim()[1] - overview.get_xlim()[0]
    assert pixels > 4 * overview.get_window_extent().width * delay / whole


@pytest.mark.parametrize("detector", ["digital", "fast"])
def test_the_threshold_drawn_is_the_one_that_was_used(detector: str, trace: Trace, drawn: list[Any]) -> None:
    found = detect(trace, Design(), detector=detector)
    plot.draw(trace, found, "title")
    (figure,) = drawn
    for axes in (figure.axes[1], figure.axes[3]):
        (line,) = [line for line in axes.get_lines() if str(line.get_label()).startswith("threshold")]
        assert np.array_equal(line.get_ydata(), 1000 * found.output.threshold_v)
    used = 1000 * found.output.threshold_v
    assert f"{used.max():.3g} mV" in line.get_label()
    assert (" to " in line.get_label()) == (np.ptp(used) > 1e-9)


def test_without_truth_the_first_detection_is_enlarged(trace: Trace, drawn: list[Any]) -> None:
    blind = Trace(trace.time_s, trace.voltage_v)
    plot.draw(blind, detect(blind, Design()), "title")
    assert "true slip is unknown" in drawn[0].axes[-1].get_title(loc="left")
    flat = Trace(trace.time_s, np.full_like(trace.voltage_v, 2.3))
    plot.draw(flat, detect(flat, Design()), "title")
    assert len(drawn[1].axes) == 3


def test_the_encoders_band_is_drawn_where_the_motion_is_known(trace: Trace, drawn: list[Any]) -> None:
    assert trace.origin.motion_s is not None
    plot.draw(trace, detect(trace, Design()), "title")
    for axes in (drawn[0].axes[0], drawn[0].axes[1], drawn[0].axes[3]):
        (band,) = [patch for patch in axes.patches if patch.get_label() == BAND_LABEL]
        assert (band.get_x(), band.get_width()) == pytest.approx((trace.origin.motion_s, 0.01))
    assert BAND_LABEL in [text.get_text() for text in drawn[0].axes[1].get_legend().get_texts()]
    unknown = replace(trace, origin=Origin(is_simulated=True))
    plot.draw(unknown, detect(unknown, Design()), "title")
    assert not [patch for axes in drawn[1].axes for patch in axes.patches if patch.get_label() == BAND_LABEL]
