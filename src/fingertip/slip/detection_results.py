"""Detection results as text for people, as data for JSON, and as a plot."""

from __future__ import annotations

from typing import Any

import numpy as np

from fingertip.slip.detectors.fast_record import Trust
from fingertip.slip.detectors.noise_and_threshold import NoiseLevel
from fingertip.slip.scored_detection import Detection, find_ratio
from fingertip.slip.traces.truth import (
    ENCODER_HZ,
    INCIPIENT_S,
    Interval,
    format_delay_band,
    measure_false_on_s,
)

DETECTED = "detected"
INTERVAL = "{onset} s to {end} s"
_MEMORY_S = 0.2
"""Time of ON without slip that is reported [s]; less is the detector's memory."""


def format_delay(delay_s: float | None) -> str:
    if delay_s is None:
        return "missed"
    if -INCIPIENT_S <= delay_s < 0.0:
        return f"detected {-1000 * delay_s:.1f} ms before onset, in incipient slip"
    if delay_s < 0.0:
        return f"already ON {round(-1000 * delay_s, 1):g} ms before onset"

    return f"detected after {1000 * delay_s:.1f} ms"


_LISTED = 10
"""Number of intervals of incipient slip alone that a text lists."""


def as_text(detection: Detection) -> str:
    """Describe a detection: a line for each interval and, if known, for each true slip."""
    score = detection.score
    truth = detection.trace.origin.truth
    width = len(truth) if score else len(DETECTED)
    lines = [f"detector {describe_detector(detection)}"]

    if detection.undecided:
        lines.append(
            f"{'undecided':{width}} {_format_interval(detection.undecided)}, nothing rested before"
        )

    forces = [f", at {force.describe()}" for force in detection.forces or ()]
    forces = forces or [""] * len(detection.intervals)
    kinds = [f", {trust.name}" for trust in detection.trusts or ()]
    kinds = kinds or [""] * len(detection.intervals)
    for interval, kind, force in zip(detection.intervals, kinds, forces, strict=True):
        begin = _format_begin(interval, detection)
        lines.append(f"{DETECTED:{width}} {_format_interval(interval)}{kind}{begin}{force}")

    if not detection.intervals:
        lines.append(_describe_silence(detection))

    lines += [trust.describe() for trust in dict.fromkeys(detection.trusts or ())]
    lines += _list_incipient_alone(detection, width)
    if score is None:
        return "\n".join(lines)

    since_motion = detection.motion_delays_s or (None,) * len(score.slips)
    for slip, delay, moved in zip(score.slips, score.delays_s, since_motion, strict=True):
        delay_text = format_delay(delay)
        if moved is not None:
            delay_text += f", {format_motion_delay(moved)}"

        lines.append(f"{truth:{width}} {_format_interval(slip)}: {delay_text}")

    lines.append(f"false intervals: {len(score.false_intervals)}")
    lines += [f"{'':{width}} {_format_interval(interval)}" for interval in score.false_intervals]
    silent_s = measure_false_on_s(detection.intervals, score.slips)
    if silent_s > _MEMORY_S:
        lines.append(f"ON for {silent_s:.2f} s without slip")

    return "\n".join(lines)


def _describe_silence(detection: Detection) -> str:
    """Describe how near the statistic of a detector that was never ON came to its threshold."""
    ratio = find_ratio(detection.output)
    place = int(np.argmax(ratio))
    if ratio[place] == 0.0:
        return "never ON"

    if ratio[place] > 1:
        return "never ON: what exceeded the threshold was taken for a blow or a step, not for slip"

    reached = f"the statistic reached {100 * ratio[place]:.0f} % of its threshold"
    return f"never ON: {reached}, at {detection.trace.time_s[place]:.4f} s"


def describe_detector(detection: Detection) -> str:
    threshold = detection.threshold
    return (
        f"{detection.detector}, {detection.signals.describe()}, {threshold.quantity}: "
        f"{threshold.describe()}"
    )


def format_motion_delay(delay_s: float) -> str:
    """Describe a delay since the robot moved [s], with those that encoders would show."""
    band = f"{format_delay_band(delay_s)} by encoders at {ENCODER_HZ:g} Hz"
    return f"{1000 * delay_s:.1f} ms after the robot moved ({band})"


def _format_begin(interval: Interval, detection: Detection) -> str:
    """Describe from when an interval of ON was incipient slip; empty if it was not."""
    begins = [
        incipient.onset_s
        for incipient in detection.incipient or ()
        if incipient.onset_s < interval.onset_s < incipient.end_s
    ]
    return f", incipient from {begins[0]:.4f} s" if begins else ""


def _list_incipient_alone(detection: Detection, width: int) -> list[str]:
    """List incipient slip that never became ON: a controller that tightens early acts on it."""
    alone = [
        incipient
        for incipient in detection.incipient or ()
        if not any(
            incipient.onset_s <= interval.onset_s < incipient.end_s
            for interval in detection.intervals
        )
    ]
    lines = [
        f"{'incipient':{width}} {_format_interval(incipient)}, never ON"
        for incipient in alone[:_LISTED]
    ]
    if len(alone) > _LISTED:
        lines.append(f"{'':{width}} and {len(alone) - _LISTED} more")

    return lines


def _format_interval(interval: Interval) -> str:
    return INTERVAL.format(onset=f"{interval.onset_s:9.4f}", end=f"{interval.end_s:9.4f}")


def as_data(detection: Detection, noise: NoiseLevel | None) -> dict[str, Any]:
    """Convert a detection to plain mappings and lists for JSON. Keys contain their units."""
    score = detection.score
    moved = detection.motion_delays_s
    forces = [force.as_data() for force in detection.forces or ()]
    forces = forces or [{}] * len(detection.intervals)
    trusts = [_trust_data(trust) for trust in detection.trusts or ()]
    trusts = trusts or [{}] * len(detection.intervals)
    rows = zip(detection.intervals, detection.strengths, trusts, forces, strict=True)

    return {
        "intervals": [
            _interval_data(interval) | {"strength": round(strength, 4)} | trust | force
            for interval, strength, trust, force in rows
        ],
        "incipient": None
        if detection.incipient is None
        else [_interval_data(interval) for interval in detection.incipient],
        "undecided": _interval_data(detection.undecided) if detection.undecided else None,
        "slips": None if score is None else [_interval_data(slip) for slip in score.slips],
        "delays_s": None if score is None else [_round(delay) for delay in score.delays_s],
        "motion_s": _round(detection.trace.origin.motion_s),
        "delays_since_motion_s": None if moved is None else [_round(delay) for delay in moved],
        "missed_slips": None if score is None else [_interval_data(slip) for slip in score.missed],
        "false_intervals": None
        if score is None
        else [_interval_data(interval) for interval in score.false_intervals],
        "detector": detection.detector,
        "signals": list(detection.signals.columns),
        "threshold_v": _round(detection.threshold_v),
        "threshold_range_v": [
            _round(detection.threshold.lowest_v),
            _round(detection.threshold.highest_v),
        ],
        "threshold_of": detection.threshold.quantity,
        "learned_noise_v": _round(detection.learned_noise_v),
        "noise_threshold_v": round(noise.threshold_v, 6) if noise else None,
    }


def _trust_data(trust: Trust) -> dict[str, Any]:
    """What such an ON was on real recordings, as data."""
    data = {
        "class": trust.name,
        "slips": trust.slides,
        "of": trust.slides + trust.others,
        "delay_s": list(trust.delay_s),
    }
    return {"record": data}


def _round(value: float | None) -> float | None:
    """Round to 0.1 us, or to 0.1 uV: thresholds of `fast` lie below a millivolt."""
    return None if value is None else round(value, 7)


def _interval_data(interval: Interval) -> dict[str, float | None]:
    return {"onset_s": _round(interval.onset_s), "end_s": _round(interval.end_s)}
