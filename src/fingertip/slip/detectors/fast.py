"""Detector `fast`: short-time energies over a learned noise floor, beside the slow force, judged by small trees.

A contact, a release, a change of grip and a knock leave energy in the band of slip, as slip does. What distinguishes
them is the slow force: it changes much for the energy it leaves, and one way, and the energy of a knock decays. The
detector computes fifteen ratios that express this (`fingertip.slip.detectors.fast_model.FEATURES`), and a sum of small
decision trees weighs them. The trees were fitted to simulated slips and to a wider mix of what is not slip
(`tools/detector_training/`).

Every feature is relative: to the noise floors, which the detector learns, or to another feature. So the unit of the
input does not matter, and the stated noise hardly does. The floors are learned within 0.5 s from the start, and again
after each change of force, because a hand that holds vibrates more than one that does not. They adapt slowly
afterwards. They stand still while the detector is ON or the force changes. They are never below the noise of a
converter halfway between two codes.

ON stays while the energy of 20 ms is above the floors and the trees agree on average, however long the slip lasts.
Only a tone, whose energy hardly varies, is unlearned.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fingertip.arrays import Array
from fingertip.design import Design
from fingertip.slip.detectors import fast_loop
from fingertip.slip.detectors.detector import DetectorOutput, as_samples
from fingertip.slip.detectors.fast_filters import HIGH_HZ, LOW_HZ, design_filters, noise_energies
from fingertip.slip.detectors.fast_loop import COUNT, LOOP, FastCoefficients
from fingertip.slip.detectors.fast_model import FastModel, load_model
from fingertip.slip.detectors.noise import input_noise_v

SHORT_S, LONG_S = 0.006, 0.02
"""Time constants of the energies and movements [s]."""
TICK_S = 0.002
"""Time between two evaluations of the trees [s]."""
SLOT_S = 0.04
"""Duration of a slot of the peaks [s]; three of them are kept."""
FILTERS_SETTLE_S = 0.04
"""Time in which the filters settle after the first sample [s]."""
SETTLING_S = 0.2
"""Initial OFF, in which the floors are learned [s]."""
FLOOR_S = 2.0
"""Time over which the floors average in the end [s]."""
TONE_S = 3.0
"""Time of ON after which a tone is unlearned [s]."""
UNLEARNING_S = 0.5
"""Time constant with which it is unlearned [s]."""
LOWEST_SCORE = -4.0
"""Score of confidence 0: odds of 1 to 55 in the training mix."""
STAY_SCORE = -1.0
"""Score above which slip stays ON."""
STAY_RATIO = 2.0
"""Ratio of an energy of 20 ms to its floor above which slip stays ON, while its smoothed score exceeds `STAY_SCORE`.
Without the score, vibration that begins with the grasp would keep the detector ON."""
SCORE_S = 0.1
"""Time constant with which the score is smoothed while ON [s]."""
MIN_NOISE_SHARE = 0.5
"""Smallest noise that is learned, as a share of the stated noise: half of it was trained on."""
MIN_NOISE_V_RTHZ = 1.26e-5
"""Smallest noise density that is taken for stated [V/sqrt(Hz)]: 0.4 mV at 2 kHz, as in training. In less noise,
features would exceed what was trained on: a slip would look like a contact."""
STATISTIC_RATIO = 2.5
"""Threshold in volts over the RMS noise in the wide band. It only gives the statistic a scale in volts."""


@dataclass(frozen=True)
class FastSettings:
    """Settings of the detector."""

    sample_rate_hz: float
    noise_v: float
    """White RMS noise at the input, before the noise is learned [V]."""
    threshold_scale: float = 1.0
    """Factor of the threshold of the confidence, to trade delay for false alarms."""

    @classmethod
    def from_design(cls, design: Design, noise_v: float | None = None) -> FastSettings:
        """Take the settings from a design.

        Parameters
        ----------
        design
            Source of the sampling rate and the noise.
        noise_v
            White RMS noise of the input; by default the design's [V]. The input may then have another unit than volts.
        """
        noise = max(input_noise_v(design), min_noise_v(design)) if noise_v is None else noise_v
        return cls(design.detector.sample_rate_hz, noise)


@dataclass(frozen=True, eq=False)
class FastOutput(DetectorOutput):
    """Output of the detector: one value per input sample."""

    filtered_v: Array
    """Wide band [V]."""
    confidence: Array
    """Statistic over threshold: from 1 on, slip turns ON."""
    incipient: NDArray[np.bool_]
    """True if slip may begin: the confidence exceeds a lower threshold, at some ten times the false alarms."""


class FastDetector:
    """Fast detector with its state. It starts in the steady state of the first sample.

    Parameters
    ----------
    settings
        Settings of the detector.
    model
        Trees. None: those of the package.
    """

    def __init__(self, settings: FastSettings, model: FastModel | None = None) -> None:
        self.settings = settings
        self._model = model = model or load_model()
        self._coefficients = c = _compute_coefficients(settings, model)
        low, scale = LOWEST_SCORE, settings.threshold_scale
        self._incipient = (model.incipient_threshold - low) / (model.threshold - low) / scale
        # Energies and floors start at those of the stated noise.
        self._state = [0.0] * fast_loop.STATES
        wide, upper = noise_energies(settings.sample_rate_hz)
        for index in (fast_loop.WIDE_SHORT, fast_loop.WIDE_LONG, fast_loop.FLOOR):
            self._state[index] = wide * settings.noise_v**2
        for index in (fast_loop.UPPER_SHORT, fast_loop.UPPER_LONG, fast_loop.UPPER_FLOOR):
            self._state[index] = upper * settings.noise_v**2
        ticks_per_s = settings.sample_rate_hz / c.tick_samples
        self._state[fast_loop.SETTLING] = float(round(SETTLING_S * ticks_per_s))
        self._state[fast_loop.FLOOR_TICKS] = -float(round(FILTERS_SETTLE_S * ticks_per_s))
        self._started = False

    @property
    def coefficients(self) -> FastCoefficients:
        """Constants of the loop at this sampling rate and noise."""
        return self._coefficients

    @property
    def state(self) -> tuple[float, ...]:
        """Present state, by the indices of `fingertip.slip.detectors.fast_loop`."""
        return tuple(self._state)

    @property
    def incipient_confidence(self) -> float:
        """Confidence above which slip may begin."""
        return self._incipient

    @property
    def threshold_v(self) -> float:
        """Threshold above the present noise floor, as a voltage in the wide band [V]."""
        return self._coefficients.statistic_gain * math.sqrt(self._state[fast_loop.FLOOR])

    @property
    def memory_s(self) -> float:
        """Time until an abrupt end is recognised [s]: by the ratio of the energies or, after a weak slip, the floor."""
        return math.log(1 / (fast_loop.DECAY_RATIO * STAY_RATIO)) * LONG_S

    @property
    def noise_v(self) -> float:
        """White RMS noise that has the energy of the learned wide floor [V]."""
        return math.sqrt(self._state[fast_loop.FLOOR] / self._coefficients.wide_share)

    @property
    def noise_energy_v2(self) -> float:
        """Mean power of the stated noise in the wide band [V^2]."""
        return self._coefficients.wide_share * self.settings.noise_v**2

    @property
    def band_hz(self) -> tuple[float, float]:
        """Edges of the wide band [Hz]."""
        return LOW_HZ, HIGH_HZ

    def equivalent_noise_v(self, quiet_v: Array) -> float:
        """Compute the white RMS noise that has as much energy in the bands as these samples of a quiet signal [V]."""
        rate = self.settings.sample_rate_hz
        responses = design_filters(rate).impulse_responses(round(4 * rate / LOW_HZ))
        return max(
            math.sqrt(float(np.mean(np.convolve(quiet_v - quiet_v[0], h, "valid") ** 2)) / energy)
            for h, energy in zip(responses, noise_energies(rate), strict=True)
        )

    def process(self, voltage_v: Iterable[float]) -> FastOutput:
        """Process the next samples [V], any number of them, and return one output per sample."""
        samples = as_samples(voltage_v)
        filtered, confidence, level, on = self._run(samples, np.zeros(COUNT), 0)
        return FastOutput(confidence * level, level, on > 0.0, filtered, confidence, confidence > self._incipient)

    def compute_features(self, voltage_v: Array) -> tuple[FastOutput, Array]:
        """Process samples and return the output and the features of every tick, (ticks, features)."""
        ticks = len(voltage_v) // int(self._coefficients.tick_samples)
        rows = np.zeros((ticks + 1) * COUNT)
        filtered, confidence, level, on = self._run(voltage_v, rows, COUNT)
        output = FastOutput(confidence * level, level, on > 0.0, filtered, confidence, confidence > self._incipient)
        return output, rows[: ticks * COUNT].reshape(ticks, COUNT)

    def step(self, voltage_v: float) -> bool:
        """Process one sample [V] and return whether slip is ON."""
        self._start(voltage_v)
        m = self._model
        LOOP.plain(
            self._coefficients, *m.lists, 0, (voltage_v,), self._state, [0.0] * COUNT, [0.0], [0.0], [0.0], [0.0]
        )
        return self._state[fast_loop.ON] > 0.0

    def _run(self, samples: list[float] | Array, rows: Array, stride: int) -> Array:
        if len(samples):
            self._start(float(samples[0]))
        out: Array = np.zeros((4, len(samples)))
        m = self._model
        LOOP(self._coefficients, m.features, m.thresholds, m.leaves, stride, samples, self._state, rows, *out)
        return out

    def _start(self, voltage_v: float) -> None:
        """Take the first sample for a constant input until then: there is no difference, and nothing in the bands."""
        if not self._started:
            self._started = True
            self._state[fast_loop.INPUT] = voltage_v
            self._state[fast_loop.STEP] = math.inf


def min_noise_v(design: Design) -> float:
    """Smallest noise that is taken for stated, where the input is in volts [V]."""
    return MIN_NOISE_V_RTHZ * math.sqrt(design.detector.sample_rate_hz / 2)


def _compute_coefficients(settings: FastSettings, model: FastModel) -> FastCoefficients:
    rate, filters = settings.sample_rate_hz, design_filters(settings.sample_rate_hz)
    wide, upper = noise_energies(rate)
    tick = max(1, round(TICK_S * rate))
    ticks_per_s = rate / tick
    least = (MIN_NOISE_SHARE * settings.noise_v) ** 2
    threshold = LOWEST_SCORE + settings.threshold_scale * (model.threshold - LOWEST_SCORE)
    return FastCoefficients(
        *filters.high_edge,
        *(filters.upper.b0, *filters.upper[3:]),
        *(filters.wide.b0, *filters.wide[3:]),
        *filters.slow,
        sample_rate_hz=rate,
        short_smoothing=1 / (1 + rate * SHORT_S),
        long_smoothing=1 / (1 + rate * LONG_S),
        tick_samples=float(tick),
        slot_ticks=float(round(SLOT_S * ticks_per_s)),
        max_floor_ticks=FLOOR_S * ticks_per_s,
        tone_ticks=TONE_S * ticks_per_s,
        unlearning=1 / (UNLEARNING_S * ticks_per_s),
        wide_share=wide,
        upper_share=upper,
        min_floor=wide * least,
        min_upper_floor=upper * least,
        offset=model.offset,
        lowest_score=LOWEST_SCORE,
        threshold=threshold,
        stay_threshold=min(STAY_SCORE, threshold),
        stay_ratio=STAY_RATIO,
        score_smoothing=1 / (1 + SCORE_S * ticks_per_s),
        statistic_gain=STATISTIC_RATIO,
    )
