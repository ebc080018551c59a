"""Bursts of band-limited noise on a held force: slips of which nothing is known but their band and their strength.

They are not drawn from the simulation, so a detector that fits the simulation alone fails on them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.design.formulas.filter import filtered_range_v
from fingertip.foundation.numerics import Array
from fingertip.lab.campaign.run import separate_events
from fingertip.sim.signal.converter import compute_bridge_v
from fingertip.slip.detectors.digital import ChainSettings, SlipChain
from fingertip.slip.traces.intervals import Interval, intervals

# Signal with everything that is known about it, and what a detector made of it.


EARLY_S = 0.005
"""Time before gross slip from which a detection counts as one of this slip [s]: the pad creeps already."""
REACTION_S = 0.2
"""Time after the end of an event in which an alarm counts as caused by it [s]."""


@dataclass(frozen=True)
class Slide:
    """One slip: the moments of its motion."""

    motion_s: float
    """Moment at which the robot begins to move [s], or the burst begins."""
    onset_s: float
    """Onset of gross slip [s]."""
    end_s: float
    """End of gross slip [s]."""


@dataclass(frozen=True, eq=False)
class LabelledSignal:
    """Sampled voltage, the slips in it, and the events in it that are not slip."""

    kind: str
    """Name of the group that it belongs to."""
    rate_hz: float
    voltage_v: Array
    """Tactile voltage [V]."""
    slides: tuple[Slide, ...] = ()
    events: tuple[Interval, ...] = ()
    """Events that are not slip, such as changes of grip."""
    alarms_from_s: float = 0.0
    """Moment from which alarms count [s]: a detector may need time to learn the noise."""
    strength_v: float = 0.0
    """RMS voltage of the slip [V], where it is known."""
    filtered_v: Array | None = None
    """Filtered signal of the board, where it gives one [V]."""

    @property
    def duration_s(self) -> float:
        """Time in which alarms count [s]."""
        return len(self.voltage_v) / self.rate_hz - self.alarms_from_s


@dataclass(frozen=True)
class Outcome:
    """Result of a detector on one signal."""

    kind: str
    strength_v: float
    minutes: float
    slides: int
    delays_s: tuple[float, ...]
    """Delays of the slips that were found, from gross slip [s]."""
    motion_delays_s: tuple[float, ...]
    """The same delays from the start of the motion [s]."""
    on_shares: tuple[float, ...]
    """Share of each slip, from its onset to its end, that is ON."""
    alarms: int
    """Number of alarms without slip."""
    alarms_s: tuple[float, ...]
    """Moments of these alarms [s]."""
    events: int
    disturbed: int
    """Number of events that caused an alarm."""
    false_on_share: float
    """Share of the time without slip that is ON, where alarms count."""


def assess(signal: LabelledSignal, on: NDArray[np.bool_], memory_s: float) -> Outcome:
    """Compare the flags of a detector with what is known about a signal.

    A slip is found if the detector turns ON between its onset, less `EARLY_S`, and its end. An alarm is a transition to
    ON outside the slips, their creep, and the detector's memory after them. Alarms closer together than
    `fingertip.lab.campaign.evaluate.SAME_EVENT_S` count once.
    """
    time_s = np.arange(len(on)) / signal.rate_hz
    found = intervals(time_s, on)
    delays, motion_delays, shares = [], [], []
    is_slip = np.zeros(len(on), dtype=bool)
    for slide in signal.slides:
        inside = [i for i in found if slide.onset_s - EARLY_S <= i.onset_s < slide.end_s]
        if inside:
            delays.append(max(0.0, inside[0].onset_s - slide.onset_s))
            motion_delays.append(max(0.0, inside[0].onset_s - slide.motion_s))
        during = (time_s >= slide.onset_s) & (time_s < slide.end_s)
        shares.append(float(np.mean(on[during])) if during.any() else 0.0)
        is_slip |= (time_s >= slide.motion_s) & (time_s < slide.end_s + memory_s)
    alarms = separate_events(
        i
        for i in found
        if i.onset_s >= signal.alarms_from_s
        and not any(s.onset_s - EARLY_S <= i.onset_s < s.end_s + memory_s for s in signal.slides)
    )
    disturbed = sum(
        any(event.onset_s <= i.onset_s < event.end_s + REACTION_S for i in found) for event in signal.events
    )
    counted = ~is_slip & (time_s >= signal.alarms_from_s)
    return Outcome(
        signal.kind,
        signal.strength_v,
        signal.duration_s / 60,
        len(signal.slides),
        tuple(delays),
        tuple(motion_delays),
        tuple(shares),
        len(alarms),
        tuple(alarm.onset_s for alarm in alarms),
        len(signal.events),
        disturbed,
        float(np.mean(on[counted])) if counted.any() else 0.0,
    )


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
    """Draw a held force with one abrupt burst in a random band; its kind says where most of its energy lies."""
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
    """Draw a held force with three knocks that ring and decay, as hand and object do: no slip."""
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
