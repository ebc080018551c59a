"""Motion of the sled: lag of its contact, shear of the skin, and weights on the string."""

import math

STROKE = 30.0
OPEN = 0.05
LONGEST_S = 0.2
MAX_ERROR_S = 0.005
"""Way of the sled, way by which both contacts are open (assumption)
[mm], longest travel, and largest error [s].
"""
MASS_KG = 0.05
SLIDING = 0.3
EDGE = 1.6
FRICTION = 1.0
LEAST_M_S2 = 1.5
"""Sled with strip; friction coefficient below it; ratio of tensions over the edge, exp(0.3 pi / 2);
largest friction coefficient of the skin; least acceleration.
"""


def reach_s(way_mm, travel_s):
    """Return when the sled has gone `way_mm` of its stroke, at a
    constant acceleration: s = a t^2 / 2 [s].
    """
    return travel_s * math.sqrt(way_mm / STROKE)


def onset_s(travel_s, rate_hz):
    """Return by how much the open contact lags the first motion, and the error of that [s].

    The lag lies between 0 and the time for the way OPEN; take its half. The clock adds one sample.
    """
    longest_s = reach_s(OPEN, travel_s)
    return longest_s / 2, longest_s / 2 + 1 / rate_hz


def pulling_kg(force_n):
    """Return the mass on the string that gives LEAST_M_S2 against all
    friction, and the tension of the string [N].
    """
    resisting_n = FRICTION * force_n + SLIDING * (force_n + 9.81 * MASS_KG)
    kg = EDGE * (resisting_n + MASS_KG * LEAST_M_S2) / (9.81 - LEAST_M_S2)
    return kg, 9.81 * kg


def check(rate_hz):
    """Assert that the onset is known well enough; return the figures."""
    lag_s, error_s = onset_s(LONGEST_S, rate_hz)
    assert error_s <= MAX_ERROR_S
    assert math.sqrt(2e-3 * STROKE / LEAST_M_S2) <= LONGEST_S + 1e-9, (
        "the weights of pulling_kg travel too long"
    )

    return {"lag_s": lag_s, "error_s": error_s, "shear_of_1_mm_s": reach_s(1.0, LONGEST_S)}
