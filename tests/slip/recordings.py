"""Recordings for tests, and the command line in this process."""

from __future__ import annotations

import json

import numpy as np
from typer.testing import CliRunner

from fingertip.cli import app
from fingertip.design import Design
from fingertip.slip import make_detector


def run(*words, lines=None):
    return CliRunner().invoke(app, [str(word) for word in words], input=lines)


def burst(rate: float = 2000.0) -> tuple[np.ndarray, np.ndarray]:
    """One second with slip from 0.5 to 0.7 s."""
    t = np.arange(int(rate)) / rate
    volts = 2.3 + np.random.default_rng(1).normal(0, 4e-4, len(t))
    return t, volts + 0.01 * np.sin(2 * np.pi * 90 * t) * ((t >= 0.5) & (t < 0.7))


def csv(t, v, delimiter=",", header=("time_s", "voltage_v"), comma=False) -> str:
    lines = [delimiter.join(header), *(f"{a:.6f}{delimiter}{b:.6f}" for a, b in zip(t, v, strict=True))]
    return "\n".join([lines[0], *(line.replace(".", ",") if comma else line for line in lines[1:])]) + "\n"


def single_onset(done) -> float:
    """Onset of the only interval that `fingertip detect --json` printed [s]."""
    assert done.exit_code == 0, done.stderr
    (interval,) = json.loads(done.stdout)["intervals"]
    return interval["onset_s"]


T, V = burst()
ONSET = float(T[np.flatnonzero(make_detector("digital", Design()).process(np.round(V, 6)).on)[0]])
