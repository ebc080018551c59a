"""Wording of detection results for people, and their form in JSON."""

from __future__ import annotations

from typing import Any

from fingertip.slip.detection import Detection
from fingertip.slip.detectors.noise import NoiseLevel
from fingertip.slip.intervals import INCIPIENT_S, Interval, measure_false_on_s
from fingertip.slip.robot_motion import ENCODER_HZ, format_delay_band

DETECTED = "detected"
"""Name of an interval in which the detector is ON."""
INTERVAL = "{onset} s to {end} s"
"""Form in which an interval is printed."""
_TOLD_S = 0.2
"""Time of ON without slip from which it is told [s]: less is the detector's memory after a slip."""


def format_delay(delay_s: float | None) -> str:
    """Describe the delay with which a slip was detected.

    Parameters
    ----------
    delay_s
        Time from the slip's onset to detection [s]. None: the slip was missed. Negative: the detector responded to
        incipient slip or was ON already.
    """
    if delay_s is None:
        return "missed"
    if -INCIPIENT_S <= delay_s < 0.0:
        return f"detected {-1000 * delay_s:.1f} ms before onset, in incipient slip"
    if delay_s < 0.0:
        return f"already ON {round(-1000 * delay_s, 1):g} ms before onset"
    return f"detected after {1000 * delay_s:.1f} ms"


def as_text(detection: Detection) -> str:
    """Describe a detection: one line for each interval and, if the true slips are known, for each slip."""
    score, truth = detection.score, detection.trace.origin.truth
    width = len(truth) if score else len(DETECTED)
    lines = [f"detector {describe_detector(detection)}"]
    lines += [f"{DETECTED:{width}} {_format_interval(i)}" for i in detection.intervals] or ["never ON"]
    if score is None:
        return "\n".join(lines)
    since_motion = detection.motion_delays_s or (None,) * len(score.slips)
    for slip, delay, moved in zip(score.slips, score.delays_s, since_motion, strict=True):
        said = format_delay(delay) + ("" if moved is None else f", {format_motion_delay(moved)}")
        lines.append(f"{truth:{width}} {_format_interval(slip)}: {said}")
    lines.append(f"false intervals: {len(score.false_intervals)}")
    lines.extend(f"{'':{width}} {_format_interval(i)}" for i in score.false_intervals)
    silent_s = measure_false_on_s(detection.intervals, score.slips)
    if silent_s > _TOLD_S:
        lines.append(f"ON for {silent_s:.2f} s without slip")
    return "\n".join(lines)


def describe_detector(detection: Detection) -> str:
    """Describe the detector of a detection, the signals and the threshold that it used."""
    threshold = detection.threshold
    return f"{detection.detector}, {detection.signals.describe()}, {threshold.quantity}: {threshold.describe()}"


def format_motion_delay(delay_s: float) -> str:
    """Describe a delay since the robot moved, and the delays that encoders would show [s]."""
    band = f"{format_delay_band(delay_s)} by encoders at {ENCODER_HZ:g} Hz"
    return f"{1000 * delay_s:.1f} ms after the robot moved ({band})"


def _format_interval(interval: Interval) -> str:
    return INTERVAL.format(onset=f"{interval.onset_s:9.4f}", end=f"{interval.end_s:9.4f}")


def as_data(detection: Detection, noise: NoiseLevel | None) -> dict[str, Any]:
    """Convert a detection to plain mappings and lists for JSON. Keys contain their units.

    Parameters
    ----------
    detection
        The detection.
    noise
        Noise level that determines the noise-derived threshold.
    """
    score, moved = detection.score, detection.motion_delays_s
    return {
        "intervals": [
            _interval_data(i) | {"confidence": round(c, 4)}
            for i, c in zip(detection.intervals, detection.confidences, strict=True)
        ],
        "incipient": None if detection.incipient is None else [_interval_data(i) for i in detection.incipient],
        "slips": None if score is None else [_interval_data(i) for i in score.slips],
        "delays_s": None if score is None else [_round_s(delay) for delay in score.delays_s],
        "motion_s": _round_s(detection.trace.origin.motion_s),
        "delays_since_motion_s": None if moved is None else [_round_s(delay) for delay in moved],
        "missed_slips": None if score is None else [_interval_data(i) for i in score.missed],
        "false_intervals": None if score is None else [_interval_data(i) for i in score.false_intervals],
        "detector": detection.detector,
        "signals": list(detection.signals.columns),
        "threshold_v": _round_v(detection.threshold_v),
        "threshold_range_v": [_round_v(detection.threshold.lowest_v), _round_v(detection.threshold.highest_v)],
        "threshold_of": detection.threshold.quantity,
        "learned_noise_v": None if detection.learned_noise_v is None else round(detection.learned_noise_v, 7),
        "noise_threshold_v": round(noise.threshold_v, 6) if noise else None,
    }


def _round_v(voltage_v: float) -> float:
    """Round to 0.1 uV: thresholds of `fast` lie below a millivolt."""
    return round(voltage_v, 7)


def _round_s(time_s: float | None) -> float | None:
    return None if time_s is None else round(time_s, 7)


def _interval_data(interval: Interval) -> dict[str, float]:
    return {"onset_s": round(interval.onset_s, 7), "end_s": round(interval.end_s, 7)}
