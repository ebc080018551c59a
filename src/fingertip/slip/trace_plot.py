"""Plot of a trace without a detection."""

from __future__ import annotations

from fingertip.plot_style import BLUE, ORANGE, RED, TEAL, new_figure, style_axes, to_png
from fingertip.slip.intervals import intervals
from fingertip.slip.traces.trace import Trace


def draw_trace(trace: Trace) -> bytes:
    """Draw the columns of a trace below each other, with the true slips shaded, as PNG.

    Raises
    ------
    MissingLibraryError
        If matplotlib is not installed.
    """
    columns = [
        (label, values, colour)
        for label, values, colour in (
            ("tactile voltage [V]", trace.voltage_v, BLUE),
            ("normal force [N]", trace.force_n, TEAL),
            ("envelope [V]", trace.envelope_v, ORANGE),
            ("filtered signal [V]", trace.filtered_v, RED),
        )
        if values is not None
    ]
    figure = new_figure(10, 1.0 + 2.2 * len(columns))
    panels = figure.subplots(len(columns), 1, sharex=True, squeeze=False)[:, 0]
    for axes, (label, values, colour) in zip(panels, columns, strict=True):
        style_axes(axes, "both")
        for slip in () if trace.slip is None else intervals(trace.time_s, trace.slip):
            axes.axvspan(slip.onset_s, slip.end_s, color="0.8", linewidth=0)
        axes.plot(trace.time_s, values, color=colour, linewidth=0.8)
        axes.set_ylabel(label)
    panels[-1].set_xlabel("time [s]; shaded: true slip" if trace.slip is not None else "time [s]")
    figure.align_ylabels()
    return to_png(figure)
