"""The detectors by name."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from fingertip.design import Design
from fingertip.design.faults import nearest
from fingertip.errors import Fault, TraceError
from fingertip.slip.chain import ChainSettings, SlipChain
from fingertip.slip.fast import Fast, FastSettings
from fingertip.slip.fft import Fft, FftSettings
from fingertip.slip.noise import noise_level
from fingertip.slip.stream import Detector


@dataclass(frozen=True)
class Kind:
    """One kind of detector."""

    label: str
    make: Callable[[Design, float | None, float], Detector]
    """From a design, the input's noise [V] (None: the design's), and a factor of the threshold that follows."""


def _paper(design: Design, noise_v: float | None, scale: float) -> SlipChain:
    settings = ChainSettings.of(design)
    threshold = settings.threshold_v
    if noise_v is not None:  # as the design's default: the rule, rounded up to whole millivolts or two digits
        rule = noise_level(design, noise_v).threshold_v
        digit = 10.0 ** (math.floor(math.log10(rule)) - 1) if rule > 0.0 else 1.0
        threshold = math.ceil(rule / digit) * digit
    return SlipChain(replace(settings, threshold_v=threshold * scale))


def _fft(design: Design, noise_v: float | None, scale: float) -> Fft:
    return Fft(replace(FftSettings.of(design, noise_v), scale=scale))


def _fast(design: Design, noise_v: float | None, scale: float) -> Fast:
    return Fast(replace(FastSettings.of(design, noise_v), scale=scale))


DETECTORS: dict[str, Kind] = {
    "paper": Kind("the article's chain", _paper),
    "fft": Kind("spectrum of 64 ms", _fft),
    "fast": Kind("energy of 5 ms against the force's slope", _fast),
}


def make(name: str, design: Design, noise_v: float | None = None, scale: float = 1.0) -> Detector:
    """A detector of a design, ready for its first sample.

    Parameters
    ----------
    name
        One of `DETECTORS`.
    design
        Gives rate, filters, window and, unless `noise_v` is given, thresholds.
    noise_v
        White noise of the input, rms [V]; thresholds then follow from it.
    scale
        Factor of the threshold, to trade delay against false alarms.

    Raises
    ------
    TraceError
        If there is no detector of that name.
    """
    return known(name).make(design, noise_v, scale)


def known(name: str) -> Kind:
    """The kind of detector of a name.

    Raises
    ------
    TraceError
        If there is none.
    """
    if name not in DETECTORS:
        raise TraceError(Fault("--detector", f"{name!r} is not known; {nearest(name, list(DETECTORS))}"))
    return DETECTORS[name]
