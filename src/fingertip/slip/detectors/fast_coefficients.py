"""Constants of the sample loop of the detector `fast` at one sampling rate and noise.

They are arguments of the loop, which takes them in this order. What is fixed for all stands in the
loop's own module, where the cache of compiled loops notices a change of it.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import resources
from typing import NamedTuple

import numpy as np

from fingertip.foundation.numerics import Array
from fingertip.slip.detectors.analog_and_digital import FirstOrder, SecondOrder


class FastCoefficients(NamedTuple):
    """Constants of the loop. Sections without an order in their name are of second order.

    `board` is the board's high-pass filter as a digital filter; its first section has the numerator
    ``b (1 - 1/z)``. `restore` moves its cutoff down to that of the bands. Smoothing factors are per
    sample, or per tick where a floor or a score is smoothed; their times and scores stand in
    `fast_settings` and in `FastModel`.
    """

    board_1: FirstOrder
    board: SecondOrder
    restore_1: FirstOrder
    restore: SecondOrder
    edge: SecondOrder
    upper: SecondOrder
    wide: SecondOrder
    slow: SecondOrder
    sample_rate_hz: float
    direction: float
    """1 if the input falls with the force, -1 if it rises."""
    filtered_gain: float
    """Factor from the filtered signal to a voltage at the filter's
    input; 0 if the board gives no filtered signal.
    """
    filtered_limit: float
    """Voltage at the filter's input from which on a stage of the board may be at its limit [V]."""
    filtered_rest: float
    """Rest of the filtered signal [V]: where its mean is off by
    more than `rest_limit`, it is not used.
    """
    rest_limit: float
    level_smoothing: float
    limited_samples: float
    """Samples for which the filtered signal is not used after that."""
    still_samples: float
    """Samples without any change after which the filtered signal
    is not used: its wire may be broken.
    """
    short_smoothing: float
    long_smoothing: float
    tick_samples: float
    slot_ticks: float
    max_floor_ticks: float
    tone_ticks: float
    unlearning: float
    wide_share: float
    """Energy of white noise of unit variance in the wide band."""
    upper_share: float
    min_floor: float
    """Lower bound of the wide band's floor [V^2]."""
    min_upper_floor: float
    """Lower bound of the upper band's floor [V^2]."""
    min_input_floor: float
    """Lower bound of the floor of the tactile voltage [V^2]."""
    silent_floor: float
    """Energy of a tactile voltage below which it may stand still [V^2]."""
    noisy_floor: float
    """Floor of the wide band from which there is more noise than stated, and the threshold rises
    [V^2]; at twice this floor it has risen to its end.
    """
    noisy_slow_floor: float
    """The same for the slow force."""
    offset: float
    lowest_score: float
    threshold: float
    incipient_rise: float
    noise_rise: float
    stay_threshold: float
    stay_ratio: float
    mean_smoothing: float
    hold_smoothing: float
    weak_smoothing: float
    statistic_gain: float
    """Threshold in volts, divided by the root of the wide floor."""
    number_limit: float
    """Size from which on a value is no voltage [V]."""
    jump_limit: float
    """Difference between two samples that the next one must confirm [V]."""
    filtered_jump_limit: float
    """The same for the filtered signal, as a voltage at the filter's input [V]."""
    middle_input: float
    """Middle of the tactile voltages that forces give [V]."""
    half_range: float
    trusted_samples: float
    gap_samples: float
    fault_samples: float
    restart_ticks: float


# Filters of the detector `fast`, and the energy that white noise has behind them.

LOW_HZ = 40.0
UPPER_HZ = 90.0
HIGH_HZ = 170.0
"""Lower edges of the wide and of the upper band, and the upper edge of both [Hz].

Contacts lie below 30 Hz, and the spectrum of slip in an embedded sensor rarely exceeds 100 Hz
(article, section III.A and figure 2), where noise is weakest compared with what a change of force
leaves. The edges belong to pad and sensor, not to the filter board, whose cutoff may differ.
"""
SLOW_HZ = 28.0
"""Cutoff behind which the voltage follows the slow force [Hz]:
just below contacts' highest frequency.
"""

RESTORED_HZ = 15.0
"""Cutoff of the restored high-pass [Hz]: below the bands, but not
so low that offsets and limits count.
"""

ThirdOrder = tuple[FirstOrder, SecondOrder]


@dataclass(frozen=True)
class FastFilters:
    """Butterworth filters.

    The output of `restored` feeds `high_edge`, whose output feeds the two other high-passes.
    """

    restored: ThirdOrder
    """High-pass filter of the board's order, with its cutoff moved to `RESTORED_HZ`."""
    high_edge: SecondOrder
    """Low-pass filter at the upper edge of the bands."""
    upper: SecondOrder
    """High-pass filter at the lower edge of the upper band."""
    wide: SecondOrder
    """High-pass filter at the lower edge of the wide band."""
    slow: SecondOrder
    """Low-pass filter of the slow force, from the input."""

    def impulse_responses(self, count: int) -> tuple[Array, Array]:
        """Compute the impulse responses of the wide and the upper band, `count` samples each."""
        impulse = np.zeros(count)
        impulse[0] = 1.0
        first, second = self.restored
        restored = _filter(
            second,
            _filter(
                SecondOrder(
                    b0=first.b0,
                    b1=first.b1,
                    b2=0.0,
                    a1=first.a1,
                    a2=0.0,
                ),
                impulse,
            ),
        )
        edge = _filter(self.high_edge, restored)

        return _filter(self.wide, edge), _filter(self.upper, edge)


@functools.lru_cache(maxsize=16)
def design_filters(sample_rate_hz: float) -> FastFilters:
    return FastFilters(
        restored=_third_order(sample_rate_hz, RESTORED_HZ),
        high_edge=_butterworth(sample_rate_hz, HIGH_HZ, 1),
        upper=_butterworth(sample_rate_hz, UPPER_HZ, -1),
        wide=_butterworth(sample_rate_hz, LOW_HZ, -1),
        slow=_butterworth(sample_rate_hz, SLOW_HZ, 1),
    )


def design_board_filter(sample_rate_hz: float, cutoff_hz: float) -> tuple[ThirdOrder, ThirdOrder]:
    """Design the board's high-pass filter for a gain of 1, and
    what turns it into `FastFilters.restored`.
    """
    first, second = board = _third_order(sample_rate_hz, cutoff_hz)
    low_first, low_second = _third_order(sample_rate_hz, RESTORED_HZ)
    gain_1 = low_first.b0 / first.b0
    gain_2 = low_second.b0 / second.b0
    restore = (
        FirstOrder(gain_1, gain_1 * first.a1, low_first.a1),
        SecondOrder(
            b0=gain_2,
            b1=gain_2 * second.a1,
            b2=gain_2 * second.a2,
            a1=low_second.a1,
            a2=low_second.a2,
        ),
    )

    return board, restore


@functools.lru_cache(maxsize=16)
def noise_energies(sample_rate_hz: float) -> tuple[float, float]:
    """Mean energies of white noise of unit variance in the wide and
    in the upper band, for a sampling rate [Hz].
    """
    wide, upper = design_filters(sample_rate_hz).impulse_responses(
        math.ceil(8 * sample_rate_hz / LOW_HZ)
    )
    # A dot product differs between processors.
    return math.fsum(wide * wide), math.fsum(upper * upper)


def _third_order(sample_rate_hz: float, cutoff_hz: float) -> ThirdOrder:
    K = math.tan(math.pi * cutoff_hz / sample_rate_hz)
    b = 1 / (1 + K)
    norm = 1 / (1 + K + K * K)
    return (
        FirstOrder(b, -b, (K - 1) * b),
        SecondOrder(
            b0=norm,
            b1=-2 * norm,
            b2=norm,
            a1=2 * (K * K - 1) * norm,
            a2=(1 - K + K * K) * norm,
        ),
    )


def _butterworth(sample_rate_hz: float, cutoff_hz: float, sign: int) -> SecondOrder:
    """Design a second-order section by the bilinear transform: a
    low-pass for sign 1, a high-pass for -1.
    """
    K = math.tan(math.pi * cutoff_hz / sample_rate_hz)
    norm = 1 / (1 + math.sqrt(2) * K + K * K)
    b = norm * (K * K if sign > 0 else 1.0)

    return SecondOrder(
        b0=b,
        b1=2 * sign * b,
        b2=b,
        a1=2 * (K * K - 1) * norm,
        a2=(1 - math.sqrt(2) * K + K * K) * norm,
    )


def _filter(section: SecondOrder, samples: Sequence[float] | Array) -> Array:
    b0, b1, b2, a1, a2 = section
    out = np.zeros(len(samples))
    s1 = 0.0
    s2 = 0.0

    for i in range(len(samples)):
        x = float(samples[i])
        y = b0 * x + s1
        s1 = b1 * x - a1 * y + s2
        s2 = b2 * x - a2 * y
        out[i] = y

    return out


# Trained part of the detector: a sum of small decision trees, which `tools/detector_training` fits.
# Every tree is complete, so an evaluation takes the same number of comparisons for every input.

TABLE = "fast_model.json"
DEPTH = 4
"""Comparisons of one tree."""
NODES = (1 << DEPTH) - 1
"""Comparisons that a tree stores."""
FEATURES = (
    "upper energy, 6 ms",
    "upper energy, 20 ms",
    "wide energy, 6 ms",
    "wide energy, 20 ms",
    "greatest slope",
    "change over 100 ms",
    "signed change over 48 ms",
    "upper energy over its peak",
    "wide energy over greatest slope",
    "upper energy over greatest slope",
    "upper over wide energy",
    "slope over greatest slope",
    "smallest wide energy",
    "smallest wide energy over that of 20 ms",
    "upper energy, 80 ms",
    "wide energy, 80 ms",
    "slope, 80 ms",
    "slope of 80 ms over greatest slope",
    "upper over wide energy, 80 ms",
    "upper energy of 20 ms over that of 80 ms",
    "ticks of lasting upper energy",
    "ticks of weaker upper energy",
)
"""Names of the features, in the order of their numbers.

All but the ticks are squares or ratios of squares. Those without "over" are relative to the learned
noise, so no feature depends on the unit of the input. "Smallest" is that of 6 ms in the last 16 to
24 ms. "Greatest" and "peak" are those of the last 80 to 120 ms.
"""


@dataclass(frozen=True, eq=False)
class FastModel:
    """Trees, flattened: node k of tree t stands at ``t * NODES + k``;
    its branches are nodes 2 k + 1 and 2 k + 2.
    """

    features: Array
    """Number of the feature that each node compares."""
    thresholds: Array
    """Value above which the second branch is taken."""
    leaves: Array
    """Values of the leaves, `NODES` + 1 for each tree."""
    offset: float
    """Score before the first tree."""
    threshold: float
    """Mean score above which slip is ON, in the stated noise."""
    noise_rise: float
    """Rise of this threshold in more noise."""
    incipient_threshold: float
    """Score above which slip may begin."""

    @functools.cached_property
    def lists(self) -> tuple[list[float], list[float], list[float]]:
        """Features, thresholds and leaves as lists, which plain Python reads fastest."""
        return self.features.tolist(), self.thresholds.tolist(), self.leaves.tolist()

    @property
    def trees(self) -> int:
        return len(self.leaves) // (NODES + 1)


@functools.cache
def load_model() -> FastModel:
    table = json.loads(resources.files(__package__).joinpath(TABLE).read_text(encoding="utf-8"))
    features, thresholds, leaves = (
        np.array(table[n], dtype=np.float64) for n in ("features", "thresholds", "leaves")
    )
    scores = (table[name] for name in ("offset", "threshold", "noise_rise", "incipient_threshold"))
    return FastModel(features, thresholds, leaves, *scores)
