"""Bursts of band-limited noise on a held force: slips of which nothing is known but their band and their strength.

They are not drawn from the simulation, so a detector that fits the simulation alone fails on them.
"""

from __future__ import annotations

import math

import numpy as np

from fingertip.arrays import Array
from fingertip.campaign.wider_mix.labelled_signal import LabelledSignal, Slide
from fingertip.design import Design
from fingertip.design.signal_ground import filtered_range_v
from fingertip.sim.signal.board_output import compute_bridge_v
from fingertip.slip.detectors.digital import ChainSettings, SlipChain
from fingertip.slip.intervals import Interval

HIGH_HZ = 67.0
"""Frequency above which the energy of a burst counts as high [Hz]: the article's cutoff."""
MAX_HIGH_RATIO = 1.5
"""Largest ratio of the total RMS value to that above `HIGH_HZ` for which most energy counts as high."""
_MIN_WIDTH_HZ = 20.0
_LOWEST_HZ, _HIGHEST_HZ = 20.0, 250.0


def draw_band_noise(rng: np.random.Generator, count: int, rate_hz: float, low_hz: float, high_hz: float) -> Array:
    """Draw noise of unit RMS value within a band [Hz], with random phases and amplitudes of all its frequencies."""
    frequency_hz = np.fft.rfftfreq(count, 1 / rate_hz)
    inside = (frequency_hz >= low_hz) & (frequency_hz <= high_hz)
    spectrum = (rng.standard_normal(len(inside)) + 1j * rng.standard_normal(len(inside))) * inside
    noise = np.fft.irfft(spectrum, count)
    return np.asarray(noise / math.sqrt(float(np.mean(noise**2))))


def high_ratio(volts: Array, rate_hz: float) -> float:
    """Ratio of the RMS value to that above `HIGH_HZ`."""
    power = np.abs(np.fft.rfft(volts)) ** 2
    high = float(power[np.fft.rfftfreq(len(volts), 1 / rate_hz) >= HIGH_HZ].sum())
    return math.sqrt(float(power.sum()) / high) if high > 0.0 else math.inf


def sample(design: Design, rng: np.random.Generator, volts: Array) -> Array:
    """Add the design's noise to a voltage, and quantise it as its ADC does [V]."""
    d = design.detector
    return np.asarray(np.round((volts + rng.normal(0.0, d.noise_v, len(volts))) / d.adc_step_v) * d.adc_step_v)


def filter_as_board(design: Design, volts: Array) -> Array | None:
    """Filter a tactile voltage as an ideal board does [V]; None if the design's gives its controller no such signal."""
    range_v = filtered_range_v(design.board, design.detector.adc_range_v)
    if range_v is None:
        return None
    settings = ChainSettings.from_design(design)
    return np.asarray(np.clip(SlipChain(settings).process(volts).filtered_v, -range_v, range_v))


def sample_filtered(design: Design, rng: np.random.Generator, volts: Array) -> Array | None:
    """Filter a tactile voltage as an ideal board does, and sample it [V]; None if its controller gets none."""
    filtered_v = filter_as_board(design, volts)
    return None if filtered_v is None else sample(design, rng, filtered_v)


def draw_rest_v(design: Design, rng: np.random.Generator) -> float:
    """Draw the tactile voltage of a light grip [V]: a share of that of an open sensor."""
    return float(rng.uniform(0.82, 0.95) * compute_bridge_v(design, np.zeros(1))[0])


def abrupt_burst(design: Design, seed: int, low_v: float, high_v: float, duration_s: float = 0.5) -> LabelledSignal:
    """Draw a held force with one abrupt burst in a random band; its kind says where most of its energy lies.

    Parameters
    ----------
    design
        Source of the sampling rate, the noise and the ADC.
    seed
        Seed of everything random.
    low_v, high_v
        Range of the burst's RMS value [V], drawn logarithmically.
    duration_s
        Duration of the burst [s].
    """
    rng = np.random.default_rng(seed)
    low_hz = rng.uniform(_LOWEST_HZ, 120.0)
    return _burst(design, rng, low_hz, rng.uniform(low_hz + _MIN_WIDTH_HZ, _HIGHEST_HZ), low_v, high_v, duration_s)


def low_burst(design: Design, seed: int, low_v: float, high_v: float, duration_s: float = 0.5) -> LabelledSignal:
    """Draw the same with most energy below 60 Hz."""
    rng = np.random.default_rng(seed)
    low_hz = rng.uniform(_LOWEST_HZ, 45.0)
    return _burst(design, rng, low_hz, rng.uniform(low_hz + 15.0, 70.0), low_v, high_v, duration_s)


def _burst(
    design: Design, rng: np.random.Generator, low_hz: float, high_hz: float, low_v: float, high_v: float,
    duration_s: float,
) -> LabelledSignal:  # fmt: skip
    rate = design.detector.sample_rate_hz
    strength_v = math.exp(rng.uniform(math.log(low_v), math.log(high_v)))
    start_s = rng.uniform(1.5, 2.5)
    count, first, length = round((start_s + duration_s + 0.5) * rate), round(start_s * rate), round(duration_s * rate)
    burst = strength_v * draw_band_noise(rng, length, rate, low_hz, high_hz)
    volts = np.full(count, draw_rest_v(design, rng))
    volts[first : first + length] += burst
    kind = "burst above 60 Hz" if high_ratio(burst, rate) <= MAX_HIGH_RATIO else "burst below 60 Hz"
    slide = Slide(first / rate, first / rate, (first + length) / rate)
    sampled_v, filtered_v = sample(design, rng, volts), sample_filtered(design, rng, volts)
    return LabelledSignal(kind, rate, sampled_v, (slide,), strength_v=strength_v, filtered_v=filtered_v)


def ringing_knock(design: Design, seed: int, low_v: float = 0.05, high_v: float = 0.5) -> LabelledSignal:
    """Draw a held force with three knocks that ring and decay, as hand and object do: no slip.

    Parameters
    ----------
    design
        Source of the sampling rate, the noise and the ADC.
    seed
        Seed of everything random.
    low_v, high_v
        Range of the first swing's height [V], drawn logarithmically.
    """
    rng, rate = np.random.default_rng(seed), design.detector.sample_rate_hz
    times_s = np.arange(round(4.0 * rate)) / rate
    volts = np.full(len(times_s), draw_rest_v(design, rng))
    height_v = math.exp(rng.uniform(math.log(low_v), math.log(high_v)))
    ring_hz, decay_s = rng.uniform(50.0, 150.0), math.exp(rng.uniform(math.log(0.004), math.log(0.02)))
    events = []
    for start_s in (1.5, 2.2, 2.9):
        since_s = np.clip(times_s - start_s, 0.0, None)
        volts -= height_v * np.sin(2 * math.pi * ring_hz * since_s) * np.exp(-since_s / decay_s)
        events.append(Interval(start_s, start_s + 5 * decay_s))
    sampled_v, filtered_v = sample(design, rng, volts), sample_filtered(design, rng, volts)
    return LabelledSignal("ringing knock", rate, sampled_v, (), tuple(events), filtered_v=filtered_v)


def long_slide(design: Design, seed: int, strength_v: float, duration_s: float = 8.0) -> LabelledSignal:
    """Draw a held force with a slide of constant strength [V] in a band of an embedded sensor's slip."""
    rng, rate = np.random.default_rng(seed), design.detector.sample_rate_hz
    low_hz = rng.uniform(40.0, 70.0)
    high_hz = rng.uniform(110.0, 170.0)
    start_s = 1.5
    first, length = round(start_s * rate), round(duration_s * rate)
    slide_v = strength_v * draw_band_noise(rng, length, rate, low_hz, high_hz)
    volts = np.full(first + length + round(0.5 * rate), draw_rest_v(design, rng))
    volts[first : first + length] += slide_v
    slide = Slide(start_s, start_s, start_s + duration_s)
    sampled_v, filtered_v = sample(design, rng, volts), sample_filtered(design, rng, volts)
    return LabelledSignal("long slide", rate, sampled_v, (slide,), strength_v=strength_v, filtered_v=filtered_v)
