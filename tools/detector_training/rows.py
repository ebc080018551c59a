"""Rows to fit: the features of every tick at which the signal is loud, with label and weight."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fingertip.arrays import Array
from fingertip.campaign.wider_mix.labelled_signal import LabelledSignal
from fingertip.jit import compiled
from fingertip.slip.detectors import fast_loop
from fingertip.slip.detectors.fast import LOWEST_SCORE, SETTLING_S, TICK_S, FastDetector, FastSettings
from fingertip.slip.detectors.fast_model import FastModel
from tools.detector_training.signals import TrainingSignal

EARLY_S = 0.004
"""Time before gross slip from which a tick is labelled as slip [s]."""
ONSET_S = 0.08
"""Time after the onset in which rows count most [s]: there the delay is decided."""
AFTER_S = 0.1
"""Time after a slip in which rows do not count [s]: the energy decays."""
ONSET_WEIGHT, SLIP_WEIGHT, EVENT_WEIGHT, QUIET_WEIGHT = 3.0, 0.3, 2.0, 0.25
ALARM_WEIGHTS = ((-3.0, 3.0), (-1.0, 8.0))
"""Factors of the weight of rows without slip whose score, relative to the threshold, exceeds a value: the previous
round's own false alarms."""
CUTOFF_ERROR, GAIN_ERROR = 0.08, 0.03
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
    labels, weights = np.zeros(ticks), np.full(ticks, QUIET_WEIGHT)
    for event in signal.events:
        weights[(t >= event.onset_s - 0.01) & (t < event.end_s + 0.25)] = EVENT_WEIGHT
    for slide in signal.slides:
        early_s = slide.onset_s - EARLY_S
        weights[(t >= slide.motion_s) & (t < early_s)] = 0.0
        slipping = (t >= early_s) & (t < slide.end_s)
        labels[slipping], weights[slipping] = 1.0, SLIP_WEIGHT
        weights[slipping & (t < slide.onset_s + ONSET_S)] = ONSET_WEIGHT
        weights[(t >= slide.end_s) & (t < slide.end_s + AFTER_S)] = 0.0
    weights[t < SETTLING_S] = 0.0
    return labels, weights


def collect(signals: Iterable[TrainingSignal], model: FastModel, seed: int) -> Rows:
    """Run the detector with a model over signals and collect the rows.

    The detector assumes the cutoff and the gain of an ideal board; the real one deviates from them.
    """
    rng = np.random.default_rng(seed)
    low = fast_loop.UPPER_LOUD_20
    parts: list[tuple[Array, Array, Array]] = []
    with compiled():
        for item in signals:
            signal, settings = item.signal, FastSettings.from_design(item.design)
            if settings.filtered:
                cutoff_hz = settings.cutoff_hz * (1 + rng.uniform(-CUTOFF_ERROR, CUTOFF_ERROR))
                gain = settings.filtered.gain * (1 + rng.uniform(-GAIN_ERROR, GAIN_ERROR))
                settings = replace(settings, cutoff_hz=cutoff_hz, filtered=replace(settings.filtered, gain=gain))
            output, found = FastDetector(settings, model).compute_features(signal.voltage_v, signal.filtered_v)
            labels, weights = label(signal, len(found))
            every = round(TICK_S * signal.rate_hz)
            # The confidence is 1 at the threshold and 0 at the lowest score.
            span = model.threshold - LOWEST_SCORE
            margin = (output.confidence[every - 1 :: every][: len(found)] - 1) * span
            factor = np.ones(len(found))
            for above, value in ALARM_WEIGHTS:
                factor[margin > above] = value
            weights = np.where(labels > 0.0, weights, weights * factor) if model.trees else weights
            loud = (found[:, [0, 2]] > fast_loop.UPPER_LOUD).any(axis=1) | (found[:, [1, 3]] > low).any(axis=1)
            thinned = rng.random(len(found)) < KEPT_SHARE
            kept = loud & (weights > 0.0) & (thinned | (weights >= 1.0))
            weights = np.where(weights < 1.0, weights / KEPT_SHARE, weights)
            parts.append((found[kept].astype(np.float32), labels[kept], weights[kept]))
    return Rows(*(np.concatenate(column) for column in zip(*parts, strict=True)))
