"""The converter: what it makes of a voltage at its instants, with its noise and in its steps."""

from __future__ import annotations

import random

import numpy as np

from fingertip.arrays import Array
from fingertip.design import Design


def sampled_v(design: Design, voltage_v: Array, rng: random.Random | None) -> Array:
    """Samples [V] of the voltages at the converter's instants [V]; without its noise if there is no `rng`."""
    d = design.detector
    noisy = voltage_v if rng is None else voltage_v + noise_v(rng, d.noise_v, len(voltage_v))
    return quantise(noisy, d.adc_bits, d.adc_range_v)


def noise_v(rng: random.Random, deviation_v: float, count: int) -> Array:
    """White Gaussian noise [V]."""
    return np.array([rng.gauss(0.0, deviation_v) for _ in range(count)])


def quantise(voltage_v: Array, bits: int, range_v: float) -> Array:
    """The converter's nearest steps [V] for ``-range_v <= V < range_v``; its ends beyond."""
    half: int = 2 ** (bits - 1)
    codes = np.floor(voltage_v / range_v * half + 0.5)
    return np.clip(codes, -half, half - 1) * range_v / half
