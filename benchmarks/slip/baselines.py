"""Detectors of this project and of its field, each run over one recording at some factors of its
threshold. Baselines take their noise from the stated rest, where a recording has one.

The article's chain and its FFT are those of `fingertip.slip.detectors`, the FFT as published and in
a stronger form.

References: CUSUM: E. S. Page, Biometrika 41, 1954, for a step of the variance of Gaussian samples:
M. Basseville and I. V. Nikiforov, Detection of Abrupt Changes, 1993, section 2.2. Ratio of a short
to a long mean of the energy: R. Allen, Bull. Seismol. Soc. Am. 68, 1978.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable, Iterator, MutableSequence, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.slip.recordings import Recording
from benchmarks.slip.scores import Flags
from fingertip.design import Design
from fingertip.detection.adaptation import adapt_rate, equivalent_noise_v
from fingertip.foundation.jit import CompiledLoop
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.analog_and_digital import ChainSettings, SlipChain, noise_level
from fingertip.slip.detectors.fast import FastDetector, FastOutput
from fingertip.slip.detectors.fast_settings import FastSettings
from fingertip.slip.detectors.fast_table import BlowTable, read_table
from fingertip.slip.detectors.fft import FftDetector
from fingertip.slip.detectors.registry import select_inputs

Run = Callable[[Design, Recording, Sequence[float]], Iterator[Flags]]
"""Function that returns ON at each sample, for each factor of the threshold."""


def adapt(design: Design, recording: Recording) -> tuple[Design, Recording]:
    """Adapt a design's filters and windows to the rate of a recording,
    and the recording to the design's direction.
    """
    rises = recording.rises_with_force
    if rises is not None and rises != design.board.tactile_rises:
        signal = replace(recording.signal, voltage_v=-recording.signal.voltage_v)
        rest = None if recording.rest is None else -recording.rest
        recording = replace(recording, signal=signal, rest=rest)

    return adapt_rate(design, recording.signal.rate_hz), recording


def find_noise_v(name: str, design: Design, recording: Recording) -> float | None:
    """Noise for a baseline, from the stated rest; None: the design's."""
    rest = recording.rest
    return None if rest is None else equivalent_noise_v(name, design, rest, recording.signal.kind)


@functools.lru_cache(maxsize=32)
def detect(
    design: Design, recording: Recording, factor: float, table: Path | None = None
) -> FastOutput:
    """Run `fast` over a recording, for both of its flags."""
    design, recording = adapt(design, recording)
    settings = replace(make_settings(design, recording), threshold_scale=factor)
    detector = FastDetector(settings, None if table is None else load_file(table))
    return detector.process(*select_inputs(recording.signal, "fast"))


def make_settings(design: Design, recording: Recording) -> FastSettings:
    """Make the settings of `fast`, which learns its floors by itself.

    Of a signal that is no voltage, the rest tells it what is a glitch.
    """
    rest = recording.rest
    noise_v = None if rest is None else FastDetector.equivalent_noise_v(design, rest)
    return FastSettings.from_design(design, noise_v)


@functools.cache
def load_file(path: Path) -> BlowTable:
    """Load a table that is not the package's."""
    return read_table(json.loads(path.read_text(encoding="utf-8")))


def make_fast_run(table: Path | None = None) -> Run:
    """Make the run of `fast` with the package's table or another one."""

    def run(design: Design, recording: Recording, factors: Sequence[float]) -> Iterator[Flags]:
        for factor in factors:
            yield detect(design, recording, factor, table).on

    return run


def run_incipient(
    design: Design, recording: Recording, factors: Sequence[float]
) -> Iterator[Flags]:
    for factor in factors:
        yield detect(design, recording, factor).incipient


def run_chain(design: Design, recording: Recording, factors: Sequence[float]) -> Iterator[Flags]:
    """Run the article's chain once: its threshold does not change its statistic."""
    design, recording = adapt(design, recording)
    noise_v = find_noise_v("digital", design, recording)
    # `make_detector` would refuse a divider, on which the chain is slow and noisy but runs.
    detector = SlipChain.for_design(design, noise_v)
    statistic = detector.process(recording.signal.voltage_v).statistic_v
    for factor in factors:
        yield statistic > factor * detector.threshold_v


def make_fft_run(is_plain: bool) -> Run:
    def run(design: Design, recording: Recording, factors: Sequence[float]) -> Iterator[Flags]:
        design, recording = adapt(design, recording)
        detector = FftDetector(design, find_noise_v("fft", design, recording), is_plain=is_plain)
        statistic = detector.process(recording.signal.voltage_v).statistic_v
        for factor in factors:
            yield statistic > factor * detector.threshold_v

    return run


def band_signal(design: Design, recording: Recording) -> Array:
    """Signal above the board's cutoff: the board's own where it
    gives one, otherwise filtered in software.
    """
    filtered = recording.signal.filtered_v
    if filtered is not None:
        return (filtered - float(np.median(filtered))) / design.board.passband_gain

    chain = SlipChain(ChainSettings.from_design(design))
    return chain.filter(recording.signal.voltage_v) / design.board.passband_gain


NOISE_S = 2.0
SLOWER = 0.05
"""Time constant of the learned noise energy [s], and how much
of its speed is left while slip is ON.
"""
SHORT_S = 0.01
"""Short mean of the energy [s]."""
HEARD = 4.0
"""Ratio of the energies in slip and in noise for which CUSUM is best."""
RATIO_THRESHOLD = 4.0
CUSUM_THRESHOLD = 12.0
"""Thresholds at the factor 1: ratio of energies, and log likelihood."""
CAP = 2.0
"""Bound of the sum of CUSUM over its threshold: without one, ON
would outlast a slip by the slip's duration.
"""


def _ratio_loop(
    samples: Sequence[float],
    short: float,
    long: float,
    least: float,
    threshold: float,
    on: MutableSequence[float],
) -> None:
    mean = least
    noise = least
    for i in range(len(samples)):
        energy = samples[i] * samples[i]
        mean += short * (energy - mean)
        on[i] = 1.0 if mean > threshold * noise else 0.0
        # Slip is learned as noise slowly: never, a floor that is too low would keep it ON for ever.
        noise = max(least, noise + (SLOWER if on[i] else 1.0) * long * (energy - noise))


def _cusum_loop(
    samples: Sequence[float],
    long: float,
    least: float,
    threshold: float,
    on: MutableSequence[float],
) -> None:
    total = 0.0
    noise = least
    for i in range(len(samples)):
        energy = samples[i] * samples[i]
        # Log likelihood of a variance that is HEARD times the noise's, over that of the noise.
        total += 0.5 * (energy / noise * (1 - 1 / HEARD) - math.log(HEARD))
        total = min(max(total, 0.0), CAP * threshold)
        on[i] = 1.0 if total > threshold else 0.0
        noise = max(least, noise + (SLOWER if on[i] else 1.0) * long * (energy - noise))


_RATIO = CompiledLoop(_ratio_loop, samples="samples", plain_us=0.3)
_CUSUM = CompiledLoop(_cusum_loop, samples="samples", plain_us=0.5)


def run_ratio(design: Design, recording: Recording, factors: Sequence[float]) -> Iterator[Flags]:
    design, recording = adapt(design, recording)
    samples = band_signal(design, recording)
    rate_hz = recording.signal.rate_hz
    short = 1 / (SHORT_S * rate_hz)
    long = 1 / (NOISE_S * rate_hz)
    least = least_energy(design, recording)
    on = np.zeros(len(samples))

    for factor in factors:
        _RATIO(samples, short, long, least, factor * RATIO_THRESHOLD, on)
        yield on > 0.0


def run_cusum(design: Design, recording: Recording, factors: Sequence[float]) -> Iterator[Flags]:
    design, recording = adapt(design, recording)
    samples = band_signal(design, recording)
    long = 1 / (NOISE_S * recording.signal.rate_hz)
    least = least_energy(design, recording)
    on = np.zeros(len(samples))

    for factor in factors:
        _CUSUM(samples, long, least, factor * CUSUM_THRESHOLD, on)
        yield on > 0.0


def least_energy(design: Design, recording: Recording) -> float:
    """Energy of the stated noise or rest above the board's cutoff, below which none is learned."""
    chain = SlipChain(ChainSettings.from_design(design))
    if recording.rest is None:
        noise_v = noise_level(design).mean_v * math.sqrt(2 * math.pi)
    else:
        settled = chain.filter(recording.rest)[round(0.1 * recording.signal.rate_hz) :]
        noise_v = float(np.std(settled))

    return max(noise_v / design.board.passband_gain, 1e-9) ** 2
