"""Signals of a hand and of slips after its movements, drawn as voltages: for training and tuning
alone.

The simulation of contact knows few ways in which a force changes. These signals know none of
contact: they add a moving force, steps, blows, and band-limited noise for slip. A detector that has
seen both leans on neither. Ranges are those of a hand (`benchmarks.slip.mix` names sources) and of
the default and the article's board. The signals that a report uses are drawn by other code.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from benchmarks.slip.mix_signals import (
    LabelledSignal,
    Slide,
    draw_band_noise,
    filter_as_board,
    sample,
)
from fingertip.design import Design
from fingertip.foundation.numerics import Array
from fingertip.slip.traces.truth import Interval

OTHER_RATES_HZ = 1000.0, 5000.0, 10_000.0, 20_000.0
SLOW_SLIDES = "slow slides"
"""Kind whose slips have slow friction of their own."""
QUIET_S = 0.8, 2.0
"""Time before the first event [s]: the detector learns its floors in it."""


@dataclass
class Sketch:
    """Voltage that is drawn piece by piece, positive where the
    force grows, and what is known of it.
    """

    rng: np.random.Generator
    rate_hz: float
    duration_s: float
    volts: Array = field(init=False)
    slides: list[Slide] = field(default_factory=list)
    events: list[Interval] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.volts = np.zeros(round(self.duration_s * self.rate_hz))

    def uniform(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def spread(self, low: float, high: float) -> float:
        """Draw a value whose logarithm is uniform."""
        return math.exp(self.rng.uniform(math.log(low), math.log(high)))

    def sign(self) -> float:
        return 1.0 if self.rng.random() < 0.5 else -1.0

    def since(self, start_s: float) -> Array:
        """Time since a moment [s], 0 before it."""
        return np.maximum(np.arange(len(self.volts)) / self.rate_hz - start_s, 0.0)

    def ramp(
        self,
        start_s: float,
        height_v: float,
        rise_s: float,
        is_event: bool = True,
    ) -> None:
        """Add a change of force, in one of four shapes."""
        x = self.since(start_s) / rise_s
        shape = self.rng.integers(4)

        if shape == 0:
            risen = np.minimum(x, 1.0)
        elif shape == 1:
            risen = np.minimum(x, 1.0) ** 2 * (3 - 2 * np.minimum(x, 1.0))
        elif shape == 2:
            risen = 1 - np.exp(-3 * x)
        else:  # a lag of second order that overshoots by up to a tenth
            damping = self.uniform(0.6, 1.0)
            w = 4.0 * x
            damped = math.sqrt(max(1 - damping**2, 1e-6))
            risen = 1 - np.exp(-damping * w) * (
                np.cos(damped * w) + damping / damped * np.sin(damped * w)
            )

        self.volts += height_v * risen
        if is_event:
            self.events.append(Interval(start_s, start_s + rise_s))

    def slip(
        self,
        start_s: float,
        length_s: float,
        rms_v: float,
        creep_s: float | None = None,
    ) -> None:
        """Add noise of a random band and unsteady strength, with the
        loss or gain of force that comes with it.
        """
        count = round(length_s * self.rate_hz)
        first = round(start_s * self.rate_hz)
        count = min(count, len(self.volts) - first)
        low_hz = self.uniform(25.0, 85.0)
        noise = draw_band_noise(
            self.rng,
            count=count,
            rate_hz=self.rate_hz,
            low_hz=low_hz,
            high_hz=low_hz + self.spread(25.0, 160.0),
        )
        t = np.arange(count) / self.rate_hz

        if self.rng.random() < 0.4:  # a periodic texture beside the noise
            tone_hz = self.uniform(40.0, 130.0)
            drift = self.uniform(-0.3, 0.3)
            tone = np.sin(2 * math.pi * tone_hz * (t + 0.5 * drift * t**2 / max(length_s, 0.1)))
            share = self.uniform(0.2, 0.7)
            noise = math.sqrt(1 - share) * noise + math.sqrt(2 * share) * tone

        if self.rng.random() < 0.3:  # strength that varies
            depth = self.uniform(0.1, 0.4)
            hz = self.spread(1.0, 12.0)
            noise = noise * (1 + depth * np.sin(2 * math.pi * hz * t + self.uniform(0.0, 6.28)))

        creep_s = self.uniform(0.0, 0.015) if creep_s is None else creep_s
        grown = np.minimum(t / creep_s, 1.0) if creep_s else np.ones(count)
        ended = np.minimum((count / self.rate_hz - t) / 0.005, 1.0)
        self.volts[first : first + count] += rms_v * grown * ended * noise

        if self.rng.random() < 0.6:
            height_v = self.sign() * self.spread(0.001, 0.02)
            self.ramp(start_s, height_v, self.uniform(0.005, 0.05), is_event=False)

        onset_s = start_s + 0.5 * creep_s
        self.slides.append(Slide(start_s, onset_s, start_s + count / self.rate_hz))

    def sway(
        self,
        low_hz: float,
        high_hz: float,
        rms_v: float,
        start_s: float = 0.0,
    ) -> None:
        """Add motion of the hand within a band, steady, growing or fading."""
        motion = draw_band_noise(
            self.rng,
            count=len(self.volts),
            rate_hz=self.rate_hz,
            low_hz=low_hz,
            high_hz=high_hz,
        )
        t = self.since(start_s)
        kind = self.rng.integers(4)
        span_s = max(self.duration_s - start_s, 1.0)
        envelope = (
            np.minimum(t / 0.3, 1.0),
            np.minimum(t / span_s, 1.0) * 1.6,
            np.where(t > 0, np.maximum(1 - t / span_s, 0.0), 0.0) * np.minimum(t / 0.3, 1.0) * 1.6,
            np.minimum(t / 0.3, 1.0) * (1 + 0.5 * np.sin(2 * math.pi * self.spread(0.1, 1.0) * t)),
        )[kind]
        self.volts += rms_v * envelope * motion

    def vibrate(
        self,
        start_s: float,
        length_s: float,
        low_hz: float,
        high_hz: float,
        rms_v: float,
        fade_s: float = 0.004,
    ) -> None:
        """Add vibration, or slow motion, that is no slip by itself."""
        first = round(start_s * self.rate_hz)
        count = min(round(length_s * self.rate_hz), len(self.volts) - first)

        if count > 8:
            noise = draw_band_noise(
                self.rng,
                count=count,
                rate_hz=self.rate_hz,
                low_hz=low_hz,
                high_hz=high_hz,
            )
            t = np.arange(count) / self.rate_hz
            fade = np.minimum(np.minimum(t, t[-1] - t) / fade_s, 1.0)
            self.volts[first : first + count] += rms_v * noise * fade

    def ring(self, start_s: float, height_v: float) -> None:
        """Add a blow: a pulse of force, or none, and one or two decaying modes."""
        t = self.since(start_s)
        after = t > 0

        if self.rng.random() < 0.5:
            length_s = self.spread(0.003, 0.02)
            self.volts += (
                self.sign()
                * height_v
                * np.where(t < length_s, np.sin(math.pi * t / length_s), 0.0)
                * after
            )

        decay_s = self.spread(0.003, 0.02)
        for _ in range(self.rng.integers(1, 3)):
            hz = self.uniform(50.0, 200.0)
            rise_s = self.uniform(0.0005, 0.012)
            phase = self.uniform(0.0, 6.28)
            grown = 1 - np.exp(-t / rise_s)
            self.volts += (
                height_v
                * after
                * grown
                * np.exp(-t / decay_s)
                * np.sin(2 * math.pi * hz * t + phase)
            )

        self.events.append(Interval(start_s, start_s + 5 * decay_s))


def _load(s: Sketch, at_s: float) -> float:
    """Add a ramp of force and return its end [s]."""
    rise_s = s.spread(0.02, 0.25)
    s.ramp(at_s, s.sign() * s.spread(0.015, 0.25), rise_s)
    return at_s + rise_s


def _slide_after_load(s: Sketch) -> None:
    at_s = s.uniform(*QUIET_S)
    while at_s < s.duration_s - 2.5:
        end_s = _load(s, at_s)
        start_s = max(at_s + 0.01, end_s + s.uniform(-0.02, 0.06))
        length_s = min(s.spread(0.3, 6.0), s.duration_s - start_s - 0.3)
        s.slip(start_s, length_s, s.spread(0.0004, 0.012))
        s.events.pop()
        at_s = start_s + length_s + s.uniform(0.7, 1.5)


def _loads(s: Sketch) -> None:
    at_s = s.uniform(*QUIET_S)
    while at_s < s.duration_s - 0.6:
        at_s = _load(s, at_s) + s.uniform(0.3, 1.2)


def _slips(s: Sketch) -> None:
    at_s = s.uniform(*QUIET_S)
    while at_s < s.duration_s - 1.0:
        length_s = min(s.spread(0.1, 3.0), s.duration_s - at_s - 0.3)
        s.slip(at_s, length_s, s.spread(0.001, 0.012))
        at_s += length_s + s.uniform(0.2, 1.2)


def _slow_slides(s: Sketch) -> None:
    """Draw weak slides whose friction moves the slow force far more
    than it vibrates, and such motion alone.
    """
    at_s = s.uniform(*QUIET_S)
    while at_s < s.duration_s - 1.0:
        length_s = min(s.spread(0.3, 3.0), s.duration_s - at_s - 0.3)
        rms_v = s.spread(0.00015, 0.004)
        s.vibrate(at_s, length_s, 1.0, 28.0, rms_v * s.spread(1.5, 12.0), s.uniform(0.01, 0.06))

        if s.rng.random() < 0.7:
            s.slip(at_s, length_s, rms_v, creep_s=s.uniform(0.0, 0.05))
        else:
            s.events.append(Interval(at_s, at_s + length_s))

        at_s += length_s + s.uniform(0.2, 1.2)


def _hand_motion(s: Sketch) -> None:
    bands = ((0.5, 4.0), (3.0, 8.0), (8.0, 12.0), (7.0, 15.0), (0.5, 15.0))
    for _ in range(s.rng.integers(1, 3)):
        low_hz, high_hz = bands[s.rng.integers(len(bands))]
        s.sway(low_hz, high_hz, s.spread(0.001, 0.03), s.uniform(-0.5, 1.5))


def _slip_within_tremor(s: Sketch) -> None:
    _hand_motion(s)
    _slips(s)


def _servo(s: Sketch) -> None:
    height_v = s.spread(0.0015, 0.04)
    rise_s = s.spread(0.003, 0.035)
    rate_hz = s.spread(0.7, 11.0)
    has_gears = s.rng.random() < 0.4
    at_s = s.uniform(*QUIET_S)
    sign = s.sign()
    is_hunting = s.rng.random() < 0.6
    gear_v = s.spread(0.0001, 0.0015)

    while at_s < s.duration_s - 0.3:
        sign = -sign if is_hunting else s.sign()
        s.ramp(at_s, sign * height_v * s.uniform(0.5, 1.0), rise_s)
        if has_gears:
            s.vibrate(at_s, rise_s + 0.01, 50.0, 220.0, gear_v)

        at_s += s.uniform(0.7, 1.3) / rate_hz


def _isolated_step(s: Sketch) -> None:
    at_s = s.uniform(1.2, 3.0)
    while at_s < s.duration_s - 0.5:
        height_v = s.spread(0.002, 0.04)
        rise_s = s.spread(0.003, 0.035)
        s.ramp(at_s, s.sign() * height_v, rise_s)
        if s.rng.random() < 0.4:
            s.vibrate(at_s, rise_s + 0.01, 50.0, 220.0, s.spread(0.0001, 0.0012))

        at_s += s.uniform(1.2, 3.0)


def _set_down(s: Sketch) -> None:
    at_s = s.uniform(*QUIET_S)
    while at_s < s.duration_s - 0.5:
        s.ramp(at_s, -s.spread(0.01, 0.25), s.spread(0.004, 0.025))
        at_s += s.uniform(0.8, 2.0)


def _release(s: Sketch) -> None:
    at_s = s.uniform(*QUIET_S)
    while at_s < s.duration_s - 0.9:
        height_v = s.spread(0.05, 0.6)
        s.ramp(at_s, -height_v, s.spread(0.02, 0.25))
        at_s += s.uniform(0.5, 1.0)
        s.ramp(at_s, height_v, s.spread(0.03, 0.3))
        at_s += s.uniform(0.7, 1.5)


def _blows(s: Sketch) -> None:
    at_s = s.uniform(*QUIET_S)
    while at_s < s.duration_s - 0.4:
        s.ring(at_s, s.spread(0.003, 0.15))
        at_s += s.uniform(0.4, 1.5)


def _vibration_with_the_grasp(s: Sketch) -> None:
    at_s = s.uniform(*QUIET_S)
    s.ramp(at_s, s.sign() * s.spread(0.05, 0.5), s.spread(0.04, 0.3))
    low_hz = s.uniform(25.0, 50.0)
    s.vibrate(at_s, s.duration_s, low_hz, low_hz + s.uniform(30.0, 70.0), s.spread(0.0001, 0.0007))

    if s.rng.random() < 0.5:
        at_s += s.uniform(1.5, 2.5)
        s.slip(at_s, min(s.uniform(0.3, 2.0), s.duration_s - at_s - 0.2), s.spread(0.003, 0.012))


def _late_hum(s: Sketch) -> None:
    at_s = s.uniform(1.0, 2.5)
    hz = float(s.rng.choice([50.0, 60.0]))
    t = s.since(at_s)
    s.volts += (
        s.spread(0.0002, 0.0012)
        * math.sqrt(2)
        * np.sin(2 * math.pi * hz * t)
        * np.minimum(t / 0.02, 1.0)
    )
    s.events.append(Interval(at_s, at_s + 0.2))
    at_s += s.uniform(0.5, 3.0)
    s.slip(at_s, min(s.uniform(0.3, 1.5), s.duration_s - at_s - 0.2), s.spread(0.003, 0.012))


def _quiet(s: Sketch) -> None:
    if s.rng.random() < 0.5:
        s.vibrate(0.0, s.duration_s, 0.5, 300.0, s.spread(0.0001, 0.0016))


@dataclass(frozen=True)
class Kind:
    draw: Callable[[Sketch], None]
    duration_s: float
    share: float
    """Number of recordings, relative to the number of events of a fit."""


KINDS: Mapping[str, Kind] = {
    "slide after load": Kind(_slide_after_load, 12.0, 0.5),
    "loads": Kind(_loads, 8.0, 0.2),
    "slips": Kind(_slips, 8.0, 0.3),
    "hand motion": Kind(_hand_motion, 12.0, 0.4),
    "slip within tremor": Kind(_slip_within_tremor, 8.0, 0.3),
    "servo": Kind(_servo, 8.0, 1.0),
    "isolated step": Kind(_isolated_step, 8.0, 0.7),
    "set-down": Kind(_set_down, 8.0, 0.3),
    "release": Kind(_release, 8.0, 0.2),
    "blows": Kind(_blows, 8.0, 0.4),
    "vibration with a grasp": Kind(_vibration_with_the_grasp, 6.0, 0.8),
    "late hum": Kind(_late_hum, 6.0, 0.4),
    "quiet": Kind(_quiet, 6.0, 0.1),
    SLOW_SLIDES: Kind(_slow_slides, 10.0, 1.0),
}


def draw_disturbance(
    design: Design, kind: str, seed: int, noise_factor: float = 1.0
) -> LabelledSignal:
    """Draw one recording of a kind, sampled by the design's converter."""
    rng = np.random.default_rng((seed, list(KINDS).index(kind)))
    rate_hz = design.detector.sample_rate_hz
    sketch = Sketch(rng, rate_hz, KINDS[kind].duration_s)
    KINDS[kind].draw(sketch)
    direction = 1.0 if design.board.tactile_rises else -1.0
    middle_v = sketch.uniform(0.25, 0.6) * design.detector.adc_range_v
    volts = middle_v + direction * sketch.volts
    noisy = design.model_copy(
        update={
            "detector": design.detector.model_copy(
                update={"noise_v": design.detector.noise_v * noise_factor}
            )
        }
    )
    filtered_v = filter_as_board(design, volts)

    return LabelledSignal(
        kind=kind,
        rate_hz=rate_hz,
        voltage_v=sample(noisy, rng, volts),
        slides=tuple(sketch.slides),
        events=tuple(sketch.events),
        filtered_v=None if filtered_v is None else sample(noisy, rng, filtered_v),
    )


def generate_disturbances(
    design: Design, first_seed: int, events: int, unwired_share: float
) -> Iterator[tuple[LabelledSignal, Design]]:
    """Draw the recordings of all kinds, each with the design that a detector of it assumes.

    The noise is the stated one, or half to five times as much; a tenth of the recordings has
    another sampling rate, and a share of those with a filtered signal lacks it.
    """
    rng = np.random.default_rng(first_seed)
    seed = first_seed

    for kind, plan in KINDS.items():
        for _ in range(math.ceil(plan.share * events)):
            factor = (
                1.0 if rng.random() < 0.6 else math.exp(rng.uniform(math.log(0.5), math.log(5.0)))
            )
            rate_hz = (
                float(rng.choice(OTHER_RATES_HZ))
                if rng.random() < 0.1
                else design.detector.sample_rate_hz
            )
            sampled = design.model_copy(
                update={"detector": design.detector.model_copy(update={"sample_rate_hz": rate_hz})}
            )
            signal = draw_disturbance(sampled, kind, seed, factor)
            if signal.filtered_v is not None and rng.random() < unwired_share:
                signal = replace(signal, filtered_v=None)

            yield signal, sampled
            seed += 1
