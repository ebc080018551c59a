"""Trial section of a page: the simulated trace, and the slip that is detected in it.

Plots show the whole of it, and the onset of the first slip at a scale that shows the delay.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

import numpy as np

from fingertip.catalogues.output_files import DETECTION, SIGNAL_FOLDER, TRACE
from fingertip.detection.recordings import FileDetection, detect_file
from fingertip.foundation.files import temporary_folder
from fingertip.foundation.numerics import Array
from fingertip.page.html import Markup, element, figure, join, note
from fingertip.page.sources import COMMANDS, Sources
from fingertip.page.svg import Axis, Frame, figure_svg, legend, line, text
from fingertip.slip.detection_results import (
    DETECTED,
    describe_detector,
    format_delay,
    format_motion_delay,
)
from fingertip.slip.scored_detection import Detection
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import BAND_LABEL, Interval, encoder_band_s, parse_origin

_WIDTH = 760.0
_HEIGHT = 420.0
_BEFORE_S = 0.06
_AFTER_S = 0.12
"""Time before the onset of a slip and after it that the zoom shows [s]."""
_COLUMNS = 640
"""Columns to which longer lines are reduced: each keeps its lowest and highest sample."""


def draw_onset(trace: Trace, detection: Detection) -> Markup | None:
    """Draw the onset of the first slip that was detected, as a figure; None if there is none."""
    score = detection.score
    pairs = zip(score.slips, score.delays_s, strict=True) if score else ()
    first = next(((slip.onset_s, delay) for slip, delay in pairs if delay is not None), None)
    if first is None:
        return None

    onset_s, delay_s = first
    begin = max(float(trace.time_s[0]), onset_s - _BEFORE_S)
    end = min(float(trace.time_s[-1]), onset_s + max(_AFTER_S, 2 * delay_s))
    svg = _draw(
        trace,
        detection=detection,
        begin=begin,
        end=end,
        title="Onset of the slip and its detection",
        onset=(onset_s, onset_s + delay_s),
    )
    delays = format_delay(delay_s)
    if trace.origin.motion_s is not None:
        delays += f", {format_motion_delay(onset_s + delay_s - trace.origin.motion_s)}"

    caption = f"The onset at {onset_s:.4f} s, {delays}. Time on the axis is that of the trial."
    return figure(svg, caption, "onset of the slip", "wide")


def _draw(
    trace: Trace,
    detection: Detection,
    begin: float,
    end: float,
    title: str,
    onset: tuple[float, float] | None = None,
) -> Markup:
    low, high = np.searchsorted(trace.time_s, (begin, end))
    window = slice(int(low), int(high) + 1)
    time = trace.time_s[window]
    voltage = trace.voltage_v[window]
    statistic = 1000 * detection.output.statistic_v[window]
    threshold = 1000 * detection.output.threshold_v[window]
    across = Axis(begin, end, "time [s]")
    span = max(float(np.ptp(voltage)), 1e-3)
    upper = Frame(
        x=across,
        y=Axis(
            float(voltage.min()) - 0.08 * span,
            float(voltage.max()) + 0.08 * span,
            "tactile voltage [V]",
        ),
        left=62.0,
        top=28.0,
        width=_WIDTH - 84.0,
        height=120.0,
    )
    top = 1.15 * max(float(statistic.max()), 1.6 * float(threshold.max()))
    lower = Frame(
        x=across,
        y=Axis(0.0, top, f"{detection.threshold.quantity} [mV]"),
        left=62.0,
        top=190.0,
        width=_WIDTH - 84.0,
        height=110.0,
    )
    bars = Frame(
        x=across,
        y=Axis(0.0, 2.0, ""),
        left=62.0,
        top=316.0,
        width=_WIDTH - 84.0,
        height=40.0,
    )
    slips = detection.score.slips if detection.score else ()
    parts = [upper.axes(label_x=False, ticks_y=4), lower.axes(label_x=False, ticks_y=4)]
    for frame in (upper, lower):
        parts += [frame.span(*ends, "var(--slip)") for ends in _clip(slips, begin, end)]

    motion_s = trace.origin.motion_s
    if motion_s is not None:
        band = _clip([Interval(*encoder_band_s(motion_s))], begin, end)
        for frame in (upper, lower):
            parts += [frame.span(*ends, "var(--band)", 0.45) for ends in band]

    parts += [
        upper.line(_reduce(time, voltage), "var(--series-1)", 1.2),
        lower.line(_reduce(time, threshold), "var(--series-3)", 1.5, "6 4"),
        lower.line(_reduce(time, statistic), "var(--series-2)", 1.6),
        *_draw_bars(
            bars,
            slips=slips,
            detected=detection.intervals,
            truth=trace.origin.truth,
            begin=begin,
            end=end,
        ),
    ]
    if onset:
        parts += _mark_delay(upper, lower, *onset)

    parts.append(
        legend(
            280.0,
            182.0,
            (
                ("var(--series-2)", "", "statistic"),
                ("var(--series-3)", "6 4", "threshold"),
                ("var(--slip)", "band", trace.origin.truth),
            ),
        )
    )
    if motion_s is not None:
        parts.append(legend(280.0, 20.0, (("var(--band)", "band", BAND_LABEL),)))

    return figure_svg(_WIDTH, _HEIGHT, title, *parts)


def _mark_delay(upper: Frame, lower: Frame, onset_s: float, detected_s: float) -> Iterator[Markup]:
    for time_s, colour in ((onset_s, "var(--slip)"), (detected_s, "var(--series-2)")):
        x, low = lower.point(time_s, 0.0)
        _, high = upper.point(time_s, upper.y.high)
        yield line(
            (x, high),
            end=(x, low),
            colour=colour,
            width=1.5,
            dashes="3 3",
        )

    (x0, y), (x1, _) = (upper.point(time_s, upper.y.high) for time_s in (onset_s, detected_s))
    yield line((x0, y + 12), (x1, y + 12), "var(--text)", 1.5)
    yield text(max(x0, x1) + 6, y + 16, f"{1000 * (detected_s - onset_s):.1f} ms", weight="600")


def _draw_bars(
    frame: Frame,
    slips: Sequence[Interval],
    detected: Sequence[Interval],
    truth: str,
    begin: float,
    end: float,
) -> Iterator[Markup]:
    """Draw the intervals of true slip and of the detector, with the time axis below."""
    rows = (
        (truth.partition(" (")[0], slips, "var(--slip)"),
        (DETECTED, detected, "var(--series-2)"),
    )
    for row, (name, intervals, colour) in enumerate(rows):
        y = frame.top + 20.0 * row
        yield text(frame.left - 6, y + 12, name, "end")
        for start, stop in _clip(intervals, begin, end):
            x0 = frame.point(start, 0.0)[0]
            x1 = frame.point(stop, 0.0)[0]
            yield element(
                "rect",
                x=f"{x0:.1f}",
                y=y + 2,
                width=f"{x1 - x0:.1f}",
                height=14,
                fill=colour,
            )

    bottom = frame.top + frame.height
    for value in frame.x.ticks(8):
        x = frame.point(value, 0.0)[0]
        yield text(x, bottom + 17, f"{value:g}", "middle")
        yield line((x, bottom), (x, bottom + 4), "var(--text)", 1)

    yield text(frame.left + frame.width / 2, bottom + 36, frame.x.label, "middle")


def _clip(intervals: Sequence[Interval], begin: float, end: float) -> list[tuple[float, float]]:
    """Cut intervals to a window of time; those outside of it are left out."""
    return [
        (max(interval.onset_s, begin), min(interval.end_s, end))
        for interval in intervals
        if interval.onset_s < end and interval.end_s > begin
    ]


def _reduce(x: Array, y: Array) -> list[tuple[float, float]]:
    """Reduce a long line to the lowest and highest sample of each column, in order of time."""
    if len(x) <= 2 * _COLUMNS:
        return list(zip(x.tolist(), y.tolist(), strict=True))

    points: list[tuple[float, float]] = []
    for part in np.array_split(np.arange(len(x)), _COLUMNS):
        for i in sorted({int(part[y[part].argmin()]), int(part[y[part].argmax()])}):
            points.append((float(x[i]), float(y[i])))

    return points


def _describe(detection: Detection) -> str:
    score = detection.score
    detector = f"Detector {describe_detector(detection)}."
    if score is None:
        return detector

    delays = "; ".join(format_delay(delay) for delay in score.delays_s) or "no slip in this trial"
    return f"{detector} Slip: {delays}. False intervals: {len(score.false_intervals)}."


def render_trial(sources: Sources) -> Markup:
    if SIGNAL_FOLDER in sources.remarks:
        return note(sources.remarks[SIGNAL_FOLDER])

    trace = sources.files.get(f"{SIGNAL_FOLDER}/{TRACE}")
    if trace is None:
        command = element("code", COMMANDS[SIGNAL_FOLDER])
        missing = f"{SIGNAL_FOLDER}/{TRACE} is missing; in the folder of this page, "
        return note(missing, command, " makes it.")

    detection = sources.files.get(f"{SIGNAL_FOLDER}/{DETECTION}")
    # Without a detection beside the trace, the best detector there is.
    detector = str(json.loads(detection)["detector"]) if detection else "fast"
    with temporary_folder() as temporary:
        path = temporary / TRACE
        path.write_bytes(trace)
        result = detect_file(path, sources.design, detector, origin=parse_origin(detection))

    return draw_trial(result)


def draw_trial(result: FileDetection) -> Markup:
    """Draw a trial and its detection: the onset of the slip, and the whole."""
    onset = draw_onset(result.trace, result.detection)
    parts = [element("h3", "The onset of the slip"), onset] if onset else []
    whole = figure(draw_whole(result), _describe(result.detection), "whole trial", "wide")

    return join(
        (
            *parts,
            element("h3", "The whole trial"),
            whole,
            *(note(warning) for warning in result.warnings),
        )
    )


def draw_whole(result: FileDetection) -> Markup:
    """Draw voltage, statistic with threshold, slip and ON over the time of a trial."""
    return _draw(
        result.trace,
        detection=result.detection,
        begin=float(result.trace.time_s[0]),
        end=float(result.trace.time_s[-1]),
        title="Simulated trial: tactile voltage, detector and slip over time",
    )
