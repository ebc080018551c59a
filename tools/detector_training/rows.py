"""Rows to fit: the features of every tick at which the signal is loud, with label and weight."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.slip.mix_signals import LabelledSignal
from fingertip.foundation.jit import compiled
from fingertip.foundation.numerics import Array
from fingertip.slip.detectors import fast_state
from fingertip.slip.detectors.fast import FastDetector
from fingertip.slip.detectors.fast_coefficients import FastModel
from fingertip.slip.detectors.fast_settings import LOWEST_SCORE, SETTLING_S, TICK_S, FastSettings
from tools.detector_training.signals import TrainingSignal

EARLY_S = 0.004
"""Time before gross slip from which a tick is labelled as slip [s]."""
CREEP_S = 0.0055
"""Time before gross slip up to which the creep before it is labelled as
no slip [s]: an ON then counts as an alarm.
"""
ONSET_S = 0.08
"""Time after the onset in which rows count most [s]: there the delay is decided."""
AFTER_S = 0.1
"""Time after a slip in which rows do not count [s]: the energy decays."""
ONSET_WEIGHT = 3.0
SLIP_WEIGHT = 1.0
EVENT_WEIGHT = 2.0
QUIET_WEIGHT = 0.25
CREEP_WEIGHT = 0.3
BURST_FACTOR = 2.0
"""Factor of the weights of a burst: slip that the simulation of contact did not make."""
ALARM_FACTORS = ((-3.0, 3.0), (-1.0, 14.0))
"""Factors of the weight of rows without slip whose score, relative to the threshold, exceeded a
value in a round before: its false alarms.
"""
LATE_S = 0.022
LATE_FACTOR = 7.0
FOUND_S = 0.01
"""Delay from which a slip of a round before was late [s], the factor of the weight of its rows, and
the time after the detection up to which it applies [s].
"""
CUTOFF_ERROR = 0.08
GAIN_ERROR = 0.03
"""Largest deviations of a real board's cutoff and gain, with capacitors of 10 %."""
KEPT_SHARE = 0.35
"""Share of the rows of low weight that are kept."""


class Rows(NamedTuple):
    """Features, labels and weights."""

    features: Array
    labels: Array
    weights: Array


def label(signal: LabelledSignal, ticks: int) -> tuple[Array, Array]:
    """Label every tick of a signal: 1 in slip, with its weight; 0 for rows that do not count."""
    t = (np.arange(ticks) + 1) * TICK_S
    labels = np.zeros(ticks)
    weights = np.full(ticks, QUIET_WEIGHT)
    for event in signal.events:
        weights[(t >= event.onset_s - 0.01) & (t < event.end_s + 0.25)] = EVENT_WEIGHT

    for slide in signal.slides:
        early_s = slide.onset_s - EARLY_S
        weights[(t >= slide.motion_s) & (t < early_s)] = 0.0
        weights[(t >= slide.motion_s) & (t < slide.onset_s - CREEP_S)] = CREEP_WEIGHT
        slipping = (t >= early_s) & (t < slide.end_s)
        labels[slipping] = 1.0
        weights[slipping] = SLIP_WEIGHT
        weights[slipping & (t < slide.onset_s + ONSET_S)] = ONSET_WEIGHT
        weights[(t >= slide.end_s) & (t < slide.end_s + AFTER_S)] = 0.0

    weights[t < SETTLING_S] = 0.0
    return labels, weights * BURST_FACTOR if signal.kind.startswith("burst") else weights


def emphasise(signal: LabelledSignal, labels: Array, scores: Array, on: NDArray[np.bool_]) -> Array:
    """Compute the factor of each tick's weight: more than 1 for false alarms, and for slip that was
    found late.

    Parameters
    ----------
    signal
        The signal.
    labels
        Label of each tick.
    scores
        Score of each tick, relative to the threshold.
    on
        Flag of the detector at each tick.
    """
    factors = np.ones(len(labels))
    for above, value in ALARM_FACTORS:
        factors[(scores > above) & (labels == 0.0)] = value

    t = (np.arange(len(labels)) + 1) * TICK_S
    for slide in signal.slides:
        is_onset = (t >= slide.onset_s) & (t < min(slide.end_s, slide.onset_s + ONSET_S))
        found = t[is_onset & on]
        found_s = float(found[0]) if len(found) else slide.onset_s + ONSET_S
        if found_s > slide.onset_s + LATE_S:
            factors[is_onset & (t <= found_s + FOUND_S)] = LATE_FACTOR

    return factors


def collect(
    signals: Sequence[TrainingSignal], model: FastModel, seed: int, factors: Sequence[Array]
) -> tuple[Rows, list[Array]]:
    """Run the detector with a model over signals and collect the rows.

    The detector assumes the cutoff and the gain of an ideal board; the real one deviates from them.

    Parameters
    ----------
    signals
        The signals.
    model
        Trees of the round before, or none.
    seed
        Seed of the boards' deviations and of the choice of rows.
    factors
        Largest factor of each tick's weight in the rounds before, for each signal; empty in the
        first.

    Returns
    -------
    tuple
        The rows, and the factors with those of this model. What one round has learned, the next
        does not forget.
    """
    rng = np.random.default_rng(seed)
    low = fast_state.UPPER_LOUD_20
    parts: list[tuple[Array, Array, Array]] = []
    known: list[Array] = []

    with compiled():
        for number, item in enumerate(signals):
            signal = item.signal
            settings = replace(
                FastSettings.from_design(item.design), suspects_inputs=False, mean_s=0.0
            )
            if settings.filtered:
                cutoff_hz = settings.cutoff_hz * (1 + rng.uniform(-CUTOFF_ERROR, CUTOFF_ERROR))
                gain = settings.filtered.gain * (1 + rng.uniform(-GAIN_ERROR, GAIN_ERROR))
                settings = replace(
                    settings, cutoff_hz=cutoff_hz, filtered=replace(settings.filtered, gain=gain)
                )

            output, found = FastDetector(settings, model).compute_features(
                signal.voltage_v, signal.filtered_v
            )
            labels, weights = label(signal, len(found))
            if model.trees:
                every = round(TICK_S * signal.rate_hz)
                at_ticks = slice(every - 1, every * len(found), every)
                # The confidence is 1 at the threshold and 0 at the lowest score.
                scores = (output.confidence[at_ticks] - 1) * (model.threshold - LOWEST_SCORE)
                factor = emphasise(signal, labels, scores, output.on[at_ticks])
                known.append(np.maximum(factor, factors[number]) if factors else factor)
                weights = weights * known[-1]

            loud = (found[:, [0, 2]] > fast_state.UPPER_LOUD).any(axis=1) | (
                found[:, [1, 3]] > low
            ).any(axis=1)
            thinned = rng.random(len(found)) < KEPT_SHARE
            kept = loud & (weights > 0.0) & (thinned | (weights >= 1.0))
            weights = np.where(weights < 1.0, weights / KEPT_SHARE, weights)
            parts.append((found[kept].astype(np.float32), labels[kept], weights[kept]))

    return Rows(*(np.concatenate(column) for column in zip(*parts, strict=True))), known
