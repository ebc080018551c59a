"""Filter board: rectifier and envelope against a ten-thousandth of the tolerance."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np

from benchmarks.extremes.draw import Draw
from fingertip.design import Design
from fingertip.sim.signal.analog_circuit import AnalogBoard, Diode
from fingertip.sim.signal.filter_board import simulate_board

TOLERANCE_V = 1e-4
SAMPLES = 200


@cache
def _nominal(variant: str) -> AnalogBoard:
    if variant == "slow amplifiers":
        return AnalogBoard.from_design(Design.load("article"), 3e6)
    return AnalogBoard.from_design(Design.load(variant))


def board(draw: Draw) -> float:
    """Bound: ten tolerances and 5 % of the peak; a tolerance holds for the estimated error of one step."""
    nominal = _nominal(draw.choose("board", ("article", "fsr400", "slow amplifiers")))
    values = {
        name: float(value) * draw.log("component / nominal", (0.8, 1.25), (0.1, 10.0))
        for name, value in nominal.components.items()
    }
    fitted = nominal.with_components(**values)
    if fitted.rectifier == "diode":
        saturation = draw.log("saturation current [A]", (1e-10, 1e-8), (1e-15, 1e-6))
        series = draw.log("series resistance [ohm]", (0.1, 10.0), (1e-3, 1e5))
        fitted = replace(fitted, diode=Diode(saturation, draw.log("emission", (1.5, 2.0), (1.0, 2.5)), series))
    if draw.choose("rails", (False, True)) and draw.values["board"] != "slow amplifiers":
        fitted = replace(fitted, rail_v=draw.log("rail [V]", (1.0, 12.0), (0.1, 100.0)))
    step = draw.log("step [s]", (6.25e-6, 1e-4), (1e-6, 1e-3))
    frequency = draw.log("frequency times step", (1e-3, 0.1), (1e-4, 0.2))
    amplitude = draw.log("amplitude [V]", (1e-4, 0.1), (1e-6, 10.0))
    cycle = 2 * math.pi * frequency * np.arange(SAMPLES)
    shape = draw.choose("input", ("burst", "step", "noise"))
    wave = np.sin(cycle) if shape == "burst" else np.ones(SAMPLES)
    if shape == "noise":
        noise = np.random.RandomState(draw.number).standard_normal(SAMPLES)
        wave = np.convolve(noise, np.hanning(12) / 6, "same")
    voltage = amplitude * wave * (np.arange(SAMPLES) > SAMPLES // 8)
    found = simulate_board(fitted, step, voltage, TOLERANCE_V).envelope_v
    exact = simulate_board(fitted, step, voltage, max(1e-8, 1e-6 * amplitude)).envelope_v
    return float(np.abs(found - exact).max() / (10 * TOLERANCE_V + 0.05 * np.abs(exact).max()))
