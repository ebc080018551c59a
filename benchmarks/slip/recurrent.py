"""Small recurrent network, as the literature uses for slip in one tactile signal: one layer of
gated recurrent units.

Every 2 ms it is given the energy above the board's cutoff, that of its differences, and the change
of the tactile voltage over 10 and 50 ms, all over the noise. `tools/detector_training/recurrent.py`
trains it.
"""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.slip.baselines import Flags, adapt, band_signal, least_energy
from benchmarks.slip.recordings import Recording
from fingertip.design import Design
from fingertip.foundation.numerics import Array

TABLE = "recurrent.json"
INPUTS = 4
TICK_S = 0.002
THRESHOLD = 3.0
"""Logit above which slip is ON at the factor 1: a probability of 95 %."""
FACTORS = (-0.5, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0)
_SHORT = 5
_LONG = 25
"""Ticks over which the change of the voltage is taken."""


def find_inputs(design: Design, recording: Recording) -> Array:
    """Compute the inputs at each tick, (ticks, `INPUTS`)."""
    samples = band_signal(design, recording)
    voltage = recording.signal.voltage_v
    size = max(1, round(TICK_S * recording.signal.rate_hz))
    least = least_energy(design, recording)
    energy = _mean_over(samples**2, size) / least
    rough = _mean_over(np.diff(samples, prepend=samples[:1]) ** 2, size) / least
    slow = _mean_over(voltage, size) / math.sqrt(least)
    if design.board.tactile_rises:
        slow = -slow

    before = (
        np.concatenate((np.full(ticks, slow[0]), slow))[: len(slow)] for ticks in (_SHORT, _LONG)
    )
    changes = [np.arcsinh((slow - then) / 10) for then in before]
    return np.stack((np.log(energy + 0.1), np.log(rough + 0.1), *changes), axis=1)


def _mean_over(values: Array, size: int) -> Array:
    ticks = len(values) // size
    return np.asarray(values[: ticks * size].reshape(ticks, size).mean(axis=1))


@functools.cache
def load_weights() -> dict[str, Any]:
    read = json.loads(Path(__file__).with_name(TABLE).read_text(encoding="utf-8"))
    return {name: np.array(value) for name, value in read.items()}


def find_logits(inputs: Array) -> Array:
    """Run the network over the inputs of all ticks."""
    weights = load_weights()
    hidden_weights = weights["weight_hh_l0"]
    size = weights["weight_hh_l0"].shape[1]
    into = inputs @ weights["weight_ih_l0"].T + weights["bias_ih_l0"]
    state = np.zeros(size)
    states = np.zeros((len(inputs), size))

    for i in range(len(inputs)):
        # Equations of torch.nn.GRU: reset and update gates, then the candidate.
        within = hidden_weights @ state + weights["bias_hh_l0"]
        gates = 1 / (1 + np.exp(-(into[i, : 2 * size] + within[: 2 * size])))
        candidate = np.tanh(into[i, 2 * size :] + gates[:size] * within[2 * size :])
        state = candidate + gates[size:] * (state - candidate)
        states[i] = state

    return np.asarray(states @ weights["output"][0] + weights["bias"][0])


def run_recurrent(
    design: Design, recording: Recording, factors: Sequence[float]
) -> Iterator[Flags]:
    design, recording = adapt(design, recording)
    logits = find_logits(find_inputs(design, recording))
    count = len(recording.signal.voltage_v)
    size = max(1, round(TICK_S * recording.signal.rate_hz))
    # A tick is known when its last sample is there.
    known = np.concatenate((np.full(size - 1, -np.inf), np.repeat(logits, size)))[:count]
    known = np.concatenate((known, np.full(count - len(known), known[-1])))
    for factor in factors:
        yield known > factor * THRESHOLD
