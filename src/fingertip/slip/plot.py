"""Plot of a detection. This is the only module of `slip` that draws."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from fingertip.plot_style import GRID_COLOUR, TEXT_COLOUR, new_figure, to_png
from fingertip.slip.detection import Detection
from fingertip.slip.detectors.digital import ChainOutput
from fingertip.slip.detectors.registry import DETECTORS
from fingertip.slip.format import format_delay
from fingertip.slip.intervals import Interval, intervals
from fingertip.slip.traces.trace import Trace

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_VOLTAGE_COLOUR = "#1f4e79"
_FORCE_COLOUR = "#b0b7bf"
_ENVELOPE_COLOUR = "#f0b27a"
_STATISTIC_COLOUR = "#b03a2e"
_DETECTED_COLOUR = "#c0392b"
_SLIP_COLOUR = "#7fb3a6"


def draw(trace: Trace, detection: Detection, title: str) -> bytes:
    """Draw the voltage, the statistic with its threshold, and ON/OFF over a common time axis.

    Returns
    -------
    bytes
        PNG of 1500 x 1050 pixels. It contains no date and no version, so the same data gives the same bytes.
    """
    figure = new_figure(10, 7)
    top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=(3, 3, 1))
    slips = None if trace.slip is None else intervals(trace.time_s, trace.slip)
    for axes in (top, middle):
        for slip in slips or ():
            axes.axvspan(slip.onset_s, slip.end_s, color=_SLIP_COLOUR, alpha=0.25, linewidth=0)
        axes.grid(True, color=GRID_COLOUR, linewidth=0.7)
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
    _draw_voltage(top, trace)
    _draw_statistic(middle, trace, detection)
    _draw_intervals(bottom, detection, slips)
    bottom.set_xlabel("time [s]")
    bottom.set_xlim(float(trace.time_s[0]), float(trace.time_s[-1]))
    figure.align_ylabels()
    for axes in (top, middle, bottom):
        axes.spines[["top", "right"]].set_visible(False)
    return to_png(figure)


def _draw_voltage(axes: Axes, trace: Trace) -> None:
    axes.plot(trace.time_s, trace.voltage_v, color=_VOLTAGE_COLOUR, linewidth=0.8)
    axes.set_ylabel("tactile voltage [V]", color=_VOLTAGE_COLOUR)
    if trace.force_n is None:
        return
    twin = axes.twinx()
    twin.plot(trace.time_s, trace.force_n, color=_FORCE_COLOUR, linewidth=0.8)
    twin.set_ylabel("normal force [N]", color="#7b848d")
    twin.set_ylim(0.0, max(0.1, 1.15 * float(np.max(trace.force_n))))
    twin.spines["top"].set_visible(False)
    axes.set_zorder(twin.get_zorder() + 1)
    axes.patch.set_visible(False)


def _draw_statistic(axes: Axes, trace: Trace, detection: Detection) -> None:
    output, label, envelope = detection.output, "statistic", None
    if isinstance(output, ChainOutput):
        envelope = output.envelope_v
    elif DETECTORS[detection.detector].input_column == "envelope_v":
        envelope = trace.envelope_v
    if envelope is not None:
        axes.plot(trace.time_s, 1000 * envelope, color=_ENVELOPE_COLOUR, linewidth=0.7, label="envelope")
        label = f"mean over {1000 * detection.memory_s:g} ms"
    axes.plot(trace.time_s, 1000 * output.statistic_v, color=_STATISTIC_COLOUR, linewidth=1.4, label=label)
    threshold_label = f"threshold {1000 * detection.threshold_v:.3g} mV"
    axes.plot(
        trace.time_s, 1000 * output.threshold_v, color="black", linestyle="--", linewidth=1, label=threshold_label
    )
    # The envelope of contacts and releases is much larger than the statistic, so the axis is scaled to the statistic.
    axes.set_ylim(0.0, max(2500 * detection.threshold_v, 1350 * float(np.max(output.statistic_v))))
    axes.set_ylabel(f"{detection.detector} [mV]" if envelope is None else "envelope [mV]")
    axes.legend(loc="upper right", frameon=False, ncols=3, fontsize=9)


def _draw_intervals(axes: Axes, detection: Detection, slips: Sequence[Interval] | None) -> None:
    rows = [("detected", detection.intervals, _DETECTED_COLOUR)]
    if slips is not None:
        rows.append(("true slip", tuple(slips), _SLIP_COLOUR))
    for row, (_, parts, color) in enumerate(rows):
        axes.broken_barh([(p.onset_s, p.end_s - p.onset_s) for p in parts], (row - 0.35, 0.7), color=color, linewidth=0)
    axes.set_yticks(range(len(rows)), [name for name, _, _ in rows])
    axes.set_ylim(-0.6, len(rows) - 0.4)
    axes.invert_yaxis()
    axes.tick_params(axis="y", length=0)
    axes.grid(True, axis="x", color=GRID_COLOUR, linewidth=0.7)
    axes.set_axisbelow(True)
    if detection.score is not None:
        phrases = [format_delay(delay) for delay in detection.score.delays_s]
        phrases.append(f"false intervals: {len(detection.score.false_intervals)}")
        axes.set_title("; ".join(phrases), loc="left", fontsize=9, color=TEXT_COLOUR)
