"""Adaptation of a design's detector to another sampling rate."""

from __future__ import annotations

from dataclasses import dataclass

from fingertip.design import Design
from fingertip.slip.detectors.noise import noise_level
from fingertip.slip.traces.sampling import MAX_RATE_HZ, MIN_RATE_HZ


@dataclass(frozen=True)
class RateAdaptation:
    """A design adapted to another sampling rate, and a description of what changed."""

    design: Design
    adapted: str
    """Names of what was adapted, such as ``filters, window and threshold``."""
    values: str
    """Resulting window and threshold, such as ``the window is 150 samples, 30 ms; the threshold is 0.012 V``."""


def adapt_rate(design: Design, rate_hz: float, keep_threshold: bool = False, keep_window: bool = False) -> Design:
    """Adapt a design's filters, window and threshold to another sampling rate.

    The window keeps its duration. The threshold keeps its ratio to the noise-derived threshold: white noise of the same
    RMS value leaves less behind the filters at a higher sampling rate.

    Parameters
    ----------
    design
        The design.
    rate_hz
        New sampling rate [Hz].
    keep_threshold
        Keep the threshold: the user chose it, or it applies to a board's output, where it does not depend on the rate.
    keep_window
        Keep the window's number of samples: the user chose it for this rate.

    Raises
    ------
    DesignError
        If the rate is out of bounds, or too low for the filters.
    """
    old = design.detector
    if rate_hz == old.sample_rate_hz:
        return design
    tables = design.model_dump()
    # A rate out of bounds is refused below, as it is; its window might not even be a number.
    within_hz = min(max(rate_hz, MIN_RATE_HZ), MAX_RATE_HZ)
    if keep_window:
        window = old.window_samples
        # Compare the noise in windows of the same duration. This design only serves the comparison, so its window is
        # not checked against the bounds.
        same_duration = max(1, round(window * old.sample_rate_hz / within_hz))
        design = design.model_copy(update={"detector": old.model_copy(update={"window_samples": same_duration})})
    else:
        window = max(1, round(old.window_samples * within_hz / old.sample_rate_hz))
    tables["detector"] |= {"sample_rate_hz": rate_hz, "window_samples": window}
    adapted = Design(**tables)
    if keep_threshold:
        return adapted
    before, after = noise_level(design).threshold_v, noise_level(adapted).threshold_v
    if before > 0.0 and after > 0.0:
        tables["detector"]["threshold_v"] = old.threshold_v * after / before
        adapted = Design(**tables)
    return adapted


def adapt_detector(
    design: Design,
    rate_hz: float,
    detector: str,
    threshold_is_set: bool = False,
    window_is_set: bool = False,
    noise_is_measured: bool = False,
) -> RateAdaptation:
    """Adapt a design to another sampling rate for one detector, and describe the result.

    Parameters
    ----------
    design
        The design.
    rate_hz
        New sampling rate [Hz].
    detector
        Name of the detector. The threshold of `analog` applies to a board's output, so it does not change.
    threshold_is_set
        Whether the user chose the threshold, so that it does not change.
    window_is_set
        Whether the user chose the window for this rate, so that it does not change.
    noise_is_measured
        Whether the threshold follows from measured noise instead of the design.

    Raises
    ------
    DesignError
        If the rate is out of bounds, or too low for the filters.
    """
    keep_threshold = threshold_is_set or detector == "analog"
    adapted = adapt_rate(design, rate_hz, keep_threshold, window_is_set)
    threshold_v, samples = adapted.detector.threshold_v, adapted.detector.window_samples
    uses_threshold = not noise_is_measured and detector in ("digital", "analog")

    window = f"{samples} samples, {1000 * samples / rate_hz:.4g} ms"
    values = f"the window remains {window}, as set" if window_is_set else f"the window is {window}"
    if uses_threshold and keep_threshold:
        reason = "as set" if threshold_is_set else "as it applies to the board's output"
        values += f"; the threshold remains {threshold_v:.9g} V, {reason}"
    elif uses_threshold:
        values += f"; the threshold is {threshold_v:.3g} V"

    names = ["filters"]
    if not window_is_set:
        names.append("window")
    if not (uses_threshold and keep_threshold):
        names.append("threshold")
    joined = names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
    return RateAdaptation(adapted, joined, values)
