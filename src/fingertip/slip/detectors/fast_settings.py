"""Settings of the detector `fast`, its times and limits, and the
constants of its loop that follow from them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design import Design
from fingertip.design.formulas.filter import filtered_range_v, signal_ground_ratio
from fingertip.slip.detectors import fast_coefficients
from fingertip.slip.detectors.fast_decision_and_floors import SILENT_RATIO
from fingertip.slip.detectors.noise_and_threshold import input_noise_v

SHORT_S = 0.006
LONG_S = 0.02
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
"""Ratio of an energy of 20 ms to its floor above which vibration is
heard, and slip stays ON if the trees allow it.
"""
MEAN_S = 0.025
"""Time constant of the mean score, which decides ON: most blows
have high scores for less than this [s].
"""
WEAK_S = 0.08
"""Time constant of the longest energies: what tells a weak slide from a motor's steps [s]."""
HOLD_S = 0.1
"""Time constant with which the score is smoothed while a flag is set and vibration is heard [s]."""
MIN_NOISE_SHARE = SILENT_RATIO**-0.5
MIN_FILTERED_SHARE = 0.5
"""Smallest noise that is learned, as a share of the stated noise, from
the tactile voltage and the filtered signal.
"""
NOISY_RATIO = 1.5
"""Ratio of a floor to that of the stated noise from which on more must speak for slip."""
MIN_NOISE_V_RTHZ = 1.26e-5
"""Smallest noise density taken for stated [V/sqrt(Hz)], that of
training: a slip would look like a contact.
"""
LIMIT_SHARE = 0.9
"""Share of the filtered signal's range that is used: a stage may be at its limit beyond it."""
REST_SHARE = 0.5
"""Share of the range of the filtered signal by which its mean
of `STILL_S` may differ from its rest.
"""
LIMITED_S = 0.03
"""Time in which the board's filter recovers from a limit [s]."""
STILL_S = 0.2
"""Time without any change after which the filtered signal is not used
[s]: the converter's noise always moves it.
"""
NUMBER_RATIO = 1e6
"""Ratio to the stated noise from which on a value is no voltage."""
JUMP_RATIO = 36.0
"""Ratio to the stated noise of a jump between two samples that the
next one must confirm: a touch moves it less.
"""
FILTERED_JUMP_RATIO = 1.0
"""The same for the smallest jump of the filtered signal, 70 times its noise; in slip,
`fast_state.JUMP_MOVES` holds.
"""
TRUSTED_S = 0.01
"""Time after a confirmed jump in which no jump is suspected [s]: a fast movement goes on."""
GAP_S = 0.02
"""Time without a voltage after which the next one begins anew [s];
the detector is OFF until `FAULT_S` later.
"""
FAULT_S = 0.05
"""Time for which a replaced sample is reported, and after which an impossible voltage is [s]."""
STATISTIC_RATIO = 2.5
"""Threshold in volts over the RMS noise in the wide band.
It only gives the statistic a scale in volts.
"""


@dataclass(frozen=True)
class FilteredSignal:
    """The board's filtered signal, as a controller samples it."""

    gain: float
    """Gain of the board's filter in its passband."""
    range_v: float
    """Largest deviation from its rest that the board and the converter pass [V]."""
    rest_v: float | None = None
    """Rest that its mean is compared with, as the library does with
    codes [V]; None: a recording may have another.
    """

    @classmethod
    def from_design(cls, design: Design, in_codes: bool = False) -> FilteredSignal | None:
        """Take the filtered signal from a design; None if its
        board does not give it to a controller.
        """
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
    """Cutoff of the board's filter [Hz].
    It matters only where the board's filtered signal is given.
    """
    filtered: FilteredSignal | None = None
    """Filtered signal of the board. None: the detector is given the tactile voltage alone."""
    direction: float = 1.0
    """1 if the tactile voltage falls with the force, -1 if it rises."""
    possible_v: tuple[float, float] = (-1e30, 1e30)
    """Tactile voltages that forces give; others are reported [V]."""
    phase: int = 0
    """Samples by which its ticks come sooner: the detectors of a
    hand's fingers tick one sample apart.
    """
    suspects_inputs: bool = True
    """True if the next sample must confirm a jump, and a voltage that stands still teaches nothing.
    Not in the fit.
    """
    mean_s: float = MEAN_S
    """Time constant of the mean score [s]: 0 in the fit, which judges each tick alone."""

    @classmethod
    def from_design(cls, design: Design, noise_v: float | None = None) -> FastSettings:
        rate_hz = design.detector.sample_rate_hz
        noise = max(input_noise_v(design), min_noise_v(rate_hz)) if noise_v is None else noise_v
        filtered = FilteredSignal.from_design(design)
        direction = -1.0 if design.board.tactile_rises else 1.0

        return cls(
            rate_hz, noise, cutoff_hz=design.board.cutoff_hz, filtered=filtered, direction=direction
        )


def min_noise_v(sample_rate_hz: float) -> float:
    return MIN_NOISE_V_RTHZ * math.sqrt(sample_rate_hz / 2)


def band_noise_v(settings: FastSettings, with_filtered: bool) -> float:
    """Stated noise in the bands, as white noise at the input [V]: the
    filtered signal has less than any that counts.
    """
    return min_noise_v(settings.sample_rate_hz) if with_filtered else settings.noise_v


def compute_coefficients(
    settings: FastSettings, model: fast_coefficients.FastModel, with_filtered: bool
) -> fast_coefficients.FastCoefficients:
    rate = settings.sample_rate_hz
    filters = fast_coefficients.design_filters(settings.sample_rate_hz)
    board, restore = fast_coefficients.design_board_filter(rate, settings.cutoff_hz)
    wide, upper = fast_coefficients.noise_energies(rate)
    tick = max(1, round(TICK_S * rate))
    ticks_per_s = rate / tick
    stated = band_noise_v(settings, with_filtered) ** 2
    least = stated * (MIN_FILTERED_SHARE if with_filtered else MIN_NOISE_SHARE) ** 2
    filtered_gain = 0.0
    filtered_limit = math.inf
    filtered_rest = 0.0
    rest_limit = math.inf

    if with_filtered and settings.filtered:
        filtered_gain = 1 / settings.filtered.gain
        filtered_limit = LIMIT_SHARE * settings.filtered.range_v * filtered_gain
        if settings.filtered.rest_v is not None:
            filtered_rest = settings.filtered.rest_v
            rest_limit = REST_SHARE * settings.filtered.range_v

    lowest, highest = settings.possible_v
    threshold = LOWEST_SCORE + settings.threshold_scale * (model.threshold - LOWEST_SCORE)
    jump_ratios = (
        (JUMP_RATIO, FILTERED_JUMP_RATIO)
        if settings.suspects_inputs
        else (NUMBER_RATIO, NUMBER_RATIO)
    )
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
        silent_floor=(MIN_NOISE_SHARE * settings.noise_v) ** 2 * settings.suspects_inputs,
        noisy_floor=NOISY_RATIO * wide * stated,
        noisy_slow_floor=NOISY_RATIO * wide * settings.noise_v**2,
        offset=model.offset,
        lowest_score=LOWEST_SCORE,
        threshold=threshold,
        incipient_rise=settings.threshold_scale * (model.incipient_threshold - model.threshold),
        noise_rise=settings.threshold_scale * model.noise_rise,
        stay_threshold=min(STAY_SCORE, threshold),
        stay_ratio=STAY_RATIO,
        mean_smoothing=1 / (1 + settings.mean_s * ticks_per_s),
        hold_smoothing=1 / (1 + HOLD_S * ticks_per_s),
        weak_smoothing=1 / (1 + WEAK_S * ticks_per_s),
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
