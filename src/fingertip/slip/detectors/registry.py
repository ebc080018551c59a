"""Detectors by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from fingertip.design import Design
from fingertip.design.formulas.filter import filtered_range_v
from fingertip.design.parameters.declaration import suggest_name
from fingertip.foundation.errors import Issue, TraceError
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.analog import AnalogDetector
from fingertip.slip.detectors.detector import Detector
from fingertip.slip.detectors.digital import ChainSettings, SlipChain
from fingertip.slip.detectors.fast import FastDetector, FastSettings
from fingertip.slip.detectors.fft import FftDetector, FftSettings
from fingertip.slip.detectors.noise import noise_level


@dataclass(frozen=True)
class DetectorType:
    """Type of detector."""

    label: str
    input_column: str
    """Column of the trace that the detector takes: ``voltage_v``, or the board's output ``envelope_v``."""
    quantity: str
    """Quantity that its threshold applies to. The design's threshold applies to the mean of the envelope."""
    make: Callable[[Design, float | None, float], Detector]
    """Factory. It takes a design, the noise of the input [V] (None: the design's), and a factor of the threshold."""
    second_column: str | None = None
    """Column that the detector takes beside it, where a recording has it."""


def _make_analog(design: Design, noise_v: float | None, threshold_scale: float) -> AnalogDetector:
    if noise_v is not None:
        message = (
            f"{noise_v:g} V of input noise does not determine the threshold of the detector analog, which applies to "
            "the board's output; set detector.threshold_v instead."
        )
        raise TraceError(Issue("noise_v", message))
    return AnalogDetector.from_design(design, threshold_scale)


def _make_digital(design: Design, noise_v: float | None, threshold_scale: float) -> SlipChain:
    settings = ChainSettings.from_design(design)
    threshold_v = settings.threshold_v
    if noise_v is not None:  # the noise-derived threshold, rounded up as the design's default is
        threshold_v = noise_level(design, noise_v).rounded_threshold_v
    return SlipChain(replace(settings, threshold_v=threshold_v * threshold_scale))


def _make_fft(design: Design, noise_v: float | None, threshold_scale: float) -> FftDetector:
    return FftDetector(replace(FftSettings.from_design(design, noise_v), threshold_scale=threshold_scale))


def _make_fast(design: Design, noise_v: float | None, threshold_scale: float) -> FastDetector:
    return FastDetector(replace(FastSettings.from_design(design, noise_v), threshold_scale=threshold_scale))


ENVELOPE_MEAN = "mean of the envelope"
"""Quantity that the design's threshold applies to."""
DETECTORS: dict[str, DetectorType] = {
    "analog": DetectorType(
        "window mean of the analog board's envelope output", "envelope_v", ENVELOPE_MEAN, _make_analog
    ),
    "digital": DetectorType("the article's chain in digital filters", "voltage_v", ENVELOPE_MEAN, _make_digital),
    "fft": DetectorType("spectrum of 64 ms", "voltage_v", "statistic of fft", _make_fft),
    "fast": DetectorType(
        "energies of 6 and 20 ms over the learned noise, beside the slow force, judged by trees",
        "voltage_v",
        "statistic of fast",
        _make_fast,
        second_column="filtered_v",
    ),
}
"""Types of detector by name."""


def make_detector(name: str, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0) -> Detector:
    """Create a detector for a design, ready for its first sample. Raises TraceError."""
    return find_detector_type(name).make(design, noise_v, threshold_scale)


def select_inputs(source: object, name: str) -> tuple[Array, ...]:
    """Select the columns that a detector processes, of a trace or an observation."""
    kind = find_detector_type(name)
    first: Array | None = getattr(source, kind.input_column, None)
    second: Array | None = getattr(source, kind.second_column, None) if kind.second_column else None
    if first is None:
        return ()
    return (first,) if second is None else (first, second)


@dataclass(frozen=True)
class UsedSignals:
    """Columns of a trace that a detector takes."""

    columns: tuple[str, ...]
    missing: str | None
    """Column that it would take too and that is not there."""

    def describe(self) -> str:
        """Describe the columns."""
        used = " and ".join(self.columns)
        return f"on {used}" if self.missing is None else f"on {used} alone (no column {self.missing})"


def find_signals(design: Design, name: str, has_second: bool) -> UsedSignals:
    """Find the columns that a detector takes for the board of a design."""
    first, second = find_detector_type(name).input_column, find_second_column(design, name)
    if second is None:
        return UsedSignals((first,), None)
    return UsedSignals((first, second), None) if has_second else UsedSignals((first,), second)


def find_second_column(design: Design, name: str) -> str | None:
    """Find the column that a detector takes beside its first for the board of a design; None if there is none."""
    second = find_detector_type(name).second_column
    return second if filtered_range_v(design.board, design.detector.adc_range_v) is not None else None


def find_detector_type(name: str) -> DetectorType:
    """Look up a type of detector by name. Raises TraceError."""
    if name not in DETECTORS:
        raise TraceError(Issue("--detector", f"{name!r} is not a detector; {suggest_name(name, list(DETECTORS))}"))
    return DETECTORS[name]
