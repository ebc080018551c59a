"""Detector `fast`: short-time energies over a learned noise floor, beside the slow force, judged by small trees.

A contact, a release, a change of grip and a knock leave energy in the band of slip, as slip does. What distinguishes
them is the slow force: it changes much for the energy it leaves, and one way, and the energy of a knock decays. The
detector computes features that express this (`fast_coefficients.FEATURES`), and a sum of small decision trees weighs
them. The trees were fitted to simulated slips and to a wider mix of what is not slip (`tools/detector_training/`).

A board for a controller gives its filtered signal beside the tactile voltage. Ahead of the converter it is amplified,
so that the converter's steps and noise hardly count in it. The energies then come from this signal, and the slow force
from the tactile voltage. Where a stage of the board is at its limit, and on boards without that signal, the same filter
is computed from the tactile voltage instead.

Every feature is relative: to the noise floors, which the detector learns, or to another feature. So the unit of the
input does not matter, and the stated noise hardly does. The floors are learned within 0.5 s from the start, and again
after each change of force, because a hand that holds vibrates more than one that does not. They adapt slowly
afterwards. They stand still while the force changes, while the trees take what they see for slip or nearly so, and in
vibration above 4 times a floor, unless it is a tone or the force has stood still for 2 s of it. They are never below
the noise of a converter halfway between two codes.

Slip is incipient from a first score on, and ON from a higher one. Both last while the energy of 20 ms is above the
floors and the trees agree on average, however long the slip lasts. Only a tone, whose energy hardly varies, is
unlearned.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fingertip.design import Design
from fingertip.design.formulas.filter import filtered_range_v, signal_ground_ratio
from fingertip.foundation.jit import as_samples
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors import fast_coefficients, fast_state
from fingertip.slip.detectors.fast_loop import LOOP
from fingertip.slip.detectors.fast_state import COUNT
from fingertip.slip.detectors.noise import input_noise_v
from fingertip.slip.detectors.registry import Detector, DetectorOutput

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
"""Score above which slip stays incipient or ON, and the floors stand still."""
STAY_RATIO = 2.0
"""Ratio of an energy of 20 ms to its floor above which slip stays ON, while its smoothed score exceeds `STAY_SCORE`.
Without the score, vibration that begins with the grasp would keep the detector ON."""
HEARD_SCORE = -1.4
"""Score from which heard vibration speaks for slip; what it exceeds it by is summed up (`fast_state.EVIDENCE`)."""
SCORE_S = 0.1
"""Time constant with which the score is smoothed while ON [s]."""
MIN_NOISE_SHARE = 0.5
"""Smallest noise that is learned, as a share of the stated noise: half of it was trained on."""
MIN_NOISE_V_RTHZ = 1.26e-5
"""Smallest noise density taken for stated [V/sqrt(Hz)], that of training: a slip would look like a contact."""
LIMIT_SHARE = 0.9
"""Share of the filtered signal's range that is used: a stage may be at its limit beyond it."""
REST_SHARE = 0.5
"""Share of the range of the filtered signal by which its mean of `STILL_S` may differ from its rest."""
LIMITED_S = 0.03
"""Time in which the board's filter recovers from a limit [s]."""
STILL_S = 0.2
"""Time without any change after which the filtered signal is not used [s]: the converter's noise always moves it."""
NUMBER_RATIO = 1e6
"""Ratio to the stated noise from which on a value is no voltage."""
JUMP_RATIO = 36.0
"""Ratio to the stated noise of a jump between two samples that the next one must confirm: 20 mV on the default board,
where a glitch of 10 mV changes no more than 25 ms of output, and touching an object moves 16 mV at most, mostly."""
FILTERED_JUMP_RATIO = 1.0
"""The same for the smallest jump of the filtered signal: 37 mV on the default board, 70 times its noise there. In slip
it is greater (`fast_state.JUMP_MOVES`)."""
TRUSTED_S = 0.01
"""Time after a confirmed jump in which no jump is suspected [s]: a fast movement goes on."""
GAP_S = 0.02
"""Time without a voltage after which the next one begins anew [s]; the detector is OFF until `FAULT_S` later."""
FAULT_S = 0.05
"""Time for which a replaced sample is reported, and after which an impossible voltage is [s]."""
STATISTIC_RATIO = 2.5
"""Threshold in volts over the RMS noise in the wide band. It only gives the statistic a scale in volts."""


@dataclass(frozen=True)
class FilteredSignal:
    """The board's filtered signal, as a controller samples it."""

    gain: float
    """Gain of the board's filter in its passband."""
    range_v: float
    """Largest deviation from its rest that the board and the converter pass [V]."""
    rest_v: float | None = None
    """Rest that its mean is compared with, as the library does with codes [V]; None: a recording may have another."""

    @classmethod
    def from_design(cls, design: Design, in_codes: bool = False) -> FilteredSignal | None:
        """Take the filtered signal from a design; None if its board does not give it to a controller."""
        range_v = filtered_range_v(design.board, design.detector.adc_range_v)
        rest_v = signal_ground_ratio(design.board) * design.board.supply_v if in_codes else None
        return None if range_v is None else cls(design.board.passband_gain, range_v, rest_v)


@dataclass(frozen=True)
class FastSettings:
    sample_rate_hz: float
    noise_v: float
    """White RMS noise at the input, before the noise is learned [V]."""
    threshold_scale: float = 1.0
    """Factor of the threshold of the confidence, to trade delay for false alarms."""
    cutoff_hz: float = 67.0
    """Cutoff of the board's filter [Hz]. It matters only where the board's filtered signal is given."""
    filtered: FilteredSignal | None = None
    """Filtered signal of the board. None: the detector is given the tactile voltage alone."""
    direction: float = 1.0
    """1 if the tactile voltage falls with the force, -1 if it rises."""
    possible_v: tuple[float, float] = (-1e30, 1e30)
    """Tactile voltages that forces give; others are reported [V]."""
    phase: int = 0
    """Samples by which its ticks come sooner: the detectors of a hand's fingers tick one sample apart."""
    suspects_jumps: bool = True
    """True if a jump waits for the next sample to confirm it. Not in the fit: all jumps of its signals are real."""

    @classmethod
    def from_design(cls, design: Design, noise_v: float | None = None) -> FastSettings:
        rate_hz = design.detector.sample_rate_hz
        noise = max(input_noise_v(design), _min_noise_v(rate_hz)) if noise_v is None else noise_v
        filtered = FilteredSignal.from_design(design)
        direction = -1.0 if design.board.tactile_rises else 1.0
        return cls(rate_hz, noise, cutoff_hz=design.board.cutoff_hz, filtered=filtered, direction=direction)


@dataclass(frozen=True)
class Floors:
    """Floors that a detector has learned while its signal rested, stored for a start in which nothing rests [V^2]."""

    wide: float
    upper: float
    tactile: float


@dataclass(frozen=True, eq=False)
class FastOutput(DetectorOutput):
    """Output of the detector: one value per input sample."""

    filtered_v: Array
    """Wide band [V]."""
    confidence: Array
    """Statistic over threshold: from 1 on, slip turns ON."""
    incipient: NDArray[np.bool_]
    """True if slip may have begun: earlier than `on`, with more false alarms, and true as long as `on` is."""
    incipient_threshold_v: Array
    """Threshold of the statistic above which `incipient` begins, in the stated noise [V]."""
    is_replaced: NDArray[np.bool_]
    """True for 50 ms after a sample that was no voltage, or a glitch: the last one was used in its place."""
    is_outside: NDArray[np.bool_]
    """True while the tactile voltage is one that no force gives: an open wire, a shorted sensor, or too much force."""


class FastDetector(Detector):
    """Fast detector with its state. It starts in the steady state of the first sample."""

    memory_s = math.log(1 / (fast_state.DECAY_RATIO * STAY_RATIO)) * LONG_S
    """Time until an abrupt end is recognised [s]: by the ratio of the energies or, after a weak slip, the floor."""

    def __init__(
        self, settings: FastSettings, model: fast_coefficients.FastModel | None = None, floors: Floors | None = None
    ) -> None:
        self.settings, self.stored_floors = settings, floors
        self._model = model = model or fast_coefficients.load_model()
        self.coefficients = _compute_coefficients(settings, model, with_filtered=False)
        """Constants of the loop at this sampling rate and noise."""
        self._state = [0.0] * fast_state.STATES
        self._state[fast_state.FLOOR] = self.coefficients.wide_share * settings.noise_v**2
        self._state[fast_state.PHASE] = float(settings.phase % int(self.coefficients.tick_samples))
        self._started = False

    @classmethod
    def for_design(cls, design: Design, noise_v: float | None = None, threshold_scale: float = 1.0) -> FastDetector:
        return cls(replace(FastSettings.from_design(design, noise_v), threshold_scale=threshold_scale))

    @property
    def state(self) -> tuple[float, ...]:
        """Present state, by the indices of `fingertip.slip.detectors.fast_state`."""
        return tuple(self._state)

    @property
    def floors(self) -> Floors:
        """Floors that were learned, for the next start of a detector of the same inputs."""
        return Floors(*(self._state[at] for at in (fast_state.FLOOR, fast_state.UPPER_FLOOR, fast_state.INPUT_FLOOR)))

    @property
    def threshold_v(self) -> float:
        """Threshold above the present noise floor, as a voltage in the wide band [V]."""
        return self.coefficients.statistic_gain * math.sqrt(self._state[fast_state.FLOOR])

    @property
    def noise_v(self) -> float:
        """White RMS noise that has the energy of the learned wide floor [V]."""
        return math.sqrt(self._state[fast_state.FLOOR] / self.coefficients.wide_share)

    @classmethod
    def equivalent_noise_v(cls, design: Design, quiet_v: Array) -> float:
        """Compute the white RMS noise that has as much energy in the bands as these samples of a quiet signal [V]."""
        rate = design.detector.sample_rate_hz
        responses = fast_coefficients.design_filters(rate).impulse_responses(round(4 * rate / fast_coefficients.LOW_HZ))
        return max(
            math.sqrt(float(np.mean(np.convolve(quiet_v - quiet_v[0], h, "valid") ** 2)) / energy)
            for h, energy in zip(responses, fast_coefficients.noise_energies(rate), strict=True)
        )

    @staticmethod
    def min_noise_v(design: Design) -> float:
        """Smallest noise that is taken for stated, where the input is in volts [V]."""
        return _min_noise_v(design.detector.sample_rate_hz)

    def process(self, voltage_v: Iterable[float], filtered_v: Iterable[float] | None = None) -> FastOutput:
        return self._run(voltage_v, filtered_v, np.zeros(COUNT), 0)

    def select(self, output: FastOutput) -> FastOutput:
        """Return the output of a detector `fast` at this operating point."""
        return output

    def is_off_beyond(self, output: FastOutput) -> bool:
        """Return whether a greater threshold would give no ON either, because nothing here came near this one.

        Every threshold grows with the scale, and until a score exceeds one of them no state depends on it.
        """
        return self.coefficients.stay_threshold == STAY_SCORE and not output.incipient.any()

    def compute_features(self, voltage_v: Array, filtered_v: Array | None = None) -> tuple[FastOutput, Array]:
        """Process samples and return the output and the features of every tick, (ticks, features)."""
        ticks = len(voltage_v) // int(self.coefficients.tick_samples)
        rows = np.zeros((ticks + 1) * COUNT)
        output = self._run(voltage_v, filtered_v, rows, COUNT)
        return output, rows[: ticks * COUNT].reshape(ticks, COUNT)

    def step(self, voltage_v: float, filtered_v: float | None = None) -> bool:
        """Process one sample of the tactile voltage, and of the filtered signal if given [V]; return if slip is ON."""
        self._start(voltage_v, filtered_v)
        m, filtered = self._model, (voltage_v if filtered_v is None else filtered_v,)
        LOOP.plain(
            self.coefficients, *m.lists, 0, (voltage_v,), filtered, self._state, [0.0] * COUNT, [0.0], [0.0], [0.0],
            [0.0],
        )  # fmt: skip
        return self._state[fast_state.ON] > 0.0

    def _run(
        self, voltage_v: Iterable[float], filtered_v: Iterable[float] | None, rows: Array, stride: int
    ) -> FastOutput:
        samples = as_samples(voltage_v)
        filtered = samples if filtered_v is None else as_samples(filtered_v)
        if len(samples):
            self._start(float(samples[0]), None if filtered_v is None else float(filtered[0]))
        out: Array = np.zeros((4, len(samples)))
        m = self._model
        LOOP(self.coefficients, m.features, m.thresholds, m.leaves, stride, samples, filtered, self._state, rows, *out)
        wide, confidence, level, flags = out
        early, bits = self._early_share * level, flags.astype(np.int8)
        on, incipient, is_replaced, is_outside = (
            np.asarray(bits & int(flag) > 0)
            for flag in (fast_state.IS_ON, fast_state.IS_INCIPIENT, fast_state.IS_REPLACED, fast_state.IS_OUTSIDE)
        )
        return FastOutput(confidence * level, level, on, wide, confidence, incipient, early, is_replaced, is_outside)

    @property
    def _early_share(self) -> float:
        """Threshold of `incipient` over that of ON, in the stated noise."""
        c = self.coefficients
        return 1 - c.incipient_margin / (c.threshold - c.lowest_score)

    def _start(self, voltage_v: float, filtered_v: float | None) -> None:
        """Take the first sample for constant inputs until then: there is no difference, and nothing in the bands."""
        if self._started:
            return
        self._started = True
        settings, state = self.settings, self._state
        with_filtered = filtered_v is not None and settings.filtered is not None
        self.coefficients = c = _compute_coefficients(settings, self._model, with_filtered)
        state[fast_state.INPUT] = voltage_v if abs(voltage_v) <= c.number_limit else 0.0
        state[fast_state.STEP] = state[fast_state.FILTERED_STEP] = math.inf
        state[fast_state.REST] = filtered_v if filtered_v is not None and abs(filtered_v) <= c.number_limit else 0.0
        state[fast_state.LEVEL] = state[fast_state.REST]
        state[fast_state.STILL] = c.still_samples  # until it changes for the first time
        state[fast_state.MEAN_MOVE] = c.filtered_jump_limit  # noise that may be as great as stated
        # Energies and floors start at those of the stated noise.
        band_noise_v = _band_noise_v(settings, with_filtered)
        wide, upper = c.wide_share * band_noise_v**2, c.upper_share * band_noise_v**2
        for index in (fast_state.WIDE_SHORT, fast_state.WIDE_LONG, fast_state.FLOOR):
            state[index] = wide
        for index in (fast_state.UPPER_SHORT, fast_state.UPPER_LONG, fast_state.UPPER_FLOOR):
            state[index] = upper
        for index in (fast_state.INPUT_LONG, fast_state.INPUT_FLOOR):
            state[index] = settings.noise_v**2
        ticks_per_s = settings.sample_rate_hz / c.tick_samples
        if self.stored_floors:  # only the filters must settle
            state[fast_state.FLOOR] = max(self.stored_floors.wide, c.min_floor)
            state[fast_state.UPPER_FLOOR] = max(self.stored_floors.upper, c.min_upper_floor)
            state[fast_state.INPUT_FLOOR] = max(self.stored_floors.tactile, c.min_input_floor)
            state[fast_state.SETTLING] = float(round(FILTERS_SETTLE_S * ticks_per_s))
            state[fast_state.FLOOR_TICKS] = c.max_floor_ticks
            return
        state[fast_state.SETTLING] = float(round(SETTLING_S * ticks_per_s))
        state[fast_state.FLOOR_TICKS] = -float(round(FILTERS_SETTLE_S * ticks_per_s))


class IncipientDetector(FastDetector):
    """Detector `fast` at its early operating point: ON from the first signs of slip."""

    @property
    def threshold_v(self) -> float:
        return self._early_share * super().threshold_v

    def process(self, voltage_v: Iterable[float], filtered_v: Iterable[float] | None = None) -> FastOutput:
        return self.select(super().process(voltage_v, filtered_v))

    def select(self, output: FastOutput) -> FastOutput:
        return replace(output, on=output.incipient, threshold_v=output.incipient_threshold_v)

    def step(self, voltage_v: float, filtered_v: float | None = None) -> bool:
        super().step(voltage_v, filtered_v)
        return self._state[fast_state.INCIPIENT] > 0.0


def _min_noise_v(sample_rate_hz: float) -> float:
    return MIN_NOISE_V_RTHZ * math.sqrt(sample_rate_hz / 2)


def _band_noise_v(settings: FastSettings, with_filtered: bool) -> float:
    """Stated noise in the bands, as white noise at the input [V]: the filtered signal has less than any that counts."""
    return _min_noise_v(settings.sample_rate_hz) if with_filtered else settings.noise_v


def _compute_coefficients(
    settings: FastSettings, model: fast_coefficients.FastModel, with_filtered: bool
) -> fast_coefficients.FastCoefficients:
    rate, filters = settings.sample_rate_hz, fast_coefficients.design_filters(settings.sample_rate_hz)
    board, restore = fast_coefficients.design_board_filter(rate, settings.cutoff_hz)
    wide, upper = fast_coefficients.noise_energies(rate)
    tick = max(1, round(TICK_S * rate))
    ticks_per_s = rate / tick
    least = (MIN_NOISE_SHARE * _band_noise_v(settings, with_filtered)) ** 2
    filtered_gain, filtered_limit, filtered_rest, rest_limit = 0.0, math.inf, 0.0, math.inf
    if with_filtered and settings.filtered:
        filtered_gain = 1 / settings.filtered.gain
        filtered_limit = LIMIT_SHARE * settings.filtered.range_v * filtered_gain
        if settings.filtered.rest_v is not None:
            filtered_rest, rest_limit = settings.filtered.rest_v, REST_SHARE * settings.filtered.range_v
    lowest, highest = settings.possible_v
    threshold = LOWEST_SCORE + settings.threshold_scale * (model.threshold - LOWEST_SCORE)
    jump_ratios = (JUMP_RATIO, FILTERED_JUMP_RATIO) if settings.suspects_jumps else (NUMBER_RATIO, NUMBER_RATIO)
    return fast_coefficients.FastCoefficients(
        *board,
        *restore,
        filters.high_edge,
        filters.upper,
        filters.wide,
        filters.slow,
        sample_rate_hz=rate,
        direction=settings.direction,
        filtered_gain=filtered_gain,
        filtered_limit=filtered_limit,
        filtered_rest=filtered_rest,
        rest_limit=rest_limit,
        level_smoothing=1 / (STILL_S * rate),
        limited_samples=float(round(LIMITED_S * rate)),
        still_samples=float(round(STILL_S * rate)),
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
        min_input_floor=(MIN_NOISE_SHARE * settings.noise_v) ** 2,
        offset=model.offset,
        lowest_score=LOWEST_SCORE,
        threshold=threshold,
        incipient_margin=settings.threshold_scale * (model.threshold - model.incipient_threshold),
        noise_rise=settings.threshold_scale * model.noise_rise,
        stay_threshold=min(STAY_SCORE, threshold),
        stay_ratio=STAY_RATIO,
        heard_score=LOWEST_SCORE + settings.threshold_scale * (HEARD_SCORE - LOWEST_SCORE),
        score_smoothing=1 / (1 + SCORE_S * ticks_per_s),
        statistic_gain=STATISTIC_RATIO,
        number_limit=NUMBER_RATIO * settings.noise_v,
        jump_limit=jump_ratios[0] * settings.noise_v,
        filtered_jump_limit=jump_ratios[1] * settings.noise_v,
        middle_input=(lowest + highest) / 2,
        half_range=(highest - lowest) / 2,
        trusted_samples=float(round(TRUSTED_S * rate)),
        gap_samples=float(round(GAP_S * rate)),
        fault_samples=float(round(FAULT_S * rate)),
        restart_ticks=float(round(FAULT_S * ticks_per_s)),
    )
