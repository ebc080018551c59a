"""A design's detectors at another sampling rate."""

from __future__ import annotations

from fingertip.design import Design
from fingertip.slip.detectors.noise import noise_level


def at_rate(design: Design, rate_hz: float, keep_threshold: bool = False, keep_window: bool = False) -> Design:
    """The design with its filters made anew for another sampling rate.

    The window keeps its duration, and the threshold its place above the noise: white noise of the same rms leaves the
    filters with less where samples come faster.

    Parameters
    ----------
    design
        The design.
    rate_hz
        The other rate [Hz].
    keep_threshold
        Leave the threshold as it is: somebody chose it, or it stands on a board's output, which has no rate.
    keep_window
        Leave the window its samples: somebody chose them for this rate.

    Raises
    ------
    DesignError
        If the rate is out of bounds, or too slow for the band.
    """
    old = design.detector
    if rate_hz == old.sample_rate_hz:
        return design
    tables = design.model_dump()
    if keep_window:
        window = old.window_samples
        # The noise is compared in windows that last as long; no bound is asked of this one, for nothing runs on it.
        as_long = max(1, round(window * old.sample_rate_hz / rate_hz))
        design = design.model_copy(update={"detector": old.model_copy(update={"window_samples": as_long})})
    else:
        window = max(1, round(old.window_samples * rate_hz / old.sample_rate_hz))
    tables["detector"] |= {"sample_rate_hz": rate_hz, "window_samples": window}
    anew = Design(**tables)
    if keep_threshold:
        return anew
    before, after = noise_level(design).threshold_v, noise_level(anew).threshold_v
    if before > 0.0 and after > 0.0:
        tables["detector"]["threshold_v"] = old.threshold_v * after / before
        anew = Design(**tables)
    return anew
