"""Sample loop of the detector `fast`: two bands, their energies, the slew rate, the thresholds, and ON or OFF."""

from __future__ import annotations

import math
from collections.abc import MutableSequence, Sequence
from typing import NamedTuple

from fingertip.jit import CompiledLoop

NEW_KNOCK_RATIO = 2.0
"""A slew rate above this multiple of the decayed peak of the last knock is another knock."""


class FastCoefficients(NamedTuple):
    """Constants of the loop.

    The numerators of the low-pass filter and of the upper band's high-pass filter follow from their ``b0``: ``b1`` is
    2 b0 for the low-pass and -2 b0 for the high-pass, ``b2`` is b0.
    """

    first_b0: float
    first_b1: float
    first_a1: float
    second_b0: float
    second_b1: float
    second_b2: float
    second_a1: float
    second_a2: float
    low_pass_b0: float
    low_pass_a1: float
    low_pass_a2: float
    upper_b0: float
    upper_a1: float
    upper_a2: float
    energy_smoothing: float
    """Smoothing factor of the energies, per sample."""
    slew_smoothing: float
    """Smoothing factor of the slew rate's two poles, per sample."""
    knock_smoothing: float
    """Smoothing factor of the less smoothed slew rate that identifies knocks, per sample."""
    floor_smoothing: float
    """Smoothing factor of the noise floors, per sample."""
    peak_decay: float
    """Factor by which peak slew rates decay, per sample."""
    sample_rate_hz: float
    noise_ratio: float
    """Wide band's noise threshold, divided by its noise floor."""
    upper_noise_ratio: float
    """Upper band's noise threshold, divided by its noise floor."""
    hysteresis: float
    """Factor of the noise thresholds while ON, as an energy ratio."""
    slew_gain: float
    """Increase of the wide band's threshold per squared slew rate [s^2]."""
    upper_slew_gain: float
    """Increase of the upper band's threshold per squared slew rate [s^2]."""
    slew_noise: float
    """Squared slew rate that noise sustains, divided by the wide band's noise floor [1/s^2]."""
    max_slew_rate: float
    """Slew rate above which a signal is a knock [V/s]."""
    blanking_samples: float
    """Duration of the blanking after a knock [samples]."""
    max_on_samples: float
    """Duration of ON after which the noise floors adapt nevertheless [samples]."""
    min_floor: float
    """Lower bound of the wide band's noise floor [V^2]."""
    upper_min_floor: float
    """Lower bound of the upper band's noise floor [V^2]."""


# Indices into the loop's state.
FIRST = 0
SECOND_1 = 1
SECOND_2 = 2
LOW_PASS_1 = 3
LOW_PASS_2 = 4
UPPER_1 = 5
UPPER_2 = 6
ENERGY = 7
UPPER_ENERGY = 8
SMOOTHED_1 = 9
SMOOTHED_2 = 10
PEAK_SLEW = 11
KNOCK_SMOOTHED = 12
KNOCK_PEAK_SLEW = 13
FLOOR = 14
UPPER_FLOOR = 15
ON = 16
KNOCK_SAMPLES = 17
ON_SAMPLES = 18
SETTLING_SAMPLES = 19
STATES = 20

SMOOTHED_VOLTAGES = (SMOOTHED_1, SMOOTHED_2, KNOCK_SMOOTHED)
"""States that equal the input while it is constant."""


def _fast_loop(
    coefficients: FastCoefficients,
    samples: Sequence[float],
    state: MutableSequence[float],
    filtered: MutableSequence[float],
    statistics: MutableSequence[float],
    thresholds: MutableSequence[float],
    flags: MutableSequence[float],
) -> None:
    # In the order of the fields of FastCoefficients.
    (
        g0, g1, g_a1, b0, b1, b2, a1, a2, l0, l_a1, l_a2, u0, u_a1, u_a2,
        energy_smoothing, slew_smoothing, knock_smoothing, floor_smoothing, peak_decay, sample_rate_hz,
        noise_ratio, upper_noise_ratio, hysteresis, slew_gain, upper_slew_gain, slew_noise,
        max_slew_rate, blanking_samples, max_on_samples, min_floor, upper_min_floor,
    ) = coefficients  # fmt: skip
    s, s1, s2 = state[FIRST], state[SECOND_1], state[SECOND_2]
    l1, l2, u1, u2 = state[LOW_PASS_1], state[LOW_PASS_2], state[UPPER_1], state[UPPER_2]
    energy, upper_energy, floor, upper_floor = state[ENERGY], state[UPPER_ENERGY], state[FLOOR], state[UPPER_FLOOR]
    smoothed_1, smoothed_2, peak_slew = state[SMOOTHED_1], state[SMOOTHED_2], state[PEAK_SLEW]
    knock_smoothed, knock_peak_slew = state[KNOCK_SMOOTHED], state[KNOCK_PEAK_SLEW]
    on, on_samples = state[ON], state[ON_SAMPLES]
    knock_samples, settling_samples = state[KNOCK_SAMPLES], state[SETTLING_SAMPLES]
    for i in range(len(samples)):
        # Band filters, each section in transposed direct form II: y is the wide band, z the upper band.
        x = samples[i]
        w = g0 * x + s
        s = g1 * x - g_a1 * w
        v = b0 * w + s1
        s1 = b1 * w - a1 * v + s2
        s2 = b2 * w - a2 * v
        y = l0 * v + l1
        l1 = 2 * l0 * v - l_a1 * y + l2
        l2 = l0 * v - l_a2 * y
        z = u0 * y + u1
        u1 = -2 * u0 * y - u_a1 * z + u2
        u2 = u0 * y - u_a2 * z

        # Energies: exponentially weighted means of the squares.
        energy += energy_smoothing * (y * y - energy)
        upper_energy += energy_smoothing * (z * z - upper_energy)

        # Slew rate of the input behind two poles, and its decaying peak.
        smoothed_1 += slew_smoothing * (x - smoothed_1)
        change = slew_smoothing * (smoothed_1 - smoothed_2)
        smoothed_2 += change
        slew_rate = sample_rate_hz * abs(change)
        peak_slew *= peak_decay
        if slew_rate > peak_slew:
            peak_slew = slew_rate

        # Slew rate behind one faster pole, which identifies a knock before its energy has risen. `knock_samples` counts
        # the time since the knock began. It restarts at a new knock, and is 0 when there is none.
        change = knock_smoothing * (x - knock_smoothed)
        knock_smoothed += change
        slew_rate = sample_rate_hz * abs(change)
        knock_peak_slew *= peak_decay
        if slew_rate > knock_peak_slew:
            if slew_rate > NEW_KNOCK_RATIO * knock_peak_slew:
                knock_samples = 0.0
            knock_peak_slew = slew_rate
        knock_samples = knock_samples + 1.0 if knock_peak_slew >= max_slew_rate else 0.0

        # Thresholds as energies. The energies of noise and of a change of force add, because they are independent.
        # While ON, the slew rate does not count and the hysteresis applies.
        excess_slew = peak_slew * peak_slew - slew_noise * floor
        if excess_slew < 0.0:
            excess_slew = 0.0
        noise_threshold, upper_noise_threshold = noise_ratio * floor, upper_noise_ratio * upper_floor
        if on > 0.0:
            threshold, upper_threshold = hysteresis * noise_threshold, hysteresis * upper_noise_threshold
        else:
            threshold = noise_threshold + slew_gain * excess_slew
            upper_threshold = upper_noise_threshold + upper_slew_gain * excess_slew

        # Either band is sufficient. An upper energy above its threshold lowers the wide band's threshold so far that
        # the wide energy exceeds it by the same ratio. Not after a knock: the upper band rings longer than its
        # threshold allows for.
        if upper_energy > upper_threshold and knock_samples == 0.0:
            equivalent = energy * upper_threshold / upper_energy
            if equivalent < threshold:
                threshold = equivalent

        # Decision. OFF until the filters have settled; a knock inhibits the transition to ON during the blanking.
        if settling_samples > 0.0:
            settling_samples -= 1.0
            on = 0.0
        else:
            enabled = on > 0.0 or knock_samples == 0.0 or knock_samples > blanking_samples
            on = 1.0 if energy > threshold and enabled else 0.0
        on_samples = on_samples + 1.0 if on > 0.0 else 0.0

        # Noise floors adapt only to noise: OFF, constant force, and energies below the noise thresholds. ON for longer
        # than any slip lasts is treated as noise too.
        only_noise = excess_slew == 0.0 and energy < noise_threshold and upper_energy < upper_noise_threshold
        if on_samples > max_on_samples or (on == 0.0 and only_noise):
            floor += floor_smoothing * (energy - floor)
            upper_floor += floor_smoothing * (upper_energy - upper_floor)
            if floor < min_floor:
                floor = min_floor
            if upper_floor < upper_min_floor:
                upper_floor = upper_min_floor

        filtered[i] = y
        statistics[i] = math.sqrt(energy)
        thresholds[i] = math.sqrt(threshold)
        flags[i] = on
    state[FIRST], state[SECOND_1], state[SECOND_2] = s, s1, s2
    state[LOW_PASS_1], state[LOW_PASS_2], state[UPPER_1], state[UPPER_2] = l1, l2, u1, u2
    state[ENERGY], state[UPPER_ENERGY], state[FLOOR], state[UPPER_FLOOR] = energy, upper_energy, floor, upper_floor
    state[SMOOTHED_1], state[SMOOTHED_2], state[PEAK_SLEW] = smoothed_1, smoothed_2, peak_slew
    state[KNOCK_SMOOTHED], state[KNOCK_PEAK_SLEW] = knock_smoothed, knock_peak_slew
    state[ON], state[ON_SAMPLES] = on, on_samples
    state[KNOCK_SAMPLES], state[SETTLING_SAMPLES] = knock_samples, settling_samples


LOOP = CompiledLoop(_fast_loop, outputs=5, samples="samples", plain_us=1.2)
