"""Signals beside a campaign: bursts that no simulation made, and scenes in noise that no design
states.

Bursts are band-limited noise on a held force. Nothing is known of these slips but their band and
their strength, so a detector that fits the simulation alone fails on them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fingertip.design import Design
from fingertip.design.formulas.filter import filtered_range_v
from fingertip.foundation.numerics import Array
from fingertip.lab.campaign.run import select_board_outputs
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import SceneFile
from fingertip.sim.runs.timeline import build_timeline
from fingertip.sim.signal.bridge import Bridge
from fingertip.sim.signal.interference import HAND_BAND_HZ
from fingertip.slip.detectors.analog_and_digital import ChainSettings, SlipChain
from fingertip.slip.traces.truth import STICK_S, Interval, intervals, merge

HIGH_HZ = 67.0
"""Frequency above which the energy of a burst counts as high [Hz]: the article's cutoff."""
MAX_HIGH_RATIO = 1.5
"""Largest ratio of the total RMS value to that above `HIGH_HZ`
for which most energy counts as high.
"""
_MIN_WIDTH_HZ = 20.0
_LOWEST_HZ = 20.0
_HIGHEST_HZ = 250.0
_BURST_S = 0.5
_LIGHT_GRIP_N = 0.45, 2.6
"""Forces of a light grip [N]."""
NOISES: Mapping[str, dict[str, Any]] = {
    "noise x0.5": {"factor": 0.5},
    "noise x2": {"factor": 2.0},
    "noise x5": {"factor": 5.0},
    "pink noise": {"noise": {"pink_v": 2.5e-4}},
    "hum": {"noise": {"hum_v": 5e-4}},
    "12 bits": {"converter": {"bits": 12, "high_v": 5.0}},
    "background": {"background_v": 3e-4},
}
"""Conditions from the start of a recording that the design does not state.

Factor of the design's noise; tables ``noise`` and ``converter`` of a scene; RMS vibration from 30
to 90 Hz whether the finger touches or not [V]. Pink noise of 0.25 mV per decade is 0.2 mV between
40 and 170 Hz.
"""


@dataclass(frozen=True)
class Slide:
    """One slip: the moments of its motion."""

    motion_s: float
    """Moment at which the robot begins to move [s], or the burst begins."""
    onset_s: float
    end_s: float


@dataclass(frozen=True, eq=False)
class LabelledSignal:
    """Sampled voltage, the slips in it, and the events in it that are not slip."""

    kind: str
    rate_hz: float
    voltage_v: Array
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


def draw_band_noise(
    rng: np.random.Generator,
    count: int,
    rate_hz: float,
    low_hz: float,
    high_hz: float,
) -> Array:
    """Draw noise of unit RMS value within a band [Hz], with random
    phases and amplitudes of all its frequencies.
    """
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
    return np.asarray(
        np.round((volts + rng.normal(0.0, d.noise_v, len(volts))) / d.adc_step_v) * d.adc_step_v
    )


def filter_as_board(design: Design, volts: Array) -> Array | None:
    """Filter a tactile voltage as an ideal board does [V]; None if the design's gives its
    controller no such signal.
    """
    range_v = filtered_range_v(design.board, design.detector.adc_range_v)
    if range_v is None:
        return None

    filtered_v = SlipChain(ChainSettings.from_design(design)).filter(volts)
    return np.asarray(np.clip(filtered_v, -range_v, range_v))


def record(design: Design, rng: np.random.Generator, signal: LabelledSignal) -> LabelledSignal:
    """Sample the tactile voltage of a signal, and what an ideal board filters of it."""
    voltage_v, filtered_v = (
        sample(design, rng, signal.voltage_v),
        filter_as_board(design, signal.voltage_v),
    )
    sampled_v = None if filtered_v is None else sample(design, rng, filtered_v)
    return replace(signal, voltage_v=voltage_v, filtered_v=sampled_v)


def draw_rest_v(design: Design, rng: np.random.Generator) -> float:
    """Draw the tactile voltage of a light grip [V]."""
    return float(Bridge.of_board(design).voltage_v(rng.uniform(*_LIGHT_GRIP_N, 1))[0])


def abrupt_burst(
    design: Design,
    seed: int,
    low_v: float,
    high_v: float,
) -> LabelledSignal:
    """Draw a held force with one abrupt burst in a random band; its kind says where most of its
    energy lies.
    """
    rng = np.random.default_rng(seed)
    low_hz = rng.uniform(_LOWEST_HZ, 120.0)
    high_hz = rng.uniform(low_hz + _MIN_WIDTH_HZ, _HIGHEST_HZ)
    rate = design.detector.sample_rate_hz
    strength_v = math.exp(rng.uniform(math.log(low_v), math.log(high_v)))
    start_s = rng.uniform(1.5, 2.5)
    count = round((start_s + _BURST_S + 0.5) * rate)
    first = round(start_s * rate)
    length = round(_BURST_S * rate)
    burst = strength_v * draw_band_noise(rng, length, rate, low_hz, high_hz)
    volts = np.full(count, draw_rest_v(design, rng))
    volts[first : first + length] += burst
    kind = "burst above 60 Hz" if high_ratio(burst, rate) <= MAX_HIGH_RATIO else "burst below 60 Hz"
    slide = Slide(first / rate, first / rate, (first + length) / rate)

    return record(design, rng, LabelledSignal(kind, rate, volts, (slide,), strength_v=strength_v))


def simulate_scene(
    design: Design,
    scene: SceneFile,
    seed: int,
    kind: str,
    alarms_from_s: float = 0.0,
) -> LabelledSignal:
    """Simulate a scene through the ADC; its slips and events follow from its timeline."""
    result = run_scene(design, scene.model_copy(update={"outputs": _select_outputs(design)}), seed)
    timeline = build_timeline(design, scene, scene.draw_pad(design, seed), result.force_n)
    trace = result.trace
    assert trace.slip is not None
    slips = merge(intervals(trace.time_s, trace.slip), STICK_S)
    starts = [move.start_s for move in timeline.moves]
    # Without a move the motion begins with the slip.
    begun_s = (
        max((s for s in starts if s <= slip.onset_s), default=slip.onset_s) for slip in slips
    )
    slides = tuple(
        Slide(start, slip.onset_s, slip.end_s) for start, slip in zip(begun_s, slips, strict=True)
    )
    held = timeline.held_s
    events = []

    if scene.load_change.by_n:
        start = held + scene.load_change.at_s
        events.append(Interval(start, start + scene.load_change.rise_s))

    if scene.tap.force_n:
        tap = scene.tap
        starts = [held + tap.at_s + i * tap.interval_s for i in range(tap.count)]
        events += [Interval(start, start + 2 * tap.rise_s) for start in starts]

    if scene.servo.step_n:
        first = held + scene.servo.at_s
        servo = scene.servo
        count = math.ceil(max(0.0, timeline.release_s - first) / servo.interval_s)
        starts = [first + i * servo.interval_s for i in range(count)]
        events += [Interval(start, start + servo.rise_s) for start in starts]

    if kind == "fast closing":
        events.append(Interval(held - scene.hold.close_s, held))

    return LabelledSignal(
        kind=kind,
        rate_hz=design.detector.sample_rate_hz,
        voltage_v=trace.voltage_v,
        slides=slides,
        events=tuple(events),
        alarms_from_s=alarms_from_s,
        filtered_v=trace.filtered_v,
    )


def _select_outputs(design: Design) -> list[str]:
    return ["voltage_v", "slip", *select_board_outputs(design, ["fast"])]


def in_condition(
    design: Design,
    scene: SceneFile,
    seed: int,
    kind: str,
    condition: Mapping[str, Any],
) -> LabelledSignal:
    """Simulate a scene in a condition like those of `NOISES`; alarms count after the
    first second.
    """
    tables = scene.model_dump()
    tables["noise"] |= condition.get("noise", {})
    tables["converter"] |= condition.get("converter", {})
    simulated = design.model_dump()
    simulated["detector"]["noise_v"] *= condition.get("factor", 1.0)
    background_v = condition.get("background_v", 0.0)
    if background_v:  # is added ahead of the noise and the converter's steps
        simulated["detector"] |= {"noise_v": 0.0, "adc_bits": 24}

    signal = simulate_scene(Design(**simulated), SceneFile(**tables), seed, kind, alarms_from_s=1.0)
    if not background_v:
        return signal

    rng = np.random.default_rng(seed)
    background = background_v * draw_band_noise(
        rng, len(signal.voltage_v), signal.rate_hz, *HAND_BAND_HZ
    )
    filtered_v = signal.filtered_v
    added_v = filter_as_board(design, background)
    if filtered_v is not None and added_v is not None:
        filtered_v = sample(design, rng, filtered_v + added_v)

    return replace(
        signal, voltage_v=sample(design, rng, signal.voltage_v + background), filtered_v=filtered_v
    )
