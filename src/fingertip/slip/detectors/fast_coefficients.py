"""Constants of the sample loop of the detector `fast` at one sampling rate and noise.

They are arguments of the loop, which takes them in this order. What is fixed for all stands in the loop's own module,
where the cache of compiled loops notices a change of it.
"""

from __future__ import annotations

from typing import NamedTuple


class FastCoefficients(NamedTuple):
    """Constants of the loop. Sections without an order in their name are of second order.

    `board` is the board's high-pass filter as a digital filter; its first section has the numerator ``b (1 - 1/z)``.
    `restore` moves its cutoff down to that of the bands.
    """

    board_1_b: float
    board_1_a1: float
    board_b0: float
    board_b1: float
    board_b2: float
    board_a1: float
    board_a2: float
    restore_1_b0: float
    restore_1_b1: float
    restore_1_a1: float
    restore_b0: float
    restore_b1: float
    restore_b2: float
    restore_a1: float
    restore_a2: float
    edge_b0: float
    edge_b1: float
    edge_b2: float
    edge_a1: float
    edge_a2: float
    upper_b0: float
    upper_b1: float
    upper_b2: float
    upper_a1: float
    upper_a2: float
    wide_b0: float
    wide_b1: float
    wide_b2: float
    wide_a1: float
    wide_a2: float
    slow_b0: float
    slow_b1: float
    slow_b2: float
    slow_a1: float
    slow_a2: float
    sample_rate_hz: float
    filtered_gain: float
    """Factor from the filtered signal to a voltage at the filter's input; 0 if the board gives no filtered signal."""
    filtered_limit: float
    """Voltage at the filter's input from which on a stage of the board may be at its limit [V]."""
    limited_samples: float
    """Samples for which the filtered signal is not used after that."""
    still_samples: float
    """Samples without any change after which the filtered signal is not used: its wire may be broken."""
    short_smoothing: float
    """Smoothing factor of 6 ms, per sample."""
    long_smoothing: float
    """Smoothing factor of 20 ms, per sample."""
    tick_samples: float
    slot_ticks: float
    """Duration of a slot of the peaks [ticks]."""
    max_floor_ticks: float
    """Ticks over which the floors average in the end."""
    tone_ticks: float
    """Ticks of ON after which a tone is unlearned."""
    unlearning: float
    """Smoothing factor of the floors while a tone is unlearned, per tick."""
    wide_share: float
    """Energy of white noise of unit variance in the wide band."""
    upper_share: float
    """The same in the upper band."""
    min_floor: float
    """Lower bound of the wide band's floor [V^2]."""
    min_upper_floor: float
    """Lower bound of the upper band's floor [V^2]."""
    min_input_floor: float
    """Lower bound of the floor of the tactile voltage [V^2]."""
    offset: float
    """Score before the first tree."""
    lowest_score: float
    """Score of confidence 0."""
    threshold: float
    """Score above which slip is ON, in the stated noise."""
    noise_rise: float
    """Rise of this threshold in more noise."""
    stay_threshold: float
    """Score above which slip stays ON."""
    stay_ratio: float
    """Ratio of an energy of 20 ms to its floor above which slip stays ON."""
    score_smoothing: float
    """Smoothing factor of the score while ON, per tick."""
    statistic_gain: float
    """Threshold in volts, divided by the root of the wide floor."""
