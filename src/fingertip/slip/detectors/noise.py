"""What the article's chain shows when nothing happens, and the threshold that follows from it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.errors import Issue, TraceError
from fingertip.slip.detectors.chain import ChainSettings, SlipChain
from fingertip.slip.detectors.window import Window

DEVIATIONS = 6.0
"""Standard deviations of the window mean between its noise level and the threshold: as Gaussian noise,
crossed less than once in a year of independent windows of 30 ms (1e-9 each)."""


@dataclass(frozen=True)
class NoiseLevel:
    """Mean and standard deviation [V] of the window mean in noise alone."""

    mean_v: float
    deviation_v: float

    @property
    def threshold_v(self) -> float:
        """The threshold of the rule: the level plus `DEVIATIONS` standard deviations [V]."""
        return self.mean_v + DEVIATIONS * self.deviation_v

    @property
    def rounded_v(self) -> float:
        """The rule's threshold, rounded up to two digits [V]."""
        rule = self.threshold_v
        digit = 10.0 ** (math.floor(math.log10(rule)) - 1) if rule > 0.0 else 1.0
        return float(f"{math.ceil(rule / digit) * digit:.9g}")


_PARTS = 32
"""Of a step, over which voltages are averaged."""


def input_noise_v(design: Design) -> float:
    """Noise of the sampled voltage, rms [V]: ``detector.noise_v`` in the converter's steps."""
    detector = design.detector
    return quantised_v(detector.noise_v, 2 * detector.adc_range_v / 2**detector.adc_bits)


def quantised_v(noise_v: float, step_v: float) -> float:
    """What Gaussian noise has become, rms [V], once it is in steps: of a voltage halfway between two of them.

    Noise of some steps gains ``step / sqrt(12)``. Noise much smaller than a step shows nothing at most voltages; but
    at the worst, halfway, it flips between two codes and shows half a step.
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


def mean_quantised_v(noise_v: float, step_v: float) -> float:
    """What Gaussian noise shows once it is in steps, rms about its mean [V], over all voltages alike.

    Where `quantised_v` is what a threshold must stand clear of at the worst voltage, this is what a signal is seen in:
    noise much smaller than a step shows nothing at most voltages.
    """
    if noise_v > 4 * step_v:
        return math.hypot(noise_v, step_v / math.sqrt(12))
    if noise_v <= 0.0:
        return 0.0
    squares = []
    for part in range(_PARTS):
        at = (part + 0.5) / _PARTS * step_v
        reach = math.ceil(8 * noise_v / step_v) + 1
        edges = [((k - 0.5) * step_v - at) / noise_v / math.sqrt(2) for k in range(-reach, reach + 2)]
        shares = [(k, 0.5 * (math.erf(b) - math.erf(a))) for k, (a, b) in enumerate(pairwise(edges), -reach)]
        mean = math.fsum(k * p for k, p in shares)
        squares.append(math.fsum((k - mean) ** 2 * p for k, p in shares))
    return step_v * math.sqrt(math.fsum(squares) / _PARTS)


def noise_level(design: Design, noise_v: float | None = None) -> NoiseLevel:
    """Noise of the design's voltage, or of the given rms [V], after its chain.

    White Gaussian noise of deviation sigma leaves the high-pass with ``sigma sqrt(sum h^2)``, and its half wave
    has the mean ``sigma / sqrt(2 pi)``. The half wave is ``x/2 + |x|/2``: of the first part the high-pass has left
    nothing slow enough for the window to pass, the second has the variance ``sigma^2 (1 - 2/pi) / 4`` and is
    averaged as if its samples were independent (a test compares with noise itself: within 10 %).
    """
    settings = ChainSettings.of(design)
    sigma = input_noise_v(design) if noise_v is None else noise_v

    memory = math.ceil(settings.sample_rate_hz / min(settings.cutoff_hz, settings.envelope_cutoff_hz) * 4)
    impulse = [0.0, 1.0] + [0.0] * memory
    h = SlipChain(settings).process(impulse).filtered_v
    sigma *= math.sqrt(float(h @ h))

    share = 1 - math.exp(-2 * math.pi * settings.envelope_cutoff_hz / settings.sample_rate_hz)
    envelope = share * (1 - share) ** np.arange(memory)
    weights = np.convolve(envelope, np.full(settings.window_samples, 1 / settings.window_samples))
    deviation = sigma * math.sqrt((1 - 2 / math.pi) / 4 * float(weights @ weights))
    return NoiseLevel(sigma / math.sqrt(2 * math.pi), deviation)


def quiet_level(envelope_v: NDArray[np.float64], design: Design, name: str) -> NoiseLevel:
    """Level of a board's output in which nothing happens, after the design's window.

    Raises
    ------
    TraceError
        If it is shorter than ten windows, whose deviation would not be known to a quarter.
    """
    d = design.detector
    minimum = 11 * d.window_samples
    if len(envelope_v) < minimum:
        raise TraceError(Issue("--quiet-s", f"takes in {len(envelope_v)} samples of {name}; at least {minimum}."))
    means = Window.of(design).process(envelope_v).level_v[d.window_samples :]
    step = 2 * d.adc_range_v / 2**d.adc_bits
    return NoiseLevel(float(means.mean()), max(float(means.std()), step / DEVIATIONS))


FAR = 3.0
"""A threshold so many times above the rule's is worth a word."""
CLEAR = 4.0
"""Deviations above the level of the noise below which it crosses a threshold within minutes."""


def remarks(threshold_v: float, level: NoiseLevel, may_fall: bool = True) -> Iterator[str]:
    """Where a threshold stands in, or far above, the noise.

    It `may_fall` where noise is all that lifts the level: a board's output rests where offsets and leakage have it.
    """
    if threshold_v < level.mean_v:
        yield (
            f"detector.threshold_v of {threshold_v:g} V is below the level of the noise alone ({level.mean_v:.3g} V); "
            f"{level.threshold_v:.3g} V stands clear of it."
        )
    elif threshold_v < level.mean_v + CLEAR * level.deviation_v:
        yield (
            f"detector.threshold_v of {threshold_v:g} V is where the noise alone gets, again and again: its level is "
            f"{level.mean_v:.3g} V, give or take {level.deviation_v:.2g} V; {level.threshold_v:.3g} V stands clear."
        )
    elif may_fall and threshold_v > FAR * level.threshold_v:
        yield (
            f"detector.threshold_v of {threshold_v:g} V is {threshold_v / level.rounded_v:.0f} times what the noise "
            f"here asks for: --set detector.threshold_v={level.rounded_v:g} finds weaker slip."
        )


MIN_CUTOFF_HZ = 45.0
"""With lower ones every detector here alarms at contacts, in the quiet tuning scenes (article, III.A: contacts are
located below 30 Hz)."""
SHORTEST_S = 0.02
"""Shorter windows take contacts for slip (article, III.C)."""
_COARSE = 2.0
"""Steps so many times the noise hide it."""


WINDOWED = ("digital", "analog")
"""Detectors with the design's window."""


def setting_remarks(design: Design, detector: str = WINDOWED[0]) -> Iterator[str]:
    """What a design's filter, converter and window cannot do well with a detector, though nothing forbids them."""
    d, cutoff = design.detector, design.board.cutoff_hz
    if cutoff < MIN_CUTOFF_HZ:
        yield (
            f"board.cutoff_hz of {cutoff:g} Hz lets in what contacts and changes of grip leave, and they are taken for "
            f"slip; choose at least {MIN_CUTOFF_HZ:g} Hz (article: 67 Hz)."
        )
    step = 2 * d.adc_range_v / 2**d.adc_bits
    if step > _COARSE * d.noise_v > 0.0:
        yield (
            f"detector.adc_bits of {d.adc_bits} over plus and minus {d.adc_range_v:g} V are steps of "
            f"{1000 * step:.3g} mV, in which noise of {1000 * d.noise_v:.3g} mV is lost: weak slip is not seen, and "
            "single steps look like slip. Take more bits, or a smaller detector.adc_range_v."
        )
    lasts = d.window_samples / d.sample_rate_hz
    if detector in WINDOWED and lasts < SHORTEST_S:
        yield (
            f"detector.window_samples of {d.window_samples} at {d.sample_rate_hz:g} Hz last {1000 * lasts:.3g} ms; "
            f"below {1000 * SHORTEST_S:g} ms contacts are taken for slip. {round(0.03 * d.sample_rate_hz)} last 30 ms."
        )
