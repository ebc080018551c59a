"""Transfer functions of the article's filter with ideal amplifiers (eqs. 1, 4 and 9), as an oracle.

The article writes omega where j omega is meant. Here s = j 2 pi f.
"""

from __future__ import annotations

import math

from fingertip.design.formulas.filter import FilterComponents


def first_stage_transfer(f_hz: float, components: FilterComponents) -> complex:
    """H1 = G s / (s + 1 / (R1 C1)) at f [Hz], eq. (1), with G = 1 + R5 / R4, eq. (2)."""
    s = 2j * math.pi * f_hz
    return (
        (1.0 + components.r5_ohm / components.r4_ohm)
        * s
        / (s + 1.0 / (components.r1_ohm * components.c_f))
    )


def second_stage_transfer(f_hz: float, components: FilterComponents) -> complex:
    """H2 = s^2 / (s^2 + 2 s / (R3 C) + 1 / (R2 R3 C^2)) at f [Hz], eq. (4)."""
    s = 2j * math.pi * f_hz
    return (
        s
        * s
        / (
            s * s
            + 2.0 * s / (components.r3_ohm * components.c_f)
            + 1.0 / (components.r2_ohm * components.c_f) / (components.r3_ohm * components.c_f)
        )
    )


def ideal_filter_transfer(f_hz: float, components: FilterComponents) -> complex:
    """Hc = H1 H2 at f [Hz], eq. (9): from the tactile voltage to the diode."""
    return first_stage_transfer(f_hz, components) * second_stage_transfer(f_hz, components)
