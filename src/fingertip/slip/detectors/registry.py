"""The detectors by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from fingertip.design import Design
from fingertip.design.issues import nearest
from fingertip.errors import Issue, TraceError
from fingertip.slip.detectors.chain import ChainSettings, SlipChain
from fingertip.slip.detectors.fast import Fast, FastSettings
from fingertip.slip.detectors.fft import Fft, FftSettings
from fingertip.slip.detectors.noise import noise_level
from fingertip.slip.detectors.stream import Detector
from fingertip.slip.detectors.window import Window


@dataclass(frozen=True)
class Kind:
    """One kind of detector."""

    label: str
    reads: str
    """The trace's column that it takes: ``voltage_v``, or the board's output ``envelope_v``."""
    make: Callable[[Design, float | None, float], Detector]
    """From a design, the input's noise [V] (None: the design's), and a factor of the threshold that follows."""


def _analog(design: Design, noise_v: float | None, scale: float) -> Window:
    if noise_v is not None:
        said = "its threshold stands on the board's output; set detector.threshold_v"
        raise TraceError(Issue("noise_v", f"{noise_v:g} V of the input tells analog nothing: {said}."))
    return Window.of(design, scale)


def _digital(design: Design, noise_v: float | None, scale: float) -> SlipChain:
    settings = ChainSettings.of(design)
    threshold = settings.threshold_v
    if noise_v is not None:  # as the design's default: the rule, rounded up
        threshold = noise_level(design, noise_v).rounded_v
    return SlipChain(replace(settings, threshold_v=threshold * scale))


def _fft(design: Design, noise_v: float | None, scale: float) -> Fft:
    return Fft(replace(FftSettings.of(design, noise_v), scale=scale))


def _fast(design: Design, noise_v: float | None, scale: float) -> Fast:
    return Fast(replace(FastSettings.of(design, noise_v), scale=scale))


DETECTORS: dict[str, Kind] = {
    "analog": Kind("the board's output, window and threshold", "envelope_v", _analog),
    "digital": Kind("the article's chain in digital filters", "voltage_v", _digital),
    "fft": Kind("spectrum of 64 ms", "voltage_v", _fft),
    "fast": Kind("energy of 5 ms in two bands, against the force's slope", "voltage_v", _fast),
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
        raise TraceError(Issue("--detector", f"{name!r} is not known; {nearest(name, list(DETECTORS))}"))
    return DETECTORS[name]
