"""A detector's noise from a stretch in which nothing happens, whatever its spectrum: hum, drift, a low-pass before."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.slip.detectors.chain import ChainSettings, SlipChain
from fingertip.slip.detectors.fast import Fast, FastSettings
from fingertip.slip.detectors.fft import Fft, FftSettings
from fingertip.slip.detectors.noise import DEVIATIONS, noise_level

_LOUD = 6.0
"""Times the median; noise alone reaches half of it."""
MIN_S = 0.3
"""Shorter stretches do not show what a band of 40 Hz is like: the deviation would not be known to a tenth."""


def quiet_noise_v(detector: str, design: Design, quiet_v: Array, name: str) -> float:
    """White noise with which the detector's threshold stands as clear of this stretch as its rule asks, rms.

    What the detector itself makes of the stretch counts, and the white noise of its second differences at least, to
    which drift and a constant load are nothing.

    Parameters
    ----------
    detector
        One that reads the voltage.
    design
        Gives rate, filters and window.
    quiet_v
        The stretch, in any unit.
    name
        Of the trace, for the refusal.

    Raises
    ------
    TraceError
        If it is shorter than `MIN_S`, or never changes.
    """
    minimum = math.ceil(MIN_S * design.detector.sample_rate_hz)
    if len(quiet_v) < minimum:
        raise TraceError(Issue("--quiet-s", f"takes in {len(quiet_v)} samples of {name}; at least {minimum}."))
    white = math.sqrt(float(np.mean(np.diff(quiet_v, 2) ** 2)) / 6)
    if not white > 0.0:
        raise TraceError(Issue("--quiet-s", f"takes in a part of {name} that never changes; choose a longer one."))
    return max(white, _SHOWN[detector](design, quiet_v))


def disturbed_at(design: Design, quiet_v: Array) -> int | None:
    """First sample of the stretch at which the bands are far louder than they mostly are; None: nothing happened."""
    settling = round(0.1 * design.detector.sample_rate_hz)
    level = Fast(FastSettings.of(design, 1.0)).process(quiet_v).level_v[settling:]
    loud = np.flatnonzero(level > _LOUD * float(np.median(level))) if len(level) else level
    return settling + int(loud[0]) if len(loud) else None


def _by_chain(design: Design, quiet_v: Array) -> float:
    """By the mean over the window, as its rule is."""
    chain = SlipChain(ChainSettings.of(design))
    settling = min(len(quiet_v) // 2, round(0.1 * design.detector.sample_rate_hz) + design.detector.window_samples)
    means = chain.process(quiet_v).level_v[settling:]
    return float(means.mean() + DEVIATIONS * means.std()) / noise_level(design, 1.0).threshold_v


def _by_bands(design: Design, quiet_v: Array) -> float:
    return Fast(FastSettings.of(design, 1.0)).white_v(quiet_v)


def _by_spectrum(design: Design, quiet_v: Array) -> float:
    fft = Fft(FftSettings.of(design, 1.0))
    levels = fft.process(quiet_v).level_v[fft.settings.window_samples :]
    return math.sqrt(float(np.mean(levels**2))) / fft.white_level


_SHOWN: dict[str, Callable[[Design, Array], float]] = {"digital": _by_chain, "fast": _by_bands, "fft": _by_spectrum}
