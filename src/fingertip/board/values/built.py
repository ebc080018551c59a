"""Transfer functions of the filter as built: eqs. (1), (4) and (9) with an amplifier of finite gain-bandwidth.

The amplifier is A(s) = A0 / (1 + s A0 / (2 pi GBW)), one pole; eqs. (1) to (9) are its limit for an infinite GBW.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.board.values.filters import passband_gain, pole_hz
from fingertip.board.values.preferred import nearest
from fingertip.design.filter_components import Components, limit_capacitor_f, series_capacitor_f


@dataclass(frozen=True)
class FirstStage:
    """Capacitors that variants other than `article` add to the first stage [F]."""

    series_f: float
    """In series with R4: no gain for the amplifier's offset."""
    limit_f: float
    """Across R5: no gain above the vibrations."""
    limit_hz: float
    """Where that gain has lost 3 dB: 1 / (2 pi R5 C)."""


def fit_first_stage(c: Components, band_limit_hz: float) -> FirstStage:
    """Preferred capacitors for fitted components and a band limit [Hz]."""
    limit_f = nearest(limit_capacitor_f(c.r5_ohm, band_limit_hz), "E6", 1e-12, 1e-3)
    series_f = series_capacitor_f(c.r4_ohm, pole_hz(c.r1_ohm, c.c_f))
    return FirstStage(series_f, limit_f, pole_hz(c.r5_ohm, limit_f))


LARGE_PERCENT = 20.0
"""Tolerance of a series capacitor above `MAX_FOOTPRINT_F`: nothing finer is made in its size."""

OPEN_LOOP_GAIN = 2e5
"""A0 of the TL082 (typical, its data sheet): 106 dB; the TLV2372's 110 dB change nothing here."""


def open_loop(f_hz: float, gain_bandwidth_hz: float) -> complex:
    """A(s) of the amplifier at f [Hz]."""
    return OPEN_LOOP_GAIN / (1.0 + 1j * f_hz * OPEN_LOOP_GAIN / gain_bandwidth_hz)


def first_stage(f_hz: float, c: Components, gain_bandwidth_hz: float, extra: FirstStage | None = None) -> complex:
    """H1 at f [Hz]: the high-pass C1, R1, then G / (1 + G / A).

    Variants other than `article` make G = 1 + Z5 / Z4, Z4 = R4 + 1 / (s C14), Z5 = R5 / (1 + s R5 C20).
    """
    s = 2j * math.pi * f_hz
    G: complex = passband_gain(c.r4_ohm, c.r5_ohm)
    if extra is not None:
        G = 1.0 + c.r5_ohm / (1.0 + s * c.r5_ohm * extra.limit_f) / (c.r4_ohm + 1.0 / (s * extra.series_f))
    return s / (s + 1.0 / (c.r1_ohm * c.c_f)) * G / (1.0 + G / open_loop(f_hz, gain_bandwidth_hz))


def second_stage(f_hz: float, c: Components, gain_bandwidth_hz: float) -> complex:
    """H2 at f [Hz], with K = A / (1 + A) for the buffer's unity gain.

    Currents at the middle of C2 and C3 and at the amplifier's input give
    H2 = K s^2 C^2 R2 R3 / (s^2 C^2 R2 R3 + s C (2 R2 + (1 - K) R3) + 1), which is eq. (4) where K = 1.
    """
    s = 2j * math.pi * f_hz
    A = open_loop(f_hz, gain_bandwidth_hz)
    K = A / (1.0 + A)
    square = s * c.r2_ohm * c.c_f * s * c.r3_ohm * c.c_f
    return K * square / (square + s * c.c_f * (2.0 * c.r2_ohm + c.r3_ohm / (1.0 + A)) + 1.0)


def network(f_hz: float, c: Components, gain_bandwidth_hz: float, extra: FirstStage | None = None) -> complex:
    """Hc = H1 H2 at f [Hz]: from the tactile voltage to the diode. The article's figure 4."""
    return first_stage(f_hz, c, gain_bandwidth_hz, extra) * second_stage(f_hz, c, gain_bandwidth_hz)
