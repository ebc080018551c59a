"""Closed forms of the board's response, noise, offsets and thresholds, derived by hand from its
schematic.

The package computes all of these from the equations of the circuit. The formulas share component
values with it, and nothing else.
"""

from __future__ import annotations

import math

import numpy as np

from fingertip.board.components.selection import FirstStageCapacitors
from fingertip.board.components.values import AdcInterface
from fingertip.design.formulas.filter import FilterComponents

OPEN_LOOP_GAIN = 2e5
INPUT_F = 8e-12


def pole_hz(r_ohm: float, c_f: float) -> float:
    """1 / (2 pi R C) [Hz]."""
    return 1.0 / (math.tau * r_ohm * c_f)


def section_frequency_hz(c: FilterComponents) -> float:
    """f0 = 1 / (2 pi C sqrt(R2 R3)) [Hz] of the Sallen-Key section, eq. (10) corrected."""
    return 1.0 / (math.tau * c.c_f * math.sqrt(c.r2_ohm) * math.sqrt(c.r3_ohm))


def section_quality(c: FilterComponents) -> float:
    """Q = sqrt(R3 / (4 R2)) of the Sallen-Key section with equal capacitors, eq. (8)."""
    return math.sqrt(c.r3_ohm / (4.0 * c.r2_ohm))


def passband_gain(c: FilterComponents) -> float:
    """G = 1 + R5 / R4, eq. (2)."""
    return 1.0 + c.r5_ohm / c.r4_ohm


def ideal_cutoff_hz(c: FilterComponents) -> float:
    """Cutoff of the whole filter [Hz] with ideal amplifiers."""
    return overall_cutoff_hz(pole_hz(c.r1_ohm, c.c_f), section_frequency_hz(c), section_quality(c))


def overall_cutoff_hz(first_pole_hz: float, section_hz: float, quality: float) -> float:
    """Cutoff of the third-order high-pass: the frequency [Hz] at half the passband power (-3.0103
    dB).

    With v = (f0 / f)^2 and r = (f1 / f0)^2, eq. (9) gives (G / |H|)^2 = (1 + r v)(1 + (1/Q^2 - 2) v
    + v^2), which is 2 at the cutoff. A high Q can cause several such frequencies; everything passes
    above the highest, the least v.
    """
    r = (first_pole_hz / section_hz) ** 2
    beta = 1.0 / quality**2 - 2.0
    roots = np.roots([r, 1.0 + r * beta, r + beta, -1.0])
    return section_hz / math.sqrt(
        min(v.real for v in roots if abs(v.imag) < 1e-9 * abs(v) and v.real > 0.0)
    )


def open_loop_transfer(f_hz: float, gain_bandwidth_hz: float) -> complex:
    """Open-loop gain A(s) = A0 / (1 + s A0 / (2 pi GBW)) of an amplifier at f [Hz]."""
    return OPEN_LOOP_GAIN / (1.0 + 1j * f_hz * OPEN_LOOP_GAIN / gain_bandwidth_hz)


def first_stage_transfer(
    f_hz: float,
    c: FilterComponents,
    gain_bandwidth_hz: float,
    capacitors: FirstStageCapacitors | None = None,
    input_f: float = INPUT_F,
) -> complex:
    """H1 at f [Hz]: the high-pass C1, R1, then G / (1 + G / A) with G
    = (Y4 + Y5) / Y5; inputs have a capacitance.
    """
    s = 2j * math.pi * f_hz
    high_pass = s * c.c_f / (s * (c.c_f + input_f) + 1.0 / c.r1_ohm)
    y4 = s * input_f + 1.0 / c.r4_ohm
    y5 = 1.0 / c.r5_ohm + 0j
    if capacitors is not None:
        y4 = s * input_f + 1.0 / (c.r4_ohm + 1.0 / (s * capacitors.series_capacitor_f))
        y5 += s * capacitors.limiting_capacitor_f
    G = (y4 + y5) / y5
    return high_pass * G / (1.0 + G / open_loop_transfer(f_hz, gain_bandwidth_hz))


def second_stage_transfer(
    f_hz: float, c: FilterComponents, gain_bandwidth_hz: float, input_f: float = INPUT_F
) -> complex:
    """H2 at f [Hz], by Kirchhoff's current law between C2 and C3
    and at the buffer's input; K = A / (1 + A).
    """
    s = 2j * math.pi * f_hz
    A = open_loop_transfer(f_hz, gain_bandwidth_hz)
    K = A / (1.0 + A)
    g2 = 1.0 / c.r2_ohm
    sc = s * c.c_f
    divider = sc / (sc + 1.0 / c.r3_ohm + s * input_f)
    return K * divider * sc / (2.0 * sc + g2 - divider * (sc + K * g2))


def filter_transfer(
    f_hz: float,
    c: FilterComponents,
    gain_bandwidth_hz: float,
    capacitors: FirstStageCapacitors | None = None,
    input_f: float = INPUT_F,
) -> complex:
    """Hc = H1 H2 at f [Hz], from the tactile voltage to the rectifier; the article's figure 4."""
    first = first_stage_transfer(f_hz, c, gain_bandwidth_hz, capacitors, input_f)
    return first * second_stage_transfer(f_hz, c, gain_bandwidth_hz, input_f)


def tactile_pin_transfer(f_hz: float, c: AdcInterface) -> complex:
    """Transfer function from the tactile voltage to its pin at f [Hz]: two RC sections."""
    s = 2j * math.pi * f_hz
    sum_s = c.first_ohm * (c.first_f + c.second_f) + c.second_ohm * c.second_f
    return 1.0 / (1.0 + s * sum_s + s * c.first_ohm * c.first_f * s * c.second_ohm * c.second_f)


def envelope_pin_transfer(f_hz: float, c: AdcInterface) -> complex:
    """Transfer function from the envelope to its pin at f [Hz]."""
    return 1.0 / (1.0 + 1j * f_hz / pole_hz(c.output_ohm, c.output_f))


def envelope_offset_gains(
    envelope_ohm: float, rectifier_ohm: float
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Gains of the offsets of Sallen-Key stage, rectifier and envelope: with the positive diode on,
    and off.

    With it E = o1 - 2 o2 + 2 o3 for R15 = R16 and R6 = R17. Without it R16 and R17 lie in series:
    E = o3 + (o3 - o2) R6 / (R16 + R17).
    """
    ratio = envelope_ohm / (rectifier_ohm + envelope_ohm)
    return (1.0, -2.0, 2.0), (0.0, -ratio, 1.0 + ratio)


def comparator_threshold_v(
    top_ohm: float,
    hysteresis_ohm: float,
    upper_v: float,
    output_v: float,
    output_ohm: float,
    ratio: float = 0.5,
) -> float:
    """Threshold [V] above the signal ground of a 10 kohm trimmer at a ratio, between two sources
    and this ground.

    One source is the upper rail behind the top resistor, the other the output behind its own and
    the hysteresis's.
    """
    low = ratio * 10e3
    high = (1.0 - ratio) * 10e3 + top_ohm
    feedback = hysteresis_ohm + output_ohm
    return (upper_v / high + output_v / feedback) / (1.0 / high + 1.0 / feedback + 1.0 / low)
