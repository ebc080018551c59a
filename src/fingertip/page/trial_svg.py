"""Plots of a trial: the tactile voltage, the detector's statistic and threshold, and bars of slip,
one below the other over the same time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from fingertip.foundation.numerics import Array
from fingertip.page.html import Markup, element
from fingertip.page.svg import Axis, Frame, figure_svg, legend, line, text
from fingertip.slip.detection_results import DETECTED
from fingertip.slip.scored_detection import Detection
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import BAND_LABEL, Interval, encoder_band_s

Span = tuple[float, float]
"""Begin and end [s]."""
_WIDTH = 760.0
_HEIGHT = 420.0
_LEFT = 62.0
_PLOT_WIDTH = 676.0
"""Size of the figure, and left side and width of its plots [px]."""
_BAR_PITCH = 20.0
"""Distance of the bars of true and of detected slip [px]."""
_COLUMNS = 640
"""Columns to which longer lines are reduced: each keeps its lowest and highest sample."""

_TRUE = "var(--slip)"
_MOTION = "var(--band)"
_VOLTAGE = "var(--series-1)"
_STATISTIC = "var(--series-2)"
_THRESHOLD = "var(--series-3)"
_THRESHOLD_DASHES = "6 4"


@dataclass(frozen=True)
class Window:
    """Time of a trial that the plots show [s]."""

    begin_s: float
    end_s: float

    def clip(self, intervals: Iterable[Interval]) -> list[Span]:
        """Cut intervals to the window; those outside of it are left out."""
        return [
            (max(interval.onset_s, self.begin_s), min(interval.end_s, self.end_s))
            for interval in intervals
            if interval.onset_s < self.end_s and interval.end_s > self.begin_s
        ]


@dataclass(frozen=True)
class Delay:
    """Onset of a true slip, and of the interval in which it was detected [s]."""

    onset_s: float
    detected_s: float


@dataclass(frozen=True)
class _Samples:
    """Samples within a window."""

    time_s: Array
    voltage_v: Array
    statistic_mv: Array
    threshold_mv: Array

    @classmethod
    def within(cls, window: Window, trace: Trace, detection: Detection) -> _Samples:
        first, last = np.searchsorted(trace.time_s, (window.begin_s, window.end_s))
        shown = slice(int(first), int(last) + 1)

        return cls(
            time_s=trace.time_s[shown],
            voltage_v=trace.voltage_v[shown],
            statistic_mv=1000 * detection.output.statistic_v[shown],
            threshold_mv=1000 * detection.output.threshold_v[shown],
        )


@dataclass(frozen=True)
class _Plots:
    """Frames of the plots, from top to bottom."""

    voltage: Frame
    statistic: Frame
    bars: Frame

    def shade(self, spans: Sequence[Span], colour: str, opacity: float) -> Iterator[Markup]:
        """Shade spans of time in the plots of voltage and statistic."""
        for frame in (self.voltage, self.statistic):
            for begin_s, end_s in spans:
                yield frame.span(begin_s, end_s, colour, opacity)


def draw_trial(
    trace: Trace,
    detection: Detection,
    window: Window,
    title: str,
    delay: Delay | None = None,
) -> Markup:
    """Draw the plots of a trial, and mark a delay in them."""
    samples = _Samples.within(window, trace, detection)
    plots = _place_plots(window, samples, detection.threshold.quantity)
    slips = detection.score.slips if detection.score else ()
    truth = trace.origin.truth
    motion_s = trace.origin.motion_s

    parts = [
        plots.voltage.axes(label_x=False, ticks_y=4),
        plots.statistic.axes(label_x=False, ticks_y=4),
        *plots.shade(window.clip(slips), _TRUE, 0.18),
    ]
    if motion_s is not None:
        motion = Interval(*encoder_band_s(motion_s))
        parts += plots.shade(window.clip([motion]), _MOTION, 0.45)

    bars = (
        (truth.partition(" (")[0], window.clip(slips), _TRUE),
        (DETECTED, window.clip(detection.intervals), _STATISTIC),
    )
    parts += _draw_lines(plots, samples)
    parts += _draw_bars(plots.bars, bars)
    parts += _draw_time_axis(plots.bars)
    if delay:
        parts += _mark_delay(plots, delay)

    lines = (
        (_STATISTIC, "", "statistic"),
        (_THRESHOLD, _THRESHOLD_DASHES, "threshold"),
        (_TRUE, "band", truth),
    )
    parts.append(legend(280.0, 182.0, lines))
    if motion_s is not None:
        parts.append(legend(280.0, 20.0, ((_MOTION, "band", BAND_LABEL),)))

    return figure_svg(_WIDTH, _HEIGHT, title, *parts)


def _place_plots(window: Window, samples: _Samples, quantity: str) -> _Plots:
    """Place the plots, with axes that hold all samples."""
    time = Axis(window.begin_s, window.end_s, "time [s]")
    voltage_v = samples.voltage_v
    margin_v = 0.08 * max(float(np.ptp(voltage_v)), 1e-3)
    voltage = Axis(
        float(voltage_v.min()) - margin_v,
        float(voltage_v.max()) + margin_v,
        "tactile voltage [V]",
    )
    highest_mv = max(float(samples.statistic_mv.max()), 1.6 * float(samples.threshold_mv.max()))
    statistic = Axis(0.0, 1.15 * highest_mv, f"{quantity} [mV]")

    return _Plots(
        voltage=_place_plot(time, voltage, top=28.0, height=120.0),
        statistic=_place_plot(time, statistic, top=190.0, height=110.0),
        bars=_place_plot(time, Axis(0.0, 2.0, ""), top=316.0, height=2 * _BAR_PITCH),
    )


def _place_plot(time: Axis, y: Axis, top: float, height: float) -> Frame:
    return Frame(
        x=time,
        y=y,
        left=_LEFT,
        top=top,
        width=_PLOT_WIDTH,
        height=height,
    )


def _draw_lines(plots: _Plots, samples: _Samples) -> Iterator[Markup]:
    voltage = reduce_line(samples.time_s, samples.voltage_v)
    threshold = reduce_line(samples.time_s, samples.threshold_mv)
    statistic = reduce_line(samples.time_s, samples.statistic_mv)

    yield plots.voltage.line(voltage, _VOLTAGE, 1.2)
    yield plots.statistic.line(threshold, _THRESHOLD, 1.5, _THRESHOLD_DASHES)
    yield plots.statistic.line(statistic, _STATISTIC, 1.6)


def reduce_line(x: Array, y: Array) -> list[tuple[float, float]]:
    """Reduce a long line to the lowest and highest sample of each column, in order of time."""
    if len(x) <= 2 * _COLUMNS:
        return list(zip(x.tolist(), y.tolist(), strict=True))

    points: list[tuple[float, float]] = []
    for column in np.array_split(np.arange(len(x)), _COLUMNS):
        lowest = int(column[y[column].argmin()])
        highest = int(column[y[column].argmax()])
        points += [(float(x[i]), float(y[i])) for i in sorted({lowest, highest})]

    return points


def _draw_bars(frame: Frame, bars: Iterable[tuple[str, Sequence[Span], str]]) -> Iterator[Markup]:
    """Draw bars of slip, each by its name, the spans in which slip lasts, and its colour."""
    for row, (name, spans, colour) in enumerate(bars):
        top = frame.top + _BAR_PITCH * row
        yield text(frame.left - 6, top + 12, name, "end")
        for begin_s, end_s in spans:
            left = frame.point(begin_s, 0.0)[0]
            right = frame.point(end_s, 0.0)[0]
            yield element(
                "rect",
                x=f"{left:.1f}",
                y=top + 2,
                width=f"{right - left:.1f}",
                height=14,
                fill=colour,
            )


def _draw_time_axis(frame: Frame) -> Iterator[Markup]:
    """Draw the axis of time below the bars, which is that of all plots."""
    bottom = frame.top + frame.height
    for time_s in frame.x.ticks(8):
        x = frame.point(time_s, 0.0)[0]
        yield text(x, bottom + 17, f"{time_s:g}", "middle")
        yield line((x, bottom), (x, bottom + 4), "var(--text)", 1)

    yield text(frame.left + frame.width / 2, bottom + 36, frame.x.label, "middle")


def _mark_delay(plots: _Plots, delay: Delay) -> Iterator[Markup]:
    """Mark both ends of a delay by lines through the plots, and write it between them."""
    for time_s, colour in ((delay.onset_s, _TRUE), (delay.detected_s, _STATISTIC)):
        x, bottom = plots.statistic.point(time_s, 0.0)
        _, top = plots.voltage.point(time_s, plots.voltage.y.high)
        yield line(
            (x, top),
            end=(x, bottom),
            colour=colour,
            width=1.5,
            dashes="3 3",
        )

    onset_x, top = plots.voltage.point(delay.onset_s, plots.voltage.y.high)
    detected_x, _ = plots.voltage.point(delay.detected_s, plots.voltage.y.high)
    delay_ms = 1000 * (delay.detected_s - delay.onset_s)
    yield line((onset_x, top + 12), (detected_x, top + 12), "var(--text)", 1.5)
    yield text(max(onset_x, detected_x) + 6, top + 16, f"{delay_ms:.1f} ms", weight="600")
