"""Reports of detections on known recordings: text, JSON, table and figures are the
approved ones.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fingertip import Design, Trace, detect
from fingertip.detection.warnings import calibration_warnings, hum_warnings, noise_warnings
from fingertip.slip.detection_results import as_data, as_text
from fingertip.slip.detectors.analog_and_digital import ChainSettings, SlipChain
from fingertip.slip.plots import draw_trace, plot_detection
from fingertip.slip.traces.truth import Interval, Origin
from tests.approved import check_figures, list_data
from tests.figures import describe_figure, keep_figures, list_words

APPROVED = Path(__file__).with_name("approved")
ARTICLE = Design.load("article", changes=["detector.threshold_v=0.017"])
T = np.arange(8000) / 2000
NOISE_V = np.random.default_rng(3).normal(0.0, 4e-4, len(T))


def during(*parts: tuple[float, float]) -> np.ndarray:
    return np.logical_or.reduce([(start <= T) & (end > T) for start, end in parts])


def record(
    bursts: np.ndarray, slip: np.ndarray | None = None, origin: Origin | None = None
) -> Trace:
    """Noise with a tone of 10 mV at 90 Hz during the bursts; the
    slip that is stated may be another one.
    """
    volts = 2.3 + NOISE_V + 0.01 * np.sin(2 * np.pi * 90 * T) * bursts
    return Trace(T, volts, 1.0 + 0 * T, slip, 0.1 * bursts, origin=origin or Origin())


SLIP = during((1.5, 2.0))
MANY = during((0.9, 1.0), (1.5, 2.0), (2.6, 2.9), (3.2, 3.4))
"""Vibration without slip, a slip that is found, and one before
which the detector is ON; a fourth is missed.
"""
STATED = during((1.5, 2.0), (2.7, 2.9), (3.21, 3.4), (3.7, 3.75))
FILTERED_V = 1.47 + SlipChain(ChainSettings.from_design(Design())).filter(record(SLIP).voltage_v)
CASES = {
    "digital, many": (record(MANY, STATED), "digital"),
    "analog, many": (record(MANY, STATED), "analog"),
    "fast, simulated with a motion": (record(SLIP, SLIP, Origin(True, 1.487)), "fast"),
    "fft, simulated": (record(SLIP, SLIP, Origin(True)), "fft"),
    "digital, truth unknown": (record(SLIP), "digital"),
    "fast, nothing found": (record(during((9.0, 9.0)), SLIP), "fast"),
    "fast, with a filtered signal": (replace(record(SLIP, SLIP), filtered_v=FILTERED_V), "fast"),
    "digital, nothing at all": (record(during((9.0, 9.0))), "digital"),
}


@pytest.mark.every_case
@pytest.mark.parametrize("name", CASES)
def test_report_of_a_detection_is_the_approved_one(name: str) -> None:
    trace, detector = CASES[name]
    found = detect(trace, ARTICLE if trace.filtered_v is None else Design(), detector)
    is_drawn = name == "fast, simulated with a motion"
    path = APPROVED / f"{name.replace(', ', '_').replace(' ', '_')}.txt"
    with keep_figures() as figures:
        plot_detection(found, "title")
        if is_drawn:
            draw_trace(trace)
    drawn = (
        (line for one in figures for line in describe_figure(one))
        if is_drawn
        else list_words(figures)
    )
    lines = [
        *as_text(found).splitlines(),
        repr(found),
        found._repr_html_().replace("<tr>", "\n<tr>"),
    ]
    lines += (*list_data(as_data(found, found.noise)), *drawn)
    check_figures(path, lines, 1e-3, 1e-9)


def test_threshold_drawn_is_the_one_of_each_sample() -> None:
    trace, detector = CASES["fast, simulated with a motion"]
    found = detect(trace, ARTICLE, detector)
    with keep_figures() as figures:
        plot_detection(found)
    assert found.threshold.lowest_v < found.threshold.highest_v
    for axes in (figures[0].axes[1], figures[0].axes[3]):
        (drawn,) = [
            line for line in axes.get_lines() if str(line.get_label()).startswith("threshold")
        ]
        assert np.array_equal(drawn.get_ydata(), 1000 * found.output.threshold_v)


def test_incipient_slip_that_never_becomes_on_is_listed() -> None:
    trace, detector = CASES["fast, simulated with a motion"]
    found = detect(trace, ARTICLE, detector)
    assert found.incipient is not None
    assert "never ON" not in as_text(found)
    early = tuple(Interval(0.3 + 0.1 * i, 0.31 + 0.1 * i) for i in range(11))
    text = as_text(replace(found, incipient=(*early, *found.incipient)))
    assert text.count("never ON") == 10
    assert re.search(r"^incipient +0\.3000 s to +0\.3100 s, never ON$", text, re.MULTILINE)
    assert "and 1 more\n" in text


@pytest.mark.parametrize(
    ("beside", "noise", "stated"), [(-1e-6, "14 mV", "0.64 mV"), (1e-6, "15 mV", "0.65 mV")]
)
def test_figures_of_warnings_of_noise_are_rounded_at_their_edges(
    beside: float, noise: str, stated: str
) -> None:
    """A factor of 999 or 1001 would show."""
    design = Design.load(changes={"detector.noise_v": 0.645e-3 * (1 + beside)})
    noise_v = 14.5e-3 * (1 + beside)
    before = detect(record(SLIP), design, "fast")
    for warnings in (
        calibration_warnings(noise_v, before, slice(9), design, "it"),
        noise_warnings(noise_v, design, None),
    ):
        (said,) = warnings
        assert re.findall(r"[\d.]+ mV", said) == [noise, stated]
    assert bool([*noise_warnings(5 * 0.645e-3, design, None)]) == (beside < 0), (
        "the training draws up to 5 times"
    )


def test_hum_is_told_above_1_mv_rms_where_it_stands_out() -> None:
    """Hann's window leaves half of a tone 2 Hz beside it: 3/4 is the
    median at 6 and 8 Hz from the hum, 4 the ratio.
    """
    tones = np.sin(2 * np.pi * np.outer([44, 50, 56], np.arange(4000) / 2000))
    for hum_v, beside, is_told in (
        (1.42e-3, 0, 1),
        (1.41e-3, 0, 0),
        (0.01, 0.33, 1),
        (0.01, 0.34, 0),
    ):
        assert (
            len([*hum_warnings(hum_v * np.array([beside, 1, beside]) @ tones, 2000.0)]) == is_told
        )
