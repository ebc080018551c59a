"""The slip filter's formulas (article, eqs. 1 to 11): transfer functions, and what built parts achieve.

The chain: a first-order high-pass with gain (C1, R1; R4, R5), a unity-gain Sallen-Key high-pass (C2, C3; R2,
R3), a diode, and R_LP parallel to C_LP. The formulas that give R1 to R4 and R_LP (eqs. 2, 5, 6, 7, 11) stand
in `fingertip.design.filter_components`, because the design's rules need them too.

The article writes omega where j omega is meant (eqs. 1, 3, 4, 9, 11); here s = j 2 pi f.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass

from fingertip.design.filter_components import Components


def passband_gain(r4_ohm: float, r5_ohm: float) -> float:
    """G = 1 + R5 / R4, eq. (2). The article prints 66.7 for 100k and 1.5k, which is R5 / R4; G is 67.67."""
    return 1.0 + r5_ohm / r4_ohm


def pole_hz(r_ohm: float, c_f: float) -> float:
    """1 / (2 pi R C) [Hz] for R [ohm] and C [F]: of the first stage, and of the envelope (below eq. 11)."""
    return 1.0 / (math.tau * r_ohm * c_f)


def section_frequency_hz(r2_ohm: float, r3_ohm: float, c_f: float) -> float:
    """f0 = 1 / (2 pi C sqrt(R2 R3)) [Hz] of the Sallen-Key section.

    Eq. (10) prints 1 / sqrt(R2 R3 C), with C inside the root, which is no frequency.
    """
    return 1.0 / (math.tau * c_f * math.sqrt(r2_ohm) * math.sqrt(r3_ohm))


def section_quality(r2_ohm: float, r3_ohm: float) -> float:
    """Q = sqrt(R3 / (4 R2)) of the Sallen-Key section with equal capacitors, eq. (8)."""
    return math.sqrt(r3_ohm / (4.0 * r2_ohm))


def overall_cutoff_hz(first_pole_hz: float, section_hz: float, quality: float) -> float:
    """Frequency [Hz] where the third-order high-pass has lost half its passband power (-3.0103 dB).

    With v = (f0 / f)^2 and r = (f1 / f0)^2, eq. (9) gives (G / |H|)^2 = (1 + r v)(1 + (1/Q^2 - 2) v + v^2),
    which is 2 there. If a high Q makes several such frequencies, this is the highest: all above it passes.

    Parameters
    ----------
    first_pole_hz
        Pole f1 of the first-order stage.
    section_hz, quality
        f0 and Q of the second-order stage.
    """
    r = (first_pole_hz / section_hz) ** 2
    beta = 1.0 / quality**2 - 2.0

    def loss(v: float) -> float:
        return (1.0 + r * v) * (1.0 + beta * v + v * v) - 2.0

    # loss(0) = -1, and the loss may turn twice, where 3 r v^2 + 2 (1 + r beta) v + r + beta = 0: its first
    # root lies before the first turn if the loss there is positive, else after the second.
    low, high = 0.0, 1.0
    discriminant = (1.0 + r * beta) ** 2 - 3.0 * r * (r + beta)
    if discriminant > 0:
        first_turn = (-(1.0 + r * beta) - math.sqrt(discriminant)) / (3.0 * r)
        second_turn = (-(1.0 + r * beta) + math.sqrt(discriminant)) / (3.0 * r)
        if first_turn > 0 and loss(first_turn) >= 0:
            high = first_turn
        elif second_turn > 0:
            low, high = second_turn, 2.0 * second_turn
    while loss(high) < 0:
        high *= 2.0
    while low < (middle := 0.5 * (low + high)) < high:  # until low and high are neighbouring floats
        low, high = (middle, high) if loss(middle) < 0 else (low, middle)
    return section_hz / math.sqrt(high)


def first_stage(f_hz: float, c: Components) -> complex:
    """H1 = G s / (s + 1 / (R1 C1)), eq. (1), at f [Hz]."""
    s = 2j * math.pi * f_hz
    return passband_gain(c.r4_ohm, c.r5_ohm) * s / (s + 1.0 / (c.r1_ohm * c.c_f))


def second_stage(f_hz: float, c: Components) -> complex:
    """H2 = s^2 / (s^2 + 2 s / (R3 C) + 1 / (R2 R3 C^2)), eq. (4), at f [Hz]."""
    s = 2j * math.pi * f_hz
    return s * s / (s * s + 2.0 * s / (c.r3_ohm * c.c_f) + 1.0 / (c.r2_ohm * c.c_f) / (c.r3_ohm * c.c_f))


def filter_network(f_hz: float, c: Components) -> complex:
    """Hc = H1 H2, eq. (9), at f [Hz]: from the tactile voltage to the diode."""
    return first_stage(f_hz, c) * second_stage(f_hz, c)


def envelope_impedance(f_hz: float, c: Components) -> complex:
    """Z = (1 / C_LP) / (s + 1 / (R_LP C_LP)) [ohm], eq. (11), at f [Hz].

    The article calls it a low-pass filter's transfer function. It is volts per ampere: a diode that feeds
    R_LP parallel to C_LP is a peak detector, whose 36.17 Hz (tau = R_LP C_LP = 4.40 ms) are its decay.
    """
    s = 2j * math.pi * f_hz
    return (1.0 / c.c_lp_f) / (s + 1.0 / (c.r_lp_ohm * c.c_lp_f))


def decibel(ratio: complex) -> float:
    """20 log10 |ratio| [dB]; minus infinity for 0."""
    return 20.0 * math.log10(abs(ratio)) if ratio else -math.inf


def degrees(ratio: complex) -> float:
    """Phase of a transfer function's value [degree], within -180 to 180."""
    return math.degrees(cmath.phase(ratio))


@dataclass(frozen=True)
class Response:
    """What a set of component values does."""

    passband_gain: float
    """G of the formulas; as built, the largest gain there is."""
    passband_gain_db: float
    first_pole_hz: float
    section_hz: float
    """f0 of the Sallen-Key section."""
    section_quality: float
    cutoff_hz: float
    """Overall -3.0103 dB frequency, at the lower end."""
    upper_cutoff_hz: float
    """The same at the upper end; of the formulas alone: where the amplifier itself ends the first stage."""
    envelope_pole_hz: float
    envelope_decay_s: float
    """tau = R_LP C_LP."""
    amplifier_bandwidth_hz: float
    """GBW / G: where the amplifier itself ends the first stage's passband."""


def response(c: Components, gain_bandwidth_hz: float) -> Response:
    """The formulas inverted: what components achieve, given the amplifier's gain-bandwidth product [Hz]."""
    G = passband_gain(c.r4_ohm, c.r5_ohm)
    f1 = pole_hz(c.r1_ohm, c.c_f)
    f0, Q = section_frequency_hz(c.r2_ohm, c.r3_ohm, c.c_f), section_quality(c.r2_ohm, c.r3_ohm)
    return Response(
        passband_gain=G,
        passband_gain_db=decibel(G),
        first_pole_hz=f1,
        section_hz=f0,
        section_quality=Q,
        cutoff_hz=overall_cutoff_hz(f1, f0, Q),
        upper_cutoff_hz=gain_bandwidth_hz / G,
        envelope_pole_hz=pole_hz(c.r_lp_ohm, c.c_lp_f),
        envelope_decay_s=c.r_lp_ohm * c.c_lp_f,
        amplifier_bandwidth_hz=gain_bandwidth_hz / G,
    )
