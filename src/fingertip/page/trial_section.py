"""Trial section of a page: the simulated trace, and the slip that is detected in it.

Plots show the onset of the first slip, at a scale that shows the delay, and the whole trial.
"""

from __future__ import annotations

import json

from fingertip.catalogues.output_files import DETECTION, SIGNAL_FOLDER, TRACE
from fingertip.detection.recordings import FileDetection, detect_file
from fingertip.foundation.files import temporary_folder
from fingertip.page.html import Markup, element, figure, join, note
from fingertip.page.sources import COMMANDS, Sources
from fingertip.page.trial_svg import Delay, Window, draw_trial
from fingertip.slip.detection_results import (
    describe_detector,
    format_delay,
    format_motion_delay,
)
from fingertip.slip.scored_detection import Detection
from fingertip.slip.traces.trace import Trace
from fingertip.slip.traces.truth import parse_origin

_BEFORE_S = 0.06
_AFTER_S = 0.12
"""Time before the onset of a slip and after it that the plots of the onset show [s]."""
_DEFAULT_DETECTOR = "fast"
"""Detector of a trace with no detection beside it: the best there is."""


def render_trial(sources: Sources) -> Markup:
    if SIGNAL_FOLDER in sources.remarks:
        return note(sources.remarks[SIGNAL_FOLDER])

    trace_file = sources.files.get(f"{SIGNAL_FOLDER}/{TRACE}")
    if trace_file is None:
        command = element("code", COMMANDS[SIGNAL_FOLDER])
        missing = f"{SIGNAL_FOLDER}/{TRACE} is missing; in the folder of this page, "
        return note(missing, command, " makes it.")

    return render_detection(_detect(sources, trace_file))


def render_detection(result: FileDetection) -> Markup:
    """Render a trial whose slip is detected: its onset, and the whole."""
    onset = _draw_onset(result.trace, result.detection)
    parts = [element("h3", "The onset of the slip"), onset] if onset else []
    whole = figure(
        draw_whole(result.trace, result.detection),
        _describe(result.detection),
        "whole trial",
        "wide",
    )
    parts += [element("h3", "The whole trial"), whole]

    return join((*parts, *(note(warning) for warning in result.warnings)))


def draw_whole(trace: Trace, detection: Detection) -> Markup:
    """Draw voltage, statistic with threshold, slip and ON over the time of a trial."""
    return draw_trial(
        trace,
        detection=detection,
        window=Window(float(trace.time_s[0]), float(trace.time_s[-1])),
        title="Simulated trial: tactile voltage, detector and slip over time",
    )


def _detect(sources: Sources, trace_file: bytes) -> FileDetection:
    """Detect slip again by the detector of the detection beside the trace."""
    detection_file = sources.files.get(f"{SIGNAL_FOLDER}/{DETECTION}")
    detector = _DEFAULT_DETECTOR
    if detection_file:
        detector = str(json.loads(detection_file)["detector"])

    with temporary_folder() as temporary:
        path = temporary / TRACE
        path.write_bytes(trace_file)
        return detect_file(path, sources.design, detector, origin=parse_origin(detection_file))


def _draw_onset(trace: Trace, detection: Detection) -> Markup | None:
    """Draw the onset of the first slip that was detected, as a figure; None if there is none."""
    score = detection.score
    slips_and_delays = zip(score.slips, score.delays_s, strict=True) if score else ()
    detected = ((slip.onset_s, delay) for slip, delay in slips_and_delays if delay is not None)
    first = next(detected, None)
    if first is None:
        return None

    onset_s, delay_s = first
    detected_s = onset_s + delay_s
    window = Window(
        begin_s=max(float(trace.time_s[0]), onset_s - _BEFORE_S),
        end_s=min(float(trace.time_s[-1]), onset_s + max(_AFTER_S, 2 * delay_s)),
    )
    plots = draw_trial(
        trace,
        detection=detection,
        window=window,
        title="Onset of the slip and its detection",
        delay=Delay(onset_s, detected_s),
    )

    delays = format_delay(delay_s)
    if trace.origin.motion_s is not None:
        delays += f", {format_motion_delay(detected_s - trace.origin.motion_s)}"

    caption = f"The onset at {onset_s:.4f} s, {delays}. Time on the axis is that of the trial."
    return figure(plots, caption, "onset of the slip", "wide")


def _describe(detection: Detection) -> str:
    score = detection.score
    detector = f"Detector {describe_detector(detection)}."
    if score is None:
        return detector

    delays = "; ".join(format_delay(delay) for delay in score.delays_s) or "no slip in this trial"
    return f"{detector} Slip: {delays}. False intervals: {len(score.false_intervals)}."
