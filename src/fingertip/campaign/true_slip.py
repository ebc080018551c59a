"""True slip in a simulated recording: its onset, and the vibration of the pad in it."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from fingertip.campaign.plan import Case
from fingertip.design import Design
from fingertip.sim.scene.run import SceneRun
from fingertip.slip import Trace

VIBRATION_HZ = 30.0
"""Frequency from which changes of the force count as vibration [Hz]: contacts lie below it (article, III.A)."""


def find_onset_s(design: Design, case: Case, trace: Trace) -> float:
    """Find the first true slip of a trial [s], counted from the start of the slide; NaN without slip or slide."""
    slide = SceneRun(design, case.scene, case.seed).timeline.slide
    if slide is None or trace.slip is None or not trace.slip.any():
        return math.nan
    return float(trace.time_s[np.argmax(trace.slip)]) - slide.start_s


def measure_vibration_n(trace: Trace) -> float:
    """Measure the RMS vibration of the true normal force from the first to the last slip [N]; NaN without slip.

    What a mean over one period of `VIBRATION_HZ` follows is no vibration.
    """
    if trace.force_n is None or trace.slip is None or not trace.slip.any():
        return math.nan
    slipping = np.flatnonzero(trace.slip)
    width = min(max(1, round(1 / (VIBRATION_HZ * float(trace.time_s[1] - trace.time_s[0])))), len(trace.force_n))
    fast_n = trace.force_n - np.convolve(trace.force_n, np.full(width, 1 / width), "same")
    return float(np.sqrt(np.mean(fast_n[slipping[0] : slipping[-1] + 1] ** 2)))


def median_of_known(values: Iterable[float]) -> float:
    """Median of those values that are finite; NaN if none is."""
    known = [value for value in values if math.isfinite(value)]
    return float(np.median(known)) if known else math.nan
