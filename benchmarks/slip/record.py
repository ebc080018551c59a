"""Record of how often `fast` is right: what began its ON on real signals, by strength.

The strength of ON is the greatest ratio of statistic to threshold in its first 50 ms. The package
keeps the record, so that a detection can say what it is worth.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.slip.baselines import detect
from benchmarks.slip.bench import Source
from benchmarks.slip.recordings import Recording
from benchmarks.slip.scores import EARLY_S, assess, find_false, share_interval
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors import fast
from fingertip.slip.traces.truth import intervals

FILE = Path(fast.__file__).with_name("fast_record.json")
OPENING_S = 0.05
"""Time from the begin of ON in which its strength is taken [s]."""
CLASSES = {"weak": 1.0, "middle": 1.5, "strong": 3.0}
"""Name of a class -> least strength."""
FRACTIONS = (0.1, 0.5, 0.9)


@dataclass(frozen=True)
class Opening:
    """Begin of one interval of ON."""

    strength: float
    kind: str
    """Kind of signal."""
    is_slide: bool
    delay_s: float | None
    """Delay from gross slip; None if it is not the first ON of a slide [s]."""


def list_openings(recording: Recording) -> Iterator[Opening]:
    """List the intervals of ON in a recording, from where alarms count."""
    assert recording.design is not None
    signal = recording.signal
    output = detect(recording.design, recording, 1.0)
    found = intervals(np.arange(len(output.on)) / signal.rate_hz, output.on)
    false = find_false(signal, found)
    found_s = iter(assess(recording, output.on).delays_s)

    for one in found:
        if one.onset_s < signal.alarms_from_s:
            continue

        slide = next(
            (s for s in signal.slides if s.motion_s - EARLY_S <= one.onset_s < s.end_s), None
        )
        if slide is None and one not in false:
            continue  # ON again right behind a slide says neither

        strength = measure_strength(output, round(one.onset_s * signal.rate_hz), signal.rate_hz)
        delay_s = None if slide is None else next(found_s, None)
        yield Opening(strength, signal.kind.split()[0], slide is not None, delay_s)


def measure_strength(output: fast.FastOutput, begin: int, rate_hz: float) -> float:
    """Greatest ratio of statistic to threshold in the first `OPENING_S` of ON."""
    opening = slice(begin, begin + round(OPENING_S * rate_hz))
    ratios: Array = output.statistic_v[opening] / output.threshold_v[opening]
    return float(ratios.max())


def classify(strength: float) -> str:
    return next(
        (name for name in reversed(CLASSES) if strength >= CLASSES[name]), next(iter(CLASSES))
    )


def make_record(sources: Iterable[Source], card: Mapping[str, Any]) -> dict[str, Any]:
    """Count what began ON in real signals, for each class of strength."""
    openings = [
        opening
        for source in sources
        for recording in source.read()
        for opening in list_openings(recording)
    ]
    classes = []
    for name, least in CLASSES.items():
        chosen = [one for one in openings if classify(one.strength) == name]
        classes.append({"class": name, "least_ratio": least, **_count(chosen)})

    return {"card": dict(card), "opening_ms": round(1000 * OPENING_S), "classes": classes}


def _count(openings: list[Opening]) -> dict[str, Any]:
    slides = sum(one.is_slide for one in openings)
    others = Counter(one.kind for one in openings if not one.is_slide)
    delays_s = [one.delay_s for one in openings if one.delay_s is not None]
    return {
        "slides": slides,
        "others": others.total(),
        "others_by_signal": dict(sorted(others.items())),
        "slides_95": share_interval(slides, len(openings)),
        "delays_ms": [round(1000 * _quantile(delays_s, fraction), 1) for fraction in FRACTIONS],
    }


def _quantile(values: list[float], fraction: float) -> float:
    return float(np.quantile(values, fraction, method="higher")) if values else math.nan


def write_record(record: Mapping[str, Any]) -> None:
    FILE.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
