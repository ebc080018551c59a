"""Rows to fit: the features of each tick at which the table is asked, with label and weight."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from benchmarks.slip.baselines import adapt, make_settings
from benchmarks.slip.bench import Source
from benchmarks.slip.real_sets import SLIDES
from benchmarks.slip.recordings import Recording
from fingertip.foundation.numerics import Array
from fingertip.foundation.workers import call_each
from fingertip.slip.detectors.fast import FastDetector, collect_rows
from fingertip.slip.detectors.registry import select_inputs

EARLY_S = 0.005
END_S = 0.01
"""Time before gross slip from which a tick is slip, and before a slip's end up to which [s]."""
UNSURE_S = 0.01
AFTER_S = 0.25
"""Time before a slip's motion and after its end in which ticks do not count [s]."""
SETTLING_S = 0.32
LATE_S = 0.06
LATE_SHARE = 0.1
"""Time after an onset from which a tick of slip is late [s], and the share that is kept."""
ABRUPT_S = 0.01
OPENING_S = 0.03
"""Times after an onset in which ticks weigh less: slip has hardly begun, or has been found [s]."""
APART_S = 0.1
"""Time without ticks between two events [s]."""
SLIP_WEIGHTS = {
    "slide full": 1.0,
    "slide half": 1.0,
    "slide quarter": 1.0,
    "slide on board": 0.7,
    "trials": 1.5,
    "burst": 3.5,
    "manipulation": 0.3,
    "simulated": 0.7,
}
OTHER_SLIP_WEIGHT = 1.2
WEIGHTS = {
    "grasp": 0.5,
    "stick hit": 1.0,
    "hand motion": 1.0,
    "servo": 1.2,
    "set-down": 0.6,
    "isolated step": 1.3,
    "force ramp": 0.5,
    "release": 0.4,
    "tap": 0.4,
    "knock": 0.4,
    "ring": 1.5,
    "hum": 0.8,
    "vibration": 0.15,
    "manipulation": 1.2,
    "simulated tap": 0.8,
    "simulated hard tap": 0.5,
    "simulated vibration": 0.3,
    "simulated": 0.8,
}
ON_GRASP = " on grasp"
ON_GRASP_WEIGHT = 1.5
OTHER_WEIGHT = 0.3
"""Weight of all ticks of a kind of slip, and of a kind that is none, by the begin of its name."""


@dataclass(frozen=True, eq=False)
class Rows:
    """Ticks of any number of recordings."""

    features: NDArray[np.float32]
    is_slip: NDArray[np.bool_]
    group: NDArray[np.str_]
    """Kind of signal, to whose weight a tick contributes."""
    event: NDArray[np.int64]
    """Number of the event that a tick belongs to."""
    since_s: Array
    """Time since the onset of its slip [s]; infinite without one."""


def collect(source: Source) -> Rows:
    """Compute the rows of a source."""
    parts = [rows for one in source.read() if len((rows := collect_one(one)).is_slip)]
    return join(parts) if parts else empty_rows()


def collect_one(recording: Recording) -> Rows:
    """Compute the rows of a recording, whose floors the truth guards in place of the table."""
    assert recording.design is not None
    design, recording = adapt(recording.design, recording)
    signal = recording.signal
    time_s = np.arange(len(signal.voltage_v)) / signal.rate_hz
    is_slip = np.zeros(len(time_s), dtype=bool)
    is_known = time_s >= max(signal.alarms_from_s, SETTLING_S)
    onset_s = np.full(len(time_s), -np.inf)

    for slide in signal.slides:
        around = (time_s >= slide.motion_s - UNSURE_S) & (time_s < slide.end_s + AFTER_S)
        inside = (time_s >= slide.onset_s - EARLY_S) & (time_s < slide.end_s - END_S)
        is_known[around & ~inside] = False
        is_slip[inside] = True
        onset_s[inside] = slide.onset_s

    inputs = select_inputs(signal, "fast")
    filtered_v = inputs[1] if len(inputs) > 1 else None
    detector = FastDetector(make_settings(design, recording))
    features, places = collect_rows(detector, signal.voltage_v, filtered_v, is_slip)
    if not len(places):
        return empty_rows()

    kept = is_known[places] & ~_thin(time_s[places] - onset_s[places], is_slip[places])
    return _make_rows(features[kept], places[kept], signal.rate_hz, is_slip, onset_s, signal.kind)


def _thin(since_s: Array, is_slip: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Choose the late ticks of slip to leave out."""
    drawn = np.random.default_rng(len(since_s)).random(len(since_s))
    return is_slip & (since_s > LATE_S) & (drawn >= LATE_SHARE)


def _make_rows(
    features: NDArray[np.float32],
    places: NDArray[np.int64],
    rate_hz: float,
    is_slip: NDArray[np.bool_],
    onset_s: Array,
    kind: str,
) -> Rows:
    """Join features with their labels; ticks apart from the ones before begin another event."""
    labels = is_slip[places]
    groups = [find_group(kind, one) for one in (False, True)]
    begins = np.diff(places, prepend=places[:1]) > APART_S * rate_hz
    return Rows(
        features=features,
        is_slip=labels,
        group=np.where(labels, groups[1], groups[0]),
        event=np.cumsum(begins),
        since_s=np.where(labels, places / rate_hz - onset_s[places], np.inf),
    )


def find_group(kind: str, is_slip: bool) -> str:
    """Find the group whose weight a tick of a kind of signal contributes to."""
    if kind.endswith(ON_GRASP):
        return ON_GRASP

    if kind in SLIDES and not is_slip:
        return "grasp"  # to which the slide is joined

    known = SLIP_WEIGHTS if is_slip else WEIGHTS
    return next((name for name in known if kind.startswith(name)), "other")


def empty_rows() -> Rows:
    return Rows(
        features=np.zeros((0, 0), dtype=np.float32),
        is_slip=np.zeros(0, dtype=bool),
        group=np.zeros(0, dtype=str),
        event=np.zeros(0, dtype=np.int64),
        since_s=np.zeros(0),
    )


def join(parts: Iterable[Rows]) -> Rows:
    """Join rows; events stay apart."""
    shifted = list[Rows]()
    last = 0
    for one in parts:
        if not len(one.is_slip):
            continue

        shifted.append(replace(one, event=one.event + last))
        last = int(shifted[-1].event.max()) + 1

    columns = {
        name: np.concatenate([getattr(one, name) for one in shifted]) for name in vars(shifted[0])
    }
    return Rows(**columns)


def collect_all(sources: Iterable[Source]) -> Rows:
    """Compute the rows of all sources, side by side."""
    return join(call_each(partial(collect, source) for source in sources))


def weigh(rows: Rows) -> Array:
    """Compute the weight of each row.

    An event counts by the root of its ticks, so that long motion of a hand does not drown the rest;
    all ticks of a group count as its weight says.
    """
    weights = np.ones(len(rows.is_slip))
    is_burst = rows.group == "burst"
    weights[rows.is_slip & (rows.since_s > OPENING_S)] = 0.5
    weights[rows.is_slip & (rows.since_s < ABRUPT_S)] = 0.3
    weights[rows.is_slip & (rows.since_s < ABRUPT_S) & is_burst] = 0.8
    _, event, ticks = np.unique(rows.event, return_inverse=True, return_counts=True)
    weights /= np.sqrt(ticks[event])

    for group in np.unique(rows.group):
        for is_slip in (True, False):
            inside = (rows.group == group) & (rows.is_slip == is_slip)
            if inside.any():
                weights[inside] *= find_weight(group, is_slip) / weights[inside].sum()

    return np.asarray(weights * len(weights) / weights.sum())


def find_weight(group: str, is_slip: bool) -> float:
    if group == ON_GRASP:
        return ON_GRASP_WEIGHT
    if is_slip:
        return SLIP_WEIGHTS.get(group, OTHER_SLIP_WEIGHT)

    return WEIGHTS.get(group, OTHER_WEIGHT)
