"""Formulas of the slip filter with ideal amplifiers (article, eqs. 1 to 11), and the response they give components.

The signal chain is a first-order high-pass with gain (C1, R1; R4, R5), a unity-gain Sallen-Key high-pass (C2, C3; R2,
R3), a diode, and R_LP parallel to C_LP. The formulas for R1 to R4 and R_LP (eqs. 2, 5, 6, 7, 11) are in
`fingertip.design.filter_components`, because the design's rules need them too.

The article writes omega where j omega is meant (eqs. 1, 3, 4, 9, 11). The formulas in this package use s = j 2 pi f.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from fingertip.design.filter_components import FilterComponents
from fingertip.numerics import bisect


def passband_gain(r4_ohm: float, r5_ohm: float) -> float:
    """G = 1 + R5 / R4, eq. (2). The article prints 66.7 for 100k and 1.5k, which is R5 / R4; G is 67.67."""
    return 1.0 + r5_ohm / r4_ohm


def pole_hz(r_ohm: float, c_f: float) -> float:
    """1 / (2 pi R C) [Hz] for R [ohm] and C [F]: pole of the first stage, and of the envelope (below eq. 11)."""
    return 1.0 / (math.tau * r_ohm * c_f)


def section_frequency_hz(r2_ohm: float, r3_ohm: float, c_f: float) -> float:
    """f0 = 1 / (2 pi C sqrt(R2 R3)) [Hz] of the Sallen-Key section.

    Eq. (10) prints 1 / sqrt(R2 R3 C), with C inside the root, which is not a frequency.
    """
    return 1.0 / (math.tau * c_f * math.sqrt(r2_ohm) * math.sqrt(r3_ohm))


def section_quality(r2_ohm: float, r3_ohm: float) -> float:
    """Q = sqrt(R3 / (4 R2)) of the Sallen-Key section with equal capacitors, eq. (8)."""
    return math.sqrt(r3_ohm / (4.0 * r2_ohm))


def overall_cutoff_hz(first_pole_hz: float, section_hz: float, quality: float) -> float:
    """Cutoff of the third-order high-pass: the frequency [Hz] at half the passband power (-3.0103 dB).

    With v = (f0 / f)^2 and r = (f1 / f0)^2, eq. (9) gives (G / |H|)^2 = (1 + r v)(1 + (1/Q^2 - 2) v + v^2), which is 2
    at the cutoff. A high Q can cause several such frequencies. The function returns the highest: everything above it
    passes.

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

    # loss(0) = -1. The loss has at most two extrema, where 3 r v^2 + 2 (1 + r beta) v + r + beta = 0. Its first root
    # lies before the first extremum if the loss is positive there, otherwise after the second.
    low, high = 0.0, 1.0
    discriminant = (1.0 + r * beta) ** 2 - 3.0 * r * (r + beta)
    if discriminant > 0:
        first_extremum = (-(1.0 + r * beta) - math.sqrt(discriminant)) / (3.0 * r)
        second_extremum = (-(1.0 + r * beta) + math.sqrt(discriminant)) / (3.0 * r)
        if first_extremum > 0 and loss(first_extremum) >= 0:
            high = first_extremum
        elif second_extremum > 0:
            low, high = second_extremum, 2.0 * second_extremum
    while loss(high) < 0:
        high *= 2.0
    _, high = bisect(lambda v: loss(v) < 0, low, high)
    return section_hz / math.sqrt(high)


def decibel(ratio: complex) -> float:
    """20 log10 |ratio| [dB]; minus infinity for 0."""
    return 20.0 * math.log10(abs(ratio)) if ratio else -math.inf


@dataclass(frozen=True)
class FrequencyResponse:
    """Characteristics of the frequency response of the filter and the envelope."""

    passband_gain: float
    """Gain G of the formulas; for a nonideal amplifier the maximum gain."""
    passband_gain_db: float
    first_pole_hz: float
    section_hz: float
    """f0 of the Sallen-Key section."""
    section_quality: float
    cutoff_hz: float
    """Lower overall cutoff frequency (-3.0103 dB)."""
    upper_cutoff_hz: float
    """Upper overall cutoff frequency (-3.0103 dB); for the formulas alone the amplifier's closed-loop bandwidth."""
    envelope_pole_hz: float
    envelope_decay_s: float
    """Time constant tau = R_LP C_LP."""
    amplifier_bandwidth_hz: float
    """Closed-loop bandwidth GBW / G of the first stage's amplifier."""


def ideal_response(components: FilterComponents, gain_bandwidth_hz: float) -> FrequencyResponse:
    """Compute the response of components by the formulas, for an amplifier of this gain-bandwidth product [Hz]."""
    G = passband_gain(components.r4_ohm, components.r5_ohm)
    f1 = pole_hz(components.r1_ohm, components.c_f)
    f0 = section_frequency_hz(components.r2_ohm, components.r3_ohm, components.c_f)
    Q = section_quality(components.r2_ohm, components.r3_ohm)
    return FrequencyResponse(
        passband_gain=G,
        passband_gain_db=decibel(G),
        first_pole_hz=f1,
        section_hz=f0,
        section_quality=Q,
        cutoff_hz=overall_cutoff_hz(f1, f0, Q),
        upper_cutoff_hz=gain_bandwidth_hz / G,
        envelope_pole_hz=pole_hz(components.r_lp_ohm, components.c_lp_f),
        envelope_decay_s=components.r_lp_ohm * components.c_lp_f,
        amplifier_bandwidth_hz=gain_bandwidth_hz / G,
    )
