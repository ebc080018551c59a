"""Noise at the input of a detector, the threshold that follows from a level of noise, and warnings of both."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from fingertip.design import Design
from fingertip.slip.detectors.registry import DEFAULT, find_detector_type

DEVIATIONS = 6.0
"""Standard deviations between the mean noise level and the noise-derived threshold.

Gaussian noise crosses it less than once in a year of independent windows of 30 ms (1e-9 each)."""


@dataclass(frozen=True)
class NoiseLevel:
    """Mean and standard deviation of the window mean in noise alone [V]."""

    mean_v: float
    deviation_v: float

    @property
    def threshold_v(self) -> float:
        """Noise-derived threshold: the mean plus `DEVIATIONS` standard deviations [V]."""
        return self.mean_v + DEVIATIONS * self.deviation_v

    @property
    def rounded_threshold_v(self) -> float:
        """Noise-derived threshold, rounded up to two digits [V]."""
        threshold_v = self.threshold_v
        digit = 10.0 ** (math.floor(math.log10(threshold_v)) - 1) if threshold_v > 0.0 else 1.0
        return float(f"{math.ceil(threshold_v / digit) * digit:.9g}")


_OFFSETS = 32
"""Number of voltages within one ADC step over which `mean_quantised_noise_v` averages."""


def input_noise_v(design: Design) -> float:
    """RMS noise of the sampled voltage [V]: ``detector.noise_v`` after quantisation by the ADC."""
    detector = design.detector
    return quantised_noise_v(detector.noise_v, detector.adc_step_v)


def quantised_noise_v(noise_v: float, step_v: float) -> float:
    """RMS value of Gaussian noise after quantisation [V], at a voltage halfway between two codes, the worst case.

    Noise of several steps gains ``step / sqrt(12)``. Noise much smaller than a step vanishes at most voltages, but
    halfway between two codes it toggles between them and amounts to half a step.
    """
    if noise_v > 4 * step_v:
        return math.hypot(noise_v, step_v / math.sqrt(12))
    if noise_v <= 0.0:
        return step_v / 2
    below = [
        0.5 * (1 + math.erf(k * step_v / noise_v / math.sqrt(2))) for k in range(math.ceil(8 * noise_v / step_v) + 2)
    ]
    squares = (2 * ((k + 0.5) * step_v) ** 2 * (below[k + 1] - below[k]) for k in range(len(below) - 1))
    return math.sqrt(math.fsum(squares))


def mean_quantised_noise_v(noise_v: float, step_v: float) -> float:
    """RMS value of Gaussian noise about its mean after quantisation [V], averaged over all voltages within a step.

    A threshold must exceed `quantised_noise_v`, the noise at the worst voltage. The value here is the noise in which a
    signal is observed on average: noise much smaller than a step vanishes at most voltages.
    """
    if noise_v > 4 * step_v:
        return math.hypot(noise_v, step_v / math.sqrt(12))
    if noise_v <= 0.0:
        return 0.0
    squares = []
    for i in range(_OFFSETS):
        offset_v = (i + 0.5) / _OFFSETS * step_v
        reach = math.ceil(8 * noise_v / step_v) + 1
        edges = [((k - 0.5) * step_v - offset_v) / noise_v / math.sqrt(2) for k in range(-reach, reach + 2)]
        probabilities = [(k, 0.5 * (math.erf(b) - math.erf(a))) for k, (a, b) in enumerate(pairwise(edges), -reach)]
        mean = math.fsum(k * p for k, p in probabilities)
        squares.append(math.fsum((k - mean) ** 2 * p for k, p in probabilities))
    return step_v * math.sqrt(math.fsum(squares) / _OFFSETS)


HIGH_RATIO = 3.0
"""Ratio of the threshold to the noise-derived threshold above which a warning recommends a lower one."""
CLEAR_DEVIATIONS = 4.0
"""Standard deviations above the mean noise level below which noise crosses a threshold within minutes."""


def threshold_warnings(threshold_v: float, level: NoiseLevel, may_be_lower: bool = True) -> Iterator[str]:
    """Warn of a threshold that lies within the noise, or far above it."""
    if threshold_v < level.mean_v:
        yield (
            f"detector.threshold_v of {threshold_v:g} V is below the mean noise level ({level.mean_v:.3g} V); the "
            f"noise-derived threshold is {level.threshold_v:.3g} V."
        )
    elif threshold_v < level.mean_v + CLEAR_DEVIATIONS * level.deviation_v:
        yield (
            f"detector.threshold_v of {threshold_v:g} V is within the noise, which crosses it repeatedly (mean level "
            f"{level.mean_v:.3g} V, standard deviation {level.deviation_v:.2g} V); the noise-derived threshold is "
            f"{level.threshold_v:.3g} V."
        )
    elif may_be_lower and threshold_v > HIGH_RATIO * level.threshold_v:
        yield (
            f"detector.threshold_v of {threshold_v:g} V is {threshold_v / level.rounded_threshold_v:.0f} times the "
            f"noise-derived threshold: --set detector.threshold_v={level.rounded_threshold_v:g} detects weaker slip."
        )


MIN_CUTOFF_HZ = 45.0
"""Cutoff below which every detector reports contacts as slip in the negative tuning scenes [Hz] (article, section
III.A: contacts lie below 30 Hz)."""
MIN_WINDOW_S = 0.02
"""Window length below which contacts are reported as slip [s] (article, section III.C)."""
COARSE_RATIO = 2.0
"""Ratio of the ADC's step to the noise above which the step hides the noise."""


def settings_warnings(design: Design, detector: str = DEFAULT) -> Iterator[str]:
    """Warn of settings of the filter, the ADC or the window that are permitted but degrade a detector."""
    d, cutoff = design.detector, design.board.cutoff_hz
    if cutoff < MIN_CUTOFF_HZ:
        yield (
            f"board.cutoff_hz of {cutoff:g} Hz passes contacts and changes of grip, which are then reported as slip; "
            f"choose at least {MIN_CUTOFF_HZ:g} Hz (article: 67 Hz)."
        )
    step = d.adc_step_v
    if step > COARSE_RATIO * d.noise_v > 0.0:
        yield (
            f"detector.adc_bits of {d.adc_bits} over {d.adc_range_text} gives steps of {1000 * step:.3g} mV, which "
            f"hide the noise of {1000 * d.noise_v:.3g} mV: weak slip is not detected, and single steps resemble slip. "
            "Choose more bits or a smaller detector.adc_range_v."
        )
    window_s = d.window_samples / d.sample_rate_hz
    if find_detector_type(detector).has_design_threshold and window_s < MIN_WINDOW_S:
        yield (
            f"detector.window_samples of {d.window_samples} at {d.sample_rate_hz:g} Hz is {1000 * window_s:.3g} ms; "
            f"below {1000 * MIN_WINDOW_S:g} ms contacts are reported as slip. Choose {round(0.03 * d.sample_rate_hz)} "
            "samples for 30 ms."
        )
