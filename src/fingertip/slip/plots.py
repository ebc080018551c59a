"""Plots of traces and of detections over time. This is the only module of `slip` that draws."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fingertip.foundation import display as style
from fingertip.foundation.display import Picture
from fingertip.slip.detection_results import DETECTED, format_delay, format_motion_delay
from fingertip.slip.detectors.analog_and_digital import ChainOutput
from fingertip.slip.detectors.registry import find_detector_type
from fingertip.slip.scored_detection import Detection
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import BAND_LABEL, Interval, encoder_band_s, intervals

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BEFORE_S = 0.06
_AFTER_S = 0.14
"""Time before and after an onset that is drawn larger [s]."""


def plot_trace(trace: Trace) -> Picture:
    """Draw the columns of a trace over time, with the true slips shaded.

    Raises MissingLibraryError if matplotlib is not installed.
    """
    return Picture(draw_trace(trace))


def plot_detection(detection: Detection, title: str = "") -> Picture:
    """Draw voltage, statistic with threshold, and ON/OFF over time, below them the first onset
    enlarged.

    Raises MissingLibraryError if matplotlib is not installed.
    """
    return Picture(draw_detection(detection, title or f"detector {detection.detector}"))


def draw_detection(detection: Detection, title: str) -> bytes:
    """Draw a detection as PNG. Raises MissingLibraryError."""
    trace = detection.trace
    slips = None if trace.slip is None else intervals(trace.time_s, trace.slip)
    onset = _find_onset(detection, slips)
    bars = 1.0 if detection.incipient is None else 1.4
    figure = style.new_figure(10, 6 + bars if onset is None else 8.6 + bars)
    ratios = (3, 3, bars) if onset is None else (3, 3, bars, 3)
    top, middle, bottom, *large = figure.subplots(len(ratios), 1, height_ratios=ratios)

    for axes in (top, middle):
        axes.sharex(bottom)
        axes.tick_params(labelbottom=False)

    for axes in (top, middle, *large):
        for slip in slips or ():
            axes.axvspan(slip.onset_s, slip.end_s, color=style.TRUTH, alpha=0.3, linewidth=0)

        axes.grid(True, color=style.GRID_COLOUR, linewidth=0.7)

    figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
    _draw_voltage(top, trace, detection)
    _draw_statistic(middle, trace, detection)

    if trace.origin.motion_s is not None:
        begin_s, end_s = encoder_band_s(trace.origin.motion_s)
        for axes in (top, middle, *large):  # an edge keeps the band visible where it is narrow
            axes.axvspan(
                begin_s,
                end_s,
                color=style.ORANGE,
                alpha=0.35,
                linewidth=1.0,
                label=BAND_LABEL,
            )

    # Above the axes, where it covers no data
    middle.legend(
        loc="lower left",
        bbox_to_anchor=(0.0, 1.0),
        borderaxespad=0.2,
        frameon=False,
        ncols=2,
        fontsize=9,
    )
    _draw_intervals(bottom, trace, detection, slips)
    bottom.set_xlim(float(trace.time_s[0]), float(trace.time_s[-1]))
    if onset is not None:
        _draw_onset(large[0], trace, detection, onset)

    (large or [bottom])[-1].set_xlabel("time [s]")
    figure.align_ylabels()
    for axes in (top, middle, bottom, *large):
        axes.spines[["top", "right"]].set_visible(False)

    return style.to_png(figure)


Onset = tuple[float | None, float | None]
"""True onset and the detector's ON of one slip [s]; None stands
for what is unknown, or does not occur.
"""


def _find_onset(detection: Detection, slips: Sequence[Interval] | None) -> Onset | None:
    """Find the onset to draw larger, of the first slip that was
    detected; None if nothing slips or is detected.
    """
    if detection.score is None or not slips:
        return (None, detection.intervals[0].onset_s) if detection.intervals else None

    pairs = zip(detection.score.slips, detection.score.delays_s, strict=True)
    found = next(((slip.onset_s, delay) for slip, delay in pairs if delay is not None), None)
    return (slips[0].onset_s, None) if found is None else (found[0], found[0] + found[1])


def _draw_onset(axes: Axes, trace: Trace, detection: Detection, onset: Onset) -> None:
    _draw_statistic(axes, trace, detection)
    true_s, detected_s = onset
    at = true_s if true_s is not None else detected_s
    assert at is not None
    begin_s = at if trace.origin.motion_s is None else min(at, trace.origin.motion_s)
    low = begin_s - _BEFORE_S
    high = at + _AFTER_S
    if detected_s is not None and detected_s > high:
        high = detected_s + _BEFORE_S

    axes.set_xlim(max(low, float(trace.time_s[0])), min(high, float(trace.time_s[-1])))
    inside = (trace.time_s >= low) & (trace.time_s <= high)
    statistic = detection.output.statistic_v[inside]
    threshold = detection.output.threshold_v[inside]
    top = 1000 * 1.9 * max(float(np.nanmax(threshold)), 0.6 * float(np.nanmax(statistic)))
    axes.set_ylim(0.0, top)

    for moment, line in ((true_s, "-"), (detected_s, "--")):
        if moment is not None:
            axes.axvline(moment, color=style.BLUE, linewidth=1.2, linestyle=line)

    title = "first detection, enlarged; true slip is unknown"
    if true_s is not None and detected_s is not None:
        delay_ms = 1000 * (detected_s - true_s)
        title = (
            f"first detected onset, enlarged: line at the onset, dashes at ON, {delay_ms:.1f} "
            "ms later"
        )
        axes.annotate(
            "",
            (true_s, 0.86 * top),
            (detected_s, 0.86 * top),
            arrowprops={
                "arrowstyle": "<->",
                "color": style.BLUE,
                "shrinkA": 0,
                "shrinkB": 0,
            },
        )
        axes.annotate(
            f"{delay_ms:.1f} ms",
            (min(true_s, detected_s), 0.86 * top),
            xytext=(-6, 0),
            textcoords="offset points",
            ha="right",
            va="center",
            fontsize=10,
            fontweight="bold",
            color=style.BLUE,
            bbox={
                "facecolor": "white",
                "edgecolor": "none",
                "alpha": 0.85,
                "pad": 1.5,
            },
        )
    elif true_s is not None:
        title = "first onset, enlarged: it is not detected"

    axes.set_title(title, loc="left", fontsize=9, color=style.TEXT_COLOUR)


def _draw_voltage(axes: Axes, trace: Trace, detection: Detection) -> None:
    """Draw the voltage, and beside it the true force, or the one
    that the voltage means within its interval.
    """
    axes.plot(trace.time_s, trace.voltage_v, color=style.BLUE, linewidth=0.8)
    axes.set_ylabel(
        "tactile voltage [V]" if detection.threshold.unit == "mV" else "force", color=style.BLUE
    )
    force_n = trace.force_n
    label = "normal force [N]"
    scale = detection.scale
    if force_n is None and scale is None:
        return

    twin = axes.twinx()
    if force_n is None and scale is not None:
        low_n, force_n, high_n = scale.read_all(trace.voltage_v)
        twin.fill_between(
            trace.time_s, low_n, high_n, color=style.REFERENCE, alpha=0.12, linewidth=0
        )
        label = "force by the curve [N]"

    assert force_n is not None
    twin.plot(trace.time_s, force_n, color=style.REFERENCE, linewidth=0.8)
    twin.set_ylabel(label, color=style.TEXT_COLOUR)
    twin.set_ylim(0.0, max(0.1, 1.15 * float(np.max(force_n))))
    twin.spines["top"].set_visible(False)
    axes.set_zorder(twin.get_zorder() + 1)
    axes.patch.set_visible(False)


def _draw_statistic(axes: Axes, trace: Trace, detection: Detection) -> None:
    output = detection.output
    label = "statistic"
    envelope = None

    if isinstance(output, ChainOutput):
        envelope = output.envelope_v
    elif find_detector_type(detection.detector).takes_envelope:
        envelope = trace.envelope_v

    if envelope is not None:
        axes.plot(
            trace.time_s, 1000 * envelope, color=style.ORANGE, linewidth=0.7, label="envelope"
        )
        label = f"mean over {1000 * detection.memory_s:g} ms"

    axes.plot(trace.time_s, 1000 * output.statistic_v, color=style.RED, linewidth=1.4, label=label)
    axes.plot(
        trace.time_s,
        1000 * output.threshold_v,
        color="black",
        linestyle="--",
        linewidth=1,
        label=detection.threshold.describe(),
    )
    # The envelope of contacts and releases is much larger than the statistic, so the axis is scaled
    # to the statistic.
    axes.set_ylim(
        0.0,
        max(2500 * float(np.nanmax(output.threshold_v)), 1350 * float(np.max(output.statistic_v))),
    )
    quantity = detection.threshold.quantity if envelope is None else "envelope"
    axes.set_ylabel(f"{quantity} [{detection.threshold.unit}]")


def _draw_intervals(
    axes: Axes, trace: Trace, detection: Detection, slips: Sequence[Interval] | None
) -> None:
    rows = [(DETECTED, detection.intervals, style.RED)]
    if detection.incipient is not None:
        rows.insert(0, ("incipient", detection.incipient, style.ORANGE))
    if slips is not None:
        rows.append((trace.origin.truth.replace(" (", "\n("), tuple(slips), style.TRUTH))

    draw_bars(axes, rows)
    axes.tick_params(axis="y", length=0)
    axes.grid(True, axis="x", color=style.GRID_COLOUR, linewidth=0.7)
    axes.set_axisbelow(True)

    if detection.score is not None:
        phrases = [
            f"detector {detection.detector}",
            *(format_delay(delay) for delay in detection.score.delays_s),
        ]
        phrases += [
            format_motion_delay(d) for d in detection.motion_delays_s or () if d is not None
        ]
        phrases.append(f"false intervals: {len(detection.score.false_intervals)}")
        axes.set_title("; ".join(phrases), loc="left", fontsize=9, color=style.TEXT_COLOUR)


def draw_bars(axes: Axes, rows: Sequence[tuple[str, Sequence[Interval], str]]) -> None:
    """Draw one row of intervals per name in a colour."""
    for row, (_, parts, colour) in enumerate(rows):
        spans = [(part.onset_s, part.end_s - part.onset_s) for part in parts]
        axes.broken_barh(spans, (row - 0.35, 0.7), color=colour, linewidth=0)

    axes.set_yticks(range(len(rows)), [name for name, _, _ in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)


def draw_trace(trace: Trace) -> bytes:
    """Draw the columns of a trace below each other, with the true slips shaded, as PNG.

    Raises MissingLibraryError.
    """
    columns = [
        ("tactile voltage [V]", trace.voltage_v, style.BLUE),
        ("normal force [N]", trace.force_n, style.TEAL),
        ("envelope [V]", trace.envelope_v, style.ORANGE),
        ("filtered signal [V]", trace.filtered_v, style.RED),
    ]
    columns = [column for column in columns if column[1] is not None]
    figure = style.new_figure(10, 1.0 + 2.2 * len(columns))
    panels = figure.subplots(len(columns), 1, sharex=True, squeeze=False)[:, 0]

    for axes, (label, values, colour) in zip(panels, columns, strict=True):
        style.style_axes(axes, "both")
        for slip in () if trace.slip is None else intervals(trace.time_s, trace.slip):
            axes.axvspan(slip.onset_s, slip.end_s, color="0.8", linewidth=0)

        axes.plot(trace.time_s, values, color=colour, linewidth=0.8)
        axes.set_ylabel(label)

    panels[-1].set_xlabel("time [s]; shaded: true slip" if trace.slip is not None else "time [s]")
    figure.align_ylabels()
    return style.to_png(figure)
