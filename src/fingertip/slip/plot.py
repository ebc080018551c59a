"""A detection as a picture. The only module of `slip` that imports matplotlib."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from fingertip.drawing import GRID, INK, png, sheet
from fingertip.slip.detection import Detection
from fingertip.slip.detectors.chain import ChainOutput
from fingertip.slip.detectors.registry import DETECTORS
from fingertip.slip.intervals import Interval, intervals
from fingertip.slip.traces.trace import Trace
from fingertip.slip.words import verdict

_VOLTAGE, _FORCE, _ENVELOPE, _MEAN, _ON, _TRUTH = (
    "#1f4e79",
    "#b0b7bf",
    "#f0b27a",
    "#b03a2e",
    "#c0392b",
    "#7fb3a6",
)


def draw(trace: Trace, detection: Detection, title: str) -> bytes:
    """Draw voltage, enveloped signal and ON/OFF over one time axis.

    Returns
    -------
    bytes
        A PNG, 1500 x 1050 pixels, the same for the same data (no date, no version in it).
    """
    figure = sheet(10, 7)
    top, middle, bottom = figure.subplots(3, 1, sharex=True, height_ratios=(3, 3, 1))
    truth = None if trace.slip is None else intervals(trace.time_s, trace.slip)
    for axes in (top, middle):
        for slip in truth or ():
            axes.axvspan(slip.onset_s, slip.end_s, color=_TRUTH, alpha=0.25, linewidth=0)
        axes.grid(True, color=GRID, linewidth=0.7)
    figure.suptitle(title, x=0.01, ha="left", fontweight="bold")
    _voltage(top, trace)
    _enveloped(middle, trace, detection)
    _on_off(bottom, detection, truth)
    bottom.set_xlabel("time [s]")
    bottom.set_xlim(float(trace.time_s[0]), float(trace.time_s[-1]))
    figure.align_ylabels()
    for axes in (top, middle, bottom):
        axes.spines[["top", "right"]].set_visible(False)
    return png(figure)


def _voltage(axes: Axes, trace: Trace) -> None:
    axes.plot(trace.time_s, trace.voltage_v, color=_VOLTAGE, linewidth=0.8)
    axes.set_ylabel("tactile voltage [V]", color=_VOLTAGE)
    if trace.force_n is None:
        return
    twin = axes.twinx()
    twin.plot(trace.time_s, trace.force_n, color=_FORCE, linewidth=0.8)
    twin.set_ylabel("normal force [N]", color="#7b848d")
    twin.set_ylim(0.0, max(0.1, 1.15 * float(np.max(trace.force_n))))
    twin.spines["top"].set_visible(False)
    axes.set_zorder(twin.get_zorder() + 1)
    axes.patch.set_visible(False)


def _enveloped(axes: Axes, trace: Trace, detection: Detection) -> None:
    output, what, envelope = detection.output, "level", None
    if isinstance(output, ChainOutput):
        envelope = output.envelope_v
    elif DETECTORS[detection.detector].reads == "envelope_v":
        envelope = trace.envelope_v
    if envelope is not None:
        axes.plot(trace.time_s, 1000 * envelope, color=_ENVELOPE, linewidth=0.7, label="envelope")
        what = f"mean over {1000 * detection.memory_s:g} ms"
    axes.plot(trace.time_s, 1000 * output.level_v, color=_MEAN, linewidth=1.4, label=what)
    bar = 1000 * output.bar_v
    still = f"threshold {1000 * detection.threshold_v:.3g} mV"
    axes.plot(trace.time_s, bar, color="black", linestyle="--", linewidth=1, label=still)
    # Contact and release tower above everything: the level decides, so the axis follows it.
    axes.set_ylim(0.0, max(2500 * detection.threshold_v, 1350 * float(np.max(output.level_v))))
    axes.set_ylabel(f"{detection.detector} [mV]" if envelope is None else "enveloped signal [mV]")
    axes.legend(loc="upper right", frameon=False, ncols=3, fontsize=9)


def _on_off(axes: Axes, detection: Detection, truth: Sequence[Interval] | None) -> None:
    rows = [("detected", detection.intervals, _ON)]
    if truth is not None:
        rows.append(("true slip", tuple(truth), _TRUTH))
    for row, (_, parts, color) in enumerate(rows):
        axes.broken_barh([(p.onset_s, p.end_s - p.onset_s) for p in parts], (row - 0.35, 0.7), color=color, linewidth=0)
    axes.set_yticks(range(len(rows)), [name for name, _, _ in rows])
    axes.set_ylim(-0.6, len(rows) - 0.4)
    axes.invert_yaxis()
    axes.tick_params(axis="y", length=0)
    axes.grid(True, axis="x", color=GRID, linewidth=0.7)
    axes.set_axisbelow(True)
    if detection.score is not None:
        words = [verdict(delay) for delay in detection.score.delays_s]
        words.append(f"false intervals: {len(detection.score.false_intervals)}")
        axes.set_title("; ".join(words), loc="left", fontsize=9, color=INK)
