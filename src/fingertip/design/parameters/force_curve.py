"""Parameters of the sensor's force curve: conductance over force, typical or calibrated."""

from __future__ import annotations

from typing import Literal

from fingertip.design.parameters.declaration import ParameterTable, choice, quantity

TURN_ON_N = 0.2
"""Force [N] below which a typical sensor is open: 20 gram force (Interlink; light contact in the article)."""


class ForceCurve(ParameterTable):
    """Conductance of the sensor over force; the figures are used only if curve is "calibrated"."""

    curve: Literal["typical", "calibrated"] = choice(
        "typical",
        "typical: Interlink's curve, from which real sensors differ by factors; calibrated: the figures below, which "
        "`fingertip calibrate sensor` finds.",
    )
    turn_on_n: float = quantity(TURN_ON_N, "N", "Force at which the sensor begins to conduct.", minimum=0, maximum=5)
    conductance_us: float = quantity(
        190.0, "uS", "Conductance at a force of 1 N above turn_on_n.", above=0, maximum=1e5
    )
    exponent: float = quantity(
        0.52, "", "Exponent of the conductance over the force above turn_on_n.", minimum=0.1, maximum=3
    )
    min_force_n: float = quantity(0.5, "N", "Smallest force of the calibration.", above=0, maximum=100)
    max_force_n: float = quantity(10.0, "N", "Largest force of the calibration.", above=0, maximum=1000)
    interval_factor: float = quantity(
        8.0,
        "",
        "Factor within which a force read off the curve lies with 95 % probability, between these two forces.",
        minimum=1,
        maximum=1000,
    )
