"""A whole trace through a detector, judged where the truth is known."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.slip.detectors.noise import NoiseLevel, noise_level
from fingertip.slip.detectors.registry import known, make
from fingertip.slip.detectors.stream import Output
from fingertip.slip.intervals import Interval, Score, intervals, score
from fingertip.slip.traces.trace import Trace, issues


@dataclass(frozen=True, eq=False)
class Detection:
    """What was found in a trace, and with which settings."""

    detector: str
    threshold_v: float
    """The bar in noise alone [V]."""
    memory_s: float
    """How long ON may outlast slip [s]."""
    noise: NoiseLevel | None
    """What the article's digital chain shows in this noise; None for other detectors."""
    output: Output
    intervals: tuple[Interval, ...]
    score: Score | None
    """None where the trace does not say when it slipped."""


def detect(trace: Trace, design: Design, detector: str = "digital", noise_v: float | None = None) -> Detection:
    """Detect slip in a trace.

    Parameters
    ----------
    trace
        The trace; its voltage may be any signal that follows the force, if `noise_v` is given in the same unit.
    design
        Gives rate, filters, window and threshold.
    detector
        Name of one of the detectors; by default the article's chain in digital filters. `analog` takes the trace's
        `envelope_v`, which `fingertip.sim.electronics.board_output` makes where no board was there.
    noise_v
        White noise of the signal, rms [V]; without it, the design's.

    Raises
    ------
    TraceError
        With one sentence for each issue of the trace, among them another sampling rate than the design's, and no
        envelope where the detector takes one.
    """
    found = issues(trace, design.detector, in_volts=noise_v is None)
    samples = getattr(trace, known(detector).reads)
    if samples is None:
        remedy = "record it, or take --detector digital, which needs no board"
        found.append(Issue("trace, envelope_v", f"is missing: {detector} works on the board's output; {remedy}."))
    if found:
        raise TraceError(found)
    made = make(detector, design, noise_v)
    threshold = made.threshold_v
    output = made.process(samples)
    detected = intervals(trace.time_s, output.on)
    judged = None
    if trace.slip is not None:
        judged = score(detected, intervals(trace.time_s, trace.slip), made.memory_s)
    level = noise_level(design, noise_v) if detector == "digital" else None
    return Detection(detector, threshold, made.memory_s, level, output, detected, judged)
