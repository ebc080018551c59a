"""A whole trace through the chain, judged where the truth is known."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.design import Design
from fingertip.errors import TraceError
from fingertip.slip.chain import ChainOutput, ChainSettings, SlipChain
from fingertip.slip.intervals import Interval, Score, intervals, score
from fingertip.slip.noise import NoiseLevel, noise_level
from fingertip.slip.trace import Trace, faults


@dataclass(frozen=True, eq=False)
class Detection:
    """What was found in a trace, and with which settings."""

    settings: ChainSettings
    noise: NoiseLevel
    output: ChainOutput
    intervals: tuple[Interval, ...]
    score: Score | None
    """None where the trace does not say when it slipped."""


def detect(trace: Trace, design: Design) -> Detection:
    """Detect slip in a trace with the article's chain.

    Raises
    ------
    TraceError
        With one sentence for each fault of the trace, among them another sampling rate than the design's.
    """
    settings = ChainSettings.of(design)
    if found := faults(trace, design.detector):
        raise TraceError(found)
    output = SlipChain(settings).process(trace.voltage_v)
    detected = intervals(trace.time_s, output.on)
    judged = None
    if trace.slip is not None:
        window_s = settings.window_samples / settings.sample_rate_hz
        judged = score(detected, intervals(trace.time_s, trace.slip), window_s)
    return Detection(settings, noise_level(design), output, detected, judged)
