"""Plot of a detection: the delay can be read in it, and the threshold is the one that was used."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fingertip import Design, Trace, detect, simulate
from fingertip.slip import report as plot
from fingertip.slip.traces.truth import BAND_LABEL, Origin
from tests.tools import require_module


@pytest.fixture(scope="module")
def trace() -> Trace:
    return simulate(Design())


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Figures in place of pictures."""
    require_module("matplotlib")
    figures: list[Any] = []

    def keep(figure: Any) -> bytes:
        figure.canvas.draw()
        figures.append(figure)
        return b""

    monkeypatch.setattr(plot, "to_png", keep)
    return figures


def find_delay_s(figure: Any) -> float:
    """Distance of the vertical lines of the last panel."""
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
