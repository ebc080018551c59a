"""Transfer functions of the filter as built: eqs. (1), (4) and (9) with an amplifier of finite gain-bandwidth.

The amplifier is A(s) = A0 / (1 + s A0 / (2 pi GBW)), one pole; eqs. (1) to (9) are its limit for an infinite GBW.
"""

from __future__ import annotations

import math

from fingertip.board.filters import passband_gain
from fingertip.design.filter_components import Components

OPEN_LOOP_GAIN = 2e5
"""A0 of the TL082 (typical, its data sheet): 106 dB."""


def open_loop(f_hz: float, gain_bandwidth_hz: float) -> complex:
    """A(s) of the amplifier at f [Hz]."""
    return OPEN_LOOP_GAIN / (1.0 + 1j * f_hz * OPEN_LOOP_GAIN / gain_bandwidth_hz)


def first_stage(f_hz: float, c: Components, gain_bandwidth_hz: float, series_f: float = math.inf) -> complex:
    """H1 at f [Hz]: the high-pass C1, R1, then G / (1 + G / A).

    A capacitor in series with R4 (`series_f` [F], variant `precision`) makes G = 1 + R5 / (R4 + 1 / (s C)).
    """
    s = 2j * math.pi * f_hz
    G: complex = passband_gain(c.r4_ohm, c.r5_ohm)
    if not math.isinf(series_f):
        G = 1.0 + c.r5_ohm / (c.r4_ohm + 1.0 / (s * series_f))
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


def network(f_hz: float, c: Components, gain_bandwidth_hz: float, series_f: float = math.inf) -> complex:
    """Hc = H1 H2 at f [Hz]: from the tactile voltage to the diode. The article's figure 4."""
    return first_stage(f_hz, c, gain_bandwidth_hz, series_f) * second_stage(f_hz, c, gain_bandwidth_hz)
