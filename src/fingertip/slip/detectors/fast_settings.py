"""Settings of the detector `fast`, and the constants of its filters that follow from them."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import NamedTuple

from fingertip.design import Design
from fingertip.design.formulas.filter import filtered_range_v, signal_ground_ratio
from fingertip.slip.detectors.analog_and_digital import FirstOrder, SecondOrder
from fingertip.slip.detectors.noise_and_threshold import input_noise_v

TICK_S = 0.002
"""Time between two decisions [s]."""
LAG_S = 0.001
"""Time between the samples that are compared to tell a tone [s]."""
SLOW_HZ = (3.0, 28.0)
"""Band of the slow force [Hz]: a change of grip lies in it, drift lies below it."""
BANDS_HZ = ((28.0, 60.0), (60.0, 120.0), (120.0, 250.0), (250.0, 700.0))
"""Bands of vibration whose energies tell slip from a blow [Hz]."""
HIGHEST_SHARE = 0.38
"""Upper end of the last band, as the greatest share of the sampling rate."""
GAP_S = 0.02
"""Time without a voltage after which the next one begins anew [s]."""
FAULT_S = 0.05
"""Time for which a replaced sample is reported, and after which an impossible voltage is [s]."""
BLOCKED_S = 0.05
"""Time for which the detector stays OFF after a gap or the loss of the filtered signal [s]."""
STILL_S = 0.2
"""Time without any change after which the filtered signal is not used [s]: noise moves it."""
LIMITED_S = 0.03
"""Time in which the board's filter recovers from a limit [s]."""
LIMIT_SHARE = 0.9
"""Share of the filtered signal's range that is used: a stage may be at its limit beyond it."""
REST_SHARE = 0.5
"""Share of that range by which the signal's mean over `STILL_S` may differ from its rest."""
MOVE_S = 0.006
"""Time over which the movement between two samples is averaged [s]."""
NUMBER_RATIO = 1e6
"""Ratio to the stated noise from which on a value is no voltage."""
JUMP_RATIO = 36.0
FILTERED_JUMP_RATIO = 1.0
"""Ratio to the stated noise of the smallest jump that the next sample must confirm, in the tactile
voltage and in the filtered signal.
"""
MIN_NOISE_V_RTHZ = 1.26e-5
"""Smallest noise density taken for stated [V/sqrt(Hz)]."""
MIN_NOISE_SHARE = 0.2
DIVIDER_NOISE_SHARE = 1.0
"""Smallest noise that is learned from the tactile voltage of a board, and of a divider, as a share
of the stated noise. A divider is silent in the air, where its sensor passes nothing, and has its
noise in touch.
"""
MIN_FILTERED_V = 6e-5
"""Smallest mean vibration that is learned from the filtered signal, at the filter's input [V]."""
NOISE_MEAN = math.sqrt(2 / math.pi)
"""Mean size of noise of unit variance."""


@dataclass(frozen=True)
class FilteredSignal:
    """The board's filtered signal, as a controller samples it."""

    gain: float
    """Gain of the board's filter in its passband."""
    range_v: float
    """Largest deviation from its rest that the board and the converter pass [V]."""
    rest_v: float | None = None
    """Rest that its mean is compared with [V]; None: a recording may have any."""

    @property
    def limit_v(self) -> float:
        """Vibration at the filter's input beyond which a stage counts as limited [V]."""
        return LIMIT_SHARE * self.range_v / self.gain

    @classmethod
    def from_design(cls, design: Design, in_codes: bool = False) -> FilteredSignal | None:
        """Take it from a design; None if the board does not give it to a controller.

        The library of a controller, which takes codes, knows the rest: half the supply.
        """
        range_v = filtered_range_v(design.board, design.detector.adc_range_v)
        if range_v is None:
            return None

        rest_v = signal_ground_ratio(design.board) * design.board.supply_v if in_codes else None
        return cls(design.board.passband_gain, range_v, rest_v)


@dataclass(frozen=True)
class FastSettings:
    """What a detector `fast` is made for."""

    sample_rate_hz: float
    noise_v: float
    """Stated white RMS noise [V]. It tells what is no voltage, and the least that is learned."""
    threshold_scale: float = 1.0
    """Factor of both thresholds, to trade delay for false alarms."""
    min_noise_share: float = MIN_NOISE_SHARE
    """Smallest noise that is learned from the tactile voltage, as a share of the stated one."""
    cutoff_hz: float = 67.0
    """Cutoff of the high-pass filter [Hz]."""
    filtered: FilteredSignal | None = None
    """Filtered signal of the board. None: the detector is given the tactile voltage alone."""
    possible_v: tuple[float, float] = (-1e30, 1e30)
    """Tactile voltages that forces give; others are reported [V]."""
    phase: int = 0
    """Samples by which its ticks come sooner: the detectors of a hand's fingers tick one sample
    apart.
    """

    @classmethod
    def from_design(cls, design: Design, noise_v: float | None = None) -> FastSettings:
        rate_hz = design.detector.sample_rate_hz
        stated_v = max(input_noise_v(design), min_noise_v(rate_hz))
        return cls(
            sample_rate_hz=rate_hz,
            noise_v=stated_v if noise_v is None else noise_v,
            min_noise_share=MIN_NOISE_SHARE if design.board.has_filter else DIVIDER_NOISE_SHARE,
            cutoff_hz=design.board.cutoff_hz,
            filtered=FilteredSignal.from_design(design),
        )

    @property
    def number_limit_v(self) -> float:
        """Largest number that is a voltage [V]."""
        return NUMBER_RATIO * self.noise_v

    @property
    def tick_samples(self) -> int:
        return max(1, round(TICK_S * self.sample_rate_hz))

    @property
    def tick_s(self) -> float:
        """Time between two decisions at this sampling rate [s]."""
        return self.tick_samples / self.sample_rate_hz

    def samples(self, time_s: float) -> int:
        """Number of samples of a time."""
        return max(1, round(time_s * self.sample_rate_hz))

    def ticks(self, time_s: float) -> int:
        """Number of ticks of a time."""
        return max(1, round(time_s / self.tick_s))


class FastFilters(NamedTuple):
    """Filters of the detector at one sampling rate.

    Those of first order take differences between samples: their numerator ``1 - 1/z`` is applied
    by the difference.
    """

    high_1: FirstOrder
    high_2: SecondOrder
    """The board's third-order high-pass filter, with a gain of 1."""
    leak: FirstOrder
    """Sum of differences that forgets drift: a high-pass filter of first order."""
    slow: SecondOrder
    """Low-pass filter of the slow force."""
    bands: tuple[SecondOrder, ...]
    """Band-pass filters of `BANDS_HZ`, behind the high-pass filter."""


@functools.lru_cache(maxsize=16)
def design_filters(sample_rate_hz: float, cutoff_hz: float) -> FastFilters:
    """Design the filters by the bilinear transform, which is exact at the cutoff."""
    low_hz, high_hz = SLOW_HZ
    high_1, high_2 = _high_pass(sample_rate_hz, cutoff_hz)
    leak = FirstOrder(b0=1.0, b1=0.0, a1=-math.exp(-2 * math.pi * low_hz / sample_rate_hz))
    highest_hz = HIGHEST_SHARE * sample_rate_hz
    return FastFilters(
        high_1=high_1,
        high_2=high_2,
        leak=leak,
        slow=_low_pass(sample_rate_hz, high_hz),
        bands=tuple(
            _band_pass(sample_rate_hz, begin_hz, min(end_hz, highest_hz))
            for begin_hz, end_hz in BANDS_HZ
        ),
    )


def _high_pass(sample_rate_hz: float, cutoff_hz: float) -> tuple[FirstOrder, SecondOrder]:
    """Butterworth filter of third order; its first section takes differences (article, eq. 1)."""
    K = math.tan(math.pi * cutoff_hz / sample_rate_hz)
    norm = 1 / (1 + K + K * K)
    first = FirstOrder(b0=1 / (1 + K), b1=0.0, a1=(K - 1) / (K + 1))
    second = SecondOrder(
        b0=norm, b1=-2 * norm, b2=norm, a1=2 * (K * K - 1) * norm, a2=(1 - K + K * K) * norm
    )
    return first, second


def _low_pass(sample_rate_hz: float, cutoff_hz: float) -> SecondOrder:
    K = math.tan(math.pi * cutoff_hz / sample_rate_hz)
    norm = 1 / (1 + math.sqrt(2) * K + K * K)
    b = K * K * norm
    a2 = (1 - math.sqrt(2) * K + K * K) * norm
    return SecondOrder(b0=b, b1=2 * b, b2=b, a1=2 * (K * K - 1) * norm, a2=a2)


def _band_pass(sample_rate_hz: float, begin_hz: float, end_hz: float) -> SecondOrder:
    """Resonator with unit gain at the geometric mean of a band's ends, and its width."""
    middle_hz = math.sqrt(begin_hz * end_hz)
    angle = 2 * math.pi * middle_hz / sample_rate_hz
    alpha = math.sin(angle) * (end_hz - begin_hz) / (2 * middle_hz)
    norm = 1 / (1 + alpha)
    return SecondOrder(
        b0=alpha * norm,
        b1=0.0,
        b2=-alpha * norm,
        a1=-2 * math.cos(angle) * norm,
        a2=(1 - alpha) * norm,
    )


@functools.lru_cache(maxsize=16)
def white_energies(sample_rate_hz: float, cutoff_hz: float) -> tuple[float, ...]:
    """Mean energies of white noise of unit variance in the slow band, in `BANDS_HZ` and behind the
    high-pass filter alone.
    """
    filters = design_filters(sample_rate_hz, cutoff_hz)
    count = math.ceil(sample_rate_hz)  # a second, in which all has decayed
    impulse = [1.0, -1.0] + [0.0] * count  # differences of an impulse
    wide = _run_second(filters.high_2, _run_first(filters.high_1, impulse))
    slow = _run_second(filters.slow, _run_first(filters.leak, impulse))
    signals = [slow, *(_run_second(band, wide) for band in filters.bands), wide]
    return tuple(math.fsum(value * value for value in signal) for signal in signals)


def _run_first(section: FirstOrder, samples: list[float]) -> list[float]:
    out = list[float]()
    last = 0.0
    for sample in samples:
        last = section.b0 * sample - section.a1 * last
        out.append(last)

    return out


def _run_second(section: SecondOrder, samples: list[float]) -> list[float]:
    b0, b1, b2, a1, a2 = section
    out = list[float]()
    state_1 = 0.0
    state_2 = 0.0
    for sample in samples:
        value = b0 * sample + state_1
        state_1 = b1 * sample - a1 * value + state_2
        state_2 = b2 * sample - a2 * value
        out.append(value)

    return out


def min_noise_v(sample_rate_hz: float) -> float:
    """Smallest noise that is taken for stated, where the input is in volts [V]."""
    return MIN_NOISE_V_RTHZ * math.sqrt(sample_rate_hz / 2)
