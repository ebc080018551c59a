"""Wording of detection results for people, and their form in JSON."""

from __future__ import annotations

from typing import Any

from fingertip.slip.detection import Detection
from fingertip.slip.detectors.noise import NoiseLevel
from fingertip.slip.intervals import INCIPIENT_S, Interval


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
    lines = [f"ON   {i.onset_s:9.4f} s to {i.end_s:9.4f} s" for i in detection.intervals] or ["never ON"]
    score = detection.score
    if score is None:
        return "\n".join(lines)
    for slip, delay in zip(score.slips, score.delays_s, strict=True):
        lines.append(f"slip {slip.onset_s:9.4f} s to {slip.end_s:9.4f} s: {format_delay(delay)}")
    lines.append(f"false intervals: {len(score.false_intervals)}")
    lines.extend(f"     {i.onset_s:9.4f} s to {i.end_s:9.4f} s" for i in score.false_intervals)
    return "\n".join(lines)


def as_data(detection: Detection, noise: NoiseLevel | None) -> dict[str, Any]:
    """Convert a detection to plain mappings and lists for JSON. Keys contain their units.

    Parameters
    ----------
    detection
        The detection.
    noise
        Noise level that determines the noise-derived threshold.
    """
    score = detection.score
    return {
        "intervals": [
            _interval_data(i) | {"confidence": round(c, 4)}
            for i, c in zip(detection.intervals, detection.confidences, strict=True)
        ],
        "incipient": None if detection.incipient is None else [_interval_data(i) for i in detection.incipient],
        "slips": None if score is None else [_interval_data(i) for i in score.slips],
        "delays_s": None if score is None else [None if d is None else round(d, 7) for d in score.delays_s],
        "missed_slips": None if score is None else [_interval_data(i) for i in score.missed],
        "false_intervals": None if score is None else [_interval_data(i) for i in score.false_intervals],
        "detector": detection.detector,
        "threshold_v": round(detection.threshold_v, 6),
        "learned_noise_v": None if detection.learned_noise_v is None else round(detection.learned_noise_v, 7),
        "noise_threshold_v": round(noise.threshold_v, 6) if noise else None,
    }


def _interval_data(interval: Interval) -> dict[str, float]:
    return {"onset_s": round(interval.onset_s, 7), "end_s": round(interval.end_s, 7)}
