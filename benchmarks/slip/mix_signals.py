"""Signals of the wider mix: bursts that no simulation made, unstated noise, and a hand that does
not slip.

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
from fingertip.sim.runs.grip import GripController, GripSettings
from fingertip.sim.runs.manipulation import run_manipulation
from fingertip.sim.runs.scene import run_scene
from fingertip.sim.runs.scene_and_manipulation_files import Hand, ManipulationFile, SceneFile
from fingertip.sim.runs.timeline import build_timeline
from fingertip.sim.signal.bridge import Bridge
from fingertip.sim.signal.interference import HAND_BAND_HZ
from fingertip.sim.simulation import MANIPULATED_OBJECTS
from fingertip.slip.detectors.analog_and_digital import ChainSettings, SlipChain
from fingertip.slip.traces.truth import STICK_S, Interval, intervals, merge

REACTION_S = 0.2
"""Time after the end of an event in which an alarm counts as caused by it [s]."""
HIGH_HZ = 67.0
"""Frequency above which the energy of a burst counts as high [Hz]: the article's cutoff."""
MAX_HIGH_RATIO = 1.5
"""Largest ratio of the total RMS value to that above `HIGH_HZ`
for which most energy counts as high.
"""
_MIN_WIDTH_HZ = 20.0
_LOWEST_HZ = 20.0
_HIGHEST_HZ = 250.0
_LIGHT_GRIP_N = 0.45, 2.6
"""Forces of a light grip [N]."""
_SHEAR_S = 0.1
"""Time before gross slip in which a hand's pads may creep [s]."""
_EVENT_S = 0.3
"""Time from the start of a grip step in which its alarms are its
own [s]: the motors' delay, lag and travel.
"""
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


def _record(design: Design, rng: np.random.Generator, signal: LabelledSignal) -> LabelledSignal:
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
    duration_s: float = 0.5,
) -> LabelledSignal:
    """Draw a held force with one abrupt burst in a random band; its
    kind says where most of its energy lies.
    """
    rng = np.random.default_rng(seed)
    low_hz = rng.uniform(_LOWEST_HZ, 120.0)
    return _burst(
        design,
        rng=rng,
        low_hz=low_hz,
        high_hz=rng.uniform(low_hz + _MIN_WIDTH_HZ, _HIGHEST_HZ),
        low_v=low_v,
        high_v=high_v,
        duration_s=duration_s,
    )


def low_burst(
    design: Design,
    seed: int,
    low_v: float,
    high_v: float,
    duration_s: float = 0.5,
) -> LabelledSignal:
    """Draw the same with most energy below 60 Hz."""
    rng = np.random.default_rng(seed)
    low_hz = rng.uniform(_LOWEST_HZ, 45.0)
    return _burst(
        design,
        rng=rng,
        low_hz=low_hz,
        high_hz=rng.uniform(low_hz + 15.0, 70.0),
        low_v=low_v,
        high_v=high_v,
        duration_s=duration_s,
    )


def _burst(
    design: Design,
    rng: np.random.Generator,
    low_hz: float,
    high_hz: float,
    low_v: float,
    high_v: float,
    duration_s: float,
) -> LabelledSignal:
    rate = design.detector.sample_rate_hz
    strength_v = math.exp(rng.uniform(math.log(low_v), math.log(high_v)))
    start_s = rng.uniform(1.5, 2.5)
    count = round((start_s + duration_s + 0.5) * rate)
    first = round(start_s * rate)
    length = round(duration_s * rate)
    burst = strength_v * draw_band_noise(
        rng,
        count=length,
        rate_hz=rate,
        low_hz=low_hz,
        high_hz=high_hz,
    )
    volts = np.full(count, draw_rest_v(design, rng))
    volts[first : first + length] += burst
    kind = "burst above 60 Hz" if high_ratio(burst, rate) <= MAX_HIGH_RATIO else "burst below 60 Hz"
    slide = Slide(first / rate, first / rate, (first + length) / rate)

    return _record(design, rng, LabelledSignal(kind, rate, volts, (slide,), strength_v=strength_v))


def ringing_knock(design: Design, seed: int) -> LabelledSignal:
    """Draw a held force with three knocks that ring and decay, as hand and object do: no slip."""
    rng = np.random.default_rng(seed)
    rate = design.detector.sample_rate_hz
    times_s = np.arange(round(4.0 * rate)) / rate
    volts = np.full(len(times_s), draw_rest_v(design, rng))
    height_v = math.exp(rng.uniform(math.log(0.05), math.log(0.5)))
    ring_hz = rng.uniform(50.0, 150.0)
    decay_s = math.exp(rng.uniform(math.log(0.004), math.log(0.02)))
    # the force rises first
    events = []
    direction = 1.0 if design.board.tactile_rises else -1.0

    for start_s in (1.5, 2.2, 2.9):
        since_s = np.clip(times_s - start_s, 0.0, None)
        volts += (
            direction
            * height_v
            * np.sin(2 * math.pi * ring_hz * since_s)
            * np.exp(-since_s / decay_s)
        )
        events.append(Interval(start_s, start_s + 5 * decay_s))

    return _record(
        design,
        rng,
        LabelledSignal(
            kind="ringing knock",
            rate_hz=rate,
            voltage_v=volts,
            slides=(),
            events=tuple(events),
        ),
    )


def long_slide(design: Design, seed: int, strength_v: float) -> LabelledSignal:
    """Draw a held force with a slide of constant strength [V] in
    a band of an embedded sensor's slip.
    """
    rng = np.random.default_rng(seed)
    rate = design.detector.sample_rate_hz
    low_hz = rng.uniform(40.0, 70.0)
    high_hz = rng.uniform(110.0, 170.0)
    start_s = 1.5
    duration_s = 8.0
    first = round(start_s * rate)
    length = round(duration_s * rate)
    slide_v = strength_v * draw_band_noise(
        rng,
        count=length,
        rate_hz=rate,
        low_hz=low_hz,
        high_hz=high_hz,
    )
    volts = np.full(first + length + round(0.5 * rate), draw_rest_v(design, rng))
    volts[first : first + length] += slide_v
    slide = Slide(start_s, start_s, start_s + duration_s)

    return _record(
        design, rng, LabelledSignal("long slide", rate, volts, (slide,), strength_v=strength_v)
    )


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


class SteppedGrip(GripController):
    """Controller that tightens the grip at given moments as the grip law does at a detection."""

    def __init__(self, design: Design, fingers: int, moments_s: tuple[float, ...]) -> None:
        super().__init__(
            design, GripSettings("digital", max_growth_n_s=np.inf, max_closing_m_s=np.inf), fingers
        )
        self._moments_s = moments_s
        self._periods = 0
        self._period_s = Hand().period_s

    def _detect(self, samples: tuple[Array, ...]) -> bool:
        now = self._periods * self._period_s
        self._periods = self._periods + 1
        return any(now - self._period_s < moment <= now for moment in self._moments_s)


def grip_steps(design: Design, seed: int) -> list[LabelledSignal]:
    """Simulate a hand whose controller tightens a grasp twice although
    nothing slips: one signal for each finger.
    """
    rng = np.random.default_rng(seed)
    kind = "pinch" if rng.random() < 0.5 else "power"
    force_n = float(rng.uniform(0.6, 1.6)) * (1 if kind == "pinch" else 2)
    scene = ManipulationFile(
        scene="grip_steps",
        outputs=_select_outputs(design),
        object={"mass_kg": 0.02},
        grasp={"kind": kind, "force_n": force_n, "after_s": 1.0},
        knock={"speed_m_s": 0.0},
    )
    moments_s = (1.8, 2.5)
    result = run_manipulation(
        design, scene, SteppedGrip(design, len(scene.fingers), moments_s), seed
    )
    settled_s = moments_s[0] - 0.3
    events = tuple(Interval(moment, moment + _EVENT_S) for moment in moments_s)
    rate = design.detector.sample_rate_hz

    return [
        LabelledSignal(
            kind="controller's step",
            rate_hz=rate,
            voltage_v=trace.voltage_v,
            slides=(),
            events=events,
            alarms_from_s=settled_s,
            filtered_v=trace.filtered_v,
        )
        for trace in map(result.trace, scene.fingers)
        if trace.slip is not None and not trace.slip[round(settled_s * rate) :].any()
    ]


def manipulation(
    design: Design, seed: int, speed_m_s: float = 0.0, max_margin: float = 2.0
) -> list[LabelledSignal]:
    """Simulate a hand that takes over a weight: one signal for each
    finger, whose shear is no slip by itself.
    """
    rng = np.random.default_rng(seed)
    names = list(MANIPULATED_OBJECTS)
    target, kind = MANIPULATED_OBJECTS[names[int(rng.integers(len(names)))]]
    times = {"let_go_s": float(rng.uniform(0.1, 0.6)), "after_s": 1.0}
    scene = ManipulationFile(
        scene="manipulation",
        outputs=_select_outputs(design),
        object=target,
        grasp={
            "kind": kind,
            "min_margin": 1.1,
            "max_margin": max_margin,
            **times,
        },
        knock={"speed_m_s": speed_m_s},
    )
    result = run_manipulation(design, scene, None, seed)
    rate = design.detector.sample_rate_hz
    held_s = result.plan.released_s
    weight = Interval(held_s - scene.grasp.let_go_s, held_s)
    signals = []

    for trace in map(result.trace, scene.fingers):
        assert trace.slip is not None
        found = merge(intervals(result.time_s, trace.slip), STICK_S)
        slides = tuple(
            Slide(max(0.0, slip.onset_s - _SHEAR_S), slip.onset_s, slip.end_s) for slip in found
        )
        events = (
            () if any(slide.motion_s < weight.end_s + REACTION_S for slide in slides) else (weight,)
        )
        count = int(min(len(trace.time_s), (result.lost_s or np.inf) * rate))
        volts = trace.voltage_v[:count]
        filtered_v = None if trace.filtered_v is None else trace.filtered_v[:count]
        signal = LabelledSignal(
            kind="weight taken over",
            rate_hz=rate,
            voltage_v=volts,
            slides=slides,
            events=events,
            alarms_from_s=weight.onset_s - _EVENT_S,
        )
        signals.append(replace(signal, filtered_v=filtered_v))

    return signals


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
